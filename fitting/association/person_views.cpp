#include "fitting/association/person_views.h"

#include <algorithm>
#include <cmath>

#include "fitting/evidence/noise.h"

namespace mocurate {
namespace {

constexpr double kSameTime = 1e-3;    ///< of a view's step
constexpr double kLongestStep = 2.5;  ///< of a view's usual steps, between two frames that are interpolated

/// Two frames of a view around a moment; the same twice where the view has a frame then.
struct Bracket {
  int before = -1;
  int after = -1;
  double share = 0.0;  ///< of the way from one to the other
};

double UsualStep(const std::vector<double>& time) {
  std::vector<double> steps;
  for (std::size_t f = 1; f < time.size(); ++f) steps.push_back(time[f] - time[f - 1]);
  return Median(steps);
}

Bracket FramesAround(const std::vector<double>& time, double step, double moment) {
  Bracket bracket;
  const auto next = std::lower_bound(time.begin(), time.end(), moment);
  const auto after = static_cast<int>(next - time.begin());
  for (const int f : {after, after - 1}) {
    if (f < 0 || f >= static_cast<int>(time.size())) continue;
    if (std::abs(time[static_cast<std::size_t>(f)] - moment) > std::max(kSameTime * step, 1e-9)) continue;
    bracket.before = bracket.after = f;
    return bracket;
  }
  if (after == 0 || next == time.end()) return bracket;
  const double gap = *next - *(next - 1);
  if (gap > kLongestStep * step) return bracket;
  bracket.before = after - 1;
  bracket.after = after;
  bracket.share = (moment - *(next - 1)) / gap;
  return bracket;
}

}  // namespace

std::vector<ViewKeypoints> ViewsOfPerson(const std::vector<RigView>& rig, const Association& take,
                                         const AssociatedPerson& person) {
  std::vector<ViewKeypoints> views;
  for (std::size_t v = 0; v < rig.size(); ++v) {
    const RigView& from = rig[v];
    const auto keypoints = static_cast<std::size_t>(from.keypoints);
    ViewKeypoints view;
    view.camera = from.camera.camera;
    view.normalised.assign(take.time_s.size() * keypoints, Vector2d::Zero());
    view.confidence.assign(take.time_s.size() * keypoints, 0.0);
    const double step = UsualStep(from.time_s);
    for (std::size_t f = 0; f < take.time_s.size(); ++f) {
      const Bracket bracket = FramesAround(from.time_s, step, take.time_s[f]);
      if (bracket.before < 0) continue;
      const int one = person.entry[v][static_cast<std::size_t>(bracket.before)];
      const int other = person.entry[v][static_cast<std::size_t>(bracket.after)];
      if (one < 0 || other < 0) continue;
      const std::size_t here = from.Point(bracket.before, one, 0);
      const std::size_t there = from.Point(bracket.after, other, 0);
      for (std::size_t k = 0; k < keypoints; ++k) {
        const double confidence = std::min(from.confidence[here + k], from.confidence[there + k]);
        if (confidence <= 0.0) continue;
        view.normalised[f * keypoints + k] =
            (1.0 - bracket.share) * from.normalised[here + k] + bracket.share * from.normalised[there + k];
        view.confidence[f * keypoints + k] = confidence;
      }
    }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace mocurate
