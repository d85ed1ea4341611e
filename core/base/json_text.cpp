#include "core/base/json_text.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// Offset of the bracket that opens one level too many; npos: none does. Brackets inside texts do not count.
std::size_t TooDeepAt(std::string_view text) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kDeepestJson) return i;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return std::string_view::npos;
}

/// "name:line:column" of a byte.
std::string PlaceOf(std::string_view text, std::size_t offset, const std::string& name) {
  const std::string_view before = text.substr(0, offset);
  const std::size_t line_end = before.rfind('\n');
  const std::size_t column = before.size() - (line_end == std::string_view::npos ? 0 : line_end + 1);
  return name + ":" + std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ":" +
         std::to_string(column + 1);
}

template <class Json>
Expected<Json> ParseAs(std::string_view text, const std::string& name, const typename Json::parser_callback_t& watch) {
  if (Trim(text).empty()) return EmptyFile(name);
  if (const std::size_t deep = TooDeepAt(text); deep != std::string_view::npos) {
    return Fail(ErrorCode::kMalformed, "the JSON is nested deeper than " + std::to_string(kDeepestJson) + " levels",
                PlaceOf(text, deep, name), "no file that is read here needs as many: copy it again, or leave it out");
  }
  try {
    return Json::parse(text.begin(), text.end(), watch);
  } catch (const typename Json::parse_error& error) {
    return Fail(ErrorCode::kMalformed, "the text is not valid JSON",
                PlaceOf(text, error.byte > 0 ? error.byte - 1 : 0, name), "copy the file again, or correct it");
  } catch (const typename Json::exception&) {
    return Fail(ErrorCode::kMalformed, "a number of the JSON is out of range", name, "write a finite number");
  }
}

}  // namespace

Expected<nlohmann::json> ParseJson(std::string_view text, const std::string& name,
                                   const nlohmann::json::parser_callback_t& watch) {
  return ParseAs<nlohmann::json>(text, name, watch);
}

Expected<nlohmann::ordered_json> ParseOrderedJson(std::string_view text, const std::string& name) {
  return ParseAs<nlohmann::ordered_json>(text, name, nullptr);
}

Expected<nlohmann::json> ReadJson(const std::filesystem::path& file) {
  const Expected<std::string> text = ReadFile(file);
  if (!text) return Forward(text);
  return ParseJson(*text, DisplayPath(file));
}

namespace internal {

tl::unexpected<Error> WrongJson(const std::string& where, const nlohmann::json::exception& wrong) {
  const std::string_view what = wrong.what();  // "[json.exception.type_error.302] type must be string, but is number"
  const std::size_t head = what.find("] ");
  return Fail(ErrorCode::kMalformed,
              "a value of the JSON is missing or has another type: " +
                  std::string(head == std::string_view::npos ? what : what.substr(head + 2)),
              where, "copy the file again, or correct it");
}

}  // namespace internal
}  // namespace mocurate
