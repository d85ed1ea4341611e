#include "core/base/terminal.h"

#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/base/text.h"

namespace mocurate {
namespace {

std::string Escaped(std::string_view text, std::string_view kept) {
  std::string escaped;
  escaped.reserve(text.size());
  while (!text.empty()) {
    const Character character = FirstCharacter(text);
    const std::string_view bytes = text.substr(0, character.bytes);
    if (character.kind == CharacterKind::kPlain || kept.find(bytes) != std::string_view::npos) {
      escaped += bytes;
    } else {
      for (const char byte : bytes) escaped += EscapedByte(byte);
    }
    text.remove_prefix(character.bytes);
  }
  return escaped;
}

void Write(std::string_view text, std::FILE* to) {
  const std::string escaped = TerminalText(text);
  std::fwrite(escaped.data(), 1, escaped.size(), to);
}

}  // namespace

std::string TerminalText(std::string_view text) { return Escaped(text, "\n\t"); }

std::string TerminalLine(std::string_view text) { return Escaped(text, ""); }

void Print(const char* format, ...) {
  std::va_list values, again;
  va_start(values, format);
  va_copy(again, values);
  const int length = std::vsnprintf(nullptr, 0, format, values);
  va_end(values);
  std::string text(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  Write(text, stdout);
}

void PrintLine(std::string_view text) { Write(std::string(text) + "\n", stdout); }

void PrintJson(const nlohmann::json& document, int indent) {
  PrintLine(document.dump(indent, ' ', true, nlohmann::json::error_handler_t::replace));
}

void PrintError(std::string_view text) {
  Write(text, stderr);
  std::fflush(stderr);
}

}  // namespace mocurate
