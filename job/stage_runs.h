#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/pipeline/runner.h"

namespace mocurate {

/// Runs the stages of a job one after the other and keeps their counts.
class StageRuns {
 public:
  StageRuns(Runner& runner, std::vector<StageCounts>& counts) : runner_(runner), counts_(counts) {}

  Expected<StageReport> Run(const StageDeclaration& stage, std::vector<ItemSpec> items,
                            const std::string& branch = {}) {
    auto report = runner_.Run(stage, std::move(items), branch);
    if (report) counts_.push_back(*report);
    return report;
  }

  /// Runs one item whose artifact later stages require.
  Expected<ItemResult> One(const StageDeclaration& stage, ItemSpec item, const std::string& branch = {}) {
    auto report = Run(stage, {std::move(item)}, branch);
    if (!report) return Forward(report);
    if (report->items.empty()) return ItemResult();
    const ItemResult& result = report->items.front();
    if (result.artifact.empty() && !runner_.options().dry_run) {
      Error error = result.outcome.error;
      if (error.where.empty()) error.where = stage.name;
      return tl::unexpected<Error>(error);
    }
    return result;
  }

 private:
  Runner& runner_;
  std::vector<StageCounts>& counts_;
};

}  // namespace mocurate
