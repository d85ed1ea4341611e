#include "core/quality/seen_person.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/median.h"

namespace mocurate {
namespace {

constexpr double kNearInImage = 0.25;  ///< of the body's height in the image

double HeightInImage(const Camera& camera, const Motion& motion, int frame) {
  double top = std::numeric_limits<double>::max(), bottom = -top;
  for (int j = 0; j < motion.joint_count(); ++j) {
    const auto pixel = camera.ProjectWorld(motion.joints.at(frame, j));
    if (!pixel) continue;
    top = std::min(top, pixel->y());
    bottom = std::max(bottom, pixel->y());
  }
  return std::max(0.0, bottom - top);
}

}  // namespace

int ImageAt(const KeypointView& view, double time_s, double step_s) {
  const auto after = std::lower_bound(view.time_s.begin(), view.time_s.end(), time_s);
  int nearest = -1;
  double least = 0.5 * step_s + 1e-9;
  for (const auto at : {after, after == view.time_s.begin() ? after : after - 1}) {
    if (at == view.time_s.end() || std::abs(*at - time_s) > least) continue;
    least = std::abs(*at - time_s);
    nearest = static_cast<int>(at - view.time_s.begin());
  }
  return nearest;
}

std::vector<double> DistancesFromJoints(const KeypointView& view, int image, int person,
                                        const std::vector<int>& joint_of, const Motion& motion, int frame) {
  std::vector<double> distances;
  for (std::size_t k = 0; k < joint_of.size(); ++k) {
    const double* point = view.at(image, person, static_cast<int>(k));
    if (joint_of[k] < 0 || !(point[2] > 0.0)) continue;
    const auto pixel = view.camera.ProjectWorld(motion.joints.at(frame, joint_of[k]));
    if (pixel) distances.push_back((*pixel - Vector2d(point[0], point[1])).norm());
  }
  return distances;
}

SeenPerson FindPerson(const KeypointView& view, int image, const std::vector<int>& joint_of, const Motion& motion,
                      int frame) {
  SeenPerson nearest{-1, kNearInImage * HeightInImage(view.camera, motion, frame)};
  for (int p = 0; p < view.people; ++p) {
    std::vector<double> distances = DistancesFromJoints(view, image, p, joint_of, motion, frame);
    if (distances.empty()) continue;
    const double median = MeanMedian(std::move(distances));
    if (median < nearest.median_px) nearest = {p, median};
  }
  return nearest;
}

}  // namespace mocurate
