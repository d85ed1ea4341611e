#include "fitting/clouds/observed_rig.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/stop_request.h"

namespace mocurate {
namespace {

constexpr int kMostGroups = 6;                ///< groups of moments, at most (numerical)
constexpr std::size_t kMostSurfaces = 120;    ///< surfaces, views times moments, at most (numerical)
constexpr std::size_t kViewsAllCompared = 6;  ///< with more views, only neighbouring ones are compared (numerical)
/// Views, the nearest ones, with which each of more views is compared (numerical).
constexpr std::size_t kPartners = 4;
constexpr double kVoxel = 0.025;  ///< m; voxels of a view's surface (numerical)

}  // namespace

bool CanSampleRig(const std::vector<DepthView>& views) {
  return !views.empty() && std::all_of(views.begin(), views.end(), [&](const DepthView& view) {
    const bool increases =
        std::adjacent_find(view.time_s.begin(), view.time_s.end(), std::greater_equal<double>()) == view.time_s.end();
    return view.files.size() == views[0].files.size() && !view.files.empty() && increases;
  });
}

DepthRigSampler::DepthRigSampler(std::vector<DepthView> views) : views_(std::move(views)) {
  for (const DepthView& view : views_) {
    single_.push_back({view});
    bare_.emplace_back();
    bare_.back().camera = view.camera;
    bare_.back().metres_per_unit = view.metres_per_unit;
  }
  together_ = std::min(count(), 2);
  const auto most = static_cast<int>(kMostSurfaces / views_.size()) / together_;
  const int groups = std::max(1, std::min({kMostGroups, count() / together_, most}));
  for (int g = 0; g < groups; ++g) {
    const int middle = (2 * g + 1) * count() / (2 * groups);
    frames_.push_back(std::clamp(middle, 0, count() - together_));
  }
}

double DepthRigSampler::step_s() const {
  const std::vector<double>& time = views_[0].time_s;
  if (time.size() < 2) return 0.0;
  return (time.back() - time.front()) / static_cast<double>(time.size() - 1);
}

Expected<const ViewSurface*> DepthRigSampler::At(std::size_t view, int frame) {
  if (frame < 0 || frame >= count()) return nullptr;
  std::unique_ptr<ViewSurface>& kept = surfaces_[{view, frame}];
  if (kept == nullptr) {
    if (Status on = StopIfInterrupted("audit of depth views"); !on) return Forward(on);
    Expected<std::vector<DepthImage>> images = ReadFrame(single_[view], frame);
    if (!images) return Forward(images);
    Expected<ViewSurface> surface = SurfaceOf(bare_[view], std::move(images->front()), kVoxel);
    if (!surface) return Forward(surface);
    kept = std::make_unique<ViewSurface>(std::move(*surface));
    flat_ += kept->flat ? 1 : 0;
  }
  return kept->empty() ? nullptr : kept.get();
}

/// Sets the person's centre and the compared pairs: all pairs, or for many views each with the views from nearby sides.
Status DepthRigSampler::SetPlace() {
  placed_ = true;
  Vector3d sum = Vector3d::Zero();
  double count = 0.0;
  for (const int frame : frames_) {
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const Expected<const ViewSurface*> surface = At(v, frame);
      if (!surface) return Forward(surface);
      if (*surface == nullptr) continue;
      sum += Inverse(bare_[v].camera.camera_from_world) * Vector3d((*surface)->points.rowwise().mean());
      count += 1.0;
    }
  }
  if (count > 0.0) centre_ = sum / count;
  std::vector<Vector3d> side;
  for (const DepthView& view : bare_) side.push_back((view.camera.Centre() - centre_).normalized());
  for (std::size_t a = 0; a < bare_.size(); ++a) {
    std::vector<std::pair<double, std::size_t>> others;
    for (std::size_t b = 0; b < bare_.size(); ++b) {
      if (a != b) others.emplace_back(-side[a].dot(side[b]), b);
    }
    std::sort(others.begin(), others.end());
    if (bare_.size() > kViewsAllCompared) others.resize(kPartners);
    for (const auto& [apart, b] : others) pairs_.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(pairs_.begin(), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  return {};
}

Expected<ObservedRig> DepthRigSampler::Seen(const std::vector<int>& delays) {
  if (!placed_) {
    if (Status set = SetPlace(); !set) return Forward(set);
  }
  ObservedRig rig{bare_, {}, together_, centre_, pairs_};
  for (const int first : frames_) {
    for (int frame = first; frame < first + together_; ++frame) {
      rig.moments.emplace_back();
      for (std::size_t v = 0; v < views_.size(); ++v) {
        const Expected<const ViewSurface*> surface = At(v, frame + delays[v]);
        if (!surface) return Forward(surface);
        rig.moments.back().push_back(*surface);
      }
    }
  }
  return rig;
}

Expected<ObservedRig> DepthRigSampler::SeenLater(const std::vector<int>& delays, std::size_t view, int more) {
  Expected<ObservedRig> seen = Seen(delays);
  if (!seen || more == 0) return seen;
  ObservedRig rig = *seen;
  rig.moments.clear();
  rig.together = 1;
  for (std::size_t g = 0; g < frames_.size(); ++g) {
    // One frame earlier for the first image is the first against the second, whose images are loaded.
    const int against = more < 0 && together_ > 1 ? 1 : 0;
    rig.moments.push_back(seen->moments[g * static_cast<std::size_t>(together_) + static_cast<std::size_t>(against)]);
    const Expected<const ViewSurface*> surface = At(view, frames_[g] + against + delays[view] + more);
    if (!surface) return Forward(surface);
    rig.moments.back()[view] = *surface;
  }
  return rig;
}

std::vector<std::vector<double>> ResidualsOfViews(const ObservedRig& rig, const std::vector<Camera>& cameras) {
  const auto together = static_cast<std::size_t>(rig.together);
  const std::size_t views = rig.views.size(), groups = rig.moments.size() / together;
  std::vector<std::vector<double>> residual_mm(views, std::vector<double>(groups, 0.0));
  for (std::size_t g = 0; g < groups; ++g) {
    const ObservedMoment& moment = rig.moments[g * together];
    std::vector<double> square(views, 0.0), matched(views, 0.0);
    for (const auto& [a, b] : rig.pairs) {
      for (const auto& [of, in] : {std::pair(a, b), std::pair(b, a)}) {
        if (moment[of] == nullptr || moment[in] == nullptr) continue;
        const Agreement agreement = Compare({*moment[of], rig.views[of], cameras[of]},
                                            {*moment[in], rig.views[in], cameras[in]}, rig.centre, 0.02);
        square[of] += agreement.square;
        matched[of] += agreement.matched;
      }
    }
    for (std::size_t v = 0; v < views; ++v) {
      if (matched[v] > 0.0) residual_mm[v][g] = 1e3 * std::sqrt(square[v] / matched[v]);
    }
  }
  return residual_mm;
}

std::pair<std::vector<double>, std::vector<double>> OfView(const ObservedRig& rig, std::size_t view,
                                                           const std::vector<double>& losses,
                                                           const std::vector<double>& others) {
  std::pair<std::vector<double>, std::vector<double>> of_view;
  for (std::size_t i = 0; i < losses.size(); ++i) {
    const auto& [a, b] = rig.pairs[i % rig.pairs.size()];
    if ((a != view && b != view) || losses[i] < 0.0 || others[i] < 0.0) continue;
    of_view.first.push_back(losses[i]);
    of_view.second.push_back(others[i]);
  }
  return of_view;
}

std::vector<double> LossOfViews(const ObservedRig& rig, const std::vector<double>& losses) {
  std::vector<double> of_views;
  for (std::size_t v = 0; v < rig.views.size(); ++v) of_views.push_back(MeanLoss(OfView(rig, v, losses, losses).first));
  return of_views;
}

Status CheckPersonIsSeen(const ObservedRig& rig, int flat) {
  const auto sees = [](const ObservedMoment& moment) {
    return std::any_of(moment.begin(), moment.end(), [](const ViewSurface* surface) { return surface != nullptr; });
  };
  if (flat == 0 || std::any_of(rig.moments.begin(), rig.moments.end(), sees)) return {};
  return Fail(ErrorCode::kInconsistent,
              "no view shows a person: " + Counted(static_cast<long long>(rig.views.size()), "depth camera") +
                  " show a flat surface, a wall or a door",
              "depth views", "give masks of the person, or exclude this clip");
}

std::vector<double> WithoutPerson(const ObservedRig& rig) {
  std::vector<double> without(rig.views.size(), 0.0);
  double peopled = 0.0;
  for (const ObservedMoment& moment : rig.moments) {
    if (std::all_of(moment.begin(), moment.end(), [](const ViewSurface* seen) { return seen == nullptr; })) continue;
    peopled += 1.0;
    for (std::size_t v = 0; v < moment.size(); ++v) without[v] += moment[v] == nullptr ? 1.0 : 0.0;
  }
  for (double& share : without) share /= std::max(peopled, 1.0);
  return without;
}

}  // namespace mocurate
