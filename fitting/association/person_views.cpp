#include "fitting/association/person_views.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"

namespace mocurate {
namespace {

constexpr double kSameTime = 1e-3;  ///< share of a view's step within which two stamps are equal (numerical)
/// Factor on a view's usual step: longest step between two frames that are interpolated.
constexpr double kLongestUsualSteps = 2.5;

/// Two frames of a view around a moment; the same frame twice where the view has one at that time.
struct Bracket {
  int before = -1;
  int after = -1;
  double share = 0.0;  ///< of the way from one to the other
};

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
  if (gap > kLongestUsualSteps * step) return bracket;
  bracket.before = after - 1;
  bracket.after = after;
  bracket.share = (moment - *(next - 1)) / gap;
  return bracket;
}

}  // namespace

double UsualStep(const std::vector<double>& time) {
  std::vector<double> steps;
  for (std::size_t f = 1; f < time.size(); ++f) steps.push_back(time[f] - time[f - 1]);
  return MeanMedian(steps);
}

void ReadBetweenFrames(const RigView& view, const std::vector<int>& entry, double step, double moment,
                       Vector2d* normalised, double* confidence) {
  const Bracket bracket = FramesAround(view.time_s, step, moment);
  if (bracket.before < 0) return;
  const int one = entry[static_cast<std::size_t>(bracket.before)];
  const int other = entry[static_cast<std::size_t>(bracket.after)];
  if (one < 0 || other < 0) return;
  const std::size_t here = view.Point(bracket.before, one, 0);
  const std::size_t there = view.Point(bracket.after, other, 0);
  for (std::size_t k = 0; k < static_cast<std::size_t>(view.keypoints); ++k) {
    const double sure = std::min(view.confidence[here + k], view.confidence[there + k]);
    if (sure <= 0.0) continue;
    normalised[k] = (1.0 - bracket.share) * view.normalised[here + k] + bracket.share * view.normalised[there + k];
    confidence[k] = sure;
  }
}

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
      ReadBetweenFrames(from, person.entry[v], step, take.time_s[f], view.normalised.data() + f * keypoints,
                        view.confidence.data() + f * keypoints);
    }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace mocurate
