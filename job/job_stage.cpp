#include "job/job_stage.h"

#include <vector>

#include "core/base/text.h"

namespace mocurate {
namespace {

struct StageName {
  const char* name;
  JobStage stage;
};

constexpr StageName kStages[] = {{"ingest", JobStage::kIngest},     {"proportions", JobStage::kProportions},
                                 {"fitting", JobStage::kFitting},   {"canon", JobStage::kCanon},
                                 {"assemble", JobStage::kAssemble}, {"audit", JobStage::kAudit},
                                 {"train", JobStage::kTrain},       {"table", JobStage::kTable},
                                 {"report", JobStage::kReport}};

}  // namespace

const char* Name(JobStage stage) {
  for (const StageName& known : kStages) {
    if (known.stage == stage) return known.name;
  }
  return "";
}

Expected<JobStage> JobStageFromName(const std::string& name) {
  std::vector<std::string> known;
  for (const StageName& stage : kStages) {
    if (name == stage.name) return stage.stage;
    known.emplace_back(stage.name);
  }
  return Fail(ErrorCode::kUsage, "there is no stage '" + name + "'", "--to",
              NearestOfAll(name, known, "the stages are: "));
}

}  // namespace mocurate
