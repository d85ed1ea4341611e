#include "core/base/characters.h"

namespace mocurate {
namespace {

/// Length of the UTF-8 character that `bytes` begins with; 0 when it begins with none.
std::size_t Utf8Length(std::string_view bytes) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  const unsigned char first = at(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || bytes.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((at(i) & 0xC0) != 0x80) return 0;
  }
  const unsigned char second = at(1);
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F)) return 0;
  if ((first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F)) return 0;
  return length;
}

/// U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069.
bool IsDirection(std::string_view character) {
  if (character == "\xD8\x9C") return true;
  if (character.size() != 3 || character[0] != '\xE2') return false;
  const auto last = static_cast<unsigned char>(character[2]);
  if (character[1] == '\x80') return last == 0x8E || last == 0x8F || (last >= 0xAA && last <= 0xAE);
  return character[1] == '\x81' && last >= 0xA6 && last <= 0xA9;
}

}  // namespace

Character FirstCharacter(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  if (first < 0x80) return {1, first < 0x20 || first == 0x7F ? CharacterKind::kControl : CharacterKind::kPlain};
  const std::size_t bytes = Utf8Length(text);
  if (bytes == 0) return {1, CharacterKind::kNotUtf8};
  const bool c1 = first == 0xC2 && static_cast<unsigned char>(text[1]) < 0xA0;
  return {bytes, c1                                   ? CharacterKind::kControl
                 : IsDirection(text.substr(0, bytes)) ? CharacterKind::kDirection
                                                      : CharacterKind::kPlain};
}

std::string EscapedByte(char byte) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  const auto value = static_cast<unsigned char>(byte);
  return {'\\', 'x', kDigits[value >> 4], kDigits[value & 15]};
}

int HexDigit(char digit) {
  if (digit >= '0' && digit <= '9') return digit - '0';
  if (digit >= 'a' && digit <= 'f') return digit - 'a' + 10;
  if (digit >= 'A' && digit <= 'F') return digit - 'A' + 10;
  return -1;
}

std::string WithoutControls(std::string_view text) {
  std::string clean;
  while (!text.empty()) {
    const Character character = FirstCharacter(text);
    const bool bad = character.kind == CharacterKind::kControl || character.kind == CharacterKind::kNotUtf8;
    clean += bad ? "_" : text.substr(0, character.bytes);
    text.remove_prefix(character.bytes);
  }
  return clean;
}

}  // namespace mocurate
