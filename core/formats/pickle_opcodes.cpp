#include "core/formats/pickle.h"

#include <algorithm>
#include <cstddef>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr int kFewestOpcodes = 4;  // of bytes that end before their pickle: words may begin with two or three

bool IsIdentifier(std::string_view text) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
  };
  return !text.empty() && !(text[0] >= '0' && text[0] <= '9') && std::all_of(text.begin(), text.end(), fits);
}

/// An argument that ends with its line.
bool FitsLine(char opcode, std::string_view line) {
  switch (opcode) {
    case 'S':  // a text in quotes
      return line.size() >= 2 && (line[0] == '\'' || line[0] == '"') && line.back() == line[0];
    case 'L':
      if (!line.empty() && line.back() == 'L') line.remove_suffix(1);
      return !line.empty() && line.find_first_not_of("-0123456789") == std::string_view::npos;  // of any length
    case 'I':
    case 'p':
    case 'g':
      return ParseInteger(line).has_value();
    case 'F':
      return ParseDouble(line).has_value() || line == "nan" || line == "inf" || line == "-inf";
    case 'c':
    case 'i':
      return IsIdentifier(line);
    default:  // V, P: any text
      return true;
  }
}

constexpr std::string_view kBare = "().012NQRabdelostu]}";
constexpr std::string_view kLines = "ILFSVPpgci";

/// Bytes of a binary argument; of a counted one, of its count. 0: the opcode has none.
std::size_t BinaryBytes(char opcode) {
  const auto is_one_of = [opcode](std::string_view opcodes) { return opcodes.find(opcode) != std::string_view::npos; };
  return is_one_of("KUhq") ? 1 : is_one_of("M") ? 2 : is_one_of("JTXjr") ? 4 : is_one_of("G") ? 8 : 0;
}

}  // namespace

bool BeginsAsOldPickle(std::string_view head) {
  if (head.empty() || std::string_view("(]}c").find(head[0]) == std::string_view::npos) return false;
  int opcodes = 0;
  while (!head.empty()) {
    const char opcode = head[0];
    head.remove_prefix(1);
    ++opcodes;
    if (opcode == '.') return head.empty();
    if (kBare.find(opcode) != std::string_view::npos) continue;
    if (kLines.find(opcode) != std::string_view::npos) {
      for (int lines = opcode == 'c' || opcode == 'i' ? 2 : 1; lines > 0; --lines) {
        const std::size_t end = head.find('\n');
        if (end == std::string_view::npos) return opcodes >= kFewestOpcodes;
        if (!FitsLine(opcode, head.substr(0, end))) return false;
        head.remove_prefix(end + 1);
      }
      continue;
    }
    const std::size_t width = BinaryBytes(opcode);
    if (width == 0) return false;
    if (width > head.size()) return opcodes >= kFewestOpcodes;
    std::size_t count = width;
    if (opcode == 'U' || opcode == 'T' || opcode == 'X') {
      for (std::size_t i = 0; i < width; ++i) count += std::size_t{static_cast<unsigned char>(head[i])} << (8 * i);
    }
    if (count > head.size()) return opcodes >= kFewestOpcodes;
    head.remove_prefix(count);
  }
  return opcodes >= kFewestOpcodes;
}

}  // namespace mocurate
