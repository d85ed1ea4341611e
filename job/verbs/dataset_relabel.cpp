#include <nlohmann/json.hpp>

#include "canon/values/relabel.h"
#include "canon/values/set_files.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "job/verbs/dataset_answers.h"
#include "job/verbs/output_checks.h"

namespace mocurate {

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
