#include "core/base/error.h"

#include <array>

namespace mocurate {
namespace {

struct CodeFacts {
  ErrorCode code;
  std::string_view name;
  ExitCode exit_code;
};

constexpr std::array<CodeFacts, 12> kCodes = {{
    {ErrorCode::kUsage, "usage", ExitCode::kUsage},
    {ErrorCode::kConfig, "config", ExitCode::kUsage},
    {ErrorCode::kNotFound, "not_found", ExitCode::kInputUnusable},
    {ErrorCode::kUnreadable, "unreadable", ExitCode::kInputUnusable},
    {ErrorCode::kMalformed, "malformed", ExitCode::kInputUnusable},
    {ErrorCode::kInconsistent, "inconsistent", ExitCode::kInputUnusable},
    {ErrorCode::kUnsupported, "unsupported", ExitCode::kInputUnusable},
    {ErrorCode::kMissingOnHost, "missing_on_host", ExitCode::kMissingOnHost},
    {ErrorCode::kCannotWrite, "cannot_write", ExitCode::kCannotWrite},
    {ErrorCode::kInterrupted, "interrupted", ExitCode::kInterrupted},
    {ErrorCode::kTooManyFailures, "too_many_failures", ExitCode::kTooManyFailures},
    {ErrorCode::kInternal, "internal", ExitCode::kBug},
}};

const CodeFacts& FactsOf(ErrorCode code) {
  for (const CodeFacts& facts : kCodes) {
    if (facts.code == code) return facts;
  }
  return kCodes.back();
}

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
  for (const CodeFacts& facts : kCodes) {
    if (facts.name == name) return facts.code;
  }
  return ErrorCode::kInternal;
}

ExitCode ExitCodeOf(ErrorCode code) { return FactsOf(code).exit_code; }

}  // namespace mocurate
