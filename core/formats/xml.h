#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"

namespace pugi {
class xml_document;
class xml_node;
}  // namespace pugi

namespace mocurate {

/// Error kMalformed "name:line" for bytes that are not UTF-8 and for control characters.
Status CheckMarkup(std::string_view bytes, const std::string& name);

/// Parses a file of one root element into `document`. Document types are skipped, entities other than the five of XML
/// stay as they are. Error kMalformed "name:line", also for text beside the root and for a duplicate attribute.
Status ParseXml(std::string_view bytes, const std::string& name, pugi::xml_document& document);

/// "name:line" of an element of a document that was parsed from `bytes`.
std::string XmlPlace(std::string_view bytes, const std::string& name, const pugi::xml_node& element);

}  // namespace mocurate
