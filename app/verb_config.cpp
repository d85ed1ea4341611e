#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/config_loading.h"
#include "app/verbs.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

Status ShowConfigVerb(CommonArguments& common, const ConfigArguments& arguments) {
  const auto job = LoadJob(arguments.config, arguments.assignments);
  if (!job) return Forward(job);
  if (common.json)
    std::printf("%s\n", OptionsToJson(job->options).dump(1).c_str());
  else
    std::printf("%s", ShowOptions(job->options, job->node, arguments.origins).c_str());
  return {};
}

Status ConfigSchemaVerb(CommonArguments&) {
  std::printf("%s\n", OptionsSchema<JobOptions>().dump(1).c_str());
  return {};
}

Status ConfigReferenceVerb(CommonArguments& common) {
  const std::string reference = OptionsReference<JobOptions>("Options of a job") + "\n" +
                                OptionsReference<StudioOptions>("Options of `mocurate synthesize`");
  if (common.json)
    std::printf("%s\n", nlohmann::json{{"markdown", reference}}.dump(1).c_str());
  else
    std::printf("%s", reference.c_str());
  return {};
}

}  // namespace mocurate
