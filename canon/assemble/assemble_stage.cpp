#include <algorithm>
#include <cmath>
#include <map>

#include "canon/options.h"
#include "canon/recipes/classes.h"
#include "canon/review/review.h"
#include "canon/splits/splits.h"
#include "canon/stage_parts.h"
#include "canon/stages.h"
#include "core/base/file.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"

namespace mocurate {
namespace {

/// Whether two skeletons are the same but for their rest offsets.
bool SameButRest(const Skeleton& a, const Skeleton& b) {
  const auto same_limits = [](const Joint& x, const Joint& y) {
    if (!x.limits || !y.limits) return x.limits.has_value() == y.limits.has_value();
    return x.limits->min == y.limits->min && x.limits->max == y.limits->max;
  };
  const bool same_lie = a.lie.has_value() == b.lie.has_value() &&
                        (!a.lie || (a.lie->chains == b.lie->chains && a.lie->raw_offsets == b.lie->raw_offsets));
  return a.name == b.name && same_lie && SameTree(a, b) &&
         std::equal(
             a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(), [&](const Joint& x, const Joint& y) {
               return x.mirror == y.mirror && x.radius == y.radius && x.landmark == y.landmark && same_limits(x, y);
             });
}

/// A clip that cannot stand in one dataset with the others.
Finding OtherSkeleton(const Clip& clip, double apart, const std::string& message) {
  Finding finding;
  finding.clip = clip.id();
  finding.code = "other_skeleton";
  finding.severity = Severity::kError;
  finding.value = apart;
  finding.message = message;
  finding.action = "left out of the dataset";
  return finding;
}

/// One skeleton for all clips: the one that most have their rotations counted from (of equally many, the first by clip
/// id); where these have directions of their own, the built-in one of that name, if it has that tree. Where a person's
/// bones point is the person's, like their lengths. A clip whose rotations are counted from another rest pose is left
/// out with a finding: a BVH file in an A-pose among T-poses.
void UniteSkeletons(Dataset& dataset, std::vector<Finding>& findings) {
  std::vector<std::pair<SkeletonPtr, int>> kinds;
  for (const Clip& clip : dataset.clips) {
    const SkeletonPtr& rest_pose = clip.motion->rest_pose();
    const auto known = std::find_if(kinds.begin(), kinds.end(), [&](const auto& kind) {
      return SameTree(*kind.first, *rest_pose) &&
             (clip.motion->joints_only() || RestPosesApart(*kind.first, *rest_pose) <= kSameRestPose);
    });
    if (known != kinds.end()) {
      ++known->second;
    } else {
      kinds.emplace_back(rest_pose, 1);
    }
  }
  dataset.skeleton = std::max_element(kinds.begin(), kinds.end(), [](const auto& a, const auto& b) {
                       return a.second < b.second;
                     })->first;
  const bool one_rest = std::all_of(dataset.clips.begin(), dataset.clips.end(), [&](const Clip& clip) {
    return SameRestOffsets(*clip.motion->rest_pose(), *dataset.skeleton);
  });
  const bool is_name = dataset.skeleton->name.find_first_of("/.") == std::string::npos;  // of no file
  if (const auto built_in = one_rest || !is_name ? Expected<SkeletonPtr>() : LoadSkeleton(dataset.skeleton->name);
      built_in && *built_in && SameButRest(**built_in, *dataset.skeleton) &&
      RestPosesApart(**built_in, *dataset.skeleton) <= kSameRestPose) {
    dataset.skeleton = *built_in;
  }
  std::vector<Clip> kept;
  for (Clip& clip : dataset.clips) {
    Motion& motion = *clip.motion;
    if (!SameTree(*dataset.skeleton, *motion.skeleton)) {
      findings.push_back(OtherSkeleton(
          clip, 0.0, "its joints differ from those of most clips, skeleton '" + dataset.skeleton->name + "'"));
      continue;
    }
    const double apart = motion.joints_only() ? 0.0 : RestPosesApart(*dataset.skeleton, *motion.rest_pose());
    if (apart > kSameRestPose) {
      findings.push_back(
          OtherSkeleton(clip, apart,
                        "its rotations are counted from another rest pose than those of most clips: a bone points " +
                            FormatDouble(std::round(apart * 1800.0 / kPi) / 10.0) + " degrees elsewhere"));
      continue;
    }
    const bool shared = motion.joints_only() || SameRestOffsets(*motion.skeleton, *dataset.skeleton);
    motion.skeleton = shared ? dataset.skeleton : WithRestOffsetsOf(*dataset.skeleton, *motion.skeleton);
    motion.counted_from = shared ? nullptr : dataset.skeleton;
    kept.push_back(std::move(clip));
  }
  dataset.clips = std::move(kept);
}

/// By item: whether nothing of it is kept, which findings say why clips of it are excluded, and the way out.
nlohmann::json LeftOutOfSet(const std::map<std::string, std::string>& item_of, const std::vector<Clip>& kept,
                            const std::vector<Finding>& findings) {
  nlohmann::json items = nlohmann::json::object();
  for (std::size_t i = 0; i < findings.size(); ++i) {
    nlohmann::json& item = items[item_of.at(findings[i].clip)];
    item["whole"] = true;
    item["findings"].push_back(i);
    if (findings[i].code == kLabelNotListed) {
      item["hint"] = "add the label to assemble.classes";
    } else if (findings[i].code == kReviewDrop) {
      item["hint"] = "take the decision out of canon.review";
    } else {
      if (findings[i].value > 0.0) item["threshold"] = kSameRestPose;
      item["hint"] =
          "export it in the rest pose of the others, or fit one skeleton to the joints of all: "
          "fitting.method joint_tracks";
    }
  }
  for (const Clip& clip : kept) {
    if (const auto item = items.find(item_of.at(clip.id())); item != items.end()) (*item)["whole"] = false;
  }
  return items;
}

void FindMixedRates(const Dataset& dataset, std::vector<Finding>& findings) {
  std::map<double, int> rates;
  for (const Clip& clip : dataset.clips) ++rates[clip.rate.hz()];
  if (rates.size() < 2) return;
  Finding finding;
  finding.code = "mixed_rates";
  finding.value = static_cast<double>(rates.size());
  finding.message = "clips of";
  for (const auto& [rate, count] : rates) {
    finding.message += " " + RoundedText(rate, 6) + " Hz (" + std::to_string(count) + ")";
  }
  finding.message += " stand together: windows of equal frames last differently; canon.rate brings them to one";
  finding.action = "flagged";
  findings.push_back(finding);
}

/// What was found about clips as a set, before they came here: a JSON list.
Status ReadFindings(const StageInput& input, std::vector<Finding>& findings) {
  const auto text = ReadFile(input.path);
  if (!text) return Forward(text);
  try {
    for (const nlohmann::json& finding : nlohmann::json::parse(*text)) findings.push_back(finding.get<Finding>());
  } catch (const nlohmann::json::exception& problem) {
    return Fail(ErrorCode::kMalformed, std::string("no list of findings: ") + problem.what(), input.name);
  }
  return {};
}

/// Carries a review out, if `by_id` whatever the motions are. `excluding` gets the findings about clips that it drops;
/// the others are given back.
Expected<std::vector<Finding>> TakeReview(const std::filesystem::path& file, bool by_id, Dataset& dataset,
                                          std::map<std::string, std::string>& item_of,
                                          std::vector<Finding>& excluding) {
  auto review = ReadReview(file);
  if (!review) return Forward(review);
  for (Decision& decision : review->decisions) {
    if (by_id) decision.content.clear();
  }
  auto applied = ApplyReview(*review, dataset);
  if (!applied) return Forward(applied);
  if (dataset.clips.empty()) {
    return Fail(ErrorCode::kConfig, "every clip is dropped by the review", DisplayPath(file), "keep some");
  }
  for (const auto& [old_id, new_id] : applied->new_ids) item_of[new_id] = item_of[old_id];
  std::vector<Finding> others;
  for (Finding& finding : applied->findings) {
    (finding.code == kReviewDrop ? excluding : others).push_back(std::move(finding));
  }
  return others;
}

}  // namespace

Expected<StageOutcome> AssembleStage(const StageRequest& request) {
  const auto options = OptionsFromJson<AssembleOptions>(request.options, "assemble");
  if (!options) return Forward(options);
  if (Status classes = CheckClasses(*options); !classes) return Forward(classes);
  Dataset dataset;
  dataset.created_by = CreatedBy();
  dataset.recipe = options->recipe;
  std::vector<Finding> noted;
  std::map<std::string, std::string> item_of;  // of each clip
  for (const StageInput& input : request.inputs) {
    if (input.role == "findings") {
      if (Status read = ReadFindings(input, noted); !read) return Forward(read);
      continue;
    }
    if (input.role == kReviewRole || input.role == kReviewByIdRole) continue;
    auto part = ReadDataset(input.path);
    if (!part) return Forward(part);
    if (dataset.clips.empty()) dataset.joints_only = part->joints_only;
    if (part->joints_only != dataset.joints_only) {
      return Fail(ErrorCode::kInconsistent,
                  part->joints_only ? "holds joints only where the others have rotations"
                                    : "holds rotations where the others have joints only",
                  input.name, "one dataset holds either");
    }
    for (Clip& clip : part->clips) {
      item_of[clip.id()] = input.name;
      dataset.clips.push_back(std::move(clip));
    }
    dataset.findings.insert(dataset.findings.end(), part->findings.begin(), part->findings.end());
  }
  dataset.findings.insert(dataset.findings.end(), noted.begin(), noted.end());
  if (dataset.clips.empty()) {
    return Fail(ErrorCode::kInconsistent, "no clip is left to assemble", "assemble",
                "curation_log.jsonl says why each was dropped");
  }
  SortById(dataset.clips);
  StageOutcome outcome;
  UniteSkeletons(dataset, outcome.findings);
  ApplyClasses(*options, dataset, outcome.findings);
  if (dataset.clips.empty()) {
    return Fail(ErrorCode::kInconsistent, "no clip is of a listed class; " + outcome.findings.back().message,
                "assemble.classes", "list the labels that the source declares");
  }
  std::vector<Finding> reviewed;
  const StageInput* by_id = FindInput(request, kReviewByIdRole);
  if (const StageInput* review = by_id != nullptr ? by_id : FindInput(request, kReviewRole)) {
    auto findings = TakeReview(review->path, by_id != nullptr, dataset, item_of, outcome.findings);
    if (!findings) return Forward(findings);
    reviewed = std::move(*findings);
  }
  const nlohmann::json left_out = LeftOutOfSet(item_of, dataset.clips, outcome.findings);
  outcome.findings.insert(outcome.findings.end(), reviewed.begin(), reviewed.end());
  FindMixedRates(dataset, outcome.findings);
  for (Finding& finding : CompareWithExpected(*options, dataset)) outcome.findings.push_back(std::move(finding));

  outcome.summary = {
      {"clips", dataset.clips.size()}, {"labels", dataset.labels.size()}, {"splits", nlohmann::json::array()}};
  if (!left_out.empty()) outcome.summary["left_out"] = left_out;
  for (const SplitOptions& split_options : options->splits) {
    auto split = MakeSplit(split_options, dataset, outcome.findings);
    if (!split) return Forward(split);
    outcome.summary["splits"].push_back(SplitSummary(*split));
    if (split->leak_check.rfind("ok", 0) != 0) {
      Finding finding;
      finding.code = "split_leak";
      finding.severity = Severity::kError;
      finding.message = "split '" + split->name + "': " + split->leak_check;
      finding.action = "flagged";
      outcome.findings.push_back(finding);
    }
    dataset.splits.push_back(std::move(*split));
  }
  const bool suspect = std::any_of(outcome.findings.begin(), outcome.findings.end(),
                                   [](const Finding& finding) { return finding.severity != Severity::kInfo; });
  if (suspect) outcome.kind = OutcomeKind::kDoubtful;
  dataset.findings.insert(dataset.findings.end(), outcome.findings.begin(), outcome.findings.end());
  if (Status written = WriteDataset(dataset, request.output); !written) return Forward(written);
  return outcome;
}

}  // namespace mocurate
