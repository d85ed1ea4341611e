#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/base/error.h"

namespace mocurate {

/// Lists and objects of JSON inside one another, at most: copying and writing a value recurse. Files of this program
/// and of the known formats have less than 20.
constexpr int kDeepestJson = 200;

/// The program's reader of JSON; tests/layers refuses any other. `name` is the file's in messages. Error kMalformed at
/// "name:line:column" for what is not JSON, for a number out of range, and beyond kDeepestJson.
Expected<nlohmann::json> ParseJson(std::string_view text, const std::string& name);
/// The same with the keys in the order of the text.
Expected<nlohmann::ordered_json> ParseOrderedJson(std::string_view text, const std::string& name);
/// The same of a file. Errors of ReadFile as well.
Expected<nlohmann::json> ReadJson(const std::filesystem::path& file);

/// The first key that an object of a text that ParseJson reads has twice; only the value of one of them counts.
std::optional<std::string> RepeatedKey(std::string_view text);

namespace internal {
tl::unexpected<Error> WrongJson(const std::string& where, const nlohmann::json::exception& wrong);

template <class Value>
struct ExpectedOf {
  using Type = Expected<Value>;
};
template <class Value>
struct ExpectedOf<Expected<Value>> {
  using Type = Expected<Value>;
};
}  // namespace internal

/// The result of `read`, which takes JSON of a file apart with nlohmann's throwing accessors. Error kMalformed at
/// `where` for a value that is missing or has another type.
template <class Read>
auto GuardJson(const std::string& where, const Read& read) -> typename internal::ExpectedOf<decltype(read())>::Type {
  try {
    if constexpr (std::is_void_v<decltype(read())>) {
      read();
      return {};
    } else {
      return read();
    }
  } catch (const nlohmann::json::exception& wrong) {
    return internal::WrongJson(where, wrong);
  }
}

}  // namespace mocurate
