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
  std::string list;
  for (const StageName& stage : kStages) {
    if (name == stage.name) return stage.stage;
    known.emplace_back(stage.name);
    list += (list.empty() ? "" : ", ") + known.back();
  }
  const auto near = Nearest(name, known);
  return Fail(ErrorCode::kUsage, "there is no stage '" + name + "'", "--to",
              (near ? "did you mean '" + *near + "'? " : "") + "the stages are: " + list);
}

}  // namespace mocurate
