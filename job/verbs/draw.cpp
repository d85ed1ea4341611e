#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/pi.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "job/config_loading.h"
#include "job/motion_files.h"
#include "job/run_folder.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"
#include "report/options.h"
#include "report/stages.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// Degrees of "front", "side", "three-quarter" or "AZIMUTH,ELEVATION". Error kUsage.
Expected<std::pair<double, double>> PictureViewOf(const std::string& text) {
  if (text == "front") return std::pair(0.0, 0.0);
  if (text == "side") return std::pair(90.0, 0.0);
  if (text == "three-quarter") return std::pair(45.0, 0.0);
  const std::size_t comma = text.find(',');
  const auto azimuth = ParseDouble(std::string_view(text).substr(0, comma));
  const auto elevation =
      comma == std::string::npos ? std::nullopt : ParseDouble(std::string_view(text).substr(comma + 1));
  if (!azimuth || !elevation || std::abs(*azimuth) > 360.0 || std::abs(*elevation) > 90.0) {
    return Fail(ErrorCode::kUsage, "'" + text + "' is no view", "--view",
                "give front, side, three-quarter, or degrees from the front and above the horizon: --view 30,15");
  }
  return std::pair(*azimuth, *elevation);
}

Expected<MotionPictureOptions> PictureOf(const DrawArguments& arguments) {
  const auto view = PictureViewOf(arguments.view);
  if (!view) return Forward(view);
  nlohmann::json json = OptionsToJson(MotionPictureOptions());
  json["azimuth"] = view->first * kPi / 180.0;
  json["elevation"] = view->second * kPi / 180.0;
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
  if (Status known = CheckTolerated(arguments.tolerate); !known) return known;
  const auto options = PictureOf(arguments);
  if (!options) return Forward(options);
  std::vector<fs::path> inputs;
  for (const std::string& text : arguments.motions) inputs.push_back(NamedPathOf(text).path);
  if (Status free = CheckOutputs({arguments.output}, inputs, arguments.force); !free) return free;
  auto stages = VerbStages::Make(common);
  if (!stages) return Forward(stages);
  ItemSpec item{"motions", OptionsToJson(*options), {}};
  for (const std::string& text : arguments.motions) {
    const NamedPath named = NamedPathOf(text);
    if (std::error_code unknown; !fs::exists(named.path, unknown)) {
      return Fail(ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(named.path),
                  "give FILE or NAME=FILE");
    }
    MotionFiles files{named.path, arguments.source, {}, {}};
    files.rules = {common.allow_include};
    files.tolerate = arguments.tolerate;
    auto motions =
        MotionsInput(named.name, files, {}, "declare them with --source FILE (docs/adding_a_source.md)", **stages);
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
  for (const nlohmann::json& row : drawn->summary.at("shown")) {
    if (const std::string why = row.at("absent"); !why.empty()) {
      LogWarning(row.at("source").get<std::string>() + ", " + row.at("label").get<std::string>() + ": " + why);
    }
  }
  const long long rows = drawn->summary.value("rows", 0LL);
  if (AnswersInText(common, {{"path", DisplayPath(arguments.output)}, {"rows", rows}})) {
    Print("%s in %s\n", Counted(rows, "motion").c_str(), DisplayPath(arguments.output).c_str());
  }
  return {};
}

}  // namespace mocurate
