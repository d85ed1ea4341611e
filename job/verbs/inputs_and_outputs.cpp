#include "job/verbs/inputs_and_outputs.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "ingest/options.h"
#include "ingest/stages.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

bool SamePlace(const fs::path& a, const fs::path& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code unknown;
  if (fs::equivalent(a, b, unknown)) return true;
  return fs::weakly_canonical(a, unknown) == fs::weakly_canonical(b, unknown);
}

/// Whether an existing file is inside a folder.
bool LiesBelow(const fs::path& file, const fs::path& folder) {
  std::error_code unknown;
  if (file.empty() || !fs::is_directory(folder, unknown) || !fs::is_regular_file(file, unknown)) return false;
  const fs::path whole = fs::weakly_canonical(folder, unknown), inside = fs::weakly_canonical(file, unknown);
  return std::mismatch(whole.begin(), whole.end(), inside.begin(), inside.end()).first == whole.end();
}

}  // namespace

Status CheckOutputs(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs, bool force) {
  std::error_code unknown;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    for (const fs::path& input : inputs) {
      if (SamePlace(outputs[i], input) || LiesBelow(outputs[i], input)) {
        return Fail(ErrorCode::kUsage, "the output is also an input", DisplayPath(outputs[i]), "name another file");
      }
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (SamePlace(outputs[i], outputs[k])) {
        return Fail(ErrorCode::kUsage, "two outputs have the same path", DisplayPath(outputs[i]), "name two files");
      }
    }
    if (!force && fs::exists(outputs[i], unknown)) {
      return Fail(ErrorCode::kUsage, "the file exists", DisplayPath(outputs[i]),
                  "use --force to overwrite it, or -o for another file");
    }
  }
  return {};
}

Status CheckIsDataset(const fs::path& path) {
  std::error_code unknown;
  if (!fs::exists(path, unknown)) {
    return Fail(ErrorCode::kNotFound, "no such file", DisplayPath(path),
                "give a dataset: RUN/dataset.h5, or what `mocurate fit` wrote");
  }
  if (IsMotionStore(path)) return {};
  return Fail(ErrorCode::kInconsistent, "the file is not a dataset of mocurate", DisplayPath(path),
              "create one with `mocurate config init`, then `mocurate run CONFIG --to assemble`");
}

bool AnswersInText(CommonArguments& common, const nlohmann::json& answer) {
  common.answered = common.json;
  if (common.json) PrintJson(answer);
  return !common.json && !common.quiet;
}

void WarnOf(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) {
    LogWarning((finding.clip.empty() ? "" : finding.clip + ": ") + finding.message);
  }
}

Expected<std::unique_ptr<VerbStages>> VerbStages::Make(const CommonArguments& common, int jobs,
                                                       const fs::path& folder) {
  auto made = std::unique_ptr<VerbStages>(new VerbStages());
  RunnerOptions settings;
  settings.run_folder = folder;
  if (folder.empty()) settings.run_folder = made->scratch_.emplace().path();
  if (settings.run_folder.empty()) return Forward(TemporaryFolder::Missing());
  settings.jobs = jobs;
  settings.quiet = common.quiet;
  settings.log_failures = false;
  auto runner = Runner::Make(settings);
  if (!runner) return Forward(runner);
  made->runner_ = std::move(*runner);
  made->runs_.emplace(*made->runner_, made->counts_);
  return made;
}

NamedPath NamedPathOf(const std::string& text) {
  std::error_code unknown;
  const std::size_t equals = text.find('=');
  if (equals != std::string::npos && equals > 0 && !fs::exists(text, unknown)) {
    return {text.substr(0, equals), text.substr(equals + 1)};
  }
  const fs::path whole = fs::absolute(text, unknown).lexically_normal();
  return {DisplayPath((whole.filename().empty() ? whole.parent_path() : whole).stem()), text};
}

NamedPath NamedRow(const std::string& text, std::set<std::string>& taken) {
  NamedPath named = NamedPathOf(text);
  const std::string base = named.name;
  for (int copy = 2; !taken.insert(named.name).second; ++copy) named.name = base + "~" + std::to_string(copy);
  return named;
}

Expected<StageInput> MotionsInput(const std::string& name, const MotionFiles& files, const ExtractorOptions& extractor,
                                  const std::string& declare, VerbStages& stages) {
  if (IsMotionStore(files.path) && files.labels.empty()) return StageInput{"motions", name, files.path, ""};
  const bool bare = files.source.empty() && AreBareArrays(files.path) && !DeclarationBeside(files.path);
  if (bare && extractor.name.empty()) {
    return Fail(ErrorCode::kUsage, "bare arrays have neither joint names nor axes nor a unit", DisplayPath(files.path),
                declare);
  }
  auto item = MakeMotionsItem(name, files, extractor);
  if (!item) return Forward(item);
  for (const RefusedClip& file : item->unreadable) LogWarning(name + ": " + file.error.Message());
  const auto read = stages.One(MotionsDeclaration(), std::move(item->item));
  if (!read) return Forward(read);
  for (const Finding& finding : read->outcome.findings) {
    if (finding.severity == Severity::kInfo) continue;
    LogWarning(name + ": " + (finding.clip.empty() ? "" : finding.clip + ": ") + finding.message);
  }
  return StageInput{"motions", name, read->artifact, read->sha256};
}

}  // namespace mocurate
