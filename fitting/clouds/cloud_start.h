#pragma once

#include <cstddef>
#include <optional>

#include "fitting/clouds/capsule_fit.h"

namespace mocurate {

/// Lowest and highest point along y in metres, but for a few stray ones. Of a posed body: needs Update.
struct HeightSpan {
  double low = 0.0;
  double high = 0.0;

  double height() const { return high - low; }
};
HeightSpan HeightOf(const Eigen::Matrix3Xd& points);
HeightSpan HeightOf(const CapsuleBody& body, const PoseState& state, int frame);

/// What the search for a first pose came to.
struct CloudStart {
  std::size_t finalists = 0;
  double cost = 0.0;
  /// By how much the cheapest pose that faces another way costs more, as a share of the cost; none: every start
  /// that is fitted to all points came to face about the same way, or against the declared facing.
  std::optional<double> margin;
  /// Radians between the pose and the declared facing, where every start contradicts it.
  std::optional<double> off_facing;
};

/// Where the pose in the state faces, rad about y, 0 faces +z. Needs Update.
double HeadingOf(const PoseState& state, int frame);

/// How far a search for a first pose goes.
enum class StartSearch {
  kStances,         ///< as the best stance leads to it
  kStancesAndLimbs  ///< then arms and legs are looked for one by one (SearchLimbs)
};

/// Leaves in the state the pose of a frame of which only `options.start` is known: fitted from a dozen stances
/// (standing, stepping, squatting, seated; arms in several places) that face all around, or about the
/// declared facing. Starts are fitted to few points first; the best continue, the best few are fitted to all points,
/// and the cheapest stays. Limbs are looked for in all of those, with a declared facing in the cheapest. Errors of
/// FitCloudFrame.
Expected<CloudStart> FindStart(const CapsuleBody& body, const FusedCloud& cloud, int frame,
                               const PointCloudOptions& options, PoseState& state, StartSearch search);

}  // namespace mocurate
