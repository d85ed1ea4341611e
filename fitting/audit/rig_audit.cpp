#include "fitting/audit/rig_audit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/base/text.h"
#include "fitting/audit/camera_moves.h"
#include "fitting/audit/clock_offsets.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/audit/rig_samples.h"
#include "fitting/audit/view_sides.h"

namespace mocurate {
namespace {

/// Takes with kMomentsOfTake each, evenly spread; more share as many, down to kFewestMoments each (numerical).
constexpr std::size_t kMostTakesWhole = 4;
constexpr std::size_t kSettlingMoments = 2000;  ///< moments for the final refit of a moved camera (numerical)
/// Share of a view's frame interval: smaller clock offsets are not reported.
constexpr double kSmallestStep = 0.25;
constexpr double kClockSigmas = 5.0;     ///< standard deviations: smaller clock offsets are not reported
constexpr double kLeastCostGain = 0.02;  ///< share of the cost that a correction must remove
/// Views that keep their pose: with fewer, the moved one is ambiguous (numerical).
constexpr std::size_t kMinOtherViews = 3;
constexpr std::size_t kMinSampledViews = 2;  ///< fewest views that keep their pose
constexpr double kExplainedElsewhere =
    0.25;  ///< of the cost: gain of a move that counts even with fewer than kMinOtherViews

/// Moments of all takes together.
int MomentsOfTakes(std::size_t takes) {
  const std::size_t count = std::max<std::size_t>(1, takes);
  return static_cast<int>(std::max(kMomentsOfTake * std::min(count, kMostTakesWhole), kFewestMoments * count));
}

class KeypointAuditor {
 public:
  KeypointAuditor(const std::vector<RigView>& rig, const Association& take, const std::vector<std::string>& names,
                  const KeypointFitOptions& options, const TakeStarts& takes)
      : rig_(rig),
        take_(take),
        options_(options),
        takes_(takes),
        other_side_(OtherSides(names)),
        samples_(rig, take, other_side_,
                 RigSamples::Spread(rig, take, MomentsOfTakes(takes.size()), options.triangulation.noise, takes)),
        model_(rig),
        given_(rig) {}

  AuditedRig Audit() {
    AuditedRig audited;
    audited.rig = rig_;
    audited.not_audited = WhyNotAudited();
    if (samples_.count() == 0) return audited;
    audited.residual_px = ResidualMap(samples_, given_, take_.time_s, options_.triangulation);
    if (rig_.size() < kLeastViewsAudited || samples_.count() < kFewestMoments) return audited;
    const KeypointAuditOptions& audit = options_.audit;
    if (audit.clocks == AuditAction::kOff && audit.moved == AuditAction::kOff && audit.sides == AuditAction::kOff) {
      return audited;
    }
    cost_ = CostsOf(model_);
    for (std::size_t round = 0; round < 2 * rig_.size() && Improve(); ++round) {
    }
    DropIdleClocks();
    for (std::size_t v = 0; v < rig_.size(); ++v) {
      if (model_.camera[v].size() == 2) Locate(v);
      Settle(v);
    }
    cost_ = CostsOf(model_);
    DropIdleMoves();
    DropIdleClocks();
    if (options_.audit.rules.on(FittingRule::kClockWidening)) WidenClocks();
    for (std::size_t v = 0; v < rig_.size(); ++v) {
      ReportSides(v, audited);
      ReportClock(v, audited);
      ReportMove(v, audited);
    }
    ReportAmbiguity(audited);
    if (audited.corrected) audited.rig = CorrectedRig(rig_, ToCorrect(), other_side_, take_.time_s);
    audited.estimate.model = audited.corrected ? ToCorrect() : given_;
    const std::vector<std::size_t> moved = MovedViews(given_, *audited.estimate.model);
    const auto suspect = [&](std::size_t v) { return IsSuspect(v); };
    if (std::any_of(moved.begin(), moved.end(), suspect)) audited.estimate.suspect = suspect_;
    if (too_far_) audited.estimate.suspect.push_back(*too_far_);
    for (std::size_t v = 0; v < rig_.size(); ++v) audited.estimate.gain.push_back(GainOf(v));
    return audited;
  }

 private:
  std::vector<double> CostsOf(const RigModel& model) const {
    return CostsUnder(samples_, model, options_.triangulation);
  }

  /// Of one of the tests of all views.
  double OfAllTests(double confidence) const { return ConfidenceOfTests(confidence, kTestsOfView * rig_.size()); }

  /// Of a view, with held-out moments where it was moved; empty where it is unchanged.
  std::vector<std::optional<double>> GainOf(std::size_t v) const {
    const RigModel given_pose = WithGivenPose(v);
    const bool moved = !MovedViews(given_pose, model_).empty();
    if (!moved && model_.clock_s[v] == 0.0 && !model_.sides_exchanged[v]) return {};
    RigModel without = given_pose;
    without.clock_s[v] = 0.0;
    without.sides_exchanged[v] = false;
    std::vector<double> time_s;
    for (const RigMoment& moment : samples_.moments()) time_s.push_back(moment.time_s);
    return GainOfTakes(takes_, time_s, CostsOf(without),
                       moved ? HeldOutCostsOfMoves(samples_, given_pose, {v}, options_.triangulation) : cost_);
  }

  /// The parts of the requested audit that are impossible, and why. Empty when all are possible, and for rigs of two.
  std::string WhyNotAudited() const {
    const RigAuditOptions& audit = options_.audit;
    const bool moved = audit.moved != AuditAction::kOff;
    const bool clocks = audit.clocks != AuditAction::kOff;
    if (rig_.size() < kLeastViewsAudited) return {};
    if (samples_.count() < kFewestMoments && (moved || clocks)) {
      return "clocks and camera poses were not audited: another view shares people with the view of the most "
             "frames at " +
             Counted(samples_.count(), "different moment") +
             " (frames times people; without repeated frames and takes without movement), " +
             std::to_string(kFewestMoments) + " are needed";
    }
    if (rig_.size() > kMostViewsAudited && (moved || audit.exchanged != AuditAction::kOff)) {
      return "moved cameras and exchanged files were not audited: the rig has " + std::to_string(rig_.size()) +
             " cameras, at most " + std::to_string(kMostViewsAudited) + " are supported";
    }
    return {};
  }

  /// Applies the change that explains most of the remaining cost; false without one.
  bool Improve() {
    std::optional<RigModel> with_clocks;
    std::vector<double> clock_cost;
    std::optional<ClockOffsets> clocks;
    if (options_.audit.clocks != AuditAction::kOff) {
      clocks = RefineClocks(samples_, model_, options_.triangulation);
      with_clocks = WithClocks(*clocks);
      if (with_clocks) clock_cost = CostsOf(*with_clocks);
      if (with_clocks && Sum(clock_cost) >= (1.0 - kLeastCostGain) * Sum(cost_)) with_clocks.reset();
    }
    std::optional<CameraMove> move;
    if (options_.audit.moved != AuditAction::kOff && !inconsistent_) {
      move = FindMove(samples_, model_, options_.triangulation);
      if (move && !(Explains(*move) && IsNotable(move->view, move->model))) move.reset();
    }
    if (move && with_clocks && Sum(clock_cost) <= Sum(move->cost)) move.reset();
    if (ApplySides(move ? Sum(move->cost) : with_clocks ? Sum(clock_cost) : Sum(cost_))) return true;
    if (move && ApplyMove(std::move(*move))) return true;
    if (with_clocks) {
      model_ = std::move(*with_clocks);
      cost_ = std::move(clock_cost);
      clock_sigma_s_ = clocks->sigma_s;
      return true;
    }
    return false;
  }

  /// Exchanges the sides of a view where that explains more than the best other change, of cost `otherwise`.
  bool ApplySides(double otherwise) {
    if (options_.audit.sides == AuditAction::kOff || !options_.audit.rules.on(FittingRule::kSidesThroughout))
      return false;
    auto sides = FindSidesThroughout(samples_, model_, cost_, options_.audit.sure, options_.triangulation);
    if (!sides || Sum(sides->cost) > otherwise) return false;
    model_ = std::move(sides->model);
    cost_ = std::move(sides->cost);
    return true;
  }

  bool IsNotable(std::size_t view, const RigModel& model) const {
    const TriangulatedTracks points =
        TriangulateViews(samples_.Views(model), samples_.count(), samples_.keypoints(), options_.triangulation);
    return IsNotableMove(given_.camera[view][0].camera, model.camera[view], points, options_.triangulation.noise);
  }

  bool Explains(const CameraMove& move) const {
    return Sum(move.held_out) < (1.0 - kLeastCostGain) * Sum(cost_) &&
           OfAllTests(ConfidenceOfMove(samples_, move.camera, cost_, move.held_out)) >= options_.audit.sure;
  }

  /// Applies a move where it is reliable. The moved camera is ambiguous when another one's move explains about as much,
  /// or when too few cameras keep their pose; a jump identifies the camera.
  bool ApplyMove(CameraMove move) {
    if (GoesTooFar(given_, move)) {
      too_far_ = move.view;
      inconsistent_ = DisagreementOf(rig_, {move.view});
      inconsistent_->confidence = OfAllTests(ConfidenceOfMove(samples_, move.camera, cost_, move.held_out));
      inconsistent_->message +=
          " the pose that fits best is farther away than the cameras of this rig are from each other; "
          "check whether the camera records the same scene and has this calibration";
      return false;
    }
    const std::vector<std::size_t> moved = MovedViews(given_, model_);
    if (moved.size() + kMinSampledViews >= rig_.size()) return false;
    const bool overdetermined = moved.size() + kMinOtherViews < rig_.size();
    if (!overdetermined && Sum(move.cost) > (1.0 - kExplainedElsewhere) * Sum(cost_)) return false;
    std::vector<std::size_t> rivals = move.rivals;
    for (const std::size_t v : moved) {
      if (!overdetermined && move.camera.size() == 1 && model_.camera[v].size() == 1) rivals.push_back(v);
    }
    if (!rivals.empty()) suspect_.push_back(move.view);
    suspect_.insert(suspect_.end(), rivals.begin(), rivals.end());
    move_confidence_[move.view] = move.confidence;
    model_ = std::move(move.model);
    cost_ = std::move(move.cost);
    return true;
  }

  /// Confidence that a clock offset is not 0, by its standard deviation over spans of the take. Of one number, fitting
  /// all moments favours no sign, so nothing is held out.
  double ClockConfidence(std::size_t v) const {
    if (v >= clock_sigma_s_.size()) return 0.0;
    return OfAllTests(SpanConfidence(std::abs(model_.clock_s[v]) / clock_sigma_s_[v], kFewestSpans));
  }

  /// Confidence that views have other poses than in `without`, where they have the given ones.
  double MoveConfidence(const RigModel& without, const std::vector<std::size_t>& views) const {
    const std::vector<double> held_out = HeldOutCostsOfMoves(samples_, without, views, options_.triangulation);
    const std::vector<CameraPart>& parts = views.size() == 1 ? model_.camera[views[0]] : given_.camera[views[0]];
    return OfAllTests(ConfidenceOfMove(samples_, parts, CostsOf(without), held_out));
  }

  /// The model with the given pose of a view.
  RigModel WithGivenPose(std::size_t v) const {
    RigModel without = model_;
    without.camera[v] = given_.camera[v];
    return without;
  }

  /// Whether another pose of the camera explains about as much as its clock offset. Of three cameras, two do not
  /// determine points well enough to tell whose pose it is: another pose of any camera counts.
  bool MayBeMoved(std::size_t v, const RigModel& without_clock) const {
    if (rig_.size() > kMostViewsAudited) return false;
    const bool any = rig_.size() < kMinOtherViews + 1;
    for (std::size_t w = any ? 0 : v; w < (any ? rig_.size() : v + 1); ++w) {
      const auto move = FindMoveOf(samples_, without_clock, w, options_.triangulation);
      if (move && Confidence(move->cost, cost_) < kRivalBeaten) return true;
    }
    return false;
  }

  /// Disagreement of the other cameras about the clock offsets: a part of their standard deviation, not of the
  /// confidence.
  void WidenClocks() {
    if (model_.clock_s == given_.clock_s || clock_sigma_s_.empty()) return;
    clock_change_s_ = ChangeOfClocks(samples_, model_, given_, options_.triangulation);
  }

  bool IsSuspect(std::size_t v) const { return std::find(suspect_.begin(), suspect_.end(), v) != suspect_.end(); }

  /// Drops clock offsets that explain little, have a low confidence, or are of suspect cameras. For a person who walks
  /// in one direction, a small calibration error looks like a clock offset.
  void DropIdleClocks() {
    while (true) {
      double least = 0.0;
      std::size_t idle = rig_.size();
      for (std::size_t v = 0; v < rig_.size(); ++v) {
        if (model_.clock_s[v] == 0.0) continue;
        RigModel without = model_;
        without.clock_s[v] = 0.0;
        const double cost = Sum(CostsOf(without));
        const bool sure = ClockConfidence(v) >= options_.audit.sure && !IsSuspect(v) && !MayBeMoved(v, without);
        if (sure && cost >= (1.0 + kLeastCostGain) * Sum(cost_)) continue;
        if (idle < rig_.size() && cost >= least) continue;
        least = cost;
        idle = v;
      }
      if (idle == rig_.size()) return;
      model_.clock_s[idle] = 0.0;
      cost_ = CostsOf(model_);
    }
  }

  /// Drops moves that, with the final model, have a low confidence or a negligible effect.
  void DropIdleMoves() {
    for (const std::size_t v : MovedViews(given_, model_)) {
      RigModel without = WithGivenPose(v);
      if (IsNotable(v, model_) && MoveConfidence(without, {v}) >= options_.audit.sure) continue;
      model_ = std::move(without);
      cost_ = CostsOf(model_);
    }
  }

  /// The model with the significant clock offsets; empty when that changes nothing.
  std::optional<RigModel> WithClocks(const ClockOffsets& clocks) const {
    RigModel model = model_;
    bool changed = false;
    for (std::size_t v = 0; v < rig_.size(); ++v) {
      const double least = std::max({kSameClock_s, kSmallestStep * samples_.Step(v), kClockSigmas * clocks.sigma_s[v]});
      const bool off = std::abs(clocks.clock_s[v]) > least && std::abs(clocks.clock_s[v]) <= options_.audit.longest_s;
      model.clock_s[v] = off ? clocks.clock_s[v] : 0.0;
      changed = changed || std::abs(model.clock_s[v] - model_.clock_s[v]) > 0.25 * kSameClock_s;
    }
    if (!changed) return {};
    return model;
  }

  int FrameAt(double moment) const { return mocurate::FrameAt(take_.time_s, moment); }

  void ReportSides(std::size_t v, AuditedRig& audited) const {
    if (!model_.sides_exchanged[v]) return;
    RigModel without = model_;
    without.sides_exchanged[v] = false;
    const std::vector<double> costs = CostsOf(without);
    RigFault fault =
        SidesExchanged(rig_[v].camera.camera.name, static_cast<int>(take_.time_s.size()), Sum(costs) - Sum(cost_));
    fault.confidence = OfAllTests(Confidence(costs, cost_));
    fault.corrected = options_.audit.sides == AuditAction::kCorrect;
    audited.corrected = audited.corrected || fault.corrected;
    audited.faults.push_back(std::move(fault));
  }

  void ReportClock(std::size_t v, AuditedRig& audited) const {
    if (model_.clock_s[v] == 0.0) return;
    RigModel without = model_;
    without.clock_s[v] = 0.0;
    std::optional<double> sigma;
    if (v < clock_sigma_s_.size()) sigma = clock_sigma_s_[v];
    if (sigma && v < clock_change_s_.size()) sigma = std::hypot(*sigma, clock_change_s_[v]);
    RigFault fault =
        ClockOff(rig_[v].camera.camera.name, model_.clock_s[v], sigma, Sum(CostsOf(without)) / Sum(cost_) - 1.0);
    fault.confidence = ClockConfidence(v);
    fault.corrected = options_.audit.clocks == AuditAction::kCorrect;
    audited.corrected = audited.corrected || fault.corrected;
    audited.faults.push_back(std::move(fault));
  }

  void ReportAmbiguity(AuditedRig& audited) const {
    if (inconsistent_) audited.faults.push_back(*inconsistent_);
    RigModel without = model_;
    for (const std::size_t v : MovedViews(given_, model_)) {
      if (IsSuspect(v)) without.camera[v] = given_.camera[v];
    }
    const std::vector<std::size_t> suspects = MovedViews(without, model_);
    const double confidence = suspects.empty() ? 0.0 : MoveConfidence(without, suspects);
    if (confidence < options_.audit.sure) return;
    RigFault fault = DisagreementOf(rig_, suspect_);
    fault.value = 100.0 * (1.0 - Sum(cost_) / Sum(CostsOf(without)));
    fault.confidence = confidence;
    fault.corrected = options_.audit.moved == AuditAction::kCorrect;
    fault.message += " one or more of these cameras have another pose than calibrated; which ones is ambiguous";
    if (fault.corrected) {
      audited.place_covariance = ShiftBetween(samples_, model_, without, options_.triangulation);
      fault.message += "; poses were corrected so that the views agree, which moves people by " +
                       RoundedText(1e3 * std::sqrt(audited.place_covariance.trace()), 2) +
                       " mm; the stated uncertainty includes this shift";
    }
    audited.corrected = audited.corrected || fault.corrected;
    audited.estimate.suspect = suspect_;
    audited.faults.push_back(std::move(fault));
  }

  void ReportMove(std::size_t v, AuditedRig& audited) const {
    const RigModel without = WithGivenPose(v);
    if (IsSuspect(v) || MovedViews(without, model_).empty()) return;
    const double confidence = MoveConfidence(without, {v});
    const std::vector<CameraPart>& parts = model_.camera[v];
    const auto frames = static_cast<int>(take_.time_s.size());
    const int changed = parts.size() == 2 ? FrameAt(parts[1].from_s) : frames;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const Camera& was = given_.camera[v][0].camera;
      if (HaveSamePose(was, parts[p].camera)) continue;
      RigFault fault = CameraMoved(was, parts[p].camera, options_.rig.empty() ? "its calibration" : "the rig's file",
                                   p == 0 ? 0 : changed, p == 0 ? changed : frames, frames);
      fault.confidence = confidence;
      if (move_confidence_.at(v) < 1.0) {
        fault.message += "; the confidence that no other camera moved instead is " +
                         RoundedText(100.0 * RoundedConfidence(move_confidence_.at(v)), 3) + " %";
      }
      fault.corrected = options_.audit.moved == AuditAction::kCorrect;
      audited.corrected = audited.corrected || fault.corrected;
      audited.faults.push_back(std::move(fault));
    }
  }

  /// Refits a moved camera to all frames or, of a long take, evenly spaced ones. A part at its calibrated pose keeps
  /// it.
  void Settle(std::size_t v) {
    const CameraPart given = given_.camera[v][0];
    const auto stands = [&](const CameraPart& part) { return HaveSamePose(part.camera, given.camera); };
    std::vector<CameraPart>& parts = model_.camera[v];
    if (std::all_of(parts.begin(), parts.end(), stands)) return;
    const std::vector<CameraPart> found = parts;
    const std::size_t step = take_.time_s.size() * take_.people.size() / kSettlingMoments + 1;
    RefitParts(RigSamples(rig_, take_, other_side_, EveryFrame(take_.time_s.front(), take_.time_s.back(), step)), v,
               options_.triangulation, model_);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (stands(found[p])) parts[p] = found[p];
    }
  }

  /// All people in every `step`-th frame between two moments.
  std::vector<RigMoment> EveryFrame(double from_s, double to_s, std::size_t step = 1) const {
    std::vector<RigMoment> moments;
    for (std::size_t f = 0; f < take_.time_s.size(); f += step) {
      const double moment = take_.time_s[f];
      if (moment < from_s || moment > to_s) continue;
      for (int p = 0; p < static_cast<int>(take_.people.size()); ++p) moments.push_back({p, moment});
    }
    return moments;
  }

  /// Finds the exact frame from which the camera was moved.
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
    from_s = WhenMoved(RigSamples(rig_, take_, other_side_, std::move(between)), model_, v, options_.triangulation);
  }

  /// The model without changes that are only reported.
  RigModel ToCorrect() const {
    RigModel model = model_;
    const KeypointAuditOptions& audit = options_.audit;
    if (audit.clocks != AuditAction::kCorrect) model.clock_s = given_.clock_s;
    if (audit.moved != AuditAction::kCorrect) model.camera = given_.camera;
    if (audit.sides != AuditAction::kCorrect) model.sides_exchanged = given_.sides_exchanged;
    return model;
  }

  const std::vector<RigView>& rig_;
  const Association& take_;
  const KeypointFitOptions& options_;
  const TakeStarts& takes_;
  std::vector<std::size_t> other_side_;
  RigSamples samples_;
  RigModel model_;
  RigModel given_;
  std::vector<double> cost_;
  std::vector<double> clock_sigma_s_;              ///< by spans of the take
  std::vector<double> clock_change_s_;             ///< see WidenClocks
  std::optional<RigFault> inconsistent_;           ///< a move too far to be plausible
  std::optional<std::size_t> too_far_;             ///< its view
  std::vector<std::size_t> suspect_;               ///< views of which some have another pose than calibrated
  std::map<std::size_t, double> move_confidence_;  ///< confidence per moved view (CameraMove)
};

}  // namespace

AuditedRig AuditRig(const std::vector<RigView>& rig, const Association& take, const std::vector<std::string>& names,
                    const KeypointFitOptions& options, const TakeStarts& takes) {
  return KeypointAuditor(rig, take, names, options, takes).Audit();
}

}  // namespace mocurate
