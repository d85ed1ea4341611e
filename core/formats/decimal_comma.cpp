#include "core/formats/decimal_comma.h"

#include <algorithm>
#include <vector>

#include "core/base/text.h"

namespace mocurate {

namespace {

struct DigitWords {
  int all = 0;
  int commas = 0;  ///< that have one
};

/// "E-05" of "1,2E-05"; empty without an exponent.
std::string_view ExponentOf(std::string_view word) {
  const std::size_t e = word.find_first_of("eE");
  if (e == std::string_view::npos) return {};
  const std::size_t digits = word.find_first_of("0123456789", e);
  const bool is = digits != std::string_view::npos && digits <= e + 2 &&
                  word.find_first_not_of("0123456789", digits) == std::string_view::npos &&
                  (digits == e + 1 || word[e + 1] == '-' || word[e + 1] == '+');
  return is ? word.substr(e) : std::string_view();
}

/// Empty where a word is not a number, or has more than one comma.
std::optional<DigitWords> DigitWordsOf(std::string_view line) {
  std::string words(line);
  std::replace(words.begin(), words.end(), ';', ' ');
  DigitWords read;
  for (std::string_view word : SplitBlanks(Trim(words))) {
    if (word.empty()) continue;
    if (word[0] == '-' || word[0] == '+') word.remove_prefix(1);
    word.remove_suffix(ExponentOf(word).size());
    const std::size_t comma = word.find(',');
    const std::size_t other = word.find_first_not_of("0123456789,");
    if (other != std::string_view::npos || comma != word.rfind(',')) return std::nullopt;
    ++read.all;
    if (comma == std::string_view::npos) continue;
    if (comma == 0 || comma + 1 == word.size()) return std::nullopt;
    ++read.commas;
  }
  return read;
}

}  // namespace

bool HasDecimalCommas(std::string_view line) {
  const std::optional<DigitWords> words = DigitWordsOf(line);
  return words && words->commas > 0;
}

std::optional<std::string> WithDecimalPoints(std::string_view bytes) {
  constexpr int kRows = 8;
  if (bytes.find(',') == std::string_view::npos) return std::nullopt;
  int rows = 0, commas = 0;
  for (std::string_view rest = bytes; !rest.empty() && rows < kRows;) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = Trim(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    const std::optional<DigitWords> words = DigitWordsOf(line);
    if (!words) {
      if (rows > 0 || line.find_first_of("0123456789+-,") == 0) return std::nullopt;
      continue;  // a header
    }
    if (words->commas == 0) continue;
    if (words->all < 2) return std::nullopt;  // "1,2": two whole numbers as well
    ++rows;
    commas += words->commas;
  }
  if (commas < 2) return std::nullopt;
  std::string points(bytes);
  std::replace(points.begin(), points.end(), ',', '.');
  std::replace(points.begin(), points.end(), ';', ' ');
  return points;
}

}  // namespace mocurate
