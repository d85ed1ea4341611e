#include "core/formats/number_scanner.h"

#include <charconv>
#include <cmath>
#include <system_error>

namespace mocurate {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\f' || c == '\v'; }

}  // namespace

NumberScanner::NumberScanner(std::string_view bytes, bool comma_separates, int first_line)
    : at_(bytes.data()), end_(bytes.data() + bytes.size()), comma_separates_(comma_separates), line_(first_line) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes.substr(0, 3) == kByteOrderMark) at_ += 3;
}

NumberScanner::Token NumberScanner::Word() {
  const char* begin = at_;
  while (at_ < end_ && !IsBlank(*at_) && *at_ != '\n' && *at_ != '\r' && !(comma_separates_ && *at_ == ',')) ++at_;
  text_ = std::string_view(begin, static_cast<std::size_t>(at_ - begin));
  return Token::kWord;
}

NumberScanner::Token NumberScanner::Next() {
  while (at_ < end_ && (IsBlank(*at_) || (comma_separates_ && *at_ == ','))) ++at_;
  if (at_ == end_) return Token::kEnd;
  if (*at_ == '\n' || *at_ == '\r') {
    at_ += (*at_ == '\r' && at_ + 1 < end_ && at_[1] == '\n') ? 2 : 1;
    ++line_;
    return Token::kLineEnd;
  }
  const char* begin = at_;
  const char* digits = (*at_ == '+' && at_ + 1 < end_ && at_[1] != '-') ? at_ + 1 : at_;
  const auto [stop, error] = std::from_chars(digits, end_, value_);
  if (error == std::errc::invalid_argument) return Word();
  at_ = stop;
  const bool ends = at_ == end_ || IsBlank(*at_) || *at_ == '\n' || *at_ == '\r' || (comma_separates_ && *at_ == ',');
  if (!ends) {
    at_ = begin;
    return Word();
  }
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

}  // namespace mocurate
