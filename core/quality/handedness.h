#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/axes.h"
#include "core/motion/motion.h"

namespace mocurate {

/// Points that define front and back, left and right; -1 where a source has none. Pairs are (left, right).
struct BodyLandmarks {
  int head = -1;
  int hip[2] = {-1, -1};
  int knee[2] = {-1, -1};
  int ankle[2] = {-1, -1};
  int toe[2] = {-1, -1};
  int shoulder[2] = {-1, -1};
  int wrist[2] = {-1, -1};
};

/// `find` gives the index of a point by name ("left_hip", "head", ...), e.g. Skeleton::FindJoint.
BodyLandmarks FindHandednessPoints(const std::function<std::optional<int>(std::string_view name)>& find);

/// Vote of one part of the body. `score` in [-1, 1]: -1 as in a right-handed frame, +1 as in a left-handed one (or
/// with left and right exchanged); `weight` in [0, 1] grows with the share of frames in which the part votes.
struct HandednessCue {
  std::string name;    ///< "feet", "knees", "hands"
  int frames = 0;      ///< frames (times sides) with an opinion
  double share = 0.0;  ///< the same, of all frames and sides
  double score = 0.0;
  double weight = 0.0;
};

struct HandednessMeasure {
  std::optional<Handedness> handedness;  ///< empty: undetermined
  double confidence = 0.0;               ///< in [0, 1]; 0 where undetermined
  std::vector<HandednessCue> cues;
  /// The votes as text ("knees bend backwards (97 % of 312)"); both where they contradict each other.
  std::string evidence;
};

/// Handedness by anatomy: with r from the left to the right hip (shoulder), u up along the trunk and f to the front,
/// the determinant of (r, u, f) is negative in a right-handed frame. To the front point the toes, the hinge of a knee
/// bent about the axis of the hips, and hands that reach away from the trunk. Rotations of
/// the frame do not change the result. It needs two parts of the body that agree and none that contradicts (feet and
/// knees overrule hands), or one part nearly always and in most frames. Where thighs and shanks change their length,
/// joints are those of a depth tracker, which bends straight legs backwards by up to 50 degrees. Knees then count from
/// 57 degrees on, else from 29, and more frames are required.
/// `confidence` (frames*K) may be null; points with confidence 0 are not read.
HandednessMeasure MeasureHandedness(const JointPositions& positions, const BodyLandmarks& points,
                                    const std::vector<double>* confidence = nullptr);

}  // namespace mocurate
