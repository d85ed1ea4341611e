#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// An OpenSim motion or storage file (.mot, .sto): a header, labels, rows of numbers that begin with the time.
struct OpenSimTable {
  std::string title;                          ///< first line: "Coordinates"; empty where the file has none
  std::map<std::string, std::string> header;  ///< key=value lines but those below ("version": "1")
  std::optional<bool> in_degrees;             ///< rotational coordinates; translations are always metres
  int components = 1;                         ///< numbers per cell: 1; 3 for DataType=Vec3; 4 for Quaternion
  std::vector<std::string> labels;            ///< without time
  std::vector<double> time_s;                 ///< (rows)
  std::vector<double> values;                 ///< (rows, labels, components)

  int rows() const { return static_cast<int>(time_s.size()); }
  double value(int row, int label, int component = 0) const {
    return values[(static_cast<std::size_t>(row) * labels.size() + static_cast<std::size_t>(label)) *
                      static_cast<std::size_t>(components) +
                  static_cast<std::size_t>(component)];
  }
};

/// LF or CRLF; labels between tabs, or blanks where the line has no tab; cells of several numbers with commas. Error
/// kMalformed "name:line" that names the key, the label or the column: no `endheader`, a label twice or none, first
/// label not `time`, a row of another length, no finite number; time that does not grow; kInconsistent: nRows or
/// nColumns contradict what follows; kUnsupported: another DataType. Source: OpenSim's documentation of .mot and .sto.
Expected<OpenSimTable> ParseOpenSimTable(std::string_view bytes, const std::string& name);

}  // namespace mocurate
