#include "core/formats/xml.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "core/formats/binary_numbers.h"

namespace mocurate {
namespace {

constexpr std::size_t kMaxXmlDepth = 64;
constexpr std::string_view kBlanks = " \t\r\n";

class XmlParser {
 public:
  XmlParser(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  Expected<XmlElement> Parse() {
    // The open elements; the first stands for the document.
    std::vector<XmlElement> open(1);
    while (at_ < bytes_.size()) {
      if (bytes_[at_] != '<') {
        if (open.size() == 1 && kBlanks.find(bytes_[at_]) == std::string_view::npos) {
          return Bad("text stands outside the root element");
        }
        Advance(1);
        continue;
      }
      Status read = Markup(open);
      if (!read) return Forward(read);
    }
    if (open.size() > 1)
      return Bad("the element '" + ShownText(open.back().name) + "' has no end; is the file cut off?");
    if (open[0].children.size() != 1) return Bad("one root element is expected");
    return std::move(open[0].children[0]);
  }

 private:
  tl::unexpected<Error> Bad(const std::string& rule, ErrorCode code = ErrorCode::kMalformed) const {
    return Fail(code, rule, name_ + ":" + std::to_string(line_));
  }

  void Advance(std::size_t count) {
    for (; count > 0 && at_ < bytes_.size(); --count) line_ += bytes_[at_++] == '\n' ? 1 : 0;
  }
  bool At(std::string_view text) const { return bytes_.substr(at_, text.size()) == text; }
  void SkipBlanks() {
    while (at_ < bytes_.size() && kBlanks.find(bytes_[at_]) != std::string_view::npos) Advance(1);
  }
  bool SkipBeyond(std::string_view end) {
    const std::size_t found = bytes_.find(end, at_);
    if (found == std::string_view::npos) return false;
    Advance(found + end.size() - at_);
    return true;
  }

  Status Markup(std::vector<XmlElement>& open) {
    constexpr std::pair<std::string_view, std::string_view> kPassedOver[] = {
        {"<!--", "-->"}, {"<?", "?>"}, {"<![CDATA[", "]]>"}};
    for (const auto& [begin, end] : kPassedOver) {
      if (!At(begin)) continue;
      return SkipBeyond(end) ? Status() : Bad("'" + std::string(begin) + "' has no end");
    }
    if (At("<!")) return Bad("document type declarations are not supported", ErrorCode::kUnsupported);
    if (At("</")) {
      Advance(2);
      const std::string name = Word();
      SkipBlanks();
      if (!At(">")) return Bad("'>' is expected");
      Advance(1);
      if (open.size() == 1 || open.back().name != name) return Bad("'</" + ShownText(name) + ">' ends no open element");
      Close(open);
      return {};
    }
    return Element(open);
  }

  static void Close(std::vector<XmlElement>& open) {
    XmlElement done = std::move(open.back());
    open.pop_back();
    open.back().children.push_back(std::move(done));
  }

  Status Element(std::vector<XmlElement>& open) {
    XmlElement element;
    element.line = line_;
    Advance(1);
    element.name = Word();
    if (element.name.empty()) return Bad("'<' begins no element");
    for (SkipBlanks(); at_ < bytes_.size() && bytes_[at_] != '>' && bytes_[at_] != '/'; SkipBlanks()) {
      const std::string key = Word();
      SkipBlanks();
      if (key.empty() || !At("="))
        return Bad("an attribute NAME=\"VALUE\" is expected in '" + ShownText(element.name) + "'");
      Advance(1);
      SkipBlanks();
      Expected<std::string> value = Quoted();
      if (!value) return Forward(value);
      if (!element.attributes.emplace(key, std::move(*value)).second) {
        return Bad("the attribute '" + ShownText(key) + "' comes twice");
      }
    }
    const bool empty = At("/");
    if (empty) Advance(1);
    if (!At(">")) return Bad("the element '" + ShownText(element.name) + "' has no '>'");
    Advance(1);
    if (open.size() > kMaxXmlDepth) return Bad("elements are nested too deeply");
    open.push_back(std::move(element));
    if (empty) Close(open);
    return {};
  }

  std::string Word() {
    std::string word;
    while (at_ < bytes_.size()) {
      const char c = bytes_[at_];
      const bool part = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                        c == '-' || c == '.' || c == ':' || static_cast<unsigned char>(c) >= 128;
      if (!part) break;
      word += c;
      ++at_;
    }
    return word;
  }

  Expected<std::string> Quoted() {
    if (!At("\"") && !At("'")) return Bad("the value of an attribute stands between quotes");
    const char quote = bytes_[at_];
    const std::size_t end = bytes_.find(quote, at_ + 1);
    if (end == std::string_view::npos) return Bad("the value of an attribute has no end");
    const std::string_view raw = bytes_.substr(at_ + 1, end - at_ - 1);
    if (raw.find('<') != std::string_view::npos) return Bad("'<' in the value of an attribute");
    std::string value;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (raw[i] != '&') {
        value += raw[i];
        continue;
      }
      const std::size_t stop = raw.find(';', i);
      const std::string_view entity = stop == std::string_view::npos ? raw.substr(i) : raw.substr(i + 1, stop - i - 1);
      const std::optional<char> character = stop == std::string_view::npos ? std::nullopt : Entity(entity);
      if (!character) return Bad("'" + ShownText(entity) + "' is no known entity");
      value += *character;
      i = stop;
    }
    Advance(end + 1 - at_);
    return value;
  }

  static std::optional<char> Entity(std::string_view entity) {
    constexpr std::array<std::pair<std::string_view, char>, 5> kEntities = {
        {{"amp", '&'}, {"lt", '<'}, {"gt", '>'}, {"quot", '"'}, {"apos", '\''}}};
    for (const auto& [known, character] : kEntities) {
      if (known == entity) return character;
    }
    if (entity.size() < 2 || entity[0] != '#') return std::nullopt;
    const std::optional<long long> code = ParseInteger(entity.substr(1));
    return code && *code >= 9 && *code < 128 ? std::optional(static_cast<char>(*code)) : std::nullopt;
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
  int line_ = 1;
};

}  // namespace

const XmlElement* XmlElement::Find(std::string_view child) const {
  const auto found =
      std::find_if(children.begin(), children.end(), [&](const XmlElement& element) { return element.name == child; });
  return found == children.end() ? nullptr : &*found;
}

Expected<XmlElement> ParseXml(std::string_view bytes, const std::string& name) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (bytes.substr(0, 3) == kByteOrderMark) bytes.remove_prefix(3);
  if (Trim(bytes).empty()) return EmptyFile(name);
  return XmlParser(bytes, name).Parse();
}

}  // namespace mocurate
