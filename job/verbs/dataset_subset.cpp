#include <nlohmann/json.hpp>

#include "canon/values/set_files.h"
#include "canon/values/subset.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "job/verbs/dataset_answers.h"
#include "job/verbs/output_checks.h"

namespace mocurate {

Status DatasetSubsetVerb(CommonArguments& common, const DatasetArguments& arguments) {
  const auto condition = Condition::Parse(arguments.where);
  if (!condition) return Forward(condition);
  if (Status free = CheckOutputs({arguments.output}, {arguments.path}, arguments.force); !free) return free;
  const auto files = OpenDatasetFiles({arguments.path});
  if (!files) return Forward(files);
  const Dataset& whole = files->front().outline;
  auto subset = SubsetOf(whole, *condition, {files->front().name, arguments.drop_empty_labels});
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

}  // namespace mocurate
