#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace mocurate {

/// A path to keep: std::filesystem::path also keeps its parts, some 600 bytes.
class PathText {
 public:
  PathText() = default;
  PathText(const std::filesystem::path& path) : text_(path.native()) {}
  PathText(std::string path) : text_(std::move(path)) {}
  PathText(const char* path) : text_(path) {}

  operator std::filesystem::path() const { return text_; }
  const std::string& native() const { return text_; }
  bool empty() const { return text_.empty(); }
  void clear() { text_.clear(); }

 private:
  std::string text_;
};

inline bool operator==(const PathText& a, const PathText& b) { return a.native() == b.native(); }

}  // namespace mocurate
