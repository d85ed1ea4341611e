#include "core/formats/line_reader.h"

#include <algorithm>
#include <utility>

#include "core/base/text.h"

namespace mocurate {

std::string Shown(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown;
  for (const char c : text.substr(0, kLongest)) shown += c == '\t' ? ' ' : (c >= ' ' && c < 127) ? c : '?';
  return text.size() > kLongest ? shown + "..." : shown;
}

bool SameWord(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [&](char x, char y) { return lower(x) == lower(y); });
}

LineReader::LineReader(std::string_view bytes, std::string name)
    : rest_(WithoutByteOrderMark(bytes)), name_(std::move(name)) {}

std::string_view LineReader::Next() {
  while (!rest_.empty()) {
    const std::size_t end = rest_.find_first_of("\r\n");
    const std::string_view line = Trim(rest_.substr(0, end));
    ++number_;
    if (end == std::string_view::npos) {
      rest_ = {};
    } else {
      const bool both = rest_[end] == '\r' && end + 1 < rest_.size() && rest_[end + 1] == '\n';
      rest_.remove_prefix(end + (both ? 2 : 1));
    }
    if (!line.empty()) return line;
  }
  return {};
}

std::string_view LineReader::Peek() const { return LineReader(*this).Next(); }

tl::unexpected<Error> LineReader::Bad(std::string what, std::string hint) const {
  return Fail(ErrorCode::kMalformed, std::move(what), Place(), std::move(hint));
}

tl::unexpected<Error> LineReader::CutOff(const std::string& wanted) const {
  return Bad("the file ends where " + wanted + " is expected", "the file is cut off: copy it again");
}

}  // namespace mocurate
