#include <map>
#include <optional>

#include "core/base/file.h"
#include "core/motion/operations.h"
#include "core/store/store.h"
#include "eval/metrics/fit_error.h"
#include "eval/stages.h"

namespace mocurate {
namespace {

struct Inputs {
  std::map<std::string, Motion> truth;
  std::map<std::string, Clip> fits;      ///< by clip id
  std::map<std::string, Clip> evidence;  ///< by clip id
};

Expected<Inputs> ReadInputs(const StageRequest& request) {
  Inputs inputs;
  for (const StageInput& input : request.inputs) {
    if (input.role == "truth") {
      auto truth = ReadTruth(input.path);
      if (!truth) return Forward(truth);
      inputs.truth.merge(truth->motion);
    } else if (input.role == "fit") {
      auto dataset = ReadDataset(input.path);
      if (!dataset) return Forward(dataset);
      for (Clip& clip : dataset->clips) inputs.fits.emplace(clip.id(), std::move(clip));
    } else if (input.role == "evidence") {
      auto clip = ReadEvidence(input.path);
      if (!clip) return Forward(clip);
      const std::string id = clip->id();
      inputs.evidence.emplace(id, std::move(*clip));
    }
  }
  return inputs;
}

/// The truth of a fitted clip: of the same id, or of the recording whose unobserved ends were cut.
std::optional<Motion> TruthOf(const Clip& fitted, const std::map<std::string, Motion>& truth) {
  const std::string id = fitted.id();
  if (const auto same = truth.find(id); same != truth.end()) return same->second;
  const std::string recording = id.substr(0, id.rfind('#') + 1);
  const auto whole = truth.lower_bound(recording);
  if (whole == truth.end() || whole->first.compare(0, recording.size(), recording) != 0) return std::nullopt;
  Clip of_truth;
  of_truth.motion = whole->second;
  const Expected<Clip> cut = Cut(of_truth, fitted.identity.begin_frame, fitted.identity.end_frame);
  return cut ? cut->motion : std::nullopt;
}

nlohmann::json FitErrorJson(const FitError& error) {
  nlohmann::json json = {{"joint_mm", error.joint_mm},
                         {"evidence_mm", error.evidence_mm},
                         {"rotation_deg", error.rotation_deg},
                         {"bone_direction_deg", error.bone_direction_deg},
                         {"frames", error.frames}};
  if (error.coverage.components > 0) {
    json["within_one_sigma"] = error.coverage.within_one_sigma();
    json["within_two_sigma"] = error.coverage.within_two_sigma();
    json["within_quarters_of_sigma"] = error.coverage.within;
  }
  return json;
}

/// Shares over all components of both.
void AddClipCoverage(const Coverage& clip, Coverage& total) {
  const std::int64_t components = total.components + clip.components;
  if (clip.components == 0) return;
  const double share = static_cast<double>(clip.components) / static_cast<double>(components);
  for (std::size_t i = 0; i < total.within.size(); ++i) total.within[i] += share * (clip.within[i] - total.within[i]);
  total.components = components;
}

}  // namespace

Expected<StageOutcome> FitErrorStage(const StageRequest& request) {
  const auto inputs = ReadInputs(request);
  if (!inputs) return Forward(inputs);
  nlohmann::json per_clip = nlohmann::json::object();
  FitError total;
  std::optional<Error> first_error;
  for (const auto& [id, fitted] : inputs->fits) {
    const std::optional<Motion> truth = TruthOf(fitted, inputs->truth);
    if (!truth) continue;
    const auto evidence = inputs->evidence.find(id);
    const auto error =
        CompareWithTruth(fitted, evidence == inputs->evidence.end() ? Evidence() : evidence->second.evidence, *truth);
    if (!error) {
      per_clip[id] = {{"error", error.error().Message()}};
      if (!first_error) first_error = error.error();
      continue;
    }
    per_clip[id] = FitErrorJson(*error);
    AddClipCoverage(error->coverage, total.coverage);
    total.frames += error->frames;
    total.joint_mm += error->joint_mm * error->frames;
    total.evidence_mm += error->evidence_mm * error->frames;
    total.rotation_deg += error->rotation_deg * error->frames;
    total.bone_direction_deg += error->bone_direction_deg * error->frames;
  }
  if (total.frames == 0 && first_error) return tl::unexpected<Error>(*first_error);
  if (total.frames == 0) {
    return Fail(ErrorCode::kInconsistent, "no fitted clip has a truth of its id", "fit_error",
                "use the truth of the same capture");
  }
  for (double* sum : {&total.joint_mm, &total.evidence_mm, &total.rotation_deg, &total.bone_direction_deg}) {
    *sum /= total.frames;
  }
  StageOutcome outcome;
  outcome.summary = FitErrorJson(total);
  outcome.summary["clips"] = per_clip.size();
  nlohmann::json artifact = outcome.summary;
  artifact["per_clip"] = std::move(per_clip);
  if (Status written = WriteFile(request.output, artifact.dump(1)); !written) return Forward(written);
  return outcome;
}

}  // namespace mocurate
