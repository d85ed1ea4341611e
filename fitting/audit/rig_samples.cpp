#include "fitting/audit/rig_samples.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/median.h"
#include "fitting/association/associate.h"

namespace mocurate {
namespace {

constexpr double kWorst_px = 120.0;  ///< cap on the error: beyond, a detection is an outlier
constexpr int kSpans = 12;           ///< spans of a take in the report of residuals (numerical)
/// Standard deviations of a detection: a person whose keypoints all stay so close to their medians stands still.
constexpr double kStillSigmas = 2.0;
constexpr double kMovingShare = 0.05;  ///< share of the keypoints of a person who moves, at least, as of one arm

double CostOfSquare(double square_px, double noise_px) {
  const double worst = kWorst_px * kWorst_px;
  return 3.0 * std::log1p(std::min(square_px, worst) / (4.0 * noise_px * noise_px));  // Student's t of 4 degrees
}

/// A person's detections in all views at a moment (V*K), pixels; zero confidence where there is none.
struct SeenPoints {
  std::vector<Vector2d> px;
  std::vector<double> confidence;
  int views = 0;  ///< with an entry of the person

  bool operator==(const SeenPoints& other) const { return px == other.px && confidence == other.confidence; }
};

SeenPoints SeenAt(const AssociatedPerson& person, double time_s, const std::vector<RigView>& rig) {
  SeenPoints seen;
  for (std::size_t v = 0; v < rig.size(); ++v) {
    const RigView& view = rig[v];
    const auto next = std::lower_bound(view.time_s.begin(), view.time_s.end(), time_s - 1e-9);
    const auto frame = static_cast<std::size_t>(next - view.time_s.begin());
    const int entry = next == view.time_s.end() ? -1 : person.entry[v][frame];
    seen.views += entry >= 0 ? 1 : 0;
    for (int k = 0; k < view.keypoints; ++k) {
      const std::size_t at = entry < 0 ? 0 : view.Point(static_cast<int>(frame), entry, k);
      const double confidence = entry < 0 ? 0.0 : view.confidence[at];
      const Camera& camera = view.camera.camera;
      seen.confidence.push_back(confidence);
      seen.px.push_back(confidence > 0.0 ? Vector2d(view.normalised[at].cwiseProduct(Vector2d(camera.fx, camera.fy)))
                                         : Vector2d::Zero());
    }
  }
  return seen;
}

/// Whether a person keeps one posture: the errors of a detector that belong to a posture then look like those of a rig.
bool StandsStill(const std::vector<SeenPoints>& moments, double noise_px) {
  std::size_t still = 0, moving = 0;
  for (std::size_t i = 0; i < moments[0].px.size(); ++i) {
    std::vector<double> x, y, away;
    for (const SeenPoints& seen : moments) {
      if (seen.confidence[i] <= 0.0) continue;
      x.push_back(seen.px[i].x());
      y.push_back(seen.px[i].y());
    }
    if (2 * x.size() < moments.size()) continue;
    const Vector2d middle(MeanMedian(x), MeanMedian(y));
    for (const SeenPoints& seen : moments) {
      if (seen.confidence[i] > 0.0) away.push_back((seen.px[i] - middle).norm());
    }
    ++(MeanMedian(away) < kStillSigmas * noise_px ? still : moving);
  }
  return static_cast<double>(moving) < kMovingShare * static_cast<double>(still + moving);
}

}  // namespace

RigModel::RigModel(const std::vector<RigView>& rig) : clock_s(rig.size(), 0.0), sides_exchanged(rig.size(), false) {
  for (const RigView& view : rig) camera.push_back({CameraPart{view.camera.camera}});
}

RigSamples::RigSamples(const std::vector<RigView>& rig, const Association& take,
                       const std::vector<std::size_t>& other_side, std::vector<RigMoment> moments)
    : rig_(rig), take_(take), other_side_(other_side), moments_(std::move(moments)) {
  for (const RigView& view : rig) step_.push_back(UsualStep(view.time_s));
}

std::size_t TakeAt(const TakeStarts& takes, double time_s) {
  const auto next = std::upper_bound(takes.begin(), takes.end(), time_s + 1e-9);
  return next == takes.begin() ? 0 : static_cast<std::size_t>(next - takes.begin() - 1);
}

std::vector<std::optional<double>> GainOfTakes(const TakeStarts& takes, const std::vector<double>& time_s,
                                               const std::vector<double>& worse, const std::vector<double>& better) {
  const std::size_t count = std::max<std::size_t>(1, takes.size());
  std::vector<double> sum(count, 0.0), moments(count, 0.0);
  std::vector<bool> changed(count, false);
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    const std::size_t at = TakeAt(takes, time_s[i]);
    changed[at] = changed[at] || worse[i] != better[i];
    sum[at] += worse[i] - better[i];
    moments[at] += 1.0;
  }
  std::vector<std::optional<double>> gain(count);
  for (std::size_t t = 0; t < count; ++t) {
    if (changed[t]) gain[t] = sum[t] / moments[t];
  }
  return gain;
}

std::vector<RigMoment> RigSamples::Spread(const std::vector<RigView>& rig, const Association& take, int most,
                                          double noise_px, const TakeStarts& takes) {
  std::size_t base = 0;
  for (std::size_t v = 1; v < rig.size(); ++v) {
    if (rig[v].time_s.size() > rig[base].time_s.size()) base = v;
  }
  const std::size_t count = std::max<std::size_t>(1, takes.size());
  std::vector<std::vector<RigMoment>> of_take(count);
  std::vector<bool> moves(count, false);
  for (std::size_t p = 0; p < take.people.size(); ++p) {
    std::vector<std::vector<RigMoment>> when(count);
    SeenPoints last;
    for (std::size_t f = 0; f < rig[base].time_s.size(); ++f) {
      const double time = rig[base].time_s[f];
      if (take.people[p].entry[base][f] < 0) continue;
      SeenPoints now = SeenAt(take.people[p], time, rig);
      if (now.views < 2 || now == last) continue;
      when[TakeAt(takes, time)].push_back({static_cast<int>(p), time});
      last = std::move(now);
    }
    for (std::size_t t = 0; t < count; ++t) {
      std::vector<SeenPoints> seen;
      const std::size_t looked_at = std::min(when[t].size(), static_cast<std::size_t>(most));
      for (std::size_t i = 0; i < looked_at; ++i) {
        seen.push_back(SeenAt(take.people[p], when[t][i * when[t].size() / looked_at].time_s, rig));
      }
      moves[t] = moves[t] || (!seen.empty() && !StandsStill(seen, noise_px));
      of_take[t].insert(of_take[t].end(), when[t].begin(), when[t].end());
    }
  }
  for (std::size_t t = 0; t < count; ++t) {
    if (!moves[t]) of_take[t].clear();
    std::stable_sort(of_take[t].begin(), of_take[t].end(),
                     [](const RigMoment& a, const RigMoment& b) { return a.time_s < b.time_s; });
  }
  std::vector<RigMoment> some;
  for (const std::vector<RigMoment>& moments : of_take) {
    const std::size_t kept = std::min(moments.size(), static_cast<std::size_t>(most) / count);
    for (std::size_t i = 0; i < kept; ++i) some.push_back(moments[i * moments.size() / kept]);
  }
  return some;
}

RigSamples RigSamples::Half(int half) const {
  RigSamples some = *this;
  some.moments_.clear();
  const std::vector<int> halves = HalvesOf(moments_.size());
  for (std::size_t i = 0; i < moments_.size(); ++i) {
    if (halves[i] == half) some.moments_.push_back(moments_[i]);
  }
  return some;
}

ViewKeypoints RigSamples::View(const RigModel& model, std::size_t view, std::size_t part, double later_s) const {
  const RigView& from = rig_[view];
  const auto keypoints = static_cast<std::size_t>(from.keypoints);
  const std::vector<CameraPart>& parts = model.camera[view];
  ViewKeypoints seen;
  seen.camera = parts[part].camera;
  seen.normalised.assign(moments_.size() * keypoints, Vector2d::Zero());
  seen.confidence.assign(moments_.size() * keypoints, 0.0);
  for (std::size_t i = 0; i < moments_.size(); ++i) {
    const double time = moments_[i].time_s;
    if (time < parts[part].from_s || (part + 1 < parts.size() && time >= parts[part + 1].from_s)) continue;
    const auto& entry = take_.people[static_cast<std::size_t>(moments_[i].person)].entry[view];
    ReadBetweenFrames(from, entry, step_[view], time - model.clock_s[view] + later_s,
                      seen.normalised.data() + i * keypoints, seen.confidence.data() + i * keypoints);
    if (!model.sides_exchanged[view]) continue;
    for (std::size_t k = 0; k < keypoints; ++k) {
      if (other_side_[k] <= k) continue;
      std::swap(seen.normalised[i * keypoints + k], seen.normalised[i * keypoints + other_side_[k]]);
      std::swap(seen.confidence[i * keypoints + k], seen.confidence[i * keypoints + other_side_[k]]);
    }
  }
  return seen;
}

std::vector<ViewKeypoints> RigSamples::Views(const RigModel& model, std::vector<std::size_t>* view_of) const {
  std::vector<ViewKeypoints> views;
  for (std::size_t v = 0; v < rig_.size(); ++v) {
    for (std::size_t part = 0; part < model.camera[v].size(); ++part) {
      views.push_back(View(model, v, part));
      if (view_of != nullptr) view_of->push_back(v);
    }
  }
  return views;
}

Vector2d PixelError(const ViewKeypoints& view, std::size_t at, const Vector3d& point) {
  const Vector3d in_camera = view.camera.camera_from_world * point;
  if (!(in_camera.z() > 0.0)) return Vector2d::Constant(kBehind_px);
  const Vector2d off = in_camera.head<2>() / in_camera.z() - view.normalised[at];
  return {view.camera.fx * off.x(), view.camera.fy * off.y()};
}

std::vector<double> CostOfMoments(const std::vector<ViewKeypoints>& views, const TriangulatedTracks& points,
                                  double noise_px) {
  const auto keypoints = static_cast<std::size_t>(points.positions.joints);
  std::vector<double> costs(static_cast<std::size_t>(points.positions.frames), 0.0);
  for (const ViewKeypoints& view : views) {
    for (std::size_t i = 0; i < points.confidence.size(); ++i) {
      if (view.confidence[i] <= 0.0) continue;
      double square = kBehind_px;
      if (points.confidence[i] > 0.0) {
        const Eigen::Map<const Vector3d> point(points.positions.xyz.data() + 3 * i);
        square = PixelError(view, i, point).squaredNorm();
      }
      costs[i / keypoints] += view.confidence[i] * CostOfSquare(square, noise_px);
    }
  }
  return costs;
}

std::vector<double> CostsUnder(const RigSamples& samples, const RigModel& model, const TriangulationOptions& options) {
  const std::vector<ViewKeypoints> views = samples.Views(model);
  return CostOfMoments(views, TriangulateViews(views, samples.count(), samples.keypoints(), options), options.noise);
}

std::vector<double> HeldOutCosts(const RigSamples& samples, const TriangulationOptions& options,
                                 const std::function<RigModel(const RigSamples&)>& fit) {
  std::vector<double> costs(samples.moments().size());
  const std::vector<int> halves = HalvesOf(costs.size());
  for (int half = 0; half < 2; ++half) {
    const std::vector<double> of_half = CostsUnder(samples.Half(half), fit(samples.Half(1 - half)), options);
    for (std::size_t i = 0, next = 0; i < costs.size(); ++i) {
      if (halves[i] == half) costs[i] = of_half[next++];
    }
  }
  return costs;
}

std::vector<std::vector<double>> ResidualMap(const RigSamples& samples, const RigModel& model,
                                             const std::vector<double>& take_s, const TriangulationOptions& options) {
  const std::vector<ViewKeypoints> views = samples.Views(model);
  const TriangulatedTracks points = TriangulateViews(views, samples.count(), samples.keypoints(), options);
  const auto keypoints = static_cast<std::size_t>(samples.keypoints());
  const double begin = take_s.front();
  const double length = std::max(take_s.back() - begin, 1e-9);
  std::vector<std::vector<double>> map;
  for (const ViewKeypoints& view : views) {
    std::vector<std::vector<double>> spans(kSpans);
    for (std::size_t i = 0; i < points.confidence.size(); ++i) {
      if (points.confidence[i] <= 0.0 || view.confidence[i] <= 0.0) continue;
      const double at = (samples.moments()[i / keypoints].time_s - begin) / length;
      const auto span = static_cast<std::size_t>(std::clamp(at, 0.0, 1.0) * (kSpans - 1e-6));
      spans[span].push_back(
          PixelError(view, i, Eigen::Map<const Vector3d>(points.positions.xyz.data() + 3 * i)).norm());
    }
    map.emplace_back();
    for (std::vector<double>& span : spans) map.back().push_back(MeanMedian(span));
  }
  return map;
}

double Sum(const std::vector<double>& costs) { return std::accumulate(costs.begin(), costs.end(), 0.0); }

namespace {

void ExchangeAllSides(const std::vector<std::size_t>& other_side, RigView& view) {
  for (std::size_t first = 0; first < view.confidence.size(); first += other_side.size()) {
    for (std::size_t k = 0; k < other_side.size(); ++k) {
      if (other_side[k] <= k) continue;
      std::swap(view.normalised[first + k], view.normalised[first + other_side[k]]);
      std::swap(view.confidence[first + k], view.confidence[first + other_side[k]]);
    }
  }
}

}  // namespace

int FrameAt(const std::vector<double>& time_s, double moment) {
  return static_cast<int>(std::lower_bound(time_s.begin(), time_s.end(), moment - 1e-9) - time_s.begin());
}

std::vector<RigView> CorrectedRig(const std::vector<RigView>& rig, const RigModel& model,
                                  const std::vector<std::size_t>& other_side, const std::vector<double>& time_s) {
  std::vector<RigView> corrected;
  for (std::size_t v = 0; v < rig.size(); ++v) {
    const std::vector<CameraPart>& parts = model.camera[v];
    RigView whole = rig[v];
    if (model.sides_exchanged[v]) ExchangeAllSides(other_side, whole);
    for (double& time : whole.time_s) time += model.clock_s[v];
    int begin = 0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const int end = p + 1 < parts.size() ? FrameAt(whole.time_s, parts[p + 1].from_s) : whole.frames();
      RigView view = parts.size() > 1 ? whole.Frames(begin, end) : whole;
      view.camera = TriangulationView(parts[p].camera);
      if (p > 0) view.camera.camera.name += " from frame " + std::to_string(FrameAt(time_s, parts[p].from_s));
      if (view.frames() > 0) corrected.push_back(std::move(view));
      begin = end;
    }
  }
  return corrected;
}

}  // namespace mocurate
