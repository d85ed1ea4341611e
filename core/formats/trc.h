#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/file_rules.h"

namespace mocurate {

/// Markers over time as text (Motion Analysis; OpenSim, Pose2Sim): five lines of header, then a row a frame. Source:
/// OpenSim's documentation of marker (.trc) files.
struct TrcFile {
  std::string recorded;            ///< the file that the first line names
  double rate_hz = 0.0;            ///< DataRate; 0: the file states none
  std::string units;               ///< "mm", "m", ...; empty where the file has none
  std::vector<std::string> names;  ///< (markers)
  std::vector<int> frame_number;   ///< (rows) rising
  std::vector<double> time_s;      ///< (rows); NaN where the cell is empty
  std::vector<double> values;      ///< (rows, markers, 3), file units; NaN: not seen
  std::vector<Finding> findings;   ///< "count_contradiction", "unnamed_points", "row_length", "not_a_number"

  int rows() const { return static_cast<int>(frame_number.size()); }
};

/// Tabs between cells, else commas, else blanks, by the line of names. An empty cell, or "NaN", is a hole. Cells beyond
/// the names are markers without a name: they are counted and left out. Names and rows count, not the header's numbers;
/// where these differ there is a finding. Error kMalformed "name:line" for another first line, a header that is cut
/// off, a name that is empty or twice, a row whose number does not rise, or that has too few cells (kReport: all its
/// markers are holes), a word, a marker of one or two numbers (with DamagedRows::kReport a hole and a finding), a
/// number beyond 1e12; kInconsistent where fewer rows follow than NumFrames announces (kReport: a finding).
Expected<TrcFile> ParseTrc(std::string_view bytes, const std::string& name,
                           DamagedRows damaged_rows = DamagedRows::kRefuse);

/// The file as text, which OpenSim and Pose2Sim read; holes are empty cells.
std::string WriteTrc(const TrcFile& trc);

}  // namespace mocurate
