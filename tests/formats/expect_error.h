#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/base/error.h"

namespace mocurate {

/// The error of a result, without its value.
template <class T>
Status StatusOf(const Expected<T>& result) {
  return result ? Status() : Status(Forward(result));
}

/// Expects an error of this code at exactly this place, e.g. "file:12" or "file.json:/key". `file` and `line` are
/// those of the caller.
template <class T>
void ExpectError(const Expected<T>& result, ErrorCode code, const std::string& where,
                 const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  const ::testing::ScopedTrace call(file, line, result ? "no error" : result.error().Message());
  ASSERT_FALSE(result) << "expected an error at " << where;
  EXPECT_EQ(Name(result.error().code), Name(code));
  EXPECT_EQ(result.error().where, where);
}

template <class T>
void ExpectMalformed(const Expected<T>& result, const std::string& where, const char* file = __builtin_FILE(),
                     int line = __builtin_LINE()) {
  ExpectError(result, ErrorCode::kMalformed, where, file, line);
}

}  // namespace mocurate
