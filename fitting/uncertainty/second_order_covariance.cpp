#include "fitting/uncertainty/second_order_covariance.h"
#include "core/geometry/symmetric.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

/// Share of the squared length of a bone: mean square of its shortening for a uniform direction (numerical).
constexpr double kEveryDirection = 4.0 / 3.0;

/// Covariance along a bone whose end has `more` covariance than its start (m^2).
Matrix3d AlongBone(const Vector3d& bone, const Matrix3d& more) {
  const double square = bone.squaredNorm();
  if (square < kShortestBone_m * kShortestBone_m) return Matrix3d::Zero();
  const Vector3d along = bone / std::sqrt(square);
  const double across = std::max(more.trace() - along.dot(more * along), 0.0) / square;  // rad^2
  const double nearer = kEveryDirection * (1.0 - std::exp(-0.5 * across * across / kEveryDirection));
  return nearer * square * along * along.transpose();
}

}  // namespace

void AddSecondOrderCovariance(const TrackWindow& whole, std::vector<float>& position_cov) {
  const PoseState& state = whole.state;
  std::vector<Matrix3d> own(static_cast<std::size_t>(state.joints()));
  std::vector<Matrix3d> added(own.size());
  for (int f = 0; f < whole.end; ++f) {
    for (int j = 0; j < state.joints(); ++j) {
      float* stated = position_cov.data() + 6 * whole.Index(f, j);
      own[j] = FromSixNumbers(stated);
      added[j].setZero();
      if (j == 0 || whole.tracks.seen(f, j)) continue;
      const int start = state.parent(j);
      added[j] = added[start] + AlongBone(state.position(f, j) - state.position(f, start), own[j] - own[start]);
      ToSixNumbers(own[j] + added[j], stated);
    }
  }
}

}  // namespace mocurate
