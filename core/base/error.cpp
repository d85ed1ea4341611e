#include "core/base/error.h"

#include <algorithm>
#include <array>

namespace mocurate {
namespace {

struct CodeFacts {
  std::string_view name;
  ExitCode exit_code;
};

/// In the order of ErrorCode.
constexpr std::array<CodeFacts, 12> kCodes = {{
    {"usage", ExitCode::kUsage},
    {"config", ExitCode::kUsage},
    {"not_found", ExitCode::kInputUnusable},
    {"unreadable", ExitCode::kInputUnusable},
    {"malformed", ExitCode::kInputUnusable},
    {"inconsistent", ExitCode::kInputUnusable},
    {"unsupported", ExitCode::kInputUnusable},
    {"missing_on_host", ExitCode::kMissingOnHost},
    {"cannot_write", ExitCode::kCannotWrite},
    {"interrupted", ExitCode::kInterrupted},
    {"too_many_failures", ExitCode::kTooManyFailures},
    {"internal", ExitCode::kBug},
}};

const CodeFacts& FactsOf(ErrorCode code) { return kCodes.at(static_cast<std::size_t>(code)); }

}  // namespace

std::string Error::Message() const {
  std::string text;
  if (!where.empty()) text += where + ": ";
  text += what;
  if (!hint.empty()) text += " (" + hint + ")";
  return text;
}

bool operator==(const Error& a, const Error& b) {
  return a.code == b.code && a.reason == b.reason && a.number == b.number && a.what == b.what && a.where == b.where &&
         a.hint == b.hint;
}

std::string_view Name(ErrorCode code) { return FactsOf(code).name; }

ErrorCode ErrorCodeFromName(std::string_view name) {
  const auto* const found =
      std::find_if(kCodes.begin(), kCodes.end(), [&](const CodeFacts& facts) { return facts.name == name; });
  return found == kCodes.end() ? ErrorCode::kInternal : static_cast<ErrorCode>(found - kCodes.begin());
}

ExitCode ExitCodeOf(ErrorCode code) { return FactsOf(code).exit_code; }

}  // namespace mocurate
