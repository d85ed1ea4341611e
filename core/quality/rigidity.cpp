#include "core/quality/rigidity.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/median.h"
#include "core/base/pi.h"

namespace mocurate {
namespace {

constexpr int kFewestBoneFrames = 8;
constexpr std::size_t kFewestBones = 3;
constexpr double kShortestBone = 1e-3;  // metres; a joint on its parent is ignored
constexpr double kShortestRest = 0.03;  // of the rest pose: of shorter ones trackers disagree

/// One bone over the frames that show it; medians, as single frames may be far off.
struct BoneLength {
  double length = 0.0;
  double spread = 0.0;  ///< standard deviation over length, from the median distance
  int frames = 0;
};

std::optional<BoneLength> Measure(const TrackedPoints& points, int point, int parent) {
  std::vector<double> lengths;
  for (int f = 0; f < points.frames(); ++f) {
    if (points.sees(f, point) && points.sees(f, parent)) {
      lengths.push_back((points.at(f, point) - points.at(f, parent)).norm());
    }
  }
  if (lengths.empty()) return std::nullopt;
  BoneLength bone{Median(lengths), 0.0, static_cast<int>(lengths.size())};
  if (bone.length < kShortestBone) return std::nullopt;
  for (double& length : lengths) length = std::abs(length - bone.length);
  bone.spread = kMadToSigma * Median(lengths) / bone.length;
  return bone;
}

/// All but the root within pi: as axis-angle vectors are.
bool LooksLikeRotations(const TrackedPoints& points) {
  for (int k = 0; k < points.count(); ++k) {
    if (points.parents[static_cast<std::size_t>(k)] < 0) continue;
    for (int f = 0; f < points.frames(); ++f) {
      if (points.sees(f, k) && points.at(f, k).cwiseAbs().maxCoeff() > kPi) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<Finding> FindNonRigidBody(const TrackedPoints& points, const RigidityLimits& limits) {
  if (points.parents.empty()) return {};
  std::vector<double> spreads, ratios;
  for (int k = 0; k < points.count(); ++k) {
    const int parent = points.parents[static_cast<std::size_t>(k)];
    if (parent < 0) continue;
    const auto bone = Measure(points, k, parent);
    if (!bone) continue;
    if (bone->frames >= kFewestBoneFrames) spreads.push_back(bone->spread);
    const double rest = points.rest_lengths.empty() ? 0.0 : points.rest_lengths[static_cast<std::size_t>(k)];
    if (rest > kShortestRest) ratios.push_back(std::log(bone->length / rest));
  }
  double proportion = 0.0;
  if (ratios.size() >= kFewestBones) {
    const double scale = Median(ratios);
    for (const double ratio : ratios) proportion += std::abs(ratio - scale) / static_cast<double>(ratios.size());
  }
  const double spread = spreads.size() >= kFewestBones ? Median(spreads) : 0.0;
  if (proportion <= limits.proportion && spread <= limits.spread) return {};
  const std::string why = proportion > limits.proportion
                              ? "bone lengths differ from the skeleton's proportions by a factor of " +
                                    Digits(std::exp(proportion)) + " (mean), a person's by at most " +
                                    Digits(std::exp(limits.proportion))
                              : "bones change their length by " + Digits(spread) +
                                    " of it (median), a person's at most " + Digits(limits.spread);
  Finding finding =
      FrameFinding("not_joint_positions", 0, 0, "", proportion > limits.proportion ? std::exp(proportion) : spread,
                   why + (LooksLikeRotations(points)
                              ? ": joints in another order, or rotations such as Lie parameters in their place"
                              : ": joints in another order, or not joint positions"));
  finding.severity = Severity::kError;
  finding.limit = proportion > limits.proportion ? std::exp(limits.proportion) : limits.spread;
  return {finding};
}

}  // namespace mocurate
