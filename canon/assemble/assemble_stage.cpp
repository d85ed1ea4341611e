#include <algorithm>
#include <map>
#include <set>

#include "canon/assemble/clip_files.h"
#include "canon/options.h"
#include "canon/recipes/classes.h"
#include "canon/review/review.h"
#include "canon/splits/leaks.h"
#include "canon/splits/splits.h"
#include "canon/stage_parts.h"
#include "canon/stages.h"
#include "canon/values/merge.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"

namespace mocurate {
namespace {

/// By item: whether nothing of it is kept, the findings that exclude its clips, and the remedy.
nlohmann::json ExcludedFromSet(const std::map<std::string, std::string>& item_of, const std::vector<Clip>& kept,
                               const std::vector<Finding>& findings) {
  nlohmann::json items = nlohmann::json::object();
  for (std::size_t i = 0; i < findings.size(); ++i) {
    nlohmann::json& item = items[item_of.at(findings[i].clip)];
    item["whole"] = true;
    item["findings"].push_back(i);
    if (findings[i].code == kLabelNotListed) {
      item["hint"] = "add the label to assemble.classes";
    } else if (findings[i].code == kReviewDrop) {
      item["hint"] = "remove the decision from canon.review";
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

/// Findings about the clips as a set, made before this stage: a JSON list.
Status ReadFindings(const StageInput& input, std::vector<Finding>& findings) {
  const auto list = ReadJson(input.path);
  if (!list) return Forward(list);
  return GuardJson(input.name, [&] {
    for (const nlohmann::json& finding : *list) findings.push_back(finding.get<Finding>());
  });
}

/// Applies a review; with `by_id`, whatever the motions are. `excluding` receives the findings about clips that it
/// drops; the others are returned.
Expected<std::vector<Finding>> TakeReview(const std::filesystem::path& file, bool by_id, ClipFiles& files,
                                          Dataset& dataset, std::map<std::string, std::string>& item_of,
                                          std::vector<Finding>& excluding) {
  auto review = ReadReview(file);
  if (!review) return Forward(review);
  for (Decision& decision : review->decisions) {
    if (by_id) decision.content.clear();
  }
  std::set<std::string> named;
  for (const Decision& decision : review->decisions) named.insert(decision.clip);
  for (Clip& clip : dataset.clips) {
    if (named.count(clip.id()) == 0) continue;
    auto whole = files.WithFrames(clip);  // a decision applies to the motion that was reviewed
    if (!whole) return Forward(whole);
    clip = *std::move(whole);
  }
  auto applied = ApplyReview(*review, dataset);
  if (!applied) return Forward(applied);
  if (dataset.clips.empty()) {
    return Fail(ErrorCode::kConfig, "every clip is dropped by the review", DisplayPath(file), "keep at least one clip");
  }
  for (const auto& [old_id, new_id] : applied->new_ids) {
    // A clip that was cut twice had an intermediate id that no clip has; its recording identifies it.
    const auto own = item_of.find(old_id);
    const auto recording = item_of.lower_bound(old_id.substr(0, old_id.rfind('#') + 1));
    item_of[new_id] = own != item_of.end() ? own->second : recording->second;
  }
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
  ClipFiles files;
  for (const StageInput& input : request.inputs) {
    if (input.role == "findings") {
      if (Status read = ReadFindings(input, noted); !read) return Forward(read);
      continue;
    }
    if (input.role == kReviewRole || input.role == kReviewByIdRole) continue;
    if (Status added = files.Add(input, dataset); !added) return Forward(added);
  }
  dataset.findings.insert(dataset.findings.end(), noted.begin(), noted.end());
  if (dataset.clips.empty()) {
    return Fail(ErrorCode::kInconsistent, "no clip is left to assemble", "assemble",
                "curation_log.jsonl lists why each was dropped");
  }
  SortById(dataset.clips);
  StageOutcome outcome;
  UniteSkeletons(dataset, outcome.findings);
  std::set<std::string> labels;
  for (const Clip& clip : dataset.clips) labels.insert(clip.label);
  ApplyClasses(*options, dataset, outcome.findings);
  if (dataset.clips.empty()) {
    std::string known;
    for (const std::string& label : labels) known += (known.empty() ? "'" : ", '") + label + "'";
    return Fail(ErrorCode::kInconsistent, "no clip has a listed class; the labels are " + known, "assemble.classes",
                "list them, or add them to `from` of a class");
  }
  std::map<std::string, std::string> item_of = files.items();
  std::vector<Finding> reviewed;
  const StageInput* by_id = FindInput(request, kReviewByIdRole);
  if (const StageInput* review = by_id != nullptr ? by_id : FindInput(request, kReviewRole)) {
    auto findings = TakeReview(review->path, by_id != nullptr, files, dataset, item_of, outcome.findings);
    if (!findings) return Forward(findings);
    reviewed = std::move(*findings);
  }
  const nlohmann::json excluded = ExcludedFromSet(item_of, dataset.clips, outcome.findings);
  outcome.findings.insert(outcome.findings.end(), reviewed.begin(), reviewed.end());
  FindMixedRates(dataset, outcome.findings);
  FindEmptyClasses(*options, dataset, outcome.findings);
  CompareWithExpected(*options, dataset, outcome.findings);

  outcome.summary = {
      {"clips", dataset.clips.size()}, {"labels", dataset.labels.size()}, {"splits", nlohmann::json::array()}};
  if (!excluded.empty()) outcome.summary["excluded"] = excluded;
  const auto contents = options->splits.empty() ? Expected<std::vector<std::string>>() : files.Contents(dataset);
  if (!contents) return Forward(contents);
  for (const SplitOptions& split_options : options->splits) {
    auto split = MakeSplit(split_options, dataset, outcome.findings, *contents);
    if (!split) return Forward(split);
    outcome.summary["splits"].push_back(SplitSummary(*split));
    if (split->leak_check.rfind("ok", 0) != 0) {
      outcome.findings.push_back(
          MakeFinding("split_leak", Severity::kError, 0.0, "split '" + split->name + "': " + split->leak_check));
    }
    dataset.splits.push_back(std::move(*split));
  }
  const bool suspect = std::any_of(outcome.findings.begin(), outcome.findings.end(),
                                   [](const Finding& finding) { return finding.severity != Severity::kInfo; });
  if (suspect) outcome.kind = OutcomeKind::kSuspect;
  dataset.findings.insert(dataset.findings.end(), outcome.findings.begin(), outcome.findings.end());
  if (Status written = files.Write(dataset, request.output); !written) return Forward(written);
  return outcome;
}

}  // namespace mocurate
