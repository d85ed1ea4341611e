#pragma once

#include <string>

#include "core/base/text.h"
#include "core/formats/expmap_table.h"

namespace mocurate {

inline std::string WriteExpmapTable(const ExpmapTable& table) {
  const std::size_t numbers = static_cast<std::size_t>(table.joints) * 3;
  std::string text;
  for (std::size_t f = 0; f < static_cast<std::size_t>(table.frames); ++f) {
    for (std::size_t i = 0; i < 3; ++i) text += (i == 0 ? "" : ",") + FormatDouble(table.root[f * 3 + i]);
    for (std::size_t i = 0; i < numbers; ++i) text += "," + FormatDouble(table.rotation_rad[f * numbers + i]);
    text += "\n";
  }
  return text;
}

}  // namespace mocurate
