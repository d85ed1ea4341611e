#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "ingest/inspect/inspect.h"
#include "ingest/inspect/source_declaration.h"
#include "job/verbs/output_checks.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

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

}  // namespace

Status InitConfigVerb(CommonArguments& common, const InitConfigArguments& arguments) {
  std::error_code unknown;
  if (!std::filesystem::exists(arguments.path, unknown)) {
    return Fail(ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(arguments.path));
  }
  if (Status free = CheckOutputs({arguments.output}, {arguments.path}, arguments.force); !free) return free;
  const Inspection inspection = InspectPath(arguments.path, std::nullopt);
  const std::string name = arguments.name.empty() ? NameFor(arguments.path) : arguments.name;
  const Expected<WrittenDeclaration> written = DeclareSource(inspection, arguments.path, name);
  if (!written) return Forward(written);
  if (!arguments.output.empty()) {
    if (Status saved = WriteFile(arguments.output, written->yaml); !saved) return saved;
  }
  std::string unknowns;
  for (const std::string& option : written->unknown) unknowns += (unknowns.empty() ? "" : ", ") + option;
  if (common.json) {
    PrintJson(
        {{"declaration", written->yaml}, {"unknown", written->unknown}, {"output", DisplayPath(arguments.output)}});
  } else if (arguments.output.empty()) {
    Print("%s", written->yaml.c_str());
  }
  if (!unknowns.empty()) LogWarning("fill in before a run: " + unknowns);
  return {};
}

}  // namespace mocurate
