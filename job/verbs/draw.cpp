#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "job/config_loading.h"
#include "job/motion_files.h"
#include "job/run_folder.h"
#include "job/verbs/dataset_stages.h"
#include "job/verbs/output_checks.h"
#include "job/verbs/verbs.h"
#include "report/options.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// "NAME=PATH", or a path, whose file name is the name.
std::pair<std::string, fs::path> NamedPath(const std::string& text) {
  std::error_code unknown;
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || fs::exists(text, unknown)) {
    return {fs::path(text).stem().string(), text};
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

/// A set of motions as a dataset or MotionSet: one of mocurate unchanged, other files through the stage `motions`.
Expected<StageInput> MotionsOf(const std::string& text, const std::string& source, const ConfigRules& rules,
                               DatasetStages& stages) {
  const auto [name, path] = NamedPath(text);
  std::error_code unknown;
  if (!fs::exists(path, unknown)) {
    return Fail(ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(path), "give FILE or NAME=FILE");
  }
  if (IsMotionStore(path)) return StageInput{"motions", name, path, ""};
  if (source.empty() && AreBareArrays(path)) {
    return Fail(ErrorCode::kUsage, "bare arrays have neither joint names nor axes nor a unit", DisplayPath(path),
                "declare them with --source FILE (docs/adding_a_source.md)");
  }
  MotionFiles files{path, source, {}, {}};
  files.rules = rules;
  auto item = MakeMotionsItem(name, files, ExtractorOptions());
  if (!item) return Forward(item);
  const auto read = stages.One(MotionsDeclaration(), std::move(item->item));
  if (!read) return Forward(read);
  for (const RefusedClip& refused : item->unreadable) LogWarning(refused.error.Message());
  for (const Finding& finding : read->outcome.findings) {
    if (finding.severity != Severity::kInfo) LogWarning(name + ": " + finding.message);
  }
  return StageInput{"motions", name, read->artifact, read->sha256};
}

Expected<MotionPictureOptions> PictureOf(const DrawArguments& arguments) {
  nlohmann::json json = OptionsToJson(MotionPictureOptions());
  json["title"] = arguments.title;
  json["labels"] = arguments.labels;
  json["clips"] = arguments.clips;
  json["samples"] = arguments.samples;
  json["stills"] = arguments.stills;
  json["figure"] = arguments.figure;
  json["scale"] = arguments.scale;
  const std::string ending = arguments.output.extension().string();
  if (ending != ".mp4") json["format"] = ending == ".png" ? "png" : "svg";
  return OptionsFromJson<MotionPictureOptions>(json, "draw");
}

}  // namespace

Status DrawVerb(CommonArguments& common, const DrawArguments& arguments) {
  const std::string ending = arguments.output.extension().string();
  if (ending != ".svg" && ending != ".png" && ending != ".mp4") {
    return Fail(ErrorCode::kUsage, "the output is neither a picture (.svg, .png) nor a video (.mp4)",
                DisplayPath(arguments.output), "name e.g. -o motions.svg");
  }
  const auto options = PictureOf(arguments);
  if (!options) return Forward(options);
  std::vector<fs::path> inputs;
  for (const std::string& text : arguments.motions) inputs.push_back(NamedPath(text).second);
  if (Status free = CheckOutputs({arguments.output}, inputs, arguments.force); !free) return free;
  auto stages = DatasetStages::Make(common);
  if (!stages) return Forward(stages);
  ItemSpec item{"motions", OptionsToJson(*options), {}};
  for (const std::string& text : arguments.motions) {
    auto motions = MotionsOf(text, arguments.source, {common.allow_include}, **stages);
    if (!motions) return Forward(motions);
    item.inputs.push_back(std::move(*motions));
  }
  if (options->figure == FigureChoice::kSkin) {
    const fs::path body = arguments.body.empty() ? FindBody() : arguments.body;
    if (body.empty()) {
      return Fail(ErrorCode::kMissingOnHost, "no body is given, and none is below MOCURATE_WEIGHTS", "--body",
                  "give --body SMPL_NEUTRAL.pkl or body_cc0.h5; --figure capsules needs none");
    }
    item.inputs.push_back({"body", body.filename().string(), body, ""});
  }
  const StageDeclaration stage = ending == ".mp4" ? MotionVideoDeclaration() : MotionPictureDeclaration();
  const auto drawn = (*stages)->One(stage, std::move(item));
  if (!drawn) return Forward(drawn);
  if (const fs::path folder = arguments.output.parent_path(); !folder.empty()) {
    if (Status made = MakeFolder(folder); !made) return made;
  }
  if (Status copied = CopyWhole(drawn->artifact, arguments.output); !copied) return copied;
  for (const nlohmann::json& without : drawn->summary.value("without", nlohmann::json::array())) {
    LogWarning(without.get<std::string>() + " has no motion with the selected labels or clips");
  }
  const long long rows = drawn->summary.value("rows", 0LL);
  if (common.json) {
    common.answered = true;
    PrintJson({{"path", DisplayPath(arguments.output)}, {"rows", rows}});
  } else if (!common.quiet) {
    Print("%s in %s\n", Counted(rows, "motion").c_str(), DisplayPath(arguments.output).c_str());
  }
  return {};
}

}  // namespace mocurate
