#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/file.h"

namespace mocurate::test {

/// The bytes of a recorded file; empty when it is absent, then the caller skips the test.
inline std::string RecordedFile(const std::string& path) {
  const char* folder = std::getenv("MOCURATE_DATA");
  if (folder == nullptr) return {};
  const auto bytes = ReadFile(std::filesystem::path(folder) / path);
  return bytes ? *bytes : std::string();
}

#define MOCURATE_RECORDED(variable, path)                            \
  const std::string variable = ::mocurate::test::RecordedFile(path); \
  if (variable.empty()) GTEST_SKIP() << "MOCURATE_DATA has no " << (path)

/// Replaces each number, text and boolean of a JSON document by an object, then removes its key. Each time the error
/// must state its place or that of its parent. `optional` selects paths that may be absent.
inline void ExpectEveryDamagedFieldIsRejected(const nlohmann::json& document,
                                              const std::function<Status(const std::string& bytes)>& read,
                                              const std::function<bool(const std::string& path)>& optional = {}) {
  ASSERT_TRUE(read(document.dump())) << read(document.dump()).error().Message();
  const nlohmann::json flat = document.flatten();
  for (const auto& leaf : flat.items()) {
    const nlohmann::json::json_pointer place(leaf.key());
    if (!leaf.value().is_primitive() || leaf.value().is_null()) continue;
    if (optional && optional(leaf.key())) continue;
    nlohmann::json damaged = document;
    damaged[place] = nlohmann::json::object();
    Status status = read(damaged.dump());
    ASSERT_FALSE(status) << leaf.key() << " damaged";
    EXPECT_THAT(status.error().where, ::testing::HasSubstr(leaf.key()));
    damaged = document;
    nlohmann::json& parent = damaged[place.parent_pointer()];
    if (parent.is_array()) {
      parent.erase(parent.begin());
    } else {
      parent.erase(place.back());
    }
    status = read(damaged.dump());
    ASSERT_FALSE(status) << leaf.key() << " removed";
    EXPECT_THAT(status.error().where, ::testing::HasSubstr(place.parent_pointer().to_string()));
  }
}

}  // namespace mocurate::test
