#include "fitting/audit/keypoint_similarity.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

/// Of an entry's extent: two detectors' errors on one image of a person 400 px tall.
constexpr double kOneDirection = 0.03;

Vector2d DirectionOf(const Camera& camera, const double* seen) {
  return {(seen[0] - camera.cx) / camera.fx, (seen[1] - camera.cy) / camera.fy};
}

/// Diagonal of an entry's bounding box, in the units of DirectionOf.
double ExtentOfEntry(const KeypointView& view, int frame, int person) {
  Eigen::AlignedBox2d box;
  for (int k = 0; k < view.points(); ++k) {
    const double* seen = view.at(frame, person, k);
    if (seen[2] > 0.0) box.extend(DirectionOf(view.camera, seen));
  }
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

struct SharedKeypoints {
  double seen = 0.0;
  double alike = 0.0;
};

/// Compares an entry with the most similar entry of another view.
SharedKeypoints MostSimilar(const KeypointView& a, int frame, int person, const KeypointView& b, int other_frame) {
  const double near = kOneDirection * ExtentOfEntry(a, frame, person);
  SharedKeypoints best;
  for (int other = 0; other < b.people; ++other) {
    SharedKeypoints shared;
    for (int k = 0; k < std::min(a.points(), b.points()); ++k) {
      const double* one = a.at(frame, person, k);
      const double* two = b.at(other_frame, other, k);
      if (one[2] <= 0.0 || two[2] <= 0.0) continue;
      shared.seen += 1.0;
      shared.alike += (DirectionOf(a.camera, one) - DirectionOf(b.camera, two)).norm() <= near ? 1.0 : 0.0;
    }
    if (shared.alike * std::max(best.seen, 1.0) >= best.alike * std::max(shared.seen, 1.0) && shared.seen > 0.0) {
      best = shared;
    }
  }
  return best;
}

}  // namespace

double KeypointSimilarity(const KeypointView& a, const KeypointView& b) {
  SharedKeypoints all;
  for (int f = 0; f < a.frames() && b.frames() > 0; ++f) {
    const auto later = std::lower_bound(b.time_s.begin(), b.time_s.end(), a.time_s[static_cast<std::size_t>(f)]);
    const int other = std::min(static_cast<int>(later - b.time_s.begin()), b.frames() - 1);
    for (int p = 0; p < a.people; ++p) {
      const SharedKeypoints shared = MostSimilar(a, f, p, b, other);
      all.seen += shared.seen;
      all.alike += shared.alike;
    }
  }
  return all.seen > 0.0 ? all.alike / all.seen : -1.0;
}

}  // namespace mocurate
