#include "fitting/clouds/cloud_rig_audit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/inconsistent_views.h"
#include "fitting/clouds/observed_rig.h"
#include "fitting/clouds/rig_clocks.h"
#include "fitting/clouds/rig_common_faults.h"
#include "fitting/clouds/rig_exchange.h"
#include "fitting/clouds/view_registration.h"
#include "fitting/clouds/view_surface.h"
#include "fitting/evidence/noise.h"

namespace mocurate {
namespace {

constexpr std::size_t kFewestSamples = 6;  ///< fewest comparisons for an audit
/// Share of the loss that a move of kLeastMove must remove; proportional for longer moves.
constexpr double kLeastMoveGain = 0.08;
constexpr double kSureGain = 0.3;               ///< of the loss: gain that suffices for any move
constexpr double kFewerMoves = 0.15;            ///< of the gain: a solution with one moved camera may be worse by this
                                                ///< share
constexpr double kInconsistentViewsLoss = 0.2;  ///< loss from which corrected views may still show something else
constexpr double kPersonRadius = 0.45;          ///< m; converts a rotation to a displacement

class DepthAuditor {
 public:
  DepthAuditor(const std::vector<DepthView>& views, const RigAuditOptions& options)
      : options_(options), sampler_(views), delay_(views.size(), 0), cameras_(CamerasOf(views)) {
    for (const DepthView& view : views) report_.cameras.push_back(view.camera.name);
  }

  Expected<AuditedDepthRig> Audit() {
    if (Status apart = ReportSharedPlaces(); !apart) return Forward(apart);
    if (Status seen = Resample(); !seen) return Forward(seen);
    if (Status person = CheckPersonIsSeen(rig_, sampler_.flat()); !person) return Forward(person);
    if (Status corrected = CorrectLengths(); !corrected) return Forward(corrected);
    if (Status seen = Resample(); !seen) return Forward(seen);
    report_.without_person = WithoutPerson(rig_);
    report_.frames = sampler_.frames();
    report_.loss = LossOfViews(rig_, losses_);
    report_.residual_mm = ResidualsOfViews(rig_, cameras_);
    const bool enough = HasEnoughSamples();
    if (Status corrected = enough && !files_wrong_ ? CorrectCommonOffset() : Status(); !corrected) {
      return Forward(corrected);
    }
    if (enough && CorrectFileAssignment()) {
      if (Status seen = Resample(); !seen) return Forward(seen);
    }
    if (Status corrected = CorrectDepths(); !corrected) return Forward(corrected);
    if (report_.not_audited.empty() && !files_wrong_) {
      // Apply the change that explains most, then test again.
      for (std::size_t round = 0; round < 2 * delay_.size(); ++round) {
        const Expected<bool> improved = Improve();
        if (!improved) return Forward(improved);
        if (!*improved) break;
      }
    }
    report_.loss_after = LossOfViews(rig_, losses_);
    for (std::size_t v = 0; v < delay_.size(); ++v) ReportClock(v), ReportMove(v);
    ReportInconsistentViews(InconsistentViews(), report_.faults);
    return AuditedDepthRig{WithoutInconsistentViews(Corrected(), report_.faults), std::move(report_)};
  }

 private:
  Status ReportSharedPlaces() {
    const auto alike = [&](std::size_t a, std::size_t b) {
      return DepthSimilarity(sampler_.views()[a], sampler_.views()[b]);
    };
    const bool places = options_.rules.on(FittingRule::kSharedPlaces);
    auto faults = FaultsOfSharedPlaces(cameras_, alike, places ? options_.exchanged : AuditAction::kOff,
                                       {"depth views", "fitting.point_clouds.audit.exchanged"});
    if (!faults) return Forward(faults);
    files_wrong_ = PlacesAreCopied(*faults);
    report_.faults = std::move(*faults);
    return {};
  }

  std::vector<RigFault> InconsistentViews() const {
    if (!options_.rules.on(FittingRule::kInconsistentViews)) return {};
    if (!report_.not_audited.empty()) return ContradictionOf(report_.cameras, report_.loss_after);
    return files_wrong_ ? std::vector<RigFault>() : FindInconsistentViews(rig_, losses_, options_);
  }

  Status Resample() {
    Expected<ObservedRig> rig = sampler_.Seen(delay_);
    if (!rig) return Forward(rig);
    rig_ = std::move(*rig);
    losses_ = LossOfSamples(rig_, cameras_);
    return {};
  }

  /// With two views, the moved camera is ambiguous.
  bool CorrectsMoves() const { return options_.moved == AuditAction::kCorrect && delay_.size() > 2; }

  Status CorrectLengths() {
    if (options_.unit == AuditAction::kOff) return {};
    const Expected<std::optional<MisreadLengths>> misread = FindMisreadLengths(sampler_);
    if (!misread) return Forward(misread);
    if (!*misread) return {};
    if (options_.unit == AuditAction::kReport) {
      return Fail(
          ErrorCode::kInconsistent, WordsOf(**misread), "depth views",
          "declare the unit of depths and of the calibration, or set fitting.point_clouds.audit.unit to correct");
    }
    report_.faults.push_back(LengthsMisread(**misread));
    sampler_ = DepthRigSampler(WithLengths(sampler_.views(), **misread));
    cameras_ = CamerasOf(sampler_.views());
    return {};
  }

  /// Corrects depths of a view that are too long or too short, if that explains much more than another pose of its
  /// camera.
  Status CorrectDepths() {
    if (!options_.rules.on(FittingRule::kWrongDepths)) return {};
    if (options_.moved == AuditAction::kOff || delay_.size() < 3 || delay_.size() > kFewViews) return {};
    if (!report_.not_audited.empty() || files_wrong_) return {};
    const auto wrong = FindWrongDepths(sampler_, delay_, rig_, cameras_);
    if (!wrong) return Forward(wrong);
    const double loss = MeanLoss(losses_);
    if (!*wrong || (*wrong)->loss > kInconsistentViewsLoss || (*wrong)->loss > (1.0 - kSureGain) * loss) return {};
    const auto moved = FindFarMove();
    if (!moved) return Forward(moved);
    if (*moved && (*wrong)->loss > (1.0 - kFewerMoves) * MeanLoss((*moved)->losses)) return {};
    const double confidence = OfAllTests(ConfidenceOfLosses(rig_, losses_, (*wrong)->held_out, (*wrong)->view));
    if (confidence < options_.sure) return {};
    RigFault fault = DepthsOff(report_.cameras[(*wrong)->view], **wrong);
    fault.corrected = CorrectsMoves();
    wrong_depths_ = **wrong;
    sampler_ = DepthRigSampler(WithDepths(sampler_.views(), (*wrong)->view, (*wrong)->factor));
    if (Status seen = Resample(); !seen) return seen;
    fault.confidence = confidence;
    report_.faults.push_back(std::move(fault));
    return {};
  }

  /// Corrects a fault common to all views, if that explains more than one camera's depths or pose, or exchanged files.
  /// Mirrored images are only reported.
  Status CorrectCommonOffset() {
    if (!options_.rules.on(FittingRule::kCommonFault)) return {};
    const auto common = FindCommonFault(rig_, losses_);
    if (!common || common->confidence < options_.sure) return {};
    const AuditAction action = common->mirrored ? options_.exchanged : options_.moved;
    if (action == AuditAction::kOff) return {};
    const auto single = FindWrongDepths(sampler_, delay_, rig_, cameras_);
    if (!single) return Forward(single);
    const auto exchange = FindFileExchange(rig_, losses_);
    const auto moved = FindFarMove();
    if (!moved) return Forward(moved);
    const double others = std::min({*single ? (*single)->loss : 1.0, exchange ? exchange->exchanged : 1.0,
                                    *moved ? MeanLoss((*moved)->losses) : 1.0});
    if (common->loss_after > (1.0 - kFewerMoves) * others) return {};
    RigFault fault = FaultOfAll(report_.cameras, *common, rig_);
    fault.confidence = common->confidence;
    if (common->mirrored && action == AuditAction::kCorrect) {
      return Fail(ErrorCode::kInconsistent,
                  fault.message + "; " + ConfidenceText(fault.confidence, fault.confidence_of), "depth views",
                  "mirror the images, or give the calibration of the images as they are, or set "
                  "fitting.point_clouds.audit.exchanged: report to use them as given");
    }
    files_wrong_ = common->mirrored;
    fault.corrected = !common->mirrored && CorrectsMoves();
    report_.faults.push_back(std::move(fault));
    if (common->mirrored) return {};
    all_depths_ = common->factor;
    sampler_ = DepthRigSampler(WithAllDepths(sampler_.views(), all_depths_));
    return Resample();
  }

  bool HasEnoughSamples() {
    if (delay_.size() < 2) return false;
    const auto samples = static_cast<std::size_t>(
        std::count_if(losses_.begin(), losses_.end(), [](double loss) { return loss >= 0.0; }));
    if (samples >= kFewestSamples) return true;
    report_.not_audited = "poses, clocks and files of depth cameras were not audited: " +
                          Counted(static_cast<long long>(samples), "comparison") +
                          " of two views with the person at one moment, " + std::to_string(kFewestSamples) +
                          " are needed";
    return false;
  }

  /// True where files were exchanged back.
  bool CorrectFileAssignment() {
    if (options_.exchanged == AuditAction::kOff || files_wrong_) return false;
    const auto exchange = FindFileExchange(rig_, losses_);
    if (!exchange) return false;
    RigFault fault = ExchangedFiles(report_.cameras, *exchange);
    fault.corrected =
        exchange->unique && options_.exchanged == AuditAction::kCorrect && exchange->confidence >= options_.sure;
    files_wrong_ = !fault.corrected;
    if (fault.corrected) sampler_ = DepthRigSampler(WithExchangedFiles(sampler_.views(), exchange->source));
    report_.faults.push_back(std::move(fault));
    return !files_wrong_;
  }

  /// New poses of cameras, from initial ones.
  struct Moves {
    std::vector<bool> free;
    std::vector<Camera> start, cameras;
    std::vector<double> losses;                ///< LossOfSamples
    std::vector<std::vector<Camera>> of_half;  ///< RegisterHalves; empty: not yet needed
    std::map<std::size_t, double> confidence;  ///< of views
  };

  Expected<Moves> Registered(std::vector<bool> free, std::vector<Camera> start) const {
    Expected<std::vector<Camera>> found = Register(rig_, free, start);
    if (!found) return Forward(found);
    std::vector<double> losses = LossOfSamples(rig_, *found);
    return Moves{std::move(free), std::move(start), std::move(*found), std::move(losses), {}, {}};
  }

  /// Of one of the tests of all views.
  double OfAllTests(double confidence) const { return ConfidenceOfTests(confidence, kTestsOfView * delay_.size()); }

  /// Applies the clock or the poses that explain most of the remaining loss; false without an improvement.
  Expected<bool> Improve() {
    std::optional<ClockOffsetOfView> clock;
    if (options_.clocks != AuditAction::kOff && delay_.size() <= kMostViewsAudited && sampler_.step_s() > 0.0) {
      const auto longest = static_cast<int>(std::min(options_.longest_s / sampler_.step_s(), 1e4));
      auto found = FindClockOffset(sampler_, delay_, cameras_, longest, options_.sure);
      if (!found) return Forward(found);
      clock = *found;
      if (clock && std::abs(delay_[clock->view] + clock->frames) > longest) clock.reset();
    }
    std::optional<Moves> moved;
    if (options_.moved != AuditAction::kOff) {
      auto found = FindMoves();
      if (!found) return Forward(found);
      moved = std::move(*found);
    }
    if (!clock && !moved) return false;
    const double loss = MeanLoss(losses_);
    std::vector<int> delays = delay_;
    double with_clock = loss, with_moves = loss;
    if (clock) {
      delays[clock->view] += clock->frames;
      const Expected<ObservedRig> rig = sampler_.Seen(delays);
      if (!rig) return Forward(rig);
      const std::vector<double> losses = LossOfSamples(*rig, cameras_);
      // Of another scene, too, one offset is the least bad.
      if (LossOfViews(*rig, losses)[clock->view] <= kInconsistentViewsLoss) with_clock = MeanLoss(losses);
    }
    if (moved) with_moves = MeanLoss(moved->losses);
    if (std::min(with_clock, with_moves) >= loss) return false;
    if (with_clock <= with_moves) {
      delay_ = std::move(delays);
      ClockOffsetOfView& found = clocks_[clock->view];
      clock->confidence = std::max(clock->confidence, found.confidence);
      found = *clock;
    } else {
      cameras_ = std::move(moved->cameras);
      for (const auto& [v, confidence] : moved->confidence)
        move_confidence_[v] = std::max(move_confidence_[v], confidence);
    }
    if (Status seen = Resample(); !seen) return Forward(seen);
    return true;
  }

  /// New poses of cameras that certainly moved, registered. Implausible ones are reset one by one.
  Expected<std::optional<Moves>> FindMoves() {
    std::vector<bool> free = MayHaveMoved(LossOfViews(rig_, losses_));
    std::vector<double> by_clock(free.size(), -1.0);
    while (std::find(free.begin(), free.end(), true) != free.end()) {
      Expected<Moves> found = Registered(free, cameras_);
      if (!found) return Forward(found);
      std::optional<std::size_t> weakest;
      double least = 0.0;
      bool any = false;
      for (std::size_t v = 0; v < free.size(); ++v) {
        if (!free[v]) continue;
        const double move = MoveOf(cameras_[v], found->cameras[v]);
        const Expected<bool> real = IsReal(v, *found, by_clock[v]);
        if (!real) return Forward(real);
        any = any || *real;
        if (*real || (weakest && move >= least)) continue;
        weakest = v;
        least = move;
      }
      if (!weakest && std::count(free.begin(), free.end(), true) > 1) {
        auto one = FindOneMove(MeanLoss(found->losses));
        if (!one || *one) return one;
      }
      if (!weakest) return std::optional<Moves>(std::move(*found));
      if (!any) break;
      free[*weakest] = false;
    }
    return FindFarMove();
  }

  /// Registers camera v alone from `start`. Accepts the pose if it is significant and lowers the rig's loss.
  Status TryOneMove(std::size_t v, std::vector<Camera> start, double& least, std::optional<Moves>& best) {
    std::vector<bool> free(delay_.size(), false);
    free[v] = true;
    Expected<Moves> found = Registered(std::move(free), std::move(start));
    if (!found) return Forward(found);
    if (MeanLoss(found->losses) >= least) return {};
    double by_clock = -1.0;
    const Expected<bool> real = IsReal(v, *found, by_clock);
    if (!real) return Forward(real);
    if (!*real) return {};
    least = MeanLoss(found->losses);
    best = std::move(*found);
    return {};
  }

  /// The one camera that moved too far for surfaces to overlap: first shifted to the person's position, then
  /// registered.
  Expected<std::optional<Moves>> FindFarMove() {
    std::optional<Moves> best;
    if (!options_.rules.on(FittingRule::kFarMove)) return best;
    const std::vector<Vector3d> aside = AsideOf(rig_, cameras_);
    double least = MeanLoss(losses_);
    for (std::size_t v = 0; v < delay_.size() && delay_.size() > 2 && delay_.size() <= kFewViews; ++v) {
      if (aside[v].norm() < kAside) continue;
      std::vector<Camera> start = cameras_;
      start[v].camera_from_world = start[v].camera_from_world * RigidTransform{Quaterniond::Identity(), aside[v]};
      if (Status tried = TryOneMove(v, std::move(start), least, best); !tried) return Forward(tried);
    }
    return best;
  }

  /// One camera's move that explains nearly as much as several together: the others' common move is its opposite.
  Expected<std::optional<Moves>> FindOneMove(double loss_of_several) {
    std::optional<Moves> best;
    double least = loss_of_several + kFewerMoves * (MeanLoss(losses_) - loss_of_several);
    for (std::size_t v = 0; v < delay_.size() && delay_.size() <= kFewViews; ++v) {
      if (Status tried = TryOneMove(v, cameras_, least, best); !tried) return Forward(tried);
    }
    return best;
  }

  /// Whether a camera's new pose explains more than noise, also when registered to half of the samples and judged by
  /// the other half, and more than its clock between two frames. Sets the confidence.
  Expected<bool> IsReal(std::size_t v, Moves& found, double& by_clock) {
    const double move = MoveOf(cameras_[v], found.cameras[v]);
    if (move < kLeastMove) return false;
    std::vector<Camera> without = found.cameras;
    without[v] = cameras_[v];
    const auto both = OfView(rig_, v, LossOfSamples(rig_, without), found.losses);
    const double loss = MeanLoss(both.second);
    const double left = 1.0 - std::min(kLeastMoveGain * move / kLeastMove, kSureGain);
    if (loss > kInconsistentViewsLoss || loss > left * MeanLoss(both.first)) return false;
    if (delay_.size() <= kMostViewsAudited && sampler_.together() > 1) {
      if (by_clock < 0.0) {
        const Expected<double> least = LeastLossBetweenFrames(sampler_, delay_, without, v);
        if (!least) return Forward(least);
        by_clock = *least;
      }
      if (loss >= left * by_clock) return false;
    }
    if (found.of_half.empty()) {
      auto of_half = RegisterHalves(rig_, found.free, found.start);
      if (!of_half) return Forward(of_half);
      found.of_half = std::move(*of_half);
    }
    std::vector<std::vector<Camera>> unmoved = found.of_half;
    for (std::vector<Camera>& of_half : unmoved) of_half[v] = cameras_[v];
    const std::vector<double> worse = HeldOutLosses(rig_, unmoved), better = HeldOutLosses(rig_, found.of_half);
    found.confidence[v] = OfAllTests(ConfidenceOfLosses(rig_, worse, better, v));
    return found.confidence[v] >= options_.sure;
  }

  double MoveOf(const Camera& was, const Camera& is) const {
    const CameraMoveAt move = MoveBetween(was, is, rig_.centre);
    return move.shift + kPersonRadius * move.turn;
  }

  void ReportClock(std::size_t v) {
    if (delay_[v] == 0) return;
    const ClockOffsetOfView& found = clocks_.at(v);
    const double off_ms = -1e3 * sampler_.step_s() * (delay_[v] - found.frames + found.offset);
    RigFault fault = DepthClockOff(report_.cameras[v], off_ms, delay_[v]);
    fault.confidence = found.confidence;
    fault.corrected = options_.clocks == AuditAction::kCorrect;
    report_.faults.push_back(std::move(fault));
  }

  void ReportMove(std::size_t v) {
    const Camera& was = rig_.views[v].camera;
    const CameraMoveAt move = MoveBetween(was, cameras_[v], rig_.centre);
    if (move.shift == 0.0 && move.turn == 0.0) return;
    RigFault fault = CameraMoved(was, cameras_[v], rig_.centre);
    fault.confidence = move_confidence_.at(v);
    fault.corrected = CorrectsMoves();
    report_.faults.push_back(std::move(fault));
  }

  std::vector<DepthView> Corrected() const {
    std::vector<DepthView> views = sampler_.views();
    if (!CorrectsMoves()) views = WithAllDepths(std::move(views), 1.0 / all_depths_);
    if (wrong_depths_ && !CorrectsMoves()) {
      views = WithDepths(std::move(views), wrong_depths_->view, 1.0 / wrong_depths_->factor);
    }
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (delay_[v] != 0 && options_.clocks == AuditAction::kCorrect) views[v] = DelayBy(views[v], delay_[v]);
      if (CorrectsMoves()) views[v].camera = cameras_[v];
    }
    return views;
  }

  const RigAuditOptions& options_;
  DepthRigSampler sampler_;
  std::vector<int> delay_;  ///< (V) clock offset in frames
  std::vector<Camera> cameras_;
  std::map<std::size_t, ClockOffsetOfView> clocks_;
  std::map<std::size_t, double> move_confidence_;  ///< of moved views
  ObservedRig rig_;
  std::vector<double> losses_;
  bool files_wrong_ = false;
  std::optional<WrongDepths> wrong_depths_;
  double all_depths_ = 1.0;  ///< common factor applied to all depths
  DepthRigReport report_;
};

}  // namespace

Expected<AuditedDepthRig> AuditDepthRig(const std::vector<DepthView>& views, const RigAuditOptions& options) {
  const bool off = options.clocks == AuditAction::kOff && options.moved == AuditAction::kOff &&
                   options.exchanged == AuditAction::kOff && options.unit == AuditAction::kOff;
  if (off || !CanSampleRig(views)) return AuditedDepthRig{views, {}};
  return DepthAuditor(views, options).Audit();
}

namespace {

constexpr double kRarelySeen = 0.5;  ///< share of the moments without a person, from which a finding is written

}  // namespace

bool DepthRigReport::IsAmbiguous() const {
  return std::any_of(faults.begin(), faults.end(), [](const RigFault& fault) {
    return mocurate::IsAmbiguous(fault) || (fault.code == kContradictingView && !fault.corrected);
  });
}

Expected<Clip> WithAuditedRig(const Clip& clip, const RigAuditOptions& options, DepthRigReport& report) {
  Expected<AuditedDepthRig> audited = AuditDepthRig(clip.evidence.depth_views, options);
  if (!audited) return Forward(audited);
  report = std::move(audited->report);
  Clip corrected = clip;
  corrected.evidence.depth_views = std::move(audited->views);
  return corrected;
}

std::vector<Finding> FindingsOf(const DepthRigReport& report) {
  std::vector<Finding> findings;
  for (const RigFault& fault : report.faults) findings.push_back(FindingOf(fault));
  for (std::size_t v = 0; v < report.without_person.size(); ++v) {
    if (report.without_person[v] < kRarelySeen) continue;
    findings.push_back(
        MakeFinding("camera_without_person", Severity::kWarning, report.without_person[v],
                    "depth camera " + report.cameras[v] + " shows no person in " +
                        RoundedText(100.0 * report.without_person[v], 3) +
                        " % of the frames in which other cameras show one; these frames are fitted without it",
                    FindingAction::kKept));
  }
  if (report.not_audited.empty()) return findings;
  findings.push_back(MakeFinding("rig_not_audited", Severity::kWarning, static_cast<double>(report.cameras.size()),
                                 report.not_audited + "; the rig is used as given", FindingAction::kKept));
  return findings;
}

}  // namespace mocurate
