#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "ingest/inspect/inspect.h"
#include "ingest/inspect/source_declaration.h"
#include "ingest/synthetic/studio_options.h"
#include "job/config_loading.h"
#include "job/motion_files.h"
#include "job/verbs/inputs_and_outputs.h"
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

/// A short name for ids, from the folder or the file: only letters, digits, '_' and '-'.
std::string NameFor(const std::filesystem::path& path) {
  std::error_code unknown;
  const std::filesystem::path whole = std::filesystem::absolute(path, unknown).lexically_normal();
  const std::filesystem::path last = whole.filename().empty() ? whole.parent_path().filename() : whole.filename();
  std::string name;
  for (const char c : DisplayPath(std::filesystem::is_directory(path, unknown) ? last : last.stem())) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    name += plain ? c : '_';
  }
  return name.empty() ? "source" : name;
}

Expected<WrittenDeclaration> Propose(const InitConfigArguments& arguments) {
  const std::string name = arguments.name.empty() ? NameFor(arguments.path) : arguments.name;
  return DeclareSource(InspectPath(arguments.path, std::nullopt), arguments.path, name);
}

/// The declaration that `mocurate export` wrote beside its files, with the path of their folder.
Expected<WrittenDeclaration> CopyDeclaration(const std::filesystem::path& file) {
  Expected<std::string> text = ReadFile(file);
  if (!text) return Forward(text);
  LogInfo("the declaration beside the files is taken, " + DisplayPath(file));
  std::error_code unknown;
  const std::string here = "  path: .\n", folder = DisplayPath(std::filesystem::absolute(file.parent_path(), unknown));
  const std::size_t at = text->find(here);
  if (at != std::string::npos) text->replace(at, here.size(), "  path: " + YamlQuoted(folder) + "\n");
  return WrittenDeclaration{*std::move(text), {}, {}};
}

}  // namespace

Status ShowConfigVerb(CommonArguments& common, const ConfigArguments& arguments) {
  const auto job = LoadJob(arguments.config, arguments.assignments, {common.allow_include, UnsetVariables::kKeep});
  if (!job) return Forward(job);
  WarnOfUnset(job->node);
  const nlohmann::json options = OptionsToJson(job->options);
  nlohmann::json answer = options;
  if (arguments.origins) answer = {{"options", options}, {"origins", OriginsOf(options, &job->node)}};
  if (AnswersInText(common, answer)) Print("%s", ShowOptions(job->options, job->node, arguments.origins).c_str());
  return {};
}

Status ConfigSchemaVerb(CommonArguments&) {
  PrintJson(OptionsSchema<JobOptions>());
  return {};
}

Status ConfigReferenceVerb(CommonArguments& common) {
  const std::string reference = OptionsReference<JobOptions>("Options of a job") + "\n" +
                                OptionsReference<StudioOptions>("Options of `mocurate synthesize`");
  if (AnswersInText(common, {{"markdown", reference}})) Print("%s", reference.c_str());
  return {};
}

Status InitConfigVerb(CommonArguments& common, const InitConfigArguments& arguments) {
  std::error_code unknown;
  if (!std::filesystem::exists(arguments.path, unknown)) {
    return Fail(ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(arguments.path));
  }
  if (Status free = CheckOutputs({arguments.output}, {arguments.path}, arguments.force); !free) return free;
  const auto beside = DeclarationBeside(arguments.path);
  const Expected<WrittenDeclaration> written = beside ? CopyDeclaration(*beside) : Propose(arguments);
  if (!written) return Forward(written);
  if (!arguments.output.empty()) {
    if (Status saved = WriteFile(arguments.output, written->yaml); !saved) return saved;
  }
  const nlohmann::json answer = {
      {"declaration", written->yaml}, {"unknown", written->unknown}, {"output", DisplayPath(arguments.output)}};
  if (AnswersInText(common, answer) && arguments.output.empty()) Print("%s", written->yaml.c_str());
  if (!written->others.empty()) LogWarning("not of this source: " + JoinTexts(written->others));
  if (!written->unknown.empty()) LogWarning("fill in before a run: " + JoinTexts(written->unknown));
  return {};
}

}  // namespace mocurate
