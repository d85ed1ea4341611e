#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "fitting/clouds/capsule_fit.h"

namespace mocurate {

/// Lowest and highest point along y in metres, without a few outliers. For a posed body: needs Update.
struct HeightSpan {
  double low = 0.0;
  double high = 0.0;

  double height() const { return high - low; }
};
HeightSpan HeightOf(const Eigen::Matrix3Xd& points);
HeightSpan HeightOf(const CapsuleBody& body, const PoseState& state, int frame);

/// m, mean distance of the joints from which two poses are two: below, one pose fits both about as well.
inline constexpr double kDistinctPose = 0.06;
/// Standard deviations of the difference of two costs, up to which the costlier pose may be the right one. Of 144 hard
/// stills the costs of wrong poses were up to 1.8 below those of the right ones with two and more views. Source:
/// bench_hard_stills 2 501 noise=1 body=known
inline constexpr double kClearlyWorse = 1.9;

/// Result of the search for a first pose.
struct CloudStart {
  double cost = 0.0;
  /// Radians between the pose and the given facing, where every start contradicts it.
  std::optional<double> off_facing{};
  /// Other poses (PoseState::FrameParameters) that explain the points about as well (kClearlyWorse), best first. Only
  /// of kStancesAndLimbs.
  std::vector<std::vector<double>> others{};
};

/// Heading of the pose in the state, rad about y; 0 faces +z. Needs Update.
double HeadingOf(const PoseState& state, int frame);

/// Extent of a search for a first pose.
enum class StartSearch {
  kUpright,          ///< upright stances only, for sizes: a larger body that is bent explains the same points
  kUprightAndLimbs,  ///< then arms and legs one by one (SearchLimbs)
  kStancesAndLimbs   ///< all stances, then arms and legs
};

/// Searches the pose of a frame for which only `options.start` is known; writes it to the state. Fits start from some
/// thirty stances (standing, stepping, squatting, seated, bent over, kneeling, on the floor, lying on each side, upside
/// down; several arm positions) in all directions, or near the given facing where the stance has one. Those nearest to
/// the points are fitted to few points first; the best continue, the best distinct ones are fitted to all points, with
/// the best one's left and right exchanged, and limbs are searched in each. The cheapest wins. Errors of FitCloudFrame.
Expected<CloudStart> FindStart(const CapsuleBody& body, const FusedCloud& cloud, int frame,
                               const PointCloudOptions& options, PoseState& state, StartSearch search);

/// The only child of a joint; -1 with several children or none, and for joint -1. `children` (J) as Skeleton::Children.
int OnlyChild(const std::vector<std::vector<int>>& children, int joint);

/// First joints of the legs, left then right; empty for a skeleton without legs.
std::optional<std::array<int, 2>> LegsOfBody(const Skeleton& skeleton);

/// Searches arms and legs anew, because a fit from a stance may miss them. Each limb is tried in some dozens of poses.
/// The poses with the lowest cost are fitted with the whole body, and a cheaper result is kept, until no limb improves.
/// Writes the cheapest pose to the state and returns its cost (PoseCost). Errors of FitCloudFrame.
Expected<double> SearchLimbs(const CapsuleBody& body, const FusedCloud& cloud, int frame,
                             const PointCloudOptions& options, PoseState& state);

}  // namespace mocurate
