#include "fitting/audit/rig_corrections.h"

#include <algorithm>
#include <utility>

#include "core/base/text.h"
#include "fitting/audit/rig_hypotheses.h"

namespace mocurate {
namespace {

constexpr const char* kAuditThisRig =
    "name the rig of these cameras in fitting.keypoints.rig, or audit them: mocurate rig audit CONFIG -o rig.yaml";

const RigCamera* CameraOfRig(const RigFile& rig, const std::string& name) {
  const auto found = std::find_if(rig.cameras.begin(), rig.cameras.end(),
                                  [&](const RigCamera& one) { return one.camera.name == name; });
  return found == rig.cameras.end() ? nullptr : &*found;
}

std::string CameraNames(const RigFile& rig) {
  std::string names;
  for (const RigCamera& one : rig.cameras) names += (names.empty() ? "" : ", ") + one.camera.name;
  return names;
}

/// The view of a camera's name; none: the evidence lacks it.
std::optional<std::size_t> ViewNamed(const std::vector<KeypointView>& views, const std::string& name) {
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (views[v].camera.name == name) return v;
  }
  return {};
}

std::string SizeText(const Camera& camera) {
  return std::to_string(camera.width) + " x " + std::to_string(camera.height) + " px";
}

/// Whether the image sizes differ, where both are known.
bool HasOtherSize(const Camera& a, const Camera& b) {
  const bool known = a.width > 0 && a.height > 0 && b.width > 0 && b.height > 0;
  return known && (a.width != b.width || a.height != b.height);
}

}  // namespace

std::vector<FileCorrection> JoinedCorrections(const std::vector<RigHypotheses>& applied, std::size_t views) {
  std::vector<FileCorrection> joined(views);
  for (std::size_t v = 0; v < views; ++v) joined[v].source = v;
  for (const RigHypotheses& one : applied) {
    const RigHypothesis& hypothesis = one.alike[0];
    const std::vector<FileCorrection> before = joined;
    for (std::size_t v = 0; v < views; ++v) joined[v] = before[hypothesis.source[v]];
    for (const std::size_t v : hypothesis.views) {
      joined[v].mirrored = joined[v].mirrored != hypothesis.mirrored;
      joined[v].sides_exchanged = joined[v].sides_exchanged != hypothesis.sides;
      joined[v].pixel_scale *= hypothesis.factor;
    }
  }
  return joined;
}

Status CheckRigFits(const Evidence& evidence, const RigFile& rig) {
  for (const KeypointView& view : evidence.keypoint_views) {
    const Camera& camera = view.camera;
    const RigCamera* of_rig = CameraOfRig(rig, camera.name);
    if (of_rig == nullptr) {
      return Fail(ErrorCode::kInconsistent,
                  "the take has camera '" + camera.name + "', the audited rig has " + CameraNames(rig),
                  rig.cameras.empty() ? "" : rig.cameras[0].place, kAuditThisRig);
    }
    if (HasOtherSize(camera, of_rig->camera)) {
      return Fail(ErrorCode::kInconsistent,
                  "images of camera '" + camera.name + "' are " + SizeText(camera) + ", in the audited rig " +
                      SizeText(of_rig->camera),
                  of_rig->place, kAuditThisRig);
    }
    if (!ViewNamed(evidence.keypoint_views, of_rig->files_of)) {
      return Fail(ErrorCode::kInconsistent,
                  "the keypoints of camera '" + camera.name + "' are in the files of camera '" + of_rig->files_of +
                      "', which the take lacks",
                  of_rig->place, kAuditThisRig);
    }
  }
  return {};
}

Expected<Evidence> WithRig(Evidence evidence, const RigFile& rig) {
  if (Status fits = CheckRigFits(evidence, rig); !fits) return Forward(fits);
  std::vector<KeypointView>& views = evidence.keypoint_views;
  RigHypothesis exchange;
  for (const KeypointView& view : views) {
    exchange.source.push_back(*ViewNamed(views, CameraOfRig(rig, view.camera.name)->files_of));
  }
  views = WithHypothesis(views, evidence.keypoint_names, exchange);
  for (std::size_t v = 0; v < views.size(); ++v) {
    const RigCamera& of_rig = *CameraOfRig(rig, views[v].camera.name);
    RigHypothesis change = RigHypothesis::AsGiven(views.size());
    change.views = {v};
    change.mirrored = of_rig.mirrored;
    change.sides = of_rig.sides_exchanged;
    change.factor = of_rig.pixel_scale;
    views[v].camera = of_rig.camera;
    if (of_rig.mirrored || of_rig.sides_exchanged || of_rig.pixel_scale != 1.0)
      views = WithHypothesis(views, evidence.keypoint_names, change);
    for (double& time : views[v].time_s) time += of_rig.clock_s;
  }
  return evidence;
}

Expected<Evidence> WithRigOf(Evidence evidence, const KeypointFitOptions& options) {
  if (options.rig.empty()) return evidence;
  const Expected<RigFile> rig = ReadRigFile(options.rig);
  if (!rig) return Forward(rig);
  return WithRig(std::move(evidence), *rig);
}

KeypointFitOptions ForAuditOfRig(KeypointFitOptions options) {
  if (options.rig.empty()) return options;
  KeypointAuditOptions& audit = options.audit;
  for (AuditAction* action : {&audit.clocks, &audit.moved, &audit.exchanged, &audit.unit, &audit.sides}) {
    if (*action == AuditAction::kCorrect) *action = AuditAction::kReport;
  }
  return options;
}

}  // namespace mocurate
