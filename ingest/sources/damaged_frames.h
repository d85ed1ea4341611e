#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/motion/motion.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// A frame of a motion whose numbers are damaged, and whole frames before and after it (the same one at either end of
/// the motion); share: of the way from one to the other.
struct DamagedFrame {
  int frame = 0;
  int before = 0;
  int after = 0;
  double share = 0.0;
};

/// How damaged frames are bridged: a motion has no missing frame, so that they are taken from their neighbours. At most
/// half a second on end. `damaged`: rising, below `frames`. Error kInconsistent at "name": a longer gap, or no whole
/// frame.
Expected<std::vector<DamagedFrame>> BridgeFrames(const std::vector<int>& damaged, int frames, double rate_hz,
                                                 const std::string& name);

/// Fills these frames of a motion's parameters, `root` (F) and `rotation` (F*joints): rotations on the shortest way
/// from the whole frame before to that after, the root on a straight line.
void Bridge(const std::vector<DamagedFrame>& bridged, int joints, std::vector<Vector3d>& root,
            std::vector<Quaterniond>& rotation);

/// Says so: `motion.state` is kInterpolated there, and findings of these frames have the action "interpolated".
void MarkBridged(const std::vector<DamagedFrame>& bridged, Motion& motion, std::vector<Finding>& findings);

/// The clip's motion from the rotations (F*joints of `skeleton`) of a file: damaged frames (rising) are bridged and
/// marked, signs are continuous. `bone_length` empty: those of the rest pose. Errors of BridgeFrames.
Status AddMotion(const std::vector<int>& damaged, const SkeletonPtr& skeleton, const std::vector<double>& bone_length,
                 std::vector<Vector3d> root, std::vector<Quaterniond> rotation, const std::string& name,
                 IngestedClip& ingested);

}  // namespace mocurate
