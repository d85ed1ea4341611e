#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

namespace mocurate {

/// Classes of errors, by who can correct them. Each code maps to one exit code of the program.
enum class ErrorCode {
  kUsage,            ///< the command line is wrong
  kConfig,           ///< a configuration value, key or reference is wrong
  kNotFound,         ///< a named file, clip or object does not exist
  kUnreadable,       ///< a file exists but cannot be opened or read
  kMalformed,        ///< bytes do not follow their format
  kInconsistent,     ///< parts of the input contradict each other
  kUnsupported,      ///< valid, but outside what the program handles
  kMissingOnHost,    ///< a program, library or setting of this machine is missing
  kCannotWrite,      ///< output cannot be written (full disk, read-only folder)
  kInterrupted,      ///< stopped on request; run again to continue
  kTooManyFailures,  ///< done, but more items failed than the configuration tolerates
  kInternal,         ///< a broken invariant: a defect of mocurate
};

/// Exit codes of every mocurate program (documented in docs/concepts.md).
enum class ExitCode : int {
  kDone = 0,
  kTooManyFailures = 1,
  kUsage = 2,
  kInputUnusable = 3,
  kMissingOnHost = 4,
  kBug = 70,
  kCannotWrite = 74,
  kInterrupted = 75,
};

/// Cause of a failure, where code must distinguish more than the ErrorCode.
enum class Reason {
  kNone,
  kEmptyFile,       ///< no bytes, or only blanks
  kCount,           ///< a header count that differs from the data; `number` is the declared one
  kUnsafePickle,    ///< a pickle that names more than plain data
  kNoValidSamples,  ///< no joint is observed in any frame
  kPersonMissing,   ///< a file holds fewer people than are declared
  kOtherTree,       ///< joints that are not those of the declared skeleton
  kOtherLayout,     ///< numbers that are not what the declaration says
  kOtherRate,       ///< times of another rate than the declared one; `number` is it, Hz
  kViewNumbering,   ///< cameras that are numbered apart; `number` is the offset, frames
};

/// One failure: `what` names the value and the broken rule, `where` the place (file:line:column or dataset
/// path), `hint` the way out. What code has to know of it are `code`, `reason` and `number`: the texts are for people.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string what;
  std::string where;
  std::string hint;
  Reason reason = Reason::kNone;
  double number = 0.0;

  /// "where: what (hint)" on one line, without empty parts.
  std::string Message() const;
};

bool operator==(const Error& a, const Error& b);

template <class T>
using Expected = tl::expected<T, Error>;

using Status = Expected<void>;

/// `return Fail(ErrorCode::kMalformed, "12 columns, header announces 14", "clip.trc:8", "...");`
inline tl::unexpected<Error> Fail(ErrorCode code, std::string what, std::string where = {}, std::string hint = {},
                                  Reason reason = Reason::kNone, double number = 0.0) {
  return tl::unexpected<Error>(Error{code, std::move(what), std::move(where), std::move(hint), reason, number});
}

/// For a file without bytes, or with blanks only.
inline tl::unexpected<Error> EmptyFile(std::string name) {
  return Fail(ErrorCode::kMalformed, "the file is empty", std::move(name), "was it copied whole?", Reason::kEmptyFile);
}

/// Passes the error of another result on.
template <class T>
tl::unexpected<Error> Forward(const Expected<T>& failed) {
  return tl::unexpected<Error>(failed.error());
}

/// Stable text of a code, as in JSON ("malformed", "cannot_write", ...).
std::string_view Name(ErrorCode code);

/// Inverse of Name; kInternal for an unknown text.
ErrorCode ErrorCodeFromName(std::string_view name);

ExitCode ExitCodeOf(ErrorCode code);

}  // namespace mocurate
