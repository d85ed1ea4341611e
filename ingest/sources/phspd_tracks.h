#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/damaged_rows.h"
#include "core/motion/motion.h"

namespace mocurate {

/// The joints of a recording of PHSPD from its first annotated frame to its last. Frames without an annotation, or
/// whose row is damaged, have confidence 0.
struct PhspdTracks {
  int first_frame = 0;             ///< its number in the recording
  JointPositions positions;        ///< (frames, 24) metres, axes of the file, in the order of the file (SMPL's)
  std::vector<double> confidence;  ///< (frames*24); 0: missing
  std::vector<Finding> findings;   ///< of damaged rows, and "time_gap" of frames without a row
};

/// Errors of ParsePhspdPose; kInconsistent where no frame is left, or a gap is too long for a recording.
Expected<PhspdTracks> ReadPhspdTracks(std::string_view bytes, const std::string& name, DamagedRows damaged);

}  // namespace mocurate
