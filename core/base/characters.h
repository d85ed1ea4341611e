#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mocurate {

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
