#include "fitting/rig_of_takes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "fitting/audit/camera_moves.h"
#include "fitting/audit/rig_corrections.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/triangulation/keypoint_tracks.h"

namespace mocurate {
namespace {

constexpr double kBetweenTakes_s = 10.0;   ///< from the end of a take to the next; no person is tracked across it
constexpr double kSameCalibration = 1e-9;  ///< share; difference of two copies of a calibration (numerical)

/// Frames of a view as the entries of a view of more people.
void AppendFrames(const KeypointView& from, double later_s, std::size_t keypoints, KeypointView& to) {
  const auto row = 3 * keypoints;
  for (int f = 0; f < from.frames(); ++f) {
    to.time_s.push_back(from.time_s[static_cast<std::size_t>(f)] + later_s);
    const std::size_t of_frame = static_cast<std::size_t>(from.people) * row;
    const std::size_t first = std::min(static_cast<std::size_t>(f) * of_frame, from.values.size());
    const std::size_t given = std::min(from.values.size() - first, of_frame);
    to.values.insert(to.values.end(), from.values.begin() + static_cast<std::ptrdiff_t>(first),
                     from.values.begin() + static_cast<std::ptrdiff_t>(first + given));
    to.values.resize(to.time_s.size() * static_cast<std::size_t>(to.people) * row, 0.0);
  }
}

bool HaveSameCalibration(const Camera& a, const Camera& b) {
  const RigidTransform &one = a.camera_from_world, &other = b.camera_from_world;
  const LensDistortion &p = a.distortion, &q = b.distortion;
  const double numbers[][2] = {{a.fx, b.fx}, {a.fy, b.fy}, {a.cx, b.cx}, {a.cy, b.cy}, {p.k1, q.k1},
                               {p.k2, q.k2}, {p.p1, q.p1}, {p.p2, q.p2}, {p.k3, q.k3}};
  const bool same = std::all_of(std::begin(numbers), std::end(numbers), [](const auto& pair) {
    return std::abs(pair[0] - pair[1]) <= kSameCalibration * (1.0 + std::abs(pair[0]));
  });
  return same && a.width == b.width && a.height == b.height &&
         (one.translation - other.translation).norm() <= kSameCalibration * (1.0 + one.translation.norm()) &&
         one.rotation.coeffs().cwiseAbs().isApprox(other.rotation.coeffs().cwiseAbs(), kSameCalibration);
}

Error OtherRig(const std::string& what, const TakeOfRig& take) {
  return {ErrorCode::kInconsistent, what, take.name,
          "a file describes one rig: choose the takes of one rig and calibration with --clip"};
}

/// The views of a take in the order of the first take's cameras.
Expected<std::vector<const KeypointView*>> ViewsAs(const TakeOfRig& first, const TakeOfRig& take) {
  std::vector<const KeypointView*> views;
  const std::vector<KeypointView>& there = take.evidence.keypoint_views;
  if (take.evidence.keypoint_names != first.evidence.keypoint_names) {
    return tl::unexpected<Error>(OtherRig("the take has other keypoints than " + first.name, take));
  }
  for (const KeypointView& wanted : first.evidence.keypoint_views) {
    const auto found = std::find_if(there.begin(), there.end(),
                                    [&](const KeypointView& view) { return view.camera.name == wanted.camera.name; });
    if (found == there.end() || there.size() != first.evidence.keypoint_views.size()) {
      return tl::unexpected<Error>(OtherRig("the take has other cameras than " + first.name, take));
    }
    if (!HaveSameCalibration(found->camera, wanted.camera)) {
      return tl::unexpected<Error>(
          OtherRig("camera " + wanted.camera.name + " has another calibration than in " + first.name, take));
    }
    views.push_back(&*found);
  }
  return views;
}

/// All takes in sequence, as one.
Expected<Evidence> JoinedTakes(const std::vector<TakeOfRig>& takes, TakeStarts& starts) {
  Evidence joined;
  joined.keypoint_names = takes[0].evidence.keypoint_names;
  std::vector<std::vector<const KeypointView*>> views;
  for (const TakeOfRig& take : takes) {
    auto of_take = ViewsAs(takes[0], take);
    if (!of_take) return Forward(of_take);
    views.push_back(std::move(*of_take));
  }
  for (const KeypointView& view : takes[0].evidence.keypoint_views) {
    KeypointView whole;
    whole.camera = view.camera;
    joined.keypoint_views.push_back(std::move(whole));
  }
  for (const auto& of_take : views) {
    for (std::size_t v = 0; v < of_take.size(); ++v) {
      joined.keypoint_views[v].people = std::max(joined.keypoint_views[v].people, of_take[v]->people);
    }
  }
  double end_s = 0.0;
  for (std::size_t t = 0; t < views.size(); ++t) {
    double begin_s = std::numeric_limits<double>::infinity(), last_s = -begin_s;
    for (const KeypointView* view : views[t]) {
      if (view->time_s.empty()) continue;
      begin_s = std::min(begin_s, view->time_s.front());
      last_s = std::max(last_s, view->time_s.back());
    }
    if (last_s < begin_s) return tl::unexpected<Error>(OtherRig("no camera has a frame", takes[t]));
    const double later_s = t == 0 ? 0.0 : end_s + kBetweenTakes_s - begin_s;
    for (std::size_t v = 0; v < views[t].size(); ++v) {
      AppendFrames(*views[t][v], later_s, joined.keypoint_names.size(), joined.keypoint_views[v]);
    }
    starts.push_back(begin_s + later_s - 0.5 * kBetweenTakes_s);  // clocks of cameras may differ
    end_s = last_s + later_s;
  }
  return joined;
}

/// What the audit found about the cameras of a rig.
class AuditedCameras {
 public:
  AuditedCameras(const Evidence& evidence, const KeypointTracks& found)
      : views_(evidence.keypoint_views),
        report_(found.report),
        files_(JoinedCorrections(report_.files.applied, views_.size())),
        suspect_(views_.size(), false) {
    for (const std::size_t v : report_.rig.suspect) suspect_[v] = true;
    for (const RigHypotheses& hypotheses : report_.files.reported) {
      const RigHypothesis& first = hypotheses.alike[0];
      for (std::size_t v = 0; v < views_.size(); ++v) {
        suspect_[v] = suspect_[v] || first.Concerns(v);
      }
    }
    for (const RigFault& fault : report_.faults) {
      if (fault.code == "calibration_unit" && fault.corrected) unit_ = fault.value;
    }
    for (const Finding& finding : found.findings) audited_ = audited_ && finding.code != kRigNotAudited;
    audited_ = audited_ && views_.size() >= kLeastViewsAudited;
  }

  RigCamera Of(std::size_t v) const {
    RigCamera one;
    one.camera = views_[v].camera;
    one.camera.camera_from_world.translation /= unit_;
    if (report_.rig.model) one.clock_s = report_.rig.model->clock_s[v];
    const Camera given = one.camera;
    const Camera audited = report_.rig.model ? report_.rig.model->camera[v].back().camera : given;
    if (!HaveSamePose(given, audited)) {
      one.camera.camera_from_world = audited.camera_from_world;
      one.moved_m = (audited.Centre() - given.Centre()).norm();
      one.rotated_rad = audited.camera_from_world.rotation.angularDistance(given.camera_from_world.rotation);
    }
    const FileCorrection& file = files_[v];
    one.files_of = views_[file.source].camera.name;
    one.mirrored = file.mirrored;
    one.pixel_scale = file.pixel_scale;
    one.sides_exchanged = file.sides_exchanged != (report_.rig.model && report_.rig.model->sides_exchanged[v]);
    one.unit_scale = unit_;
    const bool in_parts = report_.rig.model && report_.rig.model->camera[v].size() > 1;
    const bool ambiguous = suspect_[v] || in_parts;
    const auto reported = [&](const RigFault& fault) { return IsOfCamera(fault, v) && !fault.corrected; };
    one.verdict = ambiguous                                                             ? RigVerdict::kAmbiguous
                  : Changed(one)                                                        ? RigVerdict::kCorrected
                  : std::any_of(report_.faults.begin(), report_.faults.end(), reported) ? RigVerdict::kReported
                  : audited_                                                            ? RigVerdict::kKept
                                                                                        : RigVerdict::kNotAudited;
    return one;
  }

  /// Whether the rig differs from its calibration and files in this camera.
  static bool Changed(const RigCamera& one) {
    return one.moved_m != 0.0 || one.rotated_rad != 0.0 || one.clock_s != 0.0 || one.files_of != one.camera.name ||
           one.mirrored || one.sides_exchanged || one.pixel_scale != 1.0 || one.unit_scale != 1.0;
  }

  /// Sets the lowest confidence of the faults of a camera that were corrected.
  void SetConfidenceInTake(std::size_t v, RigCamera& camera) const {
    const auto consider = [&](double confidence, ConfidenceOf of) {
      if (camera.confidence && *camera.confidence <= confidence) return;
      camera.confidence = confidence;
      camera.confidence_of = of;
    };
    for (const RigFault& fault : report_.faults) {
      const bool of_it = IsOfCamera(fault, v) || (fault.camera.empty() && unit_ != 1.0);
      if (of_it && fault.corrected) consider(fault.confidence, fault.confidence_of);
    }
    for (const RigHypotheses& hypotheses : report_.files.applied) {
      if (hypotheses.alike[0].Concerns(v)) consider(hypotheses.confidence, ConfidenceOf::kSpansOfOneTake);
    }
    if (camera.confidence || !suspect_[v]) return;
    for (const RigFault& fault : report_.faults) {
      if (fault.code == kContradictingView) consider(fault.confidence, fault.confidence_of);
    }
  }

  /// Mean gains of the takes by the corrections of a camera: one list per kind of correction.
  std::vector<std::vector<double>> Gains(std::size_t v, const TakeStarts& takes) const {
    std::vector<std::vector<double>> gains;
    const auto add = [&](const std::vector<std::optional<double>>& of_takes) {
      std::vector<double> known;
      for (const std::optional<double>& gain : of_takes) {
        if (gain) known.push_back(*gain);
      }
      if (!known.empty()) gains.push_back(std::move(known));
    };
    if (v < report_.rig.gain.size()) add(report_.rig.gain[v]);
    for (const RigHypotheses& found : report_.files.applied) {
      if (found.alike[0].Concerns(v)) add(GainOfTakes(takes, found.moment_s, found.given_costs, found.read_costs));
    }
    return gains;
  }

  std::size_t count() const { return views_.size(); }

 private:
  /// Whether a fault is of this camera, and not of a limb.
  bool IsOfCamera(const RigFault& fault, std::size_t v) const {
    return fault.limb.empty() && fault.camera == views_[v].camera.name;
  }

  const std::vector<KeypointView>& views_;
  const KeypointReport& report_;
  std::vector<FileCorrection> files_;
  std::vector<bool> suspect_;
  double unit_ = 1.0;
  bool audited_ = true;
};

/// Why clocks and poses were not audited; empty: they were.
std::string WhyNotAudited(const KeypointTracks& found) {
  for (const Finding& finding : found.findings) {
    if (finding.code == kRigNotAudited) return finding.message;
  }
  return {};
}

Finding AboutTakes(const std::string& clip, const std::string& code, double value, const std::string& message) {
  Finding finding = MakeFinding(code, Severity::kWarning, value, message);
  finding.clip = clip;
  return finding;
}

/// Sets verdict and confidence of a camera from the spread over takes. Returns the takes that its corrections make
/// worse.
std::size_t JudgeByTakes(const std::vector<std::vector<double>>& gains, RigCamera& camera) {
  std::size_t worse = 0;
  for (const std::vector<double>& of_takes : gains) {
    if (of_takes.size() < 2) continue;
    const double confidence = ConfidenceAboveZero(of_takes);
    camera.confidence = std::min(camera.confidence.value_or(1.0), confidence);
    const auto against = std::count_if(of_takes.begin(), of_takes.end(), [](double gain) { return gain < 0.0; });
    worse = std::max(worse, static_cast<std::size_t>(against));
  }
  if (worse > 0) camera.verdict = RigVerdict::kAmbiguous;
  return worse;
}

/// The verdicts of a take alone.
AuditedTake AuditAlone(const TakeOfRig& take, const Skeleton& skeleton, const KeypointFitOptions& options) {
  AuditedTake alone{take.name, take.sha256, {}, {}};
  const Expected<KeypointTracks> found = TriangulateKeypoints(take.evidence, skeleton, options);
  if (!found) {
    alone.not_audited = found.error().Message();
    return alone;
  }
  const AuditedCameras cameras(take.evidence, *found);
  for (std::size_t v = 0; v < cameras.count(); ++v) {
    const RigCamera camera = cameras.Of(v);
    alone.verdicts[camera.camera.name] = Name(camera.verdict);
  }
  alone.not_audited = WhyNotAudited(*found);
  return alone;
}

/// What the audit found and no verdict states: faults that are only reported, and those of ambiguous cameras.
void ReportFaults(const std::vector<RigFault>& faults, bool one_take, std::vector<Finding>& findings) {
  for (const RigFault& fault : faults) {
    const bool in_parts = fault.code == "camera_moved" && fault.frame_end > fault.frame_begin;
    if (!fault.limb.empty() || (fault.corrected && fault.code != kContradictingView && !in_parts)) continue;
    findings.push_back(FindingOf(fault));
    if (!one_take) findings.back().message = fault.message;  // the confidence is of moments of all takes
  }
}

std::map<std::string, std::string> ActionsOf(const KeypointAuditOptions& audit) {
  const auto name = [](AuditAction action) {
    return action == AuditAction::kOff ? "off" : action == AuditAction::kReport ? "report" : "correct";
  };
  return {{"clocks", name(audit.clocks)},
          {"moved", name(audit.moved)},
          {"exchanged", name(audit.exchanged)},
          {"unit", name(audit.unit)},
          {"sides", name(audit.sides)}};
}

}  // namespace

Expected<RigOfTakes> AuditTakes(const std::vector<TakeOfRig>& takes, const Skeleton& skeleton,
                                const KeypointFitOptions& options) {
  TakeStarts starts;
  const Expected<Evidence> joined = JoinedTakes(takes, starts);
  if (!joined) return Forward(joined);
  if (takes.size() == 1) starts.clear();
  const Expected<KeypointTracks> found = TriangulateKeypoints(*joined, skeleton, options, starts);
  if (!found) return Forward(found);
  RigOfTakes audited;
  audited.rig.audit = ActionsOf(options.audit);
  const std::string why_not = WhyNotAudited(*found);
  if (!why_not.empty()) audited.findings.push_back(AboutTakes("", kRigNotAudited, 0.0, why_not));
  ReportFaults(found->report.faults, takes.size() == 1, audited.findings);
  audited.rig.place_covariance = found->report.place_covariance;
  const AuditedCameras cameras(*joined, *found);
  for (std::size_t v = 0; v < cameras.count(); ++v) {
    RigCamera camera = cameras.Of(v);
    const bool changed = AuditedCameras::Changed(camera);
    camera.confidence_of = takes.size() > 1 ? ConfidenceOf::kTakes : ConfidenceOf::kSpansOfOneTake;
    const std::size_t worse = changed ? JudgeByTakes(cameras.Gains(v, starts), camera) : 0;
    if (changed && !camera.confidence) {  // a correction that only one take shows
      cameras.SetConfidenceInTake(v, camera);
    }
    if (worse > 0) {
      audited.findings.push_back(AboutTakes("", "takes_disagree", static_cast<double>(worse),
                                            "the correction of camera " + camera.camera.name + " makes " +
                                                Counted(static_cast<long long>(worse), "take") + " of " +
                                                std::to_string(takes.size()) +
                                                " worse: audit takes before and after a move of the camera separately, "
                                                "with --clip"));
    }
    audited.rig.cameras.push_back(std::move(camera));
  }
  const auto not_audited = [](const RigCamera& camera) { return camera.verdict == RigVerdict::kNotAudited; };
  if (std::all_of(audited.rig.cameras.begin(), audited.rig.cameras.end(), not_audited)) {
    return Fail(ErrorCode::kInconsistent,
                why_not.empty()
                    ? "a rig of " + Counted(static_cast<long long>(cameras.count()), "camera") +
                          " cannot be audited, at least " + std::to_string(kLeastViewsAudited) + " are needed"
                    : why_not,
                takes[0].name, "audit longer takes of people who move, or several takes together");
  }
  for (const TakeOfRig& take : takes) {
    AuditedTake alone = AuditAlone(take, skeleton, options);
    if (!alone.not_audited.empty()) {
      audited.findings.push_back(
          AboutTakes(take.name, "take_not_audited", 0.0,
                     "the take alone is not audited: " + alone.not_audited + "; it counts with the others"));
    }
    audited.rig.takes.push_back(std::move(alone));
  }
  return audited;
}

}  // namespace mocurate
