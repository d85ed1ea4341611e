#include <algorithm>
#include <nlohmann/json.hpp>

#include "canon/values/merge.h"
#include "canon/values/set_files.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "job/verbs/dataset_answers.h"
#include "job/verbs/output_checks.h"

namespace mocurate {

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

}  // namespace mocurate
