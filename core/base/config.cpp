#include "core/base/config.h"

#include "core/base/config_parts.h"
#include "core/base/file.h"

namespace mocurate {

std::string Origin::Text() const {
  if (line == 0) return file;
  return file + ":" + std::to_string(line) + ":" + std::to_string(column);
}

const ConfigNode* ConfigNode::Find(const std::string& key) const {
  for (const auto& [name, value] : mapping) {
    if (name == key) return &value;
  }
  return nullptr;
}

namespace internal {

std::size_t CountOf(const ConfigNode& node) {
  std::size_t count = 1;
  for (const ConfigNode& child : node.sequence) count += CountOf(child);
  for (const auto& entry : node.mapping) count += CountOf(entry.second);
  return count;
}

std::size_t TextBytesOf(const ConfigNode& node) {
  std::size_t bytes = node.scalar.size();
  for (const ConfigNode& child : node.sequence) bytes += TextBytesOf(child);
  for (const auto& [key, value] : node.mapping) bytes += key.size() + TextBytesOf(value);
  return bytes;
}

std::string Quoted(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  const std::string shown = DisplayPath(std::string(text.substr(0, kLongest)));
  return "'" + shown + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace internal
}  // namespace mocurate
