#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/file_rules.h"

namespace mocurate {

/// Exponential-map tables of the CMU and Human3.6M prediction sets: per frame 3 numbers of the root's place (in CMU's
/// set a place, in Human3.6M's often a step), then a rotation vector per joint, root first. 99 columns are 32 joints,
/// 117 are
/// 38. No header, no rate, no names; the unit of length is not declared.
struct ExpmapTable {
  int frames = 0;
  int joints = 0;
  std::vector<double> root;          ///< (frames, 3), file units
  std::vector<double> rotation_rad;  ///< (frames, joints, 3)
  std::vector<Finding> findings;     ///< of damaged rows; their numbers are NaN
};

/// Comma-separated. `columns` 0: as many as the first row has. Error kMalformed "name:line" that names the column, as
/// ParseJointTable, and where the columns are not 3 + 3 per joint.
Expected<ExpmapTable> ParseExpmapTable(std::string_view bytes, const std::string& name, int columns = 0,
                                       DamagedRows damaged_rows = DamagedRows::kRefuse);

}  // namespace mocurate
