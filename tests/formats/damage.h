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

/// The message of a failed parse; "parsed" when it did not fail.
using MessageOf = std::function<std::string(const std::string& bytes)>;

/// Replaces each word of a text file in turn: every one must be refused with its line.
inline void EachWordIsRefusedWhenDamaged(const std::string& text, const std::string& name,
                                         const MessageOf& message_of) {
  ASSERT_EQ(message_of(text), "parsed");
  int line = 1;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = text.find_first_not_of(" \n", at);
    if (begin == std::string::npos) break;
    for (; at < begin; ++at) line += text[at] == '\n' ? 1 : 0;
    const std::size_t end = std::min(text.find_first_of(" \n", begin), text.size());
    std::string damaged = text;
    damaged.replace(begin, end - begin, "1?");
    const std::string message = message_of(damaged);
    EXPECT_THAT(message, ::testing::HasSubstr(name)) << "line " << line << ": " << text.substr(begin, end - begin);
    at = end;
  }
}

/// Replaces each number, text and boolean of a JSON document in turn by an object and then takes its key away: every
/// time the message must name the place. `optional` says which paths need not be there.
inline void EachFieldIsRefusedWhenDamaged(const nlohmann::json& document, const MessageOf& message_of,
                                          const std::function<bool(const std::string& path)>& optional = {}) {
  ASSERT_EQ(message_of(document.dump()), "parsed");
  const nlohmann::json flat = document.flatten();
  for (const auto& leaf : flat.items()) {
    const nlohmann::json::json_pointer place(leaf.key());
    if (!leaf.value().is_primitive() || leaf.value().is_null()) continue;
    if (optional && optional(leaf.key())) continue;
    nlohmann::json damaged = document;
    damaged[place] = nlohmann::json::object();
    EXPECT_THAT(message_of(damaged.dump()), ::testing::HasSubstr(leaf.key()));
    damaged = document;
    nlohmann::json& parent = damaged[place.parent_pointer()];
    if (parent.is_array()) {
      parent.erase(parent.begin());
    } else {
      parent.erase(place.back());
    }
    const std::string message = message_of(damaged.dump());
    EXPECT_NE(message, "parsed") << leaf.key() << " taken away";
    EXPECT_THAT(message, ::testing::HasSubstr(place.parent_pointer().to_string()));
  }
}

}  // namespace mocurate::test
