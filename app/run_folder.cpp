#include "app/run_folder.h"

#include <algorithm>

#include "app/run_file.h"
#include "app/run_outputs.h"
#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// What a run leaves that ends before its run.json is there: a lock with the number of a process, an empty journal.
bool IsBeginning(const fs::path& folder, const std::string& name) {
  if (name != "lock" && name != "journal.jsonl") return false;
  std::error_code unknown;
  if (!fs::is_regular_file(folder / name, unknown) || fs::file_size(folder / name, unknown) > 32) return false;
  const auto text = ReadFile(folder / name);
  if (!text) return false;
  const std::string_view held = Trim(*text);
  const bool digits = std::all_of(held.begin(), held.end(), [](char c) { return c >= '0' && c <= '9'; });
  return name == "lock" ? digits : held.empty();
}

}  // namespace

Expected<fs::path> RunFolder(const std::optional<fs::path>& named, const std::string& name) {
  if (named && named->empty()) {
    return Fail(ErrorCode::kUsage, "the run folder is empty text", "-o",
                "name a folder; -o . is the one you are in, without -o it is runs/NAME");
  }
  if (named) return *named;
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos) {
    return Fail(ErrorCode::kConfig, "'" + name + "' cannot be the name of a folder below runs/", "name",
                "choose a name without '/', or name the run folder with -o DIR");
  }
  return fs::path("runs") / name;
}

Status CheckRunFolder(const fs::path& folder) {
  if (ReadRunFile(folder).is_object()) return {};
  for (const std::string& name : RunFilesIn(folder)) {
    if (IsBeginning(folder, name)) continue;
    return Fail(ErrorCode::kUsage,
                "the folder is not one of a run (it holds no run.json of mocurate), and this file bears the name of an "
                "output: it would be lost",
                DisplayPath(folder / name), "choose another folder with -o, an empty one or one that does not exist");
  }
  return {};
}

}  // namespace mocurate
