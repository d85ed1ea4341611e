#include "job/verbs/generate.h"

#include <algorithm>
#include <filesystem>

#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/resources.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr long long kMostScriptFrames = 100000;

Expected<ScriptOptions> OptionsOfNode(const Expected<ConfigNode>& node, const std::string& text) {
  if (!node) return Forward(node);
  auto script = OptionsFromConfig<ScriptOptions>(*node);
  if (!script) return Forward(script);
  if (!script->actions.empty()) return script;
  return Fail(ErrorCode::kUsage, "the script has no action", text, "actions: [{action: throw}, {action: catch}]");
}

}  // namespace

void ScriptActionOptions::Declare(OptionVisitor& v) {
  v.Text("action", action, "name of a class of the network");
  v.Integer("frames", frames, {0.0, static_cast<double>(kMostScriptFrames)},
            "frames of the action; 0: the usual number");
  v.Integer("transition_frames", transition_frames, {0.0, static_cast<double>(kMostScriptFrames)},
            "frames of the transition before it; 0: the usual number");
}

void ScriptOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the script");
  v.Text("description", description, "description of the motion");
  v.List("actions", actions, "actions, in order");
}

Expected<ScriptOptions> ReadScript(const std::string& text) {
  const std::string resource = "scripts/" + text + ".yaml";
  if (const auto found = FindResource(resource)) {
    return OptionsOfNode(LoadData(ConfigSource{std::string(*found), "resource:" + resource, {}}), text);
  }
  const std::filesystem::path file(text);
  if (file.extension() == ".yaml" || file.extension() == ".yml") return OptionsOfNode(LoadData(file), text);
  ScriptOptions script;
  for (const std::string_view part : SplitText(text, ',')) {
    const std::size_t colon = part.rfind(':');
    ScriptActionOptions action;
    action.action = std::string(Trim(part.substr(0, colon)));
    if (colon != std::string_view::npos) {
      const auto frames = ParseInteger(std::string(Trim(part.substr(colon + 1))));
      if (!frames || *frames < 1 || *frames > kMostScriptFrames) {
        return Fail(ErrorCode::kUsage, "'" + std::string(part.substr(colon + 1)) + "' is not a number of frames",
                    "--script", "ACTION or ACTION:FRAMES, e.g. throw,catch:30,throw");
      }
      action.frames = *frames;
    }
    if (action.action.empty()) {
      return Fail(ErrorCode::kUsage, "'" + text + "' has an empty action", "--script", "e.g. throw,catch:30,throw");
    }
    script.actions.push_back(std::move(action));
  }
  return script;
}

Expected<int> RequestedClass(const std::string& text, const std::vector<std::string>& labels,
                             const std::string& where) {
  const auto found = std::find(labels.begin(), labels.end(), text);
  if (found != labels.end()) return static_cast<int>(found - labels.begin());
  const auto index = ParseInteger(text);
  if (index && *index >= 0 && *index < static_cast<long long>(labels.size())) return static_cast<int>(*index);
  return Fail(ErrorCode::kUsage, "the network has no class '" + text + "'", where,
              NearestOfAll(text, labels, "it has: "));
}

Expected<std::vector<ScriptStep>> StepsOf(const ScriptOptions& script, const Checkpoint& network, bool continues) {
  const nlohmann::json usual = network.facts.value("part_frames", nlohmann::json::array());
  std::vector<ScriptStep> steps;
  for (std::size_t k = 0; k < script.actions.size(); ++k) {
    const ScriptActionOptions& action = script.actions[k];
    const std::string where = "--script, action " + std::to_string(k + 1);
    const auto label = RequestedClass(action.action, network.labels, where);
    if (!label) return Forward(label);
    ScriptStep step;
    step.label = *label;
    const auto at = static_cast<std::size_t>(step.label);
    const auto known = [&](std::size_t column) {
      const bool there =
          at < usual.size() && usual[at].is_array() && usual[at].size() == 2 && usual[at][column].is_number_integer();
      const auto count = there ? usual[at][column].get<std::int64_t>() : 0;
      return count > 0 && count <= kMostScriptFrames ? static_cast<int>(count) : 0;
    };
    step.transition_frames = action.transition_frames > 0 ? static_cast<int>(action.transition_frames) : known(0);
    step.frames = action.frames > 0 ? static_cast<int>(action.frames) : known(1);
    if (step.frames < 1 || ((k > 0 || continues) && step.transition_frames < 1)) {
      return Fail(
          ErrorCode::kUsage, "the durations of '" + action.action + "' and its transition are unknown", where,
          "write ACTION:FRAMES and --transition-frames N, as the network was not trained on samples of two actions");
    }
    steps.push_back(step);
  }
  return steps;
}

}  // namespace mocurate
