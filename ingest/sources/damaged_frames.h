#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/motion/motion.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// A damaged frame of a motion, and the nearest whole frames before and after it (the same one at either end of the
/// motion); share: position between the two, 0 to 1.
struct DamagedFrame {
  int frame = 0;
  int before = 0;
  int after = 0;
  double share = 0.0;
};

/// How damaged frames are filled from their neighbours, however many there are in a row: which of them count, the gap
/// rule decides (ApplyGapRule). `damaged`: rising, below `frames`. Error kInconsistent at "name": no whole frame.
Expected<std::vector<DamagedFrame>> BridgeFrames(const std::vector<int>& damaged, int frames, const std::string& name);

/// Fills these frames of a motion's parameters, `root` (F) and `rotation` (F*joints): rotations by slerp between the
/// whole frames before and after, the root linearly.
void Bridge(const std::vector<DamagedFrame>& bridged, int joints, std::vector<Vector3d>& root,
            std::vector<Quaterniond>& rotation);

/// The clip's motion from a file's rotations (F*joints of `skeleton`): damaged frames (rising) are interpolated and
/// marked, quaternion signs are continuous. `bone_length` empty: those of the rest pose. Errors of BridgeFrames.
Status AddMotion(const std::vector<int>& damaged, const SkeletonPtr& skeleton, const std::vector<double>& bone_length,
                 std::vector<Vector3d> root, std::vector<Quaterniond> rotation, const std::string& name,
                 IngestedClip& ingested);

/// What becomes of frames in which nothing was observed, whatever the format: frames before the first and after the
/// last observation are cut (finding "unobserved_ends"); a gap longer than `source.max_gap_s` is reported ("long_gap"),
/// and where the clip has a motion its frames become kInferred. Returns "mostly_missing" where the share of frames
/// without an observation exceeds `source.max_missing`: the clip is excluded. Findings move with the frames. Clips of a
/// store keep what was decided when they were made; `people.rule: uestc_released` fills every gap as released.
std::optional<Finding> ApplyGapRule(const SourceOptions& source, IngestedClip& ingested);

}  // namespace mocurate
