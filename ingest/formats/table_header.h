#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/formats/joint_layout.h"
#include "ingest/options.h"

namespace mocurate {

/// What a column of a table is, by its header.
struct HeaderColumn {
  std::string joint;  ///< as the header names it; empty: of none
  std::string word;   ///< "x", "y", "z", "confidence", "skip"; kFillIn: not said; of a column of no joint "" or "skip"
  std::string unit;   ///< of a coordinate, "mm"; empty: not said
  std::string cell;   ///< the header's own text
};

/// The columns of a header that names joints: a name and an axis a column ("left_knee_x", "KneeLeft.Y (mm)",
/// "x:left knee"), a name on three columns, a name above each x y z, or one name for each three numbers; a line of
/// units below. Empty: it names no joints. Error kInconsistent where it names joints and its columns are not those of
/// the rows.
Expected<std::vector<HeaderColumn>> HeaderColumns(std::vector<std::vector<std::string>> header, int columns,
                                                  const std::string& name);

/// What a header says of the numbers of a frame.
struct HeaderLayout {
  std::string skeleton;             ///< of configs/skeletons: of those that have all the joints the one of fewest
  std::vector<std::string> joints;  ///< in the order of the file, as the skeleton names them
  std::string units;                ///< "mm"; empty: not said
};

/// Error kInconsistent lists the names that no skeleton has with the others, or joints without x, y and z side by side,
/// or units that differ.
Expected<HeaderLayout> LayoutOfHeader(const std::vector<HeaderColumn>& columns, const std::string& name);

/// A layout of these columns: "time_s 25*(x y z)". `words` of the columns of no joint; (columns).
std::string LayoutWords(const std::vector<HeaderColumn>& columns, const std::vector<std::string>& words);

/// Refuses a declaration that a header contradicts: another joint, axis or unit in a column. Error kInconsistent names
/// the column. `columns` may be empty.
Status CheckHeader(const std::vector<HeaderColumn>& columns, const JointLayout& layout, const SourceOptions& source,
                   const std::string& name);

}  // namespace mocurate
