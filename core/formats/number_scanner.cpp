#include "core/formats/number_scanner.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <system_error>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kPowersOfTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr int kLargestExactPower = 22;  // 5^22 < 2^53
constexpr std::uint64_t kLargestExactWhole = std::uint64_t{1} << 53;
constexpr std::ptrdiff_t kDigitsOfWhole = 19;  // fit 64 bits

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\f' || c == '\v'; }

inline bool IsDigit(const char* at, const char* end) { return at < end && static_cast<unsigned char>(*at - '0') < 10; }

/// Appends the digits at `at` to `whole`. Eight at a time where eight bytes can be loaded: how many of them are digits
/// comes from bit masks, which avoids mispredicted branches for numbers of varying length.
inline void Digits(const char*& at, const char* end, std::uint64_t& whole) {
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
  constexpr std::uint64_t kTens[] = {1, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 100000000};
  while (end - at >= 8) {
    std::uint64_t chunk = 0;
    std::memcpy(&chunk, at, sizeof(chunk));
    chunk ^= 0x3030303030303030u;                                                                // '0' becomes 0
    const std::uint64_t others = ((chunk + 0x7676767676767676u) | chunk) & 0x8080808080808080u;  // bytes above 9
    const int count = others == 0 ? 8 : __builtin_ctzll(others) / 8;
    if (count == 0) return;
    chunk <<= 64 - 8 * count;  // digits to the end, zeros before them
    chunk = chunk * 10 + (chunk >> 8);
    chunk = ((chunk & 0x000000FF000000FFu) * 0x000F424000000064u +
             ((chunk >> 16) & 0x000000FF000000FFu) * 0x0000271000000001u) >>
            32;
    whole = whole * kTens[count] + (chunk & 0xFFFFFFFFu);
    at += count;
    if (count < 8) return;
  }
#endif
  for (; IsDigit(at, end); ++at) whole = whole * 10 + static_cast<std::uint64_t>(*at - '0');
}

/// A decimal whose digits and power of ten are both exact doubles: one division or product rounds it correctly
/// (W. D. Clinger, "How to read floating point numbers accurately", 1990). Returns its end, or null where the general
/// parser must read it.
inline const char* ShortDecimal(const char* at, const char* end, double& value) {
  const bool negative = at < end && *at == '-';
  if (negative) ++at;
  std::uint64_t whole = 0;
  const char* begin = at;
  Digits(at, end, whole);
  std::ptrdiff_t digits = at - begin;
  int power = 0;
  if (at < end && *at == '.') {
    const char* fraction = ++at;
    Digits(at, end, whole);
    digits += at - fraction;
    power = -static_cast<int>(at - fraction);
  }
  if (digits == 0 || digits > kDigitsOfWhole) return nullptr;
  if (at < end && (*at == 'e' || *at == 'E')) {
    ++at;
    const bool minus = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+')) ++at;
    int exponent = 0;
    const char* first = at;
    for (; IsDigit(at, end) && at - first < 4; ++at) exponent = exponent * 10 + (*at - '0');
    if (at == first || IsDigit(at, end)) return nullptr;
    power += minus ? -exponent : exponent;
  }
  if (whole > kLargestExactWhole || power < -kLargestExactPower || power > kLargestExactPower) return nullptr;
  value = static_cast<double>(whole);
  value = power < 0 ? value / kPowersOfTen[-power] : value * kPowersOfTen[power];
  if (negative) value = -value;
  return at;
}

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

NumberScanner::NumberScanner(std::string_view bytes, bool comma_separates, int first_line)
    : at_(bytes.data()), end_(bytes.data() + bytes.size()), comma_separates_(comma_separates), line_(first_line) {
  if (first_line == 1) at_ = WithoutByteOrderMark(bytes).data();
}

inline bool NumberScanner::Separates(char c) const { return IsBlank(c) || (comma_separates_ && c == ','); }

inline bool NumberScanner::EndsAt(const char* at) const {
  return at == end_ || Separates(*at) || *at == '\n' || *at == '\r';
}

NumberScanner::Token NumberScanner::Word() {
  const char* begin = at_;
  while (!EndsAt(at_)) ++at_;
  text_ = std::string_view(begin, static_cast<std::size_t>(at_ - begin));
  return Token::kWord;
}

NumberScanner::Token NumberScanner::Numbers(std::vector<double>& values) {
  for (;;) {
    while (at_ < end_ && Separates(*at_)) ++at_;
    double value = 0.0;
    const char* stop = ShortDecimal(at_, end_, value);
    if (stop != nullptr && EndsAt(stop)) {
      values.push_back(value);
      at_ = stop;
      continue;
    }
    const Token token = Next();
    if (token != Token::kNumber) return token;
    values.push_back(value_);
  }
}

NumberScanner::Token NumberScanner::Next() {
  while (at_ < end_ && Separates(*at_)) ++at_;
  if (at_ == end_) return Token::kEnd;
  if (*at_ == '\n' || *at_ == '\r') {
    at_ += (*at_ == '\r' && at_ + 1 < end_ && at_[1] == '\n') ? 2 : 1;
    ++line_;
    return Token::kLineEnd;
  }
  const char* begin = at_;
  const char* digits = (*at_ == '+' && at_ + 1 < end_ && at_[1] != '-') ? at_ + 1 : at_;
  if (const char* stop = ShortDecimal(digits, end_, value_); stop != nullptr && EndsAt(stop)) {
    at_ = stop;
    text_ = std::string_view(begin, static_cast<std::size_t>(stop - begin));
    return Token::kNumber;
  }
  const auto [stop, error] = std::from_chars(digits, end_, value_);
  if (error == std::errc::invalid_argument || !EndsAt(stop)) return Word();
  at_ = stop;
  text_ = std::string_view(begin, static_cast<std::size_t>(stop - begin));
  if (error == std::errc::result_out_of_range) {
    // Too small for a double is zero for every purpose here ("1.6e-0318"); too large is not a number we can hold.
    const std::size_t exponent = text_.find_first_of("eE");
    if (exponent != std::string_view::npos && exponent + 1 < text_.size() && text_[exponent + 1] == '-') {
      value_ = 0.0;
      return Token::kNumber;
    }
    return Token::kNotFinite;
  }
  return std::isfinite(value_) ? Token::kNumber : Token::kNotFinite;
}

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
    std::replace(points.begin(), points.end(), ';', '\t');
    return std::optional(std::move(points));
  }
  return std::optional<std::string>();
}

}  // namespace mocurate
