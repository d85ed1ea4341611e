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

/// Result of the search for a first pose.
struct CloudStart {
  std::size_t finalists = 0;
  double cost = 0.0;
  /// Relative cost increase of the cheapest pose that faces away. Empty when all starts that were fitted to all points
  /// face about the same way, or contradict the given facing.
  std::optional<double> margin;
  /// Radians between the pose and the given facing, where every start contradicts it.
  std::optional<double> off_facing;
};

/// Heading of the pose in the state, rad about y; 0 faces +z. Needs Update.
double HeadingOf(const PoseState& state, int frame);

/// Extent of a search for a first pose.
enum class StartSearch {
  kStances,         ///< fits from stances only
  kStancesAndLimbs  ///< then searches arms and legs one by one (SearchLimbs)
};

/// Searches the pose of a frame for which only `options.start` is known; writes it to the state. Fits start from a
/// dozen stances (standing, stepping, squatting, seated; several arm positions) in all directions, or near the given
/// facing. They are fitted to few points first; the best continue, the best few are fitted to all points, and the
/// cheapest wins. Limbs are searched in all of those, or with a given facing only in the cheapest. Errors of
/// FitCloudFrame.
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
