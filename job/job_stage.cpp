#include "job/job_stage.h"

#include <algorithm>
#include <iterator>

#include "core/base/text.h"

namespace mocurate {
namespace {

/// In the order of JobStage.
constexpr const char* kStages[] = {"ingest", "proportions", "fitting", "canon", "assemble",
                                   "audit",  "train",       "table",   "report"};

}  // namespace

const char* Name(JobStage stage) { return kStages[static_cast<std::size_t>(stage)]; }

Expected<JobStage> JobStageFromName(const std::string& name) {
  const auto found = std::find(std::begin(kStages), std::end(kStages), name);
  if (found != std::end(kStages)) return static_cast<JobStage>(found - std::begin(kStages));
  return Fail(ErrorCode::kUsage, "there is no stage '" + name + "'", "--to",
              NearestOfAll(name, {std::begin(kStages), std::end(kStages)}, "the stages are: "));
}

}  // namespace mocurate
