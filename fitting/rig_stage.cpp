#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/pi.h"
#include "core/store/store.h"
#include "fitting/rig_of_takes.h"
#include "fitting/stages.h"

namespace mocurate {
namespace {

/// Whether two clips are of one recording: of several people before the same views.
bool ShareViews(const Evidence& a, const Evidence& b) {
  const auto same = [](const KeypointView& one, const KeypointView& other) {
    return one.camera.name == other.camera.name && one.time_s == other.time_s && one.values == other.values;
  };
  return a.keypoint_views.size() == b.keypoint_views.size() &&
         std::equal(a.keypoint_views.begin(), a.keypoint_views.end(), b.keypoint_views.begin(), same);
}

nlohmann::json RigSummary(const RigOfTakes& audited) {
  nlohmann::json cameras = nlohmann::json::object();
  for (const RigCamera& camera : audited.rig.cameras) {
    cameras[camera.camera.name] = {{"verdict", Name(camera.verdict)},
                                   {"confidence", nullptr},
                                   {"confidence_of", Name(camera.confidence_of)},
                                   {"moved_mm", std::round(1e4 * camera.moved_m) / 10.0},
                                   {"rotated_deg", std::round(1e3 * kDegrees * camera.rotated_rad) / 1e3},
                                   {"clock_ms", std::round(1e4 * camera.clock_s) / 10.0},
                                   {"files_of", camera.files_of},
                                   {"mirrored", camera.mirrored},
                                   {"sides_exchanged", camera.sides_exchanged},
                                   {"pixel_scale", camera.pixel_scale},
                                   {"unit_scale", camera.unit_scale}};
    if (camera.confidence) cameras[camera.camera.name]["confidence"] = RoundedConfidence(*camera.confidence);
  }
  nlohmann::json takes = nlohmann::json::array();
  for (const AuditedTake& take : audited.rig.takes) {
    takes.push_back({{"name", take.name}, {"sha256", take.sha256}, {"verdicts", take.verdicts}});
  }
  return {{"cameras", cameras}, {"takes", takes}, {"audit", audited.rig.audit}};
}

}  // namespace

Expected<StageOutcome> RigStage(const StageRequest& request) {
  const Expected<RigStageOptions> options = OptionsFromJson<RigStageOptions>(request.options, "rig");
  if (!options) return Forward(options);
  const Expected<SkeletonPtr> skeleton = LoadSkeleton(options->skeleton);
  if (!skeleton) return Forward(skeleton);
  std::vector<TakeOfRig> takes;
  for (const StageInput& input : request.inputs) {
    if (input.role != "evidence") continue;
    Expected<Clip> clip = ReadEvidence(input.path);
    if (!clip) return Forward(clip);
    if (clip->evidence.keypoint_views.empty()) {
      return Fail(ErrorCode::kInconsistent, "the clip has no keypoints of calibrated views", clip->id(),
                  "only rigs of keypoint cameras are audited: choose clips with --clip");
    }
    clip->evidence.subject = 0;
    const auto known = std::any_of(takes.begin(), takes.end(),
                                   [&](const TakeOfRig& take) { return ShareViews(take.evidence, clip->evidence); });
    if (known) continue;
    takes.push_back(
        {clip->id(), clip->evidence_sha256.empty() ? input.sha256 : clip->evidence_sha256, std::move(clip->evidence)});
  }
  if (takes.empty()) return Fail(ErrorCode::kInternal, "the audit of a rig got no evidence", request.item);
  std::sort(takes.begin(), takes.end(), [](const TakeOfRig& a, const TakeOfRig& b) { return a.name < b.name; });
  Expected<RigOfTakes> audited = AuditTakes(takes, **skeleton, options->keypoints);
  if (!audited) return Forward(audited);
  audited->rig.config = options->config;
  if (Status written = WriteFile(request.output, RigText(audited->rig)); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = RigSummary(*audited);
  outcome.findings = audited->findings;
  return outcome;
}

}  // namespace mocurate
