#include "core/base/json_text.h"

#include <algorithm>
#include <set>
#include <vector>

#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// Offset of the quote that ends a text; npos: none does. One behind an odd number of backslashes is part of the text.
std::size_t EndOfText(std::string_view text, std::size_t begin) {
  for (std::size_t end = text.find('"', begin); end != std::string_view::npos; end = text.find('"', end + 1)) {
    std::size_t slashes = 0;
    while (end - slashes > begin && text[end - slashes - 1] == '\\') ++slashes;
    if (slashes % 2 == 0) return end;
  }
  return std::string_view::npos;
}

/// Offset of the bracket that opens one level too many; npos: none does. Brackets inside texts do not count.
std::size_t TooDeepAt(std::string_view text) {
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      i = EndOfText(text, i + 1);
      if (i == std::string_view::npos) return i;
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
Expected<Json> ParseAs(std::string_view text, const std::string& name) {
  if (Trim(text).empty()) return EmptyFile(name);
  if (const std::size_t deep = TooDeepAt(text); deep != std::string_view::npos) {
    return Fail(ErrorCode::kMalformed, "the JSON is nested deeper than " + std::to_string(kDeepestJson) + " levels",
                PlaceOf(text, deep, name), "no file that is read here needs as many: copy it again, or leave it out");
  }
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const typename Json::parse_error& error) {
    return Fail(ErrorCode::kMalformed, "the text is not valid JSON",
                PlaceOf(text, error.byte > 0 ? error.byte - 1 : 0, name), "copy the file again, or correct it");
  } catch (const typename Json::exception&) {
    return Fail(ErrorCode::kMalformed, "a number of the JSON is out of range", name, "write a finite number");
  }
}

/// Sees the keys of a text and keeps no value. (A callback of Json::parse takes time with the square of a list.)
class KeyWatch final : public nlohmann::json_sax<nlohmann::json> {
 public:
  std::optional<std::string> repeated;

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }
  bool start_object(std::size_t) override {
    keys_.emplace_back();
    return true;
  }
  bool key(string_t& name) override {
    if (!keys_.back().insert(name).second) repeated = name;
    return !repeated;
  }
  bool end_object() override {
    keys_.pop_back();
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) override { return false; }

 private:
  std::vector<std::set<std::string>> keys_;  ///< of the open objects
};

}  // namespace

Expected<nlohmann::json> ParseJson(std::string_view text, const std::string& name) {
  return ParseAs<nlohmann::json>(text, name);
}

Expected<nlohmann::ordered_json> ParseOrderedJson(std::string_view text, const std::string& name) {
  return ParseAs<nlohmann::ordered_json>(text, name);
}

Expected<nlohmann::json> ReadJson(const std::filesystem::path& file) {
  const Expected<std::string> text = ReadFile(file);
  if (!text) return Forward(text);
  return ParseJson(*text, DisplayPath(file));
}

std::optional<std::string> RepeatedKey(std::string_view text) {
  KeyWatch watch;
  nlohmann::json::sax_parse(text.begin(), text.end(), &watch);
  return watch.repeated;
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
