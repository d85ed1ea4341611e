#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "job/motion_files.h"
#include "job/stage_runs.h"
#include "job/verbs/verbs.h"

namespace mocurate {

/// Checks that a path is a dataset or MotionSet of mocurate. Errors kNotFound, kInconsistent.
Status CheckIsDataset(const std::filesystem::path& path);

/// Whether files may be written: each has its own path, is neither an input nor inside a folder that is read, and does
/// not exist unless `force`. Empty paths are skipped. Error kUsage.
Status CheckOutputs(const std::vector<std::filesystem::path>& outputs, const std::vector<std::filesystem::path>& inputs,
                    bool force);

/// Prints the answer of a verb as its JSON document, where that is asked for. Otherwise true: the caller prints it as
/// text, unless nothing but errors is asked for.
bool AnswersInText(CommonArguments& common, const nlohmann::json& answer);

/// Warns of findings: their clip and message.
void WarnOf(const std::vector<Finding>& findings);

/// Runs stages for a verb, in a temporary folder or in `folder`.
class VerbStages {
 public:
  /// Error kCannotWrite if the temporary folder cannot be created, and those of Runner::Make.
  static Expected<std::unique_ptr<VerbStages>> Make(const CommonArguments& common, int jobs = 0,
                                                    const std::filesystem::path& folder = {});

  Runner& runner() { return *runner_; }
  StageRuns& runs() { return *runs_; }
  const std::filesystem::path& folder() const { return runner_->options().run_folder; }
  /// Runs one item: its artifact and outcome.
  Expected<ItemResult> One(const StageDeclaration& stage, ItemSpec item) { return runs_->One(stage, std::move(item)); }

 private:
  VerbStages() = default;

  std::optional<TemporaryFolder> scratch_;
  std::unique_ptr<Runner> runner_;
  std::vector<StageCounts> counts_;
  std::optional<StageRuns> runs_;
};

/// Motions as given on the command line: "NAME=PATH", or a path, whose name without the ending is the name.
struct NamedPath {
  std::string name;
  std::filesystem::path path;
};
NamedPath NamedPathOf(const std::string& text);
/// The same with a name that is not in `taken`, to which it is added: NAME, NAME~2, ...
NamedPath NamedRow(const std::string& text, std::set<std::string>& taken);

/// Motions as one dataset or MotionSet: one of mocurate unchanged, other files through the stage `motions`, with
/// warnings of unreadable ones. `declare`: what to do about bare arrays that neither `files` nor the extractor
/// declares.
Expected<StageInput> MotionsInput(const std::string& name, const MotionFiles& files, const ExtractorOptions& extractor,
                                  const std::string& declare, VerbStages& stages);

}  // namespace mocurate
