#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "canon/options.h"
#include "canon/recipes/classes.h"
#include "core/base/config.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "job/named_configs.h"
#include "job/run_folder.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"
#include "report/options.h"
#include "report/stages.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// The labels of "walk,run". Error kUsage for an empty or repeated one.
Expected<std::vector<std::string>> ListedLabels(const std::string& list) {
  std::vector<std::string> labels;
  std::set<std::string> seen;
  for (const std::string_view part : SplitText(list, ',')) {
    const std::string label(Trim(part));
    if (label.empty())
      return Fail(ErrorCode::kUsage, "a label is empty", "--labels '" + list + "'", "write e.g. --labels walk,run");
    if (!seen.insert(label).second) {
      return Fail(ErrorCode::kUsage, "the label '" + label + "' is given twice", "--labels '" + list + "'",
                  "give each label once");
    }
    labels.push_back(label);
  }
  return labels;
}

/// The names of `assemble.classes`. Errors of LoadNamed and CheckClasses; kConfig without classes.
Expected<std::vector<std::string>> LabelsOfRecipe(const std::string& name, const ConfigRules& rules) {
  const auto recipe = LoadNamed("recipes/", "recipe", name, {}, rules);
  if (!recipe) return Forward(recipe);
  AssembleOptions options;
  if (const ConfigNode* assemble = recipe->Find("assemble")) {
    auto read = OptionsFromConfig<AssembleOptions>(*assemble);
    if (!read) return Forward(read);
    options = std::move(*read);
  }
  if (Status sound = CheckClasses(options); !sound) return Forward(sound);
  std::vector<std::string> labels;
  for (const ClassOptions& listed : options.classes) labels.push_back(listed.name);
  if (labels.empty()) {
    return Fail(ErrorCode::kConfig, "assemble.classes lists no class", name, "name a recipe with classes, or --labels");
  }
  return labels;
}

void PrintPage(const ReviewArguments& arguments, const nlohmann::json& summary) {
  const auto count = [&](const char* key, const char* noun) { return Counted(summary.value(key, 0LL), noun); };
  Print("%s: %s, %s, %s; open it in a browser, mark spans, save spans.csv\n", DisplayPath(arguments.output).c_str(),
        count("clips", "clip").c_str(), count("spans", "span").c_str(), count("labels", "label").c_str());
  if (summary.value("not_shown", 0) > 0) {
    Print("%s of clips that are not shown will be saved unchanged\n", count("not_shown", "span").c_str());
  }
  if (summary.value("excluded", 0) > 0) {
    Print("%s in frames of clips that are not shown will not be saved, as their rate is unknown\n",
          count("excluded", "span").c_str());
  }
}

}  // namespace

Status AnnotateVerb(CommonArguments& common, const ReviewArguments& arguments) {
  AnnotateOptions options;
  options.clips = arguments.clips;
  options.all = arguments.all;
  if (arguments.labels || !arguments.recipe.empty()) {
    auto labels =
        arguments.labels ? ListedLabels(*arguments.labels) : LabelsOfRecipe(arguments.recipe, {common.allow_include});
    if (!labels) return Forward(labels);
    options.labels = std::move(*labels);
  }
  if (Status sound = CheckIsDataset(arguments.path); !sound) return sound;
  if (Status free = CheckOutputs({arguments.output}, {arguments.path, arguments.spans}, arguments.force); !free) {
    return free;
  }
  auto stages = VerbStages::Make(common);
  if (!stages) return Forward(stages);
  ItemSpec item{"annotate", OptionsToJson(options), {{"dataset", DisplayPath(arguments.path), arguments.path, ""}}};
  if (!arguments.spans.empty()) {
    item.inputs.push_back({"spans", DisplayPath(arguments.spans), arguments.spans, ""});
  }
  const auto page = (*stages)->One(AnnotateDeclaration(), std::move(item));
  if (!page) return Forward(page);
  if (Status copied = CopyWhole(page->artifact, arguments.output); !copied) return copied;
  nlohmann::json answer = page->summary;
  answer["page"] = DisplayPath(arguments.output);
  if (AnswersInText(common, answer)) PrintPage(arguments, page->summary);
  return {};
}

}  // namespace mocurate
