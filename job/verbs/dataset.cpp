#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "canon/card/dataset_card.h"
#include "canon/diff/dataset_diff.h"
#include "canon/review/review.h"
#include "canon/values/merge.h"
#include "canon/values/relabel.h"
#include "canon/values/set_files.h"
#include "canon/values/subset.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/store/store.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

/// Reports a dataset that a verb wrote: warnings on stderr; then `text`, or with --json {"clips", "frames", "labels",
/// "splits": [{name, train, validation, test, leak_check}], "findings", and the fields of `more`}.
void AnswerWithDataset(CommonArguments& common, const Dataset& dataset, const std::vector<Finding>& findings,
                       const std::string& text, const nlohmann::json& more) {
  for (const Finding& finding : findings) {
    if (finding.severity != Severity::kInfo) WarnOf({finding});
  }
  std::int64_t frames = 0;
  for (const Clip& clip : dataset.clips) frames += clip.motion->frame_count();
  nlohmann::json answer = {{"clips", dataset.clips.size()},
                           {"frames", frames},
                           {"labels", dataset.labels},
                           {"splits", nlohmann::json::array()},
                           {"findings", findings}};
  for (const Split& split : dataset.splits) {
    answer["splits"].push_back({{"name", split.name},
                                {"train", split.train.size()},
                                {"validation", split.validation.size()},
                                {"test", split.test.size()},
                                {"leak_check", split.leak_check}});
  }
  answer.update(more);
  if (AnswersInText(common, answer)) PrintLine(text);
}

/// A difference as a line: "name: 12".
void PrintCount(const char* name, const nlohmann::json& list) { Print("%-12s %zu\n", name, list.size()); }

std::string ShownValue(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void PrintDiff(const nlohmann::json& diff) {
  constexpr std::size_t kMostLines = 20;
  Print("%-12s %d\n", "equal", diff.at("equal").get<int>());
  for (const char* kind : {"added", "removed", "relabelled", "refitted", "moved", "changed"}) {
    PrintCount(kind, diff.at(kind));
  }
  for (const nlohmann::json& one : diff.at("dataset")) {
    Print("dataset      %s: %s -> %s\n", one.at("field").get<std::string>().c_str(),
          ShownValue(one.at("before")).c_str(), ShownValue(one.at("after")).c_str());
  }
  for (const char* kind : {"splits_added", "splits_removed"}) {
    if (!diff.at(kind).empty()) PrintCount(kind, diff.at(kind));
  }
  std::size_t shown = 0;
  const auto show = [&](const std::string& line) {
    if (shown++ < kMostLines) Print("%s\n", line.c_str());
  };
  for (const nlohmann::json& clip : diff.at("added")) show("added       " + clip.get<std::string>());
  for (const nlohmann::json& clip : diff.at("removed")) show("removed     " + clip.get<std::string>());
  for (const nlohmann::json& one : diff.at("relabelled")) {
    show("relabelled  " + one.at("clip").get<std::string>() + ": " + one.at("before").get<std::string>() + " -> " +
         one.at("after").get<std::string>());
  }
  for (const nlohmann::json& one : diff.at("moved")) {
    show("moved       " + one.at("clip").get<std::string>() + ": " + one.at("before").get<std::string>() + " -> " +
         one.at("after").get<std::string>() + " of split " + one.at("split").get<std::string>());
  }
  for (const nlohmann::json& one : diff.at("changed")) {
    show("changed     " + one.at("clip").get<std::string>() + ": " + one.at("field").get<std::string>() + " " +
         one.at("before").get<std::string>() + " -> " + one.at("after").get<std::string>());
  }
  for (const nlohmann::json& one : diff.at("refitted")) {
    const int before = one.at("frames_before").get<int>(), after = one.at("frames_after").get<int>();
    std::string how =
        before == after ? "to another skeleton" : std::to_string(before) + " -> " + std::to_string(after) + " frames";
    if (one.at("joint_mm").is_number()) how = RoundedText(one.at("joint_mm").get<double>(), 3) + " mm";
    if (one.at("rotation_deg").is_number()) how += ", " + RoundedText(one.at("rotation_deg").get<double>(), 3) + " deg";
    show("refitted    " + one.at("clip").get<std::string>() + ": " + how);
  }
  if (shown > kMostLines) Print("and %zu more: --json lists all\n", shown - kMostLines);
}

/// The clips that a review dropped, as another dataset; nothing without any.
Status WriteExcluded(const std::vector<DatasetFile>& files, const AppliedReview& applied,
                     const std::filesystem::path& path) {
  std::error_code ignored;
  if (applied.dropped.empty()) {
    std::filesystem::remove(path, ignored);  // an earlier one would be mistaken for this one's
    return {};
  }
  Dataset excluded = files.front().outline;
  std::vector<bool> dropped(excluded.clips.size(), true);
  for (const ReviewedRow& kept : applied.origins) dropped[kept.row] = false;
  const std::vector<std::size_t> rows = KeepRows(dropped, excluded);
  excluded.created_by = CreatedBy();
  AddToRecipe("clips that a review dropped", excluded);
  const auto written = WriteFromFiles(excluded, WholeClips(rows, files), files, path);
  return written ? Status() : Forward(written);
}

}  // namespace

Status DatasetCardVerb(CommonArguments& common, const DatasetArguments& arguments) {
  const auto card = DescribeDataset(arguments.path);
  if (!card) return Forward(card);
  constexpr auto kReplace = nlohmann::json::error_handler_t::replace;
  const std::string text =
      arguments.croissant ? CardCroissant(*card).dump(1, ' ', true, kReplace) + "\n" : CardMarkdown(*card);
  if (!arguments.output.empty()) {
    if (Status free = CheckOutputs({arguments.output}, {arguments.path}, arguments.force); !free) return free;
    if (Status written = WriteFile(arguments.output, text); !written) return written;
  }
  if (AnswersInText(common, *card) && arguments.output.empty()) Print("%s", text.c_str());
  return {};
}

Status DatasetDiffVerb(CommonArguments& common, const DatasetArguments& arguments) {
  const auto diff = DiffDatasets(arguments.path, arguments.other);
  if (!diff) return Forward(diff);
  if (AnswersInText(common, *diff)) {
    PrintDiff(*diff);
  }
  return {};
}

Status DatasetApplyVerb(CommonArguments& common, const DatasetArguments& arguments) {
  if (Status free =
          CheckOutputs({arguments.output, arguments.excluded}, {arguments.path, arguments.other}, arguments.force);
      !free) {
    return free;
  }
  const auto review = ReadReview(arguments.other);
  if (!review) return Forward(review);
  const auto files = OpenDatasetFiles({arguments.path});
  if (!files) return Forward(files);
  auto dataset = ReadDataset(arguments.path);
  if (!dataset) return Forward(dataset);
  const std::vector<Split> before = dataset->splits;
  const auto applied = ApplyReview(*review, *dataset);
  if (!applied) return Forward(applied);
  if (dataset->clips.empty()) {
    return Fail(ErrorCode::kConfig, "every clip is dropped", DisplayPath(arguments.other), "keep at least one clip");
  }
  dataset->findings.insert(dataset->findings.end(), applied->findings.begin(), applied->findings.end());
  std::vector<Finding> of_set = FindEmptyParts(before, dataset->splits);
  dataset->findings.insert(dataset->findings.end(), of_set.begin(), of_set.end());
  NoteEarlierChecks("clips were reviewed", *dataset);
  if (!arguments.excluded.empty()) {
    if (Status written = WriteExcluded(*files, *applied, arguments.excluded); !written) return written;
  }
  std::vector<ClipOrigin> origins;
  for (const ReviewedRow& kept : applied->origins) origins.push_back({0, kept.row, kept.begin, kept.end});
  const auto dropped = WriteFromFiles(*dataset, origins, *files, arguments.output);
  if (!dropped) return Forward(dropped);
  of_set.insert(of_set.end(), dropped->begin(), dropped->end());
  WarnOf(of_set);
  std::map<std::string, int> counts = {
      {"review_drop", 0}, {"review_relabel", 0}, {"review_cut", 0}, {"review_stale", 0}};
  for (const Finding& finding : applied->findings) {
    ++counts[finding.code];
    if (finding.code == "review_stale") LogWarning(finding.clip + ": " + finding.message);
  }
  if (AnswersInText(common, {{"clips", dataset->clips.size()},
                             {"dropped", counts["review_drop"]},
                             {"relabelled", counts["review_relabel"]},
                             {"cut", counts["review_cut"]},
                             {"stale", counts["review_stale"]},
                             {"findings", of_set}})) {
    Print("%s: %s; %d dropped, %d relabelled, %d cut, %d that match no clip\n", DisplayPath(arguments.output).c_str(),
          Counted(static_cast<long long>(dataset->clips.size()), "clip").c_str(), counts["review_drop"],
          counts["review_relabel"], counts["review_cut"], counts["review_stale"]);
  }
  return {};
}

Status DatasetMergeVerb(CommonArguments& common, const DatasetArguments& arguments) {
  if (Status free = CheckOutputs({arguments.output}, arguments.paths, arguments.force); !free) return free;
  const auto files = OpenDatasetFiles(arguments.paths);
  if (!files) return Forward(files);
  std::vector<MergePart> parts;
  nlohmann::json from = nlohmann::json::array();
  for (const DatasetFile& file : *files) {
    parts.push_back({file.name, file.outline, file.clips.content_sha256(),
                     [&file](std::size_t row) { return file.clips.MotionSha256(row); }});
    from.push_back({{"name", file.name}, {"clips", file.clips.size()}});
  }
  auto merged = MergeDatasets(parts);
  if (!merged) return Forward(merged);
  std::vector<ClipOrigin> origins;
  for (const auto& [file, row] : merged->origins) origins.push_back(WholeClip(file, row, *files));
  std::vector<std::pair<ClipOrigin, ClipOrigin>> repeats;
  for (const auto& [clip, place] : merged->repeats) {
    repeats.emplace_back(origins[clip], WholeClip(place.first, place.second, *files));
  }
  const auto dropped = WriteFromFiles(merged->dataset, origins, *files, arguments.output, repeats);
  if (!dropped) return Forward(dropped);
  merged->findings.insert(merged->findings.end(), dropped->begin(), dropped->end());
  const auto repeated = std::count_if(merged->findings.begin(), merged->findings.end(),
                                      [](const Finding& finding) { return finding.code == "repeated_clip"; });
  const auto new_labels = merged->dataset.labels.size() - parts[0].dataset.labels.size();
  AnswerWithDataset(common, merged->dataset, merged->findings,
                    DisplayPath(arguments.output) + ": " +
                        Counted(static_cast<long long>(merged->dataset.clips.size()), "clip") + " of " +
                        Counted(static_cast<long long>(parts.size()), "dataset") + ", " + std::to_string(repeated) +
                        " repeated; " + Counted(static_cast<long long>(merged->dataset.labels.size()), "label") + ", " +
                        std::to_string(new_labels) + " not in the first",
                    {{"datasets", from}, {"repeated", repeated}});
  return {};
}

Status DatasetSubsetVerb(CommonArguments& common, const DatasetArguments& arguments) {
  const auto condition = Condition::Parse(arguments.where);
  if (!condition) return Forward(condition);
  if (Status free = CheckOutputs({arguments.output}, {arguments.path}, arguments.force); !free) return free;
  const auto files = OpenDatasetFiles({arguments.path});
  if (!files) return Forward(files);
  const Dataset& whole = files->front().outline;
  auto subset = SubsetOf(whole, *condition, files->front().name, arguments.drop_empty_labels);
  if (!subset) return Forward(subset);
  for (const Condition::UnknownValue& unknown : condition->FindUnknownValues(whole)) {
    LogWarning("--where: no clip has the " + unknown.field + " '" + unknown.value + "'" +
               (unknown.nearest ? "; the nearest is '" + *unknown.nearest + "'" : ""));
  }
  const auto dropped = WriteFromFiles(subset->dataset, WholeClips(subset->rows, *files), *files, arguments.output);
  if (!dropped) return Forward(dropped);
  subset->findings.insert(subset->findings.end(), dropped->begin(), dropped->end());
  AnswerWithDataset(common, subset->dataset, subset->findings,
                    DisplayPath(arguments.output) + ": " + std::to_string(subset->rows.size()) + " of " +
                        Counted(static_cast<long long>(whole.clips.size()), "clip"),
                    {{"clips_before", whole.clips.size()}});
  return {};
}

Status DatasetRelabelVerb(CommonArguments& common, const DatasetArguments& arguments) {
  const auto map = ReadRelabelMap(arguments.other);
  if (!map) return Forward(map);
  if (Status free = CheckOutputs({arguments.output}, {arguments.path, arguments.other, map->clips}, arguments.force);
      !free) {
    return free;
  }
  const auto files = OpenDatasetFiles({arguments.path});
  if (!files) return Forward(files);
  const std::size_t before = files->front().clips.size();
  auto relabelled = Relabel(files->front().outline, *map);
  if (!relabelled) return Forward(relabelled);
  const auto dropped =
      WriteFromFiles(relabelled->dataset, WholeClips(relabelled->rows, *files), *files, arguments.output);
  if (!dropped) return Forward(dropped);
  relabelled->findings.insert(relabelled->findings.end(), dropped->begin(), dropped->end());
  std::size_t changed = 0;
  nlohmann::json changes = nlohmann::json::array();
  std::string lines;
  for (const auto& [labels, clips] : relabelled->changes) {
    changed += clips;
    changes.push_back({{"before", labels.first}, {"after", labels.second}, {"clips", clips}});
    lines += "\n  " + labels.first + " -> " + labels.second + ": " + Counted(static_cast<long long>(clips), "clip");
  }
  AnswerWithDataset(
      common, relabelled->dataset, relabelled->findings,
      DisplayPath(arguments.output) + ": " + Counted(static_cast<long long>(relabelled->rows.size()), "clip") + ", " +
          std::to_string(changed) + " relabelled, " + std::to_string(before - relabelled->rows.size()) + " dropped; " +
          Counted(static_cast<long long>(relabelled->dataset.labels.size()), "label") + lines,
      {{"relabelled", changed},
       {"dropped", before - relabelled->rows.size()},
       {"segments_relabelled", relabelled->segments},
       {"changes", changes}});
  return {};
}

}  // namespace mocurate
