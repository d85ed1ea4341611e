#include "canon/values/subset.h"

#include <algorithm>

#include "canon/values/rows.h"
#include "core/base/text.h"
#include "core/base/version.h"

namespace mocurate {
namespace {

/// "label == wave: 12, frames >= 60: 0 of 180 clips"
std::string TestCountsText(const std::vector<std::pair<std::string, std::size_t>>& counts, std::size_t clips) {
  std::string text;
  for (const auto& [test, count] : counts) text += (text.empty() ? "" : ", ") + test + ": " + std::to_string(count);
  return text + " of " + Counted(static_cast<long long>(clips), "clip");
}

}  // namespace

Expected<DatasetSubset> SubsetOf(Dataset dataset, const Condition& condition, const SubsetOptions& options) {
  const auto holds = condition.Holds(dataset);
  if (!holds) return Forward(holds);
  const auto count = static_cast<std::size_t>(std::count(holds->begin(), holds->end(), true));
  if (count == 0) {
    const auto counts = condition.CountTests(dataset);
    if (!counts) return Forward(counts);
    std::string nearest;
    for (const Condition::UnknownValue& unknown : condition.FindUnknownValues(dataset)) {
      if (unknown.nearest) nearest += (nearest.empty() ? "" : ", ") + unknown.value + " -> " + *unknown.nearest;
    }
    return Fail(ErrorCode::kInconsistent, "the condition matches no clip; " + TestCountsText(*counts, holds->size()),
                options.name, nearest.empty() ? "widen the condition" : "did you mean: " + nearest);
  }
  const std::vector<Split> before = dataset.splits;
  DatasetSubset subset;
  subset.rows = KeepRows(*holds, dataset);
  for (Split& split : dataset.splits) {
    if (count < holds->size() && split.leak_check.rfind("ok", 0) != 0)
      split.leak_check += " (before clips were chosen)";
  }
  subset.findings = FindEmptyParts(before, dataset.splits);
  if (options.drop_empty_labels) DropEmptyLabels(dataset);
  dataset.recipe += (dataset.recipe.empty() || dataset.recipe.back() == '\n' ? "" : "\n") + std::string("subset of ") +
                    options.name + ": " + std::to_string(count) + " of " +
                    Counted(static_cast<long long>(holds->size()), "clip") + " where " + condition.text() + "\n";
  dataset.created_by = CreatedBy();
  dataset.findings.insert(dataset.findings.end(), subset.findings.begin(), subset.findings.end());
  subset.dataset = std::move(dataset);
  return subset;
}

}  // namespace mocurate
