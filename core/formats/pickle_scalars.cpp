// Numbers, texts and bytes of the pickle machine.

#include <cstring>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/pickle_machine.h"

namespace mocurate {
namespace {

/// `count` hexadecimal digits at `at`; empty when they are not there.
std::optional<std::uint32_t> Hex(std::string_view text, std::size_t at, std::size_t count) {
  if (count > text.size() || at > text.size() - count) return std::nullopt;
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int digit = HexDigit(text[at + i]);
    if (digit < 0) return std::nullopt;
    value = value * 16 + static_cast<std::uint32_t>(digit);
  }
  return value;
}

/// The content of a Python 2 string between its quotes; empty when an escape is invalid.
std::optional<std::string> Unescaped(std::string_view text) {
  static constexpr std::string_view kLetters = "abfnrtv\\'\"";
  static constexpr std::string_view kMeanings = "\a\b\f\n\r\t\v\\'\"";
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      plain += text[i];
      continue;
    }
    if (++i >= text.size()) return std::nullopt;
    if (const std::size_t letter = kLetters.find(text[i]); letter != std::string_view::npos) {
      plain += kMeanings[letter];
    } else if (text[i] == 'x') {
      const std::optional<std::uint32_t> byte = Hex(text, i + 1, 2);
      if (!byte) return std::nullopt;
      plain += static_cast<char>(*byte);
      i += 2;
    } else {
      return std::nullopt;
    }
  }
  return plain;
}

/// UTF-8 of Latin-1 with \uXXXX and \UXXXXXXXX escapes; empty when an escape is invalid.
std::optional<std::string> RawUnicode(std::string_view text) {
  std::string utf8;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::uint32_t code_point = static_cast<unsigned char>(text[i]);
    if (text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == 'u' || text[i + 1] == 'U')) {
      const std::size_t digits = text[i + 1] == 'u' ? 4 : 8;
      const std::optional<std::uint32_t> value = Hex(text, i + 2, digits);
      if (!value) return std::nullopt;
      code_point = *value;
      i += digits + 1;
    }
    const std::string character = Utf8Of(code_point);
    if (character.empty()) return std::nullopt;
    utf8 += character;
  }
  return utf8;
}

bool IsAscii(std::string_view text) {
  for (const char c : text) {
    if (static_cast<unsigned char>(c) >= 0x80) return false;
  }
  return true;
}

}  // namespace

Expected<std::uint64_t> PickleMachine::TakeUnsigned(std::size_t count) {
  std::string_view data;
  if (!Take(count, &data)) return Bad("the file ends inside a number");
  std::uint64_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = (value << 8) | static_cast<unsigned char>(data[i]);
  return value;
}

Expected<std::string_view> PickleMachine::TakeLine(const char* what) {
  const std::size_t end = bytes_.find('\n', position_);
  if (end == std::string_view::npos) return Bad(std::string("the file ends inside ") + what);
  std::string_view line = bytes_.substr(position_, end - position_);
  position_ = end + 1;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

Expected<std::string_view> PickleMachine::TakeCounted(std::size_t length_bytes, const char* what) {
  const Expected<std::uint64_t> length = TakeUnsigned(length_bytes);
  if (!length) return Forward(length);
  std::string_view data;
  if (*length > left() || !Take(static_cast<std::size_t>(*length), &data)) {
    return Bad(std::string("the file ends inside ") + what + " of " + std::to_string(*length) + " bytes");
  }
  return data;
}

Expected<std::string_view> PickleMachine::Own(std::string text) {
  owned_bytes_ += text.size();
  if (owned_bytes_ > 4 * bytes_.size() + (std::size_t{1} << 20)) {
    return Bad("the same bytes are repeated too often", ErrorCode::kUnsupported);
  }
  pickle_.owned.push_back(std::move(text));
  return std::string_view(pickle_.owned.back());
}

Status PickleMachine::PushText(PickleKind kind, std::string_view text) {
  PickleValue value;
  value.kind = kind;
  value.text = text;
  return Push(std::move(value));
}

/// A string of Python 2: a text when it is ASCII.
Status PickleMachine::PushBytes(std::string_view text) {
  return PushText(IsAscii(text) ? PickleKind::kText : PickleKind::kBytes, text);
}

Status PickleMachine::StepNumber(unsigned char opcode) {
  PickleValue value;
  value.kind = PickleKind::kInteger;
  if (opcode == 'I' || opcode == 'L' || opcode == 'F') {
    const Expected<std::string_view> line = TakeLine("a number");
    if (!line) return Forward(line);
    std::string_view digits = *line;
    if (opcode == 'F') {
      const std::optional<double> number = ParseDouble(digits);
      if (!number) return Bad("'" + DisplayPath(std::string(digits.substr(0, 40))) + "' is not a number");
      value.kind = PickleKind::kFloat;
      value.number = *number;
      return Push(std::move(value));
    }
    if (opcode == 'I' && (digits == "00" || digits == "01")) {
      value.kind = PickleKind::kBool;
      value.integer = digits == "01";
      return PushConstant(std::move(value));
    }
    if (opcode == 'L' && !digits.empty() && digits.back() == 'L') digits.remove_suffix(1);
    const std::optional<long long> integer = ParseInteger(digits);
    if (!integer) return Bad("'" + DisplayPath(std::string(digits.substr(0, 40))) + "' is not an integer of 64 bits");
    value.integer = *integer;
    return PushConstant(std::move(value));
  }
  if (opcode == 'G') {  // BINFLOAT, big-endian
    std::string_view data;
    if (!Take(8, &data)) return Bad("the file ends inside a number");
    std::uint64_t bits = 0;
    for (const char byte : data) bits = (bits << 8) | static_cast<unsigned char>(byte);
    value.kind = PickleKind::kFloat;
    std::memcpy(&value.number, &bits, 8);
    return Push(std::move(value));
  }
  if (opcode == 0x8a || opcode == 0x8b) {  // LONG1, LONG4
    const Expected<std::uint64_t> count = TakeUnsigned(opcode == 0x8a ? 1 : 4);
    if (!count) return Forward(count);
    if (*count > 8) return Bad("an integer of " + std::to_string(*count) + " bytes", ErrorCode::kUnsupported);
    const Expected<std::uint64_t> taken = TakeUnsigned(static_cast<std::size_t>(*count));
    if (!taken) return Forward(taken);
    std::uint64_t bits = *taken;
    if (*count > 0 && *count < 8 && (bits >> (8 * *count - 1)) != 0) bits |= ~std::uint64_t{0} << (8 * *count);
    value.integer = static_cast<std::int64_t>(bits);
    return PushConstant(std::move(value));
  }
  const std::size_t count = opcode == 'K' ? 1 : opcode == 'M' ? 2 : 4;
  const Expected<std::uint64_t> taken = TakeUnsigned(count);
  if (!taken) return Forward(taken);
  value.integer =
      count == 4 ? static_cast<std::int32_t>(static_cast<std::uint32_t>(*taken)) : static_cast<std::int64_t>(*taken);
  return PushConstant(std::move(value));
}

Status PickleMachine::StepText(unsigned char opcode) {
  if (opcode == 'S' || opcode == 'V') {
    const Expected<std::string_view> line = TakeLine("a text");
    if (!line) return Forward(line);
    std::string_view inside = *line;
    if (opcode == 'V') {
      std::optional<std::string> utf8 = RawUnicode(inside);
      if (!utf8) return Bad("a text with an escape that is invalid");
      const Expected<std::string_view> owned = Own(std::move(*utf8));
      return owned ? PushText(PickleKind::kText, *owned) : Status(Forward(owned));
    }
    if (inside.size() < 2 || inside.front() != inside.back() || (inside.front() != '\'' && inside.front() != '"')) {
      return Bad("a string without its quotes");
    }
    std::optional<std::string> plain = Unescaped(inside.substr(1, inside.size() - 2));
    if (!plain) return Bad("a string with an escape that is invalid");
    const Expected<std::string_view> owned = Own(std::move(*plain));
    return owned ? PushBytes(*owned) : Status(Forward(owned));
  }
  const bool unicode = opcode == 'X' || opcode == 0x8c || opcode == 0x8d;
  const bool bytes = opcode == 'B' || opcode == 'C' || opcode == 0x8e || opcode == 0x96;
  const std::size_t length_bytes = opcode == 'U' || opcode == 'C' || opcode == 0x8c     ? 1
                                   : opcode == 0x8d || opcode == 0x8e || opcode == 0x96 ? 8
                                                                                        : 4;
  const Expected<std::string_view> text = TakeCounted(length_bytes, unicode ? "a text" : "bytes");
  if (!text) return Forward(text);
  if (bytes) return PushText(PickleKind::kBytes, *text);
  if (!unicode) return PushBytes(*text);
  if (FirstNotUtf8(*text)) return Bad("a text that is not UTF-8");
  return PushText(PickleKind::kText, *text);
}

}  // namespace mocurate
