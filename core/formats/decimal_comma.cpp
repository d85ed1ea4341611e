#include "core/formats/decimal_comma.h"

#include <algorithm>
#include <vector>

#include "core/base/text.h"

namespace mocurate {

bool HasDecimalCommas(std::string_view line) {
  std::string words(line);
  std::replace(words.begin(), words.end(), ';', ' ');
  bool any = false;
  for (std::string_view word : SplitBlanks(Trim(words))) {
    if (word.empty()) continue;
    if (word[0] == '-' || word[0] == '+') word.remove_prefix(1);
    const std::size_t comma = word.find(',');
    const std::size_t other = word.find_first_not_of("0123456789,");
    if (other != std::string_view::npos || comma != word.rfind(',')) return false;
    if (comma == std::string_view::npos) continue;
    if (comma == 0 || comma + 1 == word.size()) return false;
    any = true;
  }
  return any;
}

std::optional<std::string> WithDecimalPoints(std::string_view bytes) {
  constexpr int kRows = 8;
  int rows = 0;
  for (std::string_view rest = bytes; !rest.empty() && rows < kRows;) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = Trim(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (line.find_first_not_of("0123456789+-,; \t") != std::string_view::npos) {
      if (rows > 0 || line.find_first_of("0123456789") == 0) return std::nullopt;
      continue;  // a header
    }
    if (line.empty()) continue;
    if (!HasDecimalCommas(line) || std::count(line.begin(), line.end(), ',') < 2) return std::nullopt;
    ++rows;
  }
  if (rows == 0) return std::nullopt;
  std::string points(bytes);
  std::replace(points.begin(), points.end(), ',', '.');
  std::replace(points.begin(), points.end(), ';', ' ');
  return points;
}

}  // namespace mocurate
