#include "core/base/characters.h"
#include "core/base/file.h"

namespace mocurate {
std::optional<std::size_t> FirstNotUtf8(std::string_view bytes) {
  for (std::size_t i = 0; i < bytes.size();) {
    if (static_cast<unsigned char>(bytes[i]) < 0x80) {
      ++i;
      continue;
    }
    const Character character = FirstCharacter(bytes.substr(i));
    if (character.kind == CharacterKind::kNotUtf8) return i;
    i += character.bytes;
  }
  return std::nullopt;
}

std::string DisplayPath(const std::filesystem::path& path) {
  const std::string& bytes = path.native();
  std::string text;
  for (std::size_t i = 0; i < bytes.size();) {
    const Character character = FirstCharacter(std::string_view(bytes).substr(i));
    const auto byte = static_cast<unsigned char>(bytes[i]);
    const bool utf8 = character.kind != CharacterKind::kNotUtf8;
    const bool looks_escaped = bytes[i] == '\\' && i + 1 < bytes.size() && bytes[i + 1] == 'x';
    if (!utf8 || byte < 0x20 || byte == 0x7F || looks_escaped) {
      text += EscapedByte(bytes[i]);
      ++i;
    } else {
      text.append(bytes, i, character.bytes);
      i += character.bytes;
    }
  }
  return text;
}

std::filesystem::path PathFromText(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.substr(i, 2) == "\\x" && i + 3 < text.size() && HexDigit(text[i + 2]) >= 0 && HexDigit(text[i + 3]) >= 0) {
      bytes += static_cast<char>(16 * HexDigit(text[i + 2]) + HexDigit(text[i + 3]));
      i += 3;
    } else {
      bytes += text[i];
    }
  }
  return bytes;
}

}  // namespace mocurate
