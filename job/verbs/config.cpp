#include <nlohmann/json.hpp>

#include "core/base/log.h"
#include "core/base/terminal.h"
#include "ingest/synthetic/studio_options.h"
#include "job/config_loading.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

/// The same tree as the options, with origins instead of values.
nlohmann::json OriginsOf(const nlohmann::json& options, const ConfigNode* node) {
  if (options.is_object() && !options.empty()) {
    nlohmann::json origins = nlohmann::json::object();
    for (const auto& [name, value] : options.items()) {
      origins[name] = OriginsOf(value, node == nullptr ? nullptr : node->Find(name));
    }
    return origins;
  }
  const bool groups = options.is_array() && !options.empty() && options.front().is_object();
  if (groups && node != nullptr && node->sequence.size() == options.size()) {
    nlohmann::json origins = nlohmann::json::array();
    for (std::size_t i = 0; i < options.size(); ++i) origins.push_back(OriginsOf(options[i], &node->sequence[i]));
    return origins;
  }
  return node == nullptr || node->origin.file.empty() ? "default" : node->origin.Text();
}

/// Names the values that a run refuses.
void WarnOfUnset(const ConfigNode& node) {
  if (node.unset) {
    LogWarning(node.origin.Text() + ": '" + node.scalar +
               "' names an environment variable that is not set, and is shown unresolved; a run refuses it");
  }
  for (const ConfigNode& child : node.sequence) WarnOfUnset(child);
  for (const auto& entry : node.mapping) WarnOfUnset(entry.second);
}

}  // namespace

Status ShowConfigVerb(CommonArguments& common, const ConfigArguments& arguments) {
  const auto job = LoadJob(arguments.config, arguments.assignments, {common.allow_include, UnsetVariables::kKeep});
  if (!job) return Forward(job);
  WarnOfUnset(job->node);
  const nlohmann::json options = OptionsToJson(job->options);
  if (common.json && arguments.origins)
    PrintJson({{"options", options}, {"origins", OriginsOf(options, &job->node)}});
  else if (common.json)
    PrintJson(options);
  else
    Print("%s", ShowOptions(job->options, job->node, arguments.origins).c_str());
  return {};
}

Status ConfigSchemaVerb(CommonArguments&) {
  PrintJson(OptionsSchema<JobOptions>());
  return {};
}

Status ConfigReferenceVerb(CommonArguments& common) {
  const std::string reference = OptionsReference<JobOptions>("Options of a job") + "\n" +
                                OptionsReference<StudioOptions>("Options of `mocurate synthesize`");
  if (common.json)
    PrintJson({{"markdown", reference}});
  else
    Print("%s", reference.c_str());
  return {};
}

}  // namespace mocurate
