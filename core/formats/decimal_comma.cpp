#include "core/formats/decimal_comma.h"

#include <algorithm>

#include "core/base/text.h"

namespace mocurate {
namespace {

/// Whether a line holds several words, between blanks, tabs or semicolons, of digits with at most one comma among them.
bool HasDecimalCommas(std::string_view line) {
  std::string words(line);
  std::replace(words.begin(), words.end(), ';', ' ');
  if (words.find('.') != std::string::npos) return false;
  int count = 0;
  for (const std::string_view word : SplitBlanks(Trim(words))) {
    const std::size_t comma = word.find(',');
    std::string number(word);
    if (comma != std::string_view::npos) {
      if (comma == 0 || comma + 1 == word.size() || word[comma + 1] < '0' || word[comma + 1] > '9') return false;
      number[comma] = '.';
    }
    if (!ParseDouble(number)) return false;
    ++count;
  }
  return count > 1;
}

}  // namespace

Expected<std::optional<std::string>> WithDecimalPoints(std::string_view bytes, const std::string& name) {
  for (std::size_t comma = bytes.find(','); comma != std::string_view::npos;) {
    const std::size_t begin = bytes.rfind('\n', comma) + 1;  // npos + 1 is 0
    const std::size_t end = std::min(bytes.find('\n', comma), bytes.size());
    const std::string_view line = Trim(bytes.substr(begin, end - begin));
    if (line.find_first_of("0123456789+-") != 0) {  // a header
      comma = bytes.find(',', end);
      continue;
    }
    if (!HasDecimalCommas(line)) break;
    if (line.find_first_of(";\t") == std::string_view::npos) {
      const auto number = std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(begin), '\n') + 1;
      return Fail(ErrorCode::kMalformed, "commas are in the numbers or between them: blanks separate them too",
                  name + ":" + std::to_string(number), "write the numbers with a decimal point (1.5, not 1,5)");
    }
    std::string points(bytes);
    std::replace(points.begin(), points.end(), ',', '.');
    std::replace(points.begin(), points.end(), ';', ' ');
    return std::optional(std::move(points));
  }
  return std::optional<std::string>();
}

}  // namespace mocurate
