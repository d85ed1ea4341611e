#include "core/formats/xml.h"

#include <algorithm>
#include <pugixml.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

std::string LinePlace(std::string_view bytes, const std::string& name, std::size_t offset) {
  const std::string_view before = bytes.substr(0, offset);
  return name + ":" + std::to_string(1 + std::count(before.begin(), before.end(), '\n'));
}

/// Stops at the first element with a duplicate attribute, which pugixml does not check.
struct RepeatedAttribute : pugi::xml_tree_walker {
  pugi::xml_node element;
  std::string name;

  bool for_each(pugi::xml_node& node) override {
    std::set<std::string_view> names;
    for (const pugi::xml_attribute attribute : node.attributes()) {
      if (names.insert(attribute.name()).second) continue;
      element = node;
      name = attribute.name();
      return false;
    }
    return true;
  }
};

}  // namespace

Status CheckMarkup(std::string_view bytes, const std::string& name) {
  if (Trim(bytes).empty()) return EmptyFile(name);
  if (const auto bad = FirstNotUtf8(bytes)) {
    return Fail(ErrorCode::kMalformed, "a byte is not UTF-8", LinePlace(bytes, name, *bad), "save the file as UTF-8");
  }
  const auto control = std::find_if(bytes.begin(), bytes.end(), [](char c) {
    return static_cast<unsigned char>(c) < ' ' && c != '\t' && c != '\n' && c != '\r';
  });
  if (control == bytes.end()) return {};
  return Fail(ErrorCode::kMalformed, "a control character (code " + std::to_string(*control) + ")",
              LinePlace(bytes, name, static_cast<std::size_t>(control - bytes.begin())));
}

Status ParseXml(std::string_view bytes, const std::string& name, pugi::xml_document& document) {
  if (Status text = CheckMarkup(bytes, name); !text) return text;
  const pugi::xml_parse_result parsed =
      document.load_buffer(bytes.data(), bytes.size(),
                           pugi::parse_default | pugi::parse_fragment | pugi::parse_trim_pcdata, pugi::encoding_utf8);
  if (!parsed) {
    const auto offset = static_cast<std::size_t>(parsed.offset);
    return Fail(ErrorCode::kMalformed, std::string("the file is not XML: ") + parsed.description(),
                LinePlace(bytes, name, offset), offset + 1 >= bytes.size() ? "is the file cut off?" : "");
  }
  const pugi::xml_node root = document.document_element();
  if (!root) return Fail(ErrorCode::kMalformed, "the file has no element", name);
  for (const pugi::xml_node node : document) {
    if (node == root) continue;
    return Fail(ErrorCode::kMalformed, "text or an element is found beside the root element",
                XmlPlace(bytes, name, node));
  }
  RepeatedAttribute repeated;
  document.traverse(repeated);
  if (!repeated.element) return {};
  return Fail(ErrorCode::kMalformed, "the attribute '" + Shown(repeated.name) + "' appears twice",
              XmlPlace(bytes, name, repeated.element));
}

std::string XmlPlace(std::string_view bytes, const std::string& name, const pugi::xml_node& element) {
  return LinePlace(bytes, name, static_cast<std::size_t>(std::max<std::ptrdiff_t>(element.offset_debug(), 0)));
}

}  // namespace mocurate
