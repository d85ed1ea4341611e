#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/file_rules.h"

namespace mocurate {

/// Rows of numbers without a header: what Kinect data sets ship. A frame is `rows_per_frame` rows.
struct JointTableLayout {
  enum class Separator { kBlanks, kAny };
  int rows_per_frame = 1;
  int columns = 0;  ///< numbers per row; 0: as many as the first row has
  Separator separator = Separator::kAny;
  bool allow_nan = false;  ///< "nan" marks a missing joint and is not an error; "inf" always is
  DamagedRows damaged_rows = DamagedRows::kRefuse;
  std::string end_word;                   ///< closes the table ("END"), on a line of its own; need not be there
  std::vector<std::string> column_names;  ///< for messages; may be fewer than columns
  int first_line = 1;                     ///< number of the first line of the bytes, after a header read elsewhere
};

/// values[(frame * rows_per_frame + row) * columns + column], in the file's own units.
struct JointTable {
  int frames = 0;
  int rows_per_frame = 0;
  int columns = 0;
  std::vector<double> values;                    ///< NaN: not a finite number, or a damaged frame
  std::vector<std::vector<std::string>> header;  ///< cells of the lines before the first row
  int rows_left_over = 0;                        ///< with DamagedRows::kReport: after the last complete frame
  std::vector<Finding>
      findings;  ///< with DamagedRows::kReport: "row_length", "not_a_number", "number_too_large", "cut_off"

  /// (columns) of the last line of the header; empty: none, or of other columns.
  std::vector<std::string> names() const;
  double at(int frame, int row, int column) const {
    return values[(static_cast<std::size_t>(frame) * rows_per_frame + row) * columns + column];
  }
};

/// Blank lines and a trailing separator are ignored; LF, CRLF, byte order mark. Error kMalformed "name:line" for an
/// empty file, a row with another count of numbers, a word that is not a number, a number that is not finite or beyond
/// 1e30, and a count of rows that rows_per_frame does not divide. With DamagedRows::kReport a frame with a row of
/// another length, or with a word that is not a number, is NaN throughout, keeps its place, and is reported. A number
/// that is not finite or too large is NaN, with one finding for all. Rows after the last complete frame are dropped and
/// reported. The columns must then be declared: a damaged first row does not give the length of the others.
Expected<JointTable> ParseJointTable(std::string_view bytes, const JointTableLayout& layout, const std::string& name);

/// The same as text: one row per line, numbers that read back as the same doubles.
std::string WriteJointTable(const JointTable& table, char separator = ' ');

}  // namespace mocurate
