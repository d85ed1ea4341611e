#include "app/output_checks.h"

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

}  // namespace

Status CheckOutputs(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs, bool force) {
  std::error_code unknown;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    for (const fs::path& input : inputs) {
      if (SamePlace(outputs[i], input)) {
        return Fail(ErrorCode::kUsage, "what is read is not overwritten", DisplayPath(outputs[i]), "write a new file");
      }
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (SamePlace(outputs[i], outputs[k])) {
        return Fail(ErrorCode::kUsage, "two outputs are one file", DisplayPath(outputs[i]), "name two files");
      }
    }
    if (!force && fs::exists(outputs[i], unknown)) {
      return Fail(ErrorCode::kUsage, "the file exists", DisplayPath(outputs[i]), "--force overwrites it");
    }
  }
  return {};
}

}  // namespace mocurate
