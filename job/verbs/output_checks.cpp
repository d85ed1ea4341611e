#include "job/verbs/output_checks.h"

#include <algorithm>

#include "core/base/file.h"

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

}  // namespace mocurate
