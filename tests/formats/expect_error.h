#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/base/error.h"

namespace mocurate {

/// The error alone of a result, where its value does not matter.
template <class T>
Status StatusOf(const Expected<T>& result) {
  return result ? Status() : Status(Forward(result));
}

/// Expects an error of this code at exactly this place: "file:12", "file.json:/key". `file` and `line` are of the call.
template <class T>
void ExpectError(const Expected<T>& result, ErrorCode code, const std::string& where,
                 const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  const ::testing::ScopedTrace call(file, line, result ? "no error" : result.error().Message());
  ASSERT_FALSE(result) << "an error at " << where << " is expected";
  EXPECT_EQ(Name(result.error().code), Name(code));
  EXPECT_EQ(result.error().where, where);
}

template <class T>
void ExpectMalformed(const Expected<T>& result, const std::string& where, const char* file = __builtin_FILE(),
                     int line = __builtin_LINE()) {
  ExpectError(result, ErrorCode::kMalformed, where, file, line);
}

}  // namespace mocurate
