#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// An element of an XML file: attributes and elements; text between them is passed over.
struct XmlElement {
  std::string name;
  int line = 0;  ///< where it begins
  std::map<std::string, std::string> attributes;
  std::vector<XmlElement> children;

  /// The first child of this name; null when there is none.
  const XmlElement* Find(std::string_view child) const;
};

/// The root element. Comments, processing instructions and CDATA are passed over; the five entities and &#n; below 128
/// are replaced. Error kMalformed "name:line"; kUnsupported for a DOCTYPE. Elements are nested 64 deep at most.
Expected<XmlElement> ParseXml(std::string_view bytes, const std::string& name);

}  // namespace mocurate
