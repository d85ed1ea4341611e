#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/motion/motion.h"
#include "core/quality/handedness.h"

namespace mocurate {

/// An order in which a known tracker or data set lists its joints.
struct JointOrder {
  std::string name;      ///< "kard", "kinect1", ...
  std::string skeleton;  ///< whose names `joints` are
  std::vector<std::string> joints;
  std::string label = {};         ///< what is reported for a clip in this order; empty: `skeleton`
  double set_rate_hz = 0.0;       ///< of the one set that lists joints so, and
  std::string set_evidence = {};  ///< its origin; 0 and empty: several sets, or unknown
};

const std::vector<JointOrder>& KnownJointOrders();

/// Names of the skeletons in configs/skeletons.
std::vector<std::string> SkeletonNames();

/// LoadSkeleton, with every file read once: thousands of clips ask for the same few.
Expected<SkeletonPtr> KnownSkeleton(const std::string& name_or_path);

/// A bone between two points, with its length in a rest skeleton.
struct RawBone {
  int from = 0;
  int to = 0;
  double rest_length = 0.0;  ///< metres; 0: unknown
};

/// How body-like points are when read in some order. Both are free of scale; 0 is a rigid body of rest proportions.
struct BodyScore {
  double spread = 0.0;      ///< mean over bones of the robust relative spread of their length
  double proportion = 0.0;  ///< mean distance of log lengths from the rest skeleton's, after the best common scale
  double total() const { return spread + 0.5 * proportion; }
  /// Whether this is a body read in the right order. Trackers' bodies have proportions off by 0.2 at most, other
  /// numbers by 0.45 and more.
  bool IsBody() const { return total() < kBodyLike && proportion < kBodyProportion; }
  static constexpr double kBodyLike = 0.35;
  static constexpr double kBodyProportion = 0.4;
};
/// Above this Rigidity, points are no joints.
inline constexpr double kRigid = 0.2;

/// Bones between points named as joints of `skeleton`; joints without a point are stepped over.
std::vector<RawBone> BonesOf(const std::vector<std::string>& joints, const Skeleton& skeleton);

/// Points with confidence 0 are not read. At most 64 frames are looked at, evenly spread.
BodyScore ScoreBody(const JointPositions& positions, const std::vector<double>& confidence,
                    const std::vector<RawBone>& bones);

/// Two points of an order and how body-like the others are with them once these two change places.
struct PointExchange {
  int first = 0;
  int second = 0;
  BodyScore score;
};

/// The one that leaves the best score; nothing of fewer than two frames.
std::optional<PointExchange> BestExchange(const JointPositions& positions, const std::vector<double>& confidence,
                                          const std::vector<RawBone>& bones);

/// One order and how well it fits.
struct OrderScore {
  const JointOrder* order = nullptr;
  BodyScore score;
};

/// All known orders of this many joints, best first.
std::vector<OrderScore> ScoreOrders(const JointPositions& positions, const std::vector<double>& confidence);

/// Median relative spread, over points, of the distance to the point that moves with each most rigidly. Needs no names:
/// a body has rigid pairs, anything else has none.
double Rigidity(const JointPositions& positions, const std::vector<double>& confidence);

}  // namespace mocurate
