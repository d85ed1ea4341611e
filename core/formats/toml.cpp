#include "core/formats/toml.h"

#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/binary_numbers.h"

namespace mocurate {
namespace {

using nlohmann::json;

constexpr int kMaxTomlDepth = 32;

bool IsBare(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

class TomlParser {
 public:
  TomlParser(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Expected<json> Parse() {
    json root = json::object();
    json* table = &root;
    for (SkipToContent(); at_ < bytes_.size(); SkipToContent()) {
      Status read = bytes_[at_] == '[' ? Header(root, table) : KeyValue(*table, 0);
      if (read) read = EndOfLine();
      if (!read) return Forward(read);
    }
    return root;
  }

 private:
  tl::unexpected<Error> Bad(const std::string& rule, ErrorCode code = ErrorCode::kMalformed) const {
    return Fail(code, rule, name_ + ":" + std::to_string(line_));
  }
  char Peek(std::size_t ahead = 0) const { return at_ + ahead < bytes_.size() ? bytes_[at_ + ahead] : '\0'; }
  void SkipBlanks() {
    while (Peek() == ' ' || Peek() == '\t') ++at_;
  }
  /// Blanks, comments and line ends.
  void SkipToContent() {
    for (;; ++at_) {
      SkipBlanks();
      if (Peek() == '#') {
        while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
      }
      if (at_ >= bytes_.size()) return;
      if (Peek() == '\n') {
        ++line_;
      } else if (Peek() != '\r' || Peek(1) != '\n') {
        return;
      }
    }
  }

  Status EndOfLine() {
    SkipBlanks();
    if (at_ >= bytes_.size() || Peek() == '\n' || Peek() == '#' || (Peek() == '\r' && Peek(1) == '\n')) return {};
    return Bad("'" + ShownText(bytes_.substr(at_, 10)) + "' is left over on the line");
  }

  /// [a.b] or [[a.b]]: `table` becomes the one that follows.
  Status Header(json& root, json*& table) {
    ++at_;
    const bool array = Peek() == '[';
    if (array) ++at_;
    SkipBlanks();
    const Expected<std::vector<std::string>> keys = Keys();
    if (!keys) return Forward(keys);
    if (Peek() != ']' || (array && Peek(1) != ']')) return Bad("the header of a table ends with ']'");
    at_ += array ? 2 : 1;
    std::string path;
    table = &root;
    for (std::size_t i = 0; i < keys->size(); ++i) {
      const bool last = i + 1 == keys->size();
      path += "/" + (*keys)[i];
      json& next = (*table)[(*keys)[i]];
      if (next.is_null()) next = array && last ? json::array() : json::object();
      if (array && last) {
        if (!next.is_array() || (!next.empty() && arrays_.count(path) == 0)) {
          return Bad("'" + ShownText((*keys)[i]) + "' is no array of tables");
        }
        arrays_.insert(path);
        next.push_back(json::object());
      }
      table = next.is_array() && !next.empty() ? &next.back() : &next;
      if (!table->is_object()) return Bad("'" + ShownText((*keys)[i]) + "' is no table");
      if (next.is_array()) path += "/" + std::to_string(next.size());
    }
    if (!array && !headers_.insert(path).second) return Bad("the table '" + ShownText(keys->back()) + "' comes twice");
    return {};
  }

  Expected<std::vector<std::string>> Keys() {
    std::vector<std::string> keys;
    for (;;) {
      SkipBlanks();
      std::string key;
      if (Peek() == '"' || Peek() == '\'') {
        Expected<std::string> text = Text();
        if (!text) return Forward(text);
        key = std::move(*text);
      } else {
        while (IsBare(Peek())) key += bytes_[at_++];
        if (key.empty()) return Bad("a key is expected, not '" + ShownText(bytes_.substr(at_, 10)) + "'");
      }
      keys.push_back(std::move(key));
      if (keys.size() > kMaxTomlDepth) return Bad("tables are nested too deeply");
      SkipBlanks();
      if (Peek() != '.') return keys;
      ++at_;
    }
  }

  Status KeyValue(json& table, int depth) {
    const Expected<std::vector<std::string>> keys = Keys();
    if (!keys) return Forward(keys);
    if (Peek() != '=') return Bad("'=' is expected after the key '" + ShownText(keys->back()) + "'");
    ++at_;
    json* place = &table;
    for (const std::string& key : *keys) {
      if (!place->is_object() && !place->is_null()) return Bad("'" + ShownText(key) + "' belongs to no table");
      place = &(*place)[key];
    }
    if (!place->is_null()) return Bad("the key '" + ShownText(keys->back()) + "' comes twice");
    Expected<json> value = Value(depth);
    if (!value) return Forward(value);
    *place = std::move(*value);
    return {};
  }

  Expected<json> Value(int depth) {
    if (depth > kMaxTomlDepth) return Bad("values are nested too deeply");
    SkipBlanks();
    if (Peek() == '"' || Peek() == '\'') {
      Expected<std::string> text = Text();
      if (!text) return Forward(text);
      return json(std::move(*text));
    }
    if (Peek() == '[') return Array(depth);
    if (Peek() == '{') return InlineTable(depth);
    return Scalar();
  }

  Expected<json> Array(int depth) {
    json array = json::array();
    ++at_;
    for (SkipToContent(); Peek() != ']'; SkipToContent()) {
      Expected<json> value = Value(depth + 1);
      if (!value) return value;
      array.push_back(std::move(*value));
      SkipToContent();
      if (Peek() == ',') {
        ++at_;
      } else if (Peek() != ']') {
        return Bad("',' or ']' is expected in an array");
      }
    }
    ++at_;
    return array;
  }

  Expected<json> InlineTable(int depth) {
    json table = json::object();
    ++at_;
    SkipBlanks();
    while (Peek() != '}') {
      if (Status read = KeyValue(table, depth + 1); !read) return Forward(read);
      SkipBlanks();
      if (Peek() == ',') {
        ++at_;
        SkipBlanks();
        if (Peek() != '}') continue;
      } else if (Peek() == '}') {
        continue;
      }
      return Bad("',' and another key, or '}', is expected in an inline table");
    }
    ++at_;
    return table;
  }

  Expected<json> Scalar() {
    const std::size_t begin = at_;
    while (IsBare(Peek()) || Peek() == '+' || Peek() == '.' || Peek() == ':') ++at_;
    const std::string_view word = bytes_.substr(begin, at_ - begin);
    if (word == "true") return json(true);
    if (word == "false") return json(false);
    std::string digits;
    for (const char c : word) {
      if (c != '_') digits += c;
    }
    const std::optional<double> number = ParseDouble(digits);
    if (number && std::isfinite(*number)) {
      const std::optional<long long> whole = ParseInteger(digits);
      return whole ? json(*whole) : json(*number);
    }
    if (word.size() >= 8 && word.find_first_not_of("0123456789-:.TZtz+") == std::string_view::npos) {
      return Bad("dates are not supported", ErrorCode::kUnsupported);
    }
    return Bad("'" + ShownText(word.empty() ? bytes_.substr(begin, 10) : word) + "' is no value");
  }

  /// A string between " or '.
  Expected<std::string> Text() {
    const char quote = bytes_[at_++];
    if (Peek() == quote && Peek(1) == quote) {
      return Bad("strings over several lines are not supported", ErrorCode::kUnsupported);
    }
    std::string text;
    for (; at_ < bytes_.size() && bytes_[at_] != quote; ++at_) {
      const char c = bytes_[at_];
      if (c == '\n') break;
      if (c != '\\' || quote == '\'') {
        text += c;
        continue;
      }
      constexpr std::string_view kEscapes = "btnfr\"\\";
      constexpr std::string_view kMeanings = "\b\t\n\f\r\"\\";
      const std::size_t escape = kEscapes.find(Peek(1));
      if (escape == std::string_view::npos) return Bad("'\\" + ShownText(bytes_.substr(at_ + 1, 1)) + "' in a string");
      text += kMeanings[escape];
      ++at_;
    }
    if (Peek() != quote) return Bad("a string has no end");
    ++at_;
    if (FirstNotUtf8(text)) return Bad("a string is not UTF-8");
    return text;
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::set<std::string> headers_;
  std::set<std::string> arrays_;
};

}  // namespace

Expected<json> ParseToml(std::string_view bytes, const std::string& name) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes.substr(0, 3) == kByteOrderMark) bytes.remove_prefix(3);
  if (Trim(bytes).empty()) return EmptyFile(name);
  return TomlParser(bytes, name).Parse();
}

}  // namespace mocurate
