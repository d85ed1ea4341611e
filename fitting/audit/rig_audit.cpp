#include "fitting/audit/rig_audit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "fitting/audit/camera_moves.h"
#include "fitting/audit/clock_offsets.h"
#include "fitting/audit/rig_samples.h"
#include "fitting/evidence/noise.h"

namespace mocurate {
namespace {

constexpr int kMoments = 32;
constexpr int kFewestMoments = 8;  ///< to judge clocks and places by
constexpr std::size_t kSettlingMoments = 2000;
constexpr std::size_t kMostViews = 12;  ///< that moves and exchanged files are looked for in
constexpr int kSpans = 12;
constexpr std::size_t kLeastViews = 3;
constexpr double kSmallestClock_s = 0.004;
constexpr double kSmallestStep = 0.25;  ///< of a view's step
constexpr double kClockSigmas = 5.0;
constexpr double kLeastGain = 0.02;  ///< of the cost
constexpr double kDegrees = 57.29577951308232;

double Sum(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum;
}

class Auditor {
 public:
  Auditor(const std::vector<RigView>& rig, const Association& take, const KeypointFitOptions& options)
      : rig_(rig),
        take_(take),
        options_(options),
        samples_(rig, take, RigSamples::Spread(rig, take, kMoments)),
        model_(rig),
        given_(rig) {}

  AuditedRig Audit() {
    AuditedRig audited;
    audited.rig = rig_;
    audited.not_audited = WhyNotAudited();
    if (samples_.count() == 0) return audited;
    audited.residual_px = ResidualMap();
    if (rig_.size() < kLeastViews) return audited;
    const RigAuditOptions& audit = options_.audit;
    if (audit.clocks == AuditAction::kOff && audit.moved == AuditAction::kOff) return audited;
    cost_ = CostsOf(model_);
    for (std::size_t round = 0; round < 2 * rig_.size() && Improve(); ++round) {
    }
    DropIdleClocks();
    for (std::size_t v = 0; v < rig_.size(); ++v) {
      if (model_.camera[v].size() == 2) Locate(v);
      Settle(v);
    }
    cost_ = CostsOf(model_);
    for (std::size_t v = 0; v < rig_.size(); ++v) {
      TellOfClock(v, audited);
      TellOfMove(v, audited);
    }
    if (audited.corrected) audited.rig = Corrected();
    return audited;
  }

 private:
  std::vector<double> CostsOf(const RigModel& model) const {
    const std::vector<ViewKeypoints> views = samples_.Views(model);
    const TriangulatedTracks points =
        TriangulateViews(views, samples_.count(), samples_.keypoints(), options_.triangulation);
    return CostOfMoments(views, points, options_.triangulation.noise);
  }

  /// What of the audit that is wanted cannot be done, and why; empty where all can be, and for rigs of two.
  std::string WhyNotAudited() const {
    const RigAuditOptions& audit = options_.audit;
    const bool moved = audit.moved != AuditAction::kOff;
    const bool clocks = audit.clocks != AuditAction::kOff;
    if (rig_.size() < kLeastViews) return {};
    if (samples_.count() < kFewestMoments && (moved || clocks)) {
      return "clocks and places of cameras cannot be judged: the view with the most frames sees people that another "
             "one sees too at " +
             Counted(samples_.count(), "moment") + ", " + std::to_string(kFewestMoments) + " are needed";
    }
    if (rig_.size() > kMostViews && (moved || audit.exchanged != AuditAction::kOff)) {
      return "moved cameras and exchanged files are looked for among up to " + std::to_string(kMostViews) +
             " cameras, these are " + std::to_string(rig_.size());
    }
    return {};
  }

  std::vector<std::vector<double>> ResidualMap() const {
    const std::vector<ViewKeypoints> views = samples_.Views(given_);
    const TriangulatedTracks points =
        TriangulateViews(views, samples_.count(), samples_.keypoints(), options_.triangulation);
    const auto keypoints = static_cast<std::size_t>(samples_.keypoints());
    const double begin = take_.time_s.front();
    const double length = std::max(take_.time_s.back() - begin, 1e-9);
    std::vector<std::vector<double>> map;
    for (const ViewKeypoints& view : views) {
      std::vector<std::vector<double>> spans(kSpans);
      for (std::size_t i = 0; i < points.confidence.size(); ++i) {
        if (points.confidence[i] <= 0.0 || view.confidence[i] <= 0.0) continue;
        const double at = (samples_.moments()[i / keypoints].time_s - begin) / length;
        const auto span = static_cast<std::size_t>(std::clamp(at, 0.0, 1.0) * (kSpans - 1e-6));
        spans[span].push_back(
            PixelError(view, i, Eigen::Map<const Vector3d>(points.positions.xyz.data() + 3 * i)).norm());
      }
      map.emplace_back();
      for (std::vector<double>& span : spans) map.back().push_back(Median(span));
    }
    return map;
  }

  /// Takes over what explains most of what is left; false when nothing does.
  bool Improve() {
    std::optional<RigModel> best;
    std::vector<double> least = cost_;
    const auto consider = [&](const RigModel& model) {
      std::vector<double> cost = CostsOf(model);
      if (Sum(cost) >= Sum(least)) return false;
      least = std::move(cost);
      best = model;
      return true;
    };
    std::optional<ClockOffsets> clocks;
    if (options_.audit.clocks != AuditAction::kOff) {
      clocks = RefineClocks(samples_, model_, options_.triangulation);
      if (const auto model = WithClocks(*clocks); !model || !consider(*model)) clocks.reset();
    }
    if (options_.audit.moved != AuditAction::kOff) {
      const auto move = FindMove(samples_, model_, options_.triangulation);
      if (move && consider(move->model)) clocks.reset();
    }
    if (!best || Sum(least) > (1.0 - kLeastGain) * Sum(cost_)) return false;
    if (Confidence(cost_, least) < options_.audit.sure) return false;
    model_ = std::move(*best);
    cost_ = std::move(least);
    if (clocks) clock_sigma_s_ = clocks->sigma_s;
    return true;
  }

  /// Takes back clocks that hardly explain anything: a calibration that is a little off looks like a clock to who walks
  /// in one direction.
  void DropIdleClocks() {
    while (true) {
      double least = (1.0 + kLeastGain) * Sum(cost_);
      std::size_t idle = rig_.size();
      for (std::size_t v = 0; v < rig_.size(); ++v) {
        if (model_.clock_s[v] == 0.0) continue;
        RigModel without = model_;
        without.clock_s[v] = 0.0;
        const double cost = Sum(CostsOf(without));
        if (cost >= least) continue;
        least = cost;
        idle = v;
      }
      if (idle == rig_.size()) return;
      model_.clock_s[idle] = 0.0;
      cost_ = CostsOf(model_);
    }
  }

  /// The model with the clocks that are off for sure; empty when that changes nothing.
  std::optional<RigModel> WithClocks(const ClockOffsets& clocks) const {
    RigModel model = model_;
    bool changed = false;
    for (std::size_t v = 0; v < rig_.size(); ++v) {
      const double least =
          std::max({kSmallestClock_s, kSmallestStep * samples_.Step(v), kClockSigmas * clocks.sigma_s[v]});
      const bool off = std::abs(clocks.clock_s[v]) > least && std::abs(clocks.clock_s[v]) <= options_.audit.longest_s;
      model.clock_s[v] = off ? clocks.clock_s[v] : 0.0;
      changed = changed || std::abs(model.clock_s[v] - model_.clock_s[v]) > 0.25 * kSmallestClock_s;
    }
    if (!changed) return {};
    return model;
  }

  int FrameAt(double time_s) const {
    return static_cast<int>(std::lower_bound(take_.time_s.begin(), take_.time_s.end(), time_s - 1e-9) -
                            take_.time_s.begin());
  }

  void TellOfClock(std::size_t v, AuditedRig& audited) const {
    if (model_.clock_s[v] == 0.0) return;
    RigModel without = model_;
    without.clock_s[v] = 0.0;
    RigFault fault;
    fault.code = "camera_clock_off";
    fault.camera = rig_[v].camera.camera.name;
    fault.value = 1e3 * model_.clock_s[v];
    const std::vector<double> costs = CostsOf(without);
    fault.confidence = Confidence(costs, cost_);
    fault.corrected = options_.audit.clocks == AuditAction::kCorrect;
    fault.message = "what camera " + fault.camera + " stamps happens " + RoundedText(std::abs(fault.value), 3) +
                    " ms " + (fault.value > 0.0 ? "later" : "earlier") + " by the clock of the others";
    if (v < clock_sigma_s_.size())
      fault.message += " (standard deviation " + RoundedText(1e3 * clock_sigma_s_[v], 2) + " ms)";
    fault.message += ", without which it fits " + RoundedText(100.0 * (Sum(costs) / Sum(cost_) - 1.0), 2) + " % worse";
    audited.corrected = audited.corrected || fault.corrected;
    audited.faults.push_back(std::move(fault));
  }

  void TellOfMove(std::size_t v, AuditedRig& audited) const {
    const std::vector<CameraPart>& parts = model_.camera[v];
    RigModel without = model_;
    without.camera[v] = given_.camera[v];
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const Camera& is = parts[p].camera;
      const Camera& was = given_.camera[v][0].camera;
      const double moved = (is.Centre() - was.Centre()).norm();
      const double turned = is.camera_from_world.rotation.angularDistance(was.camera_from_world.rotation);
      if (moved == 0.0 && turned == 0.0) continue;
      RigFault fault;
      fault.code = "camera_moved";
      fault.camera = rig_[v].camera.camera.name;
      fault.value = 1e3 * moved;
      fault.confidence = Confidence(CostsOf(without), cost_);
      fault.corrected = options_.audit.moved == AuditAction::kCorrect;
      const int changed = parts.size() == 2 ? FrameAt(parts[1].from_s) : 0;
      if (parts.size() == 2) {
        fault.frame_begin = p == 0 ? 0 : changed;
        fault.frame_end = p == 0 ? changed : static_cast<int>(take_.time_s.size());
      }
      fault.message = "camera " + fault.camera + " stands " + RoundedText(fault.value, 3) + " mm and " +
                      RoundedText(kDegrees * turned, 2) + " degrees from where its calibration has it";
      if (parts.size() == 2) {
        fault.message +=
            p == 0 ? " until frame " + std::to_string(changed) : " from frame " + std::to_string(changed) + " on";
      }
      audited.corrected = audited.corrected || fault.corrected;
      audited.faults.push_back(std::move(fault));
    }
  }

  /// Where a moved camera stands, by all frames or, of a long take, evenly spread ones; a part that stands as
  /// calibrated stays so.
  void Settle(std::size_t v) {
    const CameraPart given = given_.camera[v][0];
    const auto stands = [&](const CameraPart& part) {
      return (part.camera.Centre() - given.camera.Centre()).norm() == 0.0;
    };
    std::vector<CameraPart>& parts = model_.camera[v];
    if (std::all_of(parts.begin(), parts.end(), stands)) return;
    const std::vector<CameraPart> found = parts;
    const std::size_t step = take_.time_s.size() * take_.people.size() / kSettlingMoments + 1;
    RefitParts(RigSamples(rig_, take_, EveryFrame(take_.time_s.front(), take_.time_s.back(), step)), v,
               options_.triangulation, model_);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (stands(found[p])) parts[p] = found[p];
    }
  }

  /// Everybody in every `step`-th frame of those from one moment to another.
  std::vector<RigMoment> EveryFrame(double from_s, double to_s, std::size_t step = 1) const {
    std::vector<RigMoment> moments;
    for (std::size_t f = 0; f < take_.time_s.size(); f += step) {
      const double moment = take_.time_s[f];
      if (moment < from_s || moment > to_s) continue;
      for (int p = 0; p < static_cast<int>(take_.people.size()); ++p) moments.push_back({p, moment});
    }
    return moments;
  }

  /// When the camera was moved, to the frame.
  void Locate(std::size_t v) {
    double& from_s = model_.camera[v][1].from_s;
    const auto later = std::find_if(samples_.moments().begin(), samples_.moments().end(),
                                    [&](const RigMoment& moment) { return moment.time_s >= from_s; });
    const auto at = later - samples_.moments().begin();
    const auto time = [&](std::ptrdiff_t i) {
      return samples_.moments()[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, samples_.count() - 1))]
          .time_s;
    };
    std::vector<RigMoment> between = EveryFrame(time(at - 3), time(at + 2));
    if (between.empty()) return;
    from_s = WhenMoved(RigSamples(rig_, take_, std::move(between)), model_, v, options_.triangulation);
  }

  std::vector<RigView> Corrected() const {
    std::vector<RigView> rig;
    const bool clocks = options_.audit.clocks == AuditAction::kCorrect;
    const bool moved = options_.audit.moved == AuditAction::kCorrect;
    for (std::size_t v = 0; v < rig_.size(); ++v) {
      const std::vector<CameraPart>& parts = moved ? model_.camera[v] : given_.camera[v];
      RigView whole = rig_[v];
      for (double& time : whole.time_s) time += clocks ? model_.clock_s[v] : 0.0;
      int begin = 0;
      for (std::size_t p = 0; p < parts.size(); ++p) {
        int end = whole.frames();
        if (p + 1 < parts.size()) {
          end =
              static_cast<int>(std::lower_bound(whole.time_s.begin(), whole.time_s.end(), parts[p + 1].from_s - 1e-9) -
                               whole.time_s.begin());
        }
        RigView view = parts.size() > 1 ? whole.Frames(begin, end) : whole;
        view.camera = TriangulationView(parts[p].camera);
        if (p > 0) view.camera.camera.name += " from frame " + std::to_string(FrameAt(parts[p].from_s));
        if (view.frames() > 0) rig.push_back(std::move(view));
        begin = end;
      }
    }
    return rig;
  }

  const std::vector<RigView>& rig_;
  const Association& take_;
  const KeypointFitOptions& options_;
  RigSamples samples_;
  RigModel model_;
  RigModel given_;
  std::vector<double> cost_;
  std::vector<double> clock_sigma_s_;
};

}  // namespace

AuditedRig AuditRig(const std::vector<RigView>& rig, const Association& take, const KeypointFitOptions& options) {
  return Auditor(rig, take, options).Audit();
}

}  // namespace mocurate
