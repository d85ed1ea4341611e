#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"

namespace mocurate {

/// A path below $MOCURATE_DATA; empty when the variable is unset or the path does not exist.
inline std::filesystem::path RecordedData(const std::string& below) {
  const char* data = std::getenv("MOCURATE_DATA");
  const std::filesystem::path path = std::filesystem::path(data != nullptr ? data : "") / below;
  return data != nullptr && std::filesystem::exists(path) ? path : std::filesystem::path();
}

/// Files of a folder with this ending, sorted.
inline std::vector<std::filesystem::path> FilesEndingIn(const std::filesystem::path& folder,
                                                        const std::string& ending) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool ends = name.size() >= ending.size() && name.substr(name.size() - ending.size()) == ending;
    if (ends) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

inline std::string Bytes(const std::filesystem::path& path) { return ReadFile(path).value(); }

inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  if (at != std::string::npos) text.replace(at, from.size(), to);
  return text;
}

/// Words that may have any value, such as names and remarks.
using FreeWord = std::function<bool(std::string_view line, std::string_view word)>;

/// Replaces each word of a small file by each of `damages`. Every time `read` must fail with the place "file:LINE" of
/// that word.
inline void ExpectEveryDamagedWordIsNamed(const std::string& text,
                                          const std::function<Status(const std::string&)>& read, const FreeWord& free,
                                          const std::string& separators = " \t\n,",
                                          const std::vector<const char*>& damages = {"x?", "nan"}) {
  ASSERT_TRUE(read(text)) << read(text).error().Message();
  int line = 1, words = 0;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == '\n') ++line;
    if (separators.find(text[at]) != std::string::npos) {
      ++at;
      continue;
    }
    const std::size_t end = std::min(text.find_first_of(separators, at), text.size());
    const std::string word = text.substr(at, end - at);
    const std::size_t begin_of_line = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
    const std::string whole = text.substr(begin_of_line, text.find('\n', at) - begin_of_line);
    for (const char* damage : damages) {
      if (free && free(whole, word)) continue;
      ++words;
      const Status answer = read(text.substr(0, at) + damage + text.substr(end));
      ASSERT_FALSE(answer) << "'" << word << "' of line " << line << " as " << damage << " is accepted";
      const std::string place = answer.error().where + ":";
      EXPECT_NE(place.find(":" + std::to_string(line) + ":"), std::string::npos)
          << "'" << word << "' of line " << line << " as " << damage << ": " << answer.error().Message();
    }
    at = end;
  }
  EXPECT_GT(words, 10);
}

}  // namespace mocurate
