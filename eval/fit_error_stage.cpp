#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/store/store.h"
#include "core/store/truth_motions.h"
#include "eval/metrics/fit_error.h"
#include "eval/stages.h"

namespace mocurate {
namespace {

struct Inputs {
  TruthMotions truth;
  std::map<std::string, Clip> fits;      ///< by clip id
  std::map<std::string, Clip> evidence;  ///< by clip id
};

Expected<Inputs> ReadInputs(const StageRequest& request) {
  Inputs inputs;
  for (const StageInput& input : request.inputs) {
    if (input.role == "truth") {
      if (Status added = inputs.truth.Add(input.path); !added) return Forward(added);
    } else if (input.role == "fit") {
      auto dataset = ReadDataset(input.path);
      if (!dataset) return Forward(dataset);
      for (Clip& clip : dataset->clips) {
        UndoCanonical(clip);
        inputs.fits.emplace(clip.id(), std::move(clip));
      }
    } else if (input.role == "evidence") {
      auto clip = ReadEvidence(input.path);
      if (!clip) return Forward(clip);
      UndoCanonical(*clip);
      const std::string id = clip->id();
      inputs.evidence.emplace(id, std::move(*clip));
    }
  }
  return inputs;
}

/// "joint_tracks", "keypoints", "depth_views", "point_clouds", joined by "+"; "motion" without any of them.
std::string KindOf(const Evidence& evidence) {
  std::string kind;
  for (const auto& [there, name] : {std::pair(evidence.tracks.has_value(), "joint_tracks"),
                                    {!evidence.keypoint_views.empty(), "keypoints"},
                                    {!evidence.depth_views.empty(), "depth_views"},
                                    {evidence.clouds.has_value(), "point_clouds"}}) {
    if (there) kind += (kind.empty() ? "" : "+") + std::string(name);
  }
  return kind.empty() ? "motion" : kind;
}

/// Why clips count in no measure of uncertainty: code and text.
constexpr std::tuple<NotMeasured, const char*, const char*> kReasons[] = {
    {NotMeasured::kNoPositionCov, "no_position_cov", "no position_cov, so their positions are not measured"},
    {NotMeasured::kNoRotationSigma, "no_rotation_sigma",
     "no rotation_sigma or rotation_observed, so their rotations are not measured"},
    {NotMeasured::kNoTrueRotations, "no_true_rotations",
     "the truth has no rotations, so those of the fits are not measured"},
    {NotMeasured::kOtherRestPose, "other_rest_pose",
     "fit and truth have other joints or another rest pose, so rotations are not measured; fit the truth's skeleton"}};

nlohmann::json OrNull(const std::optional<double>& value) { return value ? nlohmann::json(*value) : nlohmann::json(); }

nlohmann::json MeasuresJson(const SigmaSamples& samples) {
  return {{"samples", samples.pairs.size()},
          {"within_one_sigma", OrNull(samples.calibration.within_one_sigma())},
          {"within_two_sigma", OrNull(samples.calibration.within_two_sigma())},
          {"ece", OrNull(samples.calibration.ece())},
          {"spearman", OrNull(SpearmanOf(samples.pairs))}};
}

void AddCurve(const std::string& prefix, const std::optional<RiskCoverage>& curve, nlohmann::json& measures) {
  measures[prefix + "risk_coverage_mm"] = curve ? nlohmann::json(curve->risk) : nlohmann::json();
  measures[prefix + "aurc_mm"] = curve ? nlohmann::json(curve->area) : nlohmann::json();
}

nlohmann::json GroupsJson(const SigmaByPart& sigma) {
  nlohmann::json groups = nlohmann::json::object();
  for (std::size_t g = 0; g < SigmaByPart::kGroups.size(); ++g) {
    const FitSamples group = sigma.Group(g);
    nlohmann::json positions = MeasuresJson(group.positions);
    AddCurve("", RiskCoverageOf(group.positions.pairs), positions);
    AddCurve("ideal_", IdealRiskCoverageOf(group.positions.pairs), positions);
    positions["auc"] = OrNull(RocAucOf(group.positions.pairs, kLargeErrorMm));
    groups[SigmaByPart::kGroups[g]] = {{"positions", std::move(positions)},
                                       {"rotations", MeasuresJson(group.rotations)}};
  }
  return groups;
}

nlohmann::json WarningsJson(const std::map<NotMeasured, long long>& clips) {
  nlohmann::json warnings = nlohmann::json::array();
  for (const auto& [reason, code, text] : kReasons) {
    const auto found = clips.find(reason);
    if (found == clips.end()) continue;
    const long long count = found->second;
    warnings.push_back({{"code", code}, {"clips", count}, {"message", Counted(count, "clip") + ": " + text}});
  }
  return warnings;
}

nlohmann::json FitErrorJson(const FitError& error) {
  nlohmann::json json = {{"joint_mm", error.joint_mm},
                         {"evidence_mm", error.evidence_mm},
                         {"rotation_deg", error.rotation_deg},
                         {"bone_direction_deg", error.bone_direction_deg},
                         {"frames", error.frames},
                         {"joints_mm", error.joints_mm}};
  const Calibration positions = error.sigma.All().positions.calibration;
  if (positions.components == 0) return json;
  json["within_one_sigma"] = *positions.within_one_sigma();
  json["within_two_sigma"] = *positions.within_two_sigma();
  for (const std::int64_t within : positions.within_quarters) {
    json["within_quarters_of_sigma"].push_back(static_cast<double>(within) / static_cast<double>(positions.components));
  }
  return json;
}

}  // namespace

Expected<StageOutcome> FitErrorStage(const StageRequest& request) {
  const auto inputs = ReadInputs(request);
  if (!inputs) return Forward(inputs);
  nlohmann::json per_clip = nlohmann::json::object(), without_truth = nlohmann::json::array();
  FitError total;
  std::map<std::string, SigmaByPart> by_kind;
  std::map<std::string, std::pair<double, int>> joints;        // sum over frames, frames
  std::map<std::string, std::tuple<double, int, int>> labels;  // and clips
  std::map<NotMeasured, long long> not_measured;
  std::optional<Error> first_error;
  const Evidence none;
  for (const auto& [id, fitted] : inputs->fits) {
    const std::optional<Motion> truth = inputs->truth.Of(fitted);
    if (!truth) {
      without_truth.push_back(id);
      continue;
    }
    const auto found = inputs->evidence.find(id);
    const Evidence& evidence = found == inputs->evidence.end() ? none : found->second.evidence;
    const auto error = CompareWithTruth(fitted, evidence, *truth);
    if (!error) {
      per_clip[id] = {{"error", error.error().Message()}};
      if (!first_error) first_error = error.error();
      continue;
    }
    per_clip[id] = FitErrorJson(*error);
    by_kind[KindOf(evidence)].Append(error->sigma);
    for (const auto& reason : {error->no_positions, error->no_rotations}) {
      if (reason) ++not_measured[*reason];
    }
    for (const auto& [joint, mm] : error->joints_mm) {
      joints[joint].first += mm * error->frames;
      joints[joint].second += error->frames;
    }
    auto& [label_mm, label_frames, label_clips] = labels[fitted.label];
    label_mm += error->joint_mm * error->frames;
    label_frames += error->frames;
    ++label_clips;
    total.frames += error->frames;
    total.joint_mm += error->joint_mm * error->frames;
    total.evidence_mm += error->evidence_mm * error->frames;
    total.rotation_deg += error->rotation_deg * error->frames;
    total.bone_direction_deg += error->bone_direction_deg * error->frames;
  }
  if (total.frames == 0 && first_error) return tl::unexpected<Error>(*first_error);
  if (total.frames == 0) {
    return Fail(ErrorCode::kInconsistent,
                "no fitted clip has a truth of its id: the first fit is " +
                    (inputs->fits.empty() ? "none" : "'" + inputs->fits.begin()->first + "'") + ", the first truth " +
                    inputs->truth.FirstId(),
                "fit_error", "use the truth of the same capture");
  }
  for (double* sum : {&total.joint_mm, &total.evidence_mm, &total.rotation_deg, &total.bone_direction_deg}) {
    *sum /= total.frames;
  }
  for (const auto& [joint, sum] : joints) total.joints_mm[joint] = sum.first / sum.second;
  nlohmann::json by_label = nlohmann::json::object();
  for (const auto& [label, sum] : labels) {
    by_label[label] = {{"joint_mm", std::get<0>(sum) / std::get<1>(sum)}, {"clips", std::get<2>(sum)}};
  }
  nlohmann::json by_evidence = nlohmann::json::object();
  for (const auto& [kind, sigma] : by_kind) {
    total.sigma.Append(sigma);
    if (by_kind.size() > 1) by_evidence[kind] = GroupsJson(sigma);
  }
  StageOutcome outcome;
  outcome.summary = FitErrorJson(total);
  outcome.summary["clips"] = per_clip.size();
  outcome.summary["labels"] = std::move(by_label);
  outcome.summary["sigma"] = {{"large_error_mm", kLargeErrorMm},
                              {"groups", GroupsJson(total.sigma)},
                              {"by_evidence", std::move(by_evidence)},
                              {"warnings", WarningsJson(not_measured)}};
  nlohmann::json artifact = outcome.summary;
  artifact["per_clip"] = std::move(per_clip);
  artifact["without_truth"] = std::move(without_truth);
  if (Status written = WriteFile(request.output, artifact.dump(1)); !written) return Forward(written);
  return outcome;
}

}  // namespace mocurate
