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

/// The bytes of a recorded file; the test is skipped by the caller when empty.
inline std::string RecordedFile(const std::string& path) {
  const char* folder = std::getenv("MOCURATE_DATA");
  if (folder == nullptr) return {};
  const auto bytes = ReadFile(std::filesystem::path(folder) / path);
  return bytes ? *bytes : std::string();
}

#define MOCURATE_RECORDED(variable, path)                            \
  const std::string variable = ::mocurate::test::RecordedFile(path); \
  if (variable.empty()) GTEST_SKIP() << "MOCURATE_DATA has no " << (path)

/// Replaces each number, text and boolean of a JSON document in turn by an object and then takes its key away: every
/// time the error must be at its place, or at that of its parent. `optional` says which paths need not be there.
inline void EachFieldIsRefusedWhenDamaged(const nlohmann::json& document,
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
    Status refused = read(damaged.dump());
    ASSERT_FALSE(refused) << leaf.key() << " damaged";
    EXPECT_THAT(refused.error().where, ::testing::HasSubstr(leaf.key()));
    damaged = document;
    nlohmann::json& parent = damaged[place.parent_pointer()];
    if (parent.is_array()) {
      parent.erase(parent.begin());
    } else {
      parent.erase(place.back());
    }
    refused = read(damaged.dump());
    ASSERT_FALSE(refused) << leaf.key() << " taken away";
    EXPECT_THAT(refused.error().where, ::testing::HasSubstr(place.parent_pointer().to_string()));
  }
}

}  // namespace mocurate::test
