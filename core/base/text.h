#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mocurate {

/// Numbers independent of the locale. Empty when `text` is not wholly a number; "nan" and "inf" are numbers here, the
/// caller decides whether they are allowed.
std::optional<double> ParseDouble(std::string_view text);
std::optional<long long> ParseInteger(std::string_view text);

/// Fewest digits that read back as the same double ("0.1", "30", "100000", "1e-06"); whole numbers below 1e15 without
/// an exponent.
std::string FormatDouble(double value);

/// A number to be read by people, rounded to `digits` significant digits: 0.30000000000000004 -> "0.3".
std::string RoundedText(double value, int digits = 4);

/// "007" for 7 and width 3; longer numbers keep their digits.
std::string ZeroPadded(int number, int width);

/// A count with its noun in English: "1 clip", "2 clips", "0 clips".
std::string Counted(long long count, std::string_view noun);

std::string_view Trim(std::string_view text);
/// Without the mark that some programs put before UTF-8.
std::string_view WithoutByteOrderMark(std::string_view text);
bool EndsWith(std::string_view text, std::string_view end);
std::vector<std::string_view> SplitText(std::string_view text, char separator);
/// Fields between runs of blanks and tabs.
std::vector<std::string_view> SplitBlanks(std::string_view text);

/// The entry of `known` nearest to `word`, for "did you mean": one that differs in case and in zeros before numbers
/// only
/// ("P1", "p01"), else by edit distance, at most a third of the word's length.
std::optional<std::string> Nearest(std::string_view word, const std::vector<std::string>& known);

/// "a, b, c".
std::string JoinTexts(const std::vector<std::string>& texts, std::string_view separator = ", ");

/// Hint for an unknown word: "did you mean 'x'?" where an entry of `known` is near, else `otherwise`.
std::string DidYouMean(std::string_view word, const std::vector<std::string>& known, const std::string& otherwise);
/// The same, followed by all that is known: "did you mean 'x'? the stages are: x, y".
std::string NearestOfAll(std::string_view word, const std::vector<std::string>& known, const std::string& are);

enum class CharacterKind {
  kPlain,
  kControl,    ///< C0, delete, C1: a terminal obeys them
  kDirection,  ///< Unicode's Bidi_Control: reorders the characters around it
  kNotUtf8,    ///< one byte that begins no character of UTF-8
};

struct Character {
  std::size_t bytes = 1;
  CharacterKind kind = CharacterKind::kPlain;
};

/// The first character of `text`, which is not empty.
Character FirstCharacter(std::string_view text);

/// "\xNN"
std::string EscapedByte(char byte);
/// Value of a hexadecimal digit; -1 for another character.
int HexDigit(char digit);

/// `text` with '_' for each control character and byte that is not UTF-8.
std::string WithoutControls(std::string_view text);

}  // namespace mocurate
