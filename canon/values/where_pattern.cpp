#include <algorithm>

#include "canon/values/where_nodes.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

// glibc copies what + and {counts} repeat, and stores for each copy its successors: without a limit, 60 bytes of
// pattern use gigabytes.
constexpr std::size_t kLongestPattern = 128;  // bytes
constexpr double kMostCopies = 64.0;

/// Maximum copies of a part of a pattern by nested + and {counts}; empty for back references.
std::optional<double> CopiesOf(const std::string& pattern) {
  double copies = 1.0;
  for (std::size_t at = 0; at < pattern.size(); ++at) {
    if (pattern[at] == '\\') {
      ++at;
      if (at < pattern.size() && pattern[at] >= '1' && pattern[at] <= '9') return std::nullopt;
    } else if (pattern[at] == '+') {
      copies *= 2.0;
    } else if (pattern[at] == '{') {
      double most = 0.0, count = 0.0;
      for (++at; at < pattern.size() && pattern[at] != '}'; ++at) {
        const char c = pattern[at];
        count = c >= '0' && c <= '9' ? 10.0 * count + (c - '0') : 0.0;
        most = std::max(most, count);
      }
      copies *= most + 1.0;
    }
  }
  return copies;
}

}  // namespace

Expected<std::shared_ptr<const regex_t>> CompilePattern(const std::string& text) {
  const auto copies = CopiesOf(text);
  if (!copies) return Fail(ErrorCode::kUsage, "a regular expression with back references is refused");
  if (text.size() > kLongestPattern || !(*copies <= kMostCopies)) {
    return Fail(ErrorCode::kUsage,
                "the regular expression is too large: " + std::to_string(text.size()) + " bytes of at most " +
                    std::to_string(kLongestPattern) + ", + and {counts} make " + RoundedText(*copies) +
                    " copies of at most " + RoundedText(kMostCopies),
                "use * instead of +, or join two tests by 'and'");
  }
  auto pattern = std::make_unique<regex_t>();
  if (const int failed = ::regcomp(pattern.get(), text.c_str(), REG_EXTENDED | REG_NOSUB); failed != 0) {
    char reason[200] = {};
    ::regerror(failed, pattern.get(), reason, sizeof reason);
    return Fail(ErrorCode::kUsage, "'" + text + "' is not a regular expression: " + reason,
                "POSIX extended: . [a-z] * + ? {2,3} ( | ) ^ $");
  }
  return std::shared_ptr<const regex_t>(pattern.release(), [](const regex_t* compiled) {
    ::regfree(const_cast<regex_t*>(compiled));
    delete compiled;
  });
}

}  // namespace mocurate
