#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "app/output_checks.h"
#include "app/verbs.h"
#include "canon/card/dataset_card.h"
#include "canon/diff/dataset_diff.h"
#include "canon/review/review.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/base/version.h"

namespace mocurate {
namespace {

std::string Dumped(const nlohmann::json& document) {
  return document.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

/// A difference as a line: "name: 12".
void PrintCount(const char* name, const nlohmann::json& list) { std::printf("%-12s %zu\n", name, list.size()); }

void PrintDiff(const nlohmann::json& diff) {
  constexpr std::size_t kMostShown = 20;
  std::printf("%-12s %d\n", "equal", diff.at("equal").get<int>());
  for (const char* kind : {"added", "removed", "relabelled", "refitted", "moved", "changed"}) {
    PrintCount(kind, diff.at(kind));
  }
  for (const nlohmann::json& one : diff.at("dataset")) {
    std::printf("dataset      %s: %s -> %s\n", one.at("field").get<std::string>().c_str(),
                one.at("before").dump().c_str(), one.at("after").dump().c_str());
  }
  for (const char* kind : {"splits_added", "splits_removed"}) {
    if (!diff.at(kind).empty()) PrintCount(kind, diff.at(kind));
  }
  std::size_t shown = 0;
  const auto show = [&](const std::string& line) {
    if (shown++ < kMostShown) std::printf("%s\n", line.c_str());
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
    std::string how = std::to_string(one.at("frames_before").get<int>()) + " -> " +
                      std::to_string(one.at("frames_after").get<int>()) + " frames";
    if (one.at("joint_mm").is_number()) how = RoundedText(one.at("joint_mm").get<double>(), 3) + " mm";
    if (one.at("rotation_deg").is_number()) how += ", " + RoundedText(one.at("rotation_deg").get<double>(), 3) + " deg";
    show("refitted    " + one.at("clip").get<std::string>() + ": " + how);
  }
  if (shown > kMostShown) std::printf("and %zu more: --json lists all\n", shown - kMostShown);
}

/// The clips that a review dropped, as a dataset of its own; nothing where there are none.
Status WriteExcluded(const Dataset& whole, const AppliedReview& applied, const std::filesystem::path& path) {
  std::error_code ignored;
  if (applied.dropped.empty()) {
    std::filesystem::remove(path, ignored);  // an earlier one would be taken for this one
    return {};
  }
  Dataset excluded;
  excluded.skeleton = whole.skeleton;
  excluded.joints_only = whole.joints_only;
  excluded.labels = whole.labels;
  excluded.fine_labels = whole.fine_labels;
  excluded.created_by = CreatedBy();
  excluded.recipe = "dropped by a review";
  excluded.axes = whole.axes;
  excluded.clips = applied.dropped;
  excluded.findings = applied.of_dropped;
  return WriteDataset(excluded, path);
}

}  // namespace

Status DatasetCardVerb(CommonArguments& common, const DatasetArguments& arguments) {
  const auto card = DescribeDataset(arguments.path);
  if (!card) return Forward(card);
  const std::string text = arguments.croissant ? Dumped(CardCroissant(*card)) : CardMarkdown(*card);
  std::error_code unknown;
  if (!arguments.output.empty()) {
    if (std::filesystem::exists(arguments.output, unknown) && !arguments.force) {
      return Fail(ErrorCode::kUsage, "the file exists", DisplayPath(arguments.output), "--force overwrites it");
    }
    if (Status written = WriteFile(arguments.output, text); !written) return written;
  }
  if (common.json) {
    common.answered = true;
    std::printf("%s", Dumped(*card).c_str());
  } else if (arguments.output.empty()) {
    std::printf("%s", text.c_str());
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
  auto dataset = ReadDataset(arguments.path);
  if (!dataset) return Forward(dataset);
  const auto applied = ApplyReview(*review, *dataset);
  if (!applied) return Forward(applied);
  if (dataset->clips.empty()) {
    return Fail(ErrorCode::kConfig, "every clip is dropped", DisplayPath(arguments.other), "keep some");
  }
  dataset->findings.insert(dataset->findings.end(), applied->findings.begin(), applied->findings.end());
  for (Split& split : dataset->splits) {
    if (split.leak_check.rfind("ok", 0) != 0) split.leak_check += " (before clips were reviewed)";
  }
  if (!arguments.excluded.empty()) {
    if (Status written = WriteExcluded(*dataset, *applied, arguments.excluded); !written) return written;
  }
  if (Status written = WriteDataset(*dataset, arguments.output); !written) return written;
  std::map<std::string, int> counts = {
      {"review_drop", 0}, {"review_relabel", 0}, {"review_cut", 0}, {"review_stale", 0}};
  for (const Finding& finding : applied->findings) {
    ++counts[finding.code];
    if (finding.code == "review_stale") LogWarning(finding.clip + ": " + finding.message);
  }
  if (common.json) {
    common.answered = true;
    std::printf("%s", Dumped({{"clips", dataset->clips.size()},
                              {"dropped", counts["review_drop"]},
                              {"relabelled", counts["review_relabel"]},
                              {"cut", counts["review_cut"]},
                              {"stale", counts["review_stale"]}})
                          .c_str());
  } else if (!common.quiet) {
    std::printf("%s: %s; %d dropped, %d relabelled, %d cut, %d that fit no clip any more\n",
                DisplayPath(arguments.output).c_str(),
                Counted(static_cast<long long>(dataset->clips.size()), "clip").c_str(), counts["review_drop"],
                counts["review_relabel"], counts["review_cut"], counts["review_stale"]);
  }
  return {};
}

Status DatasetDiffVerb(CommonArguments& common, const DatasetArguments& arguments) {
  const auto diff = DiffDatasets(arguments.path, arguments.other);
  if (!diff) return Forward(diff);
  if (common.json) {
    common.answered = true;
    std::printf("%s", Dumped(*diff).c_str());
  } else {
    PrintDiff(*diff);
  }
  return {};
}

}  // namespace mocurate
