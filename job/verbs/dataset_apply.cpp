#include <map>
#include <nlohmann/json.hpp>

#include "canon/review/review.h"
#include "canon/values/rows.h"
#include "canon/values/set_files.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "job/verbs/dataset_answers.h"
#include "job/verbs/output_checks.h"

namespace mocurate {
namespace {

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
  excluded.recipe += (excluded.recipe.empty() || excluded.recipe.back() == '\n' ? "" : "\n") +
                     std::string("clips that a review dropped\n");
  const auto written = WriteFromFiles(excluded, WholeClips(rows, files), files, path);
  return written ? Status() : Forward(written);
}

}  // namespace

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
  for (Split& split : dataset->splits) {
    if (split.leak_check.rfind("ok", 0) != 0) split.leak_check += " (before clips were reviewed)";
  }
  if (!arguments.excluded.empty()) {
    if (Status written = WriteExcluded(*files, *applied, arguments.excluded); !written) return written;
  }
  std::vector<ClipOrigin> origins;
  for (const ReviewedRow& kept : applied->origins) origins.push_back({0, kept.row, kept.begin, kept.end});
  const auto dropped = WriteFromFiles(*dataset, origins, *files, arguments.output);
  if (!dropped) return Forward(dropped);
  of_set.insert(of_set.end(), dropped->begin(), dropped->end());
  for (const Finding& finding : of_set) LogWarning(finding.message);
  std::map<std::string, int> counts = {
      {"review_drop", 0}, {"review_relabel", 0}, {"review_cut", 0}, {"review_stale", 0}};
  for (const Finding& finding : applied->findings) {
    ++counts[finding.code];
    if (finding.code == "review_stale") LogWarning(finding.clip + ": " + finding.message);
  }
  if (common.json) {
    common.answered = true;
    PrintJson({{"clips", dataset->clips.size()},
               {"dropped", counts["review_drop"]},
               {"relabelled", counts["review_relabel"]},
               {"cut", counts["review_cut"]},
               {"stale", counts["review_stale"]},
               {"findings", of_set}});
  } else if (!common.quiet) {
    Print("%s: %s; %d dropped, %d relabelled, %d cut, %d that match no clip\n", DisplayPath(arguments.output).c_str(),
          Counted(static_cast<long long>(dataset->clips.size()), "clip").c_str(), counts["review_drop"],
          counts["review_relabel"], counts["review_cut"], counts["review_stale"]);
  }
  return {};
}

}  // namespace mocurate
