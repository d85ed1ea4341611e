#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"

namespace mocurate {

/// The `.json` beside a clip of the Bandai-Namco-Research motion dataset: {"content": 6, "style": 11}, 0-based lines of
/// content_label.txt and style_label.txt.
struct BandaiLabel {
  int content = 0;
  int style = 0;
};

/// Error kMalformed with "name:line:column" where it is not JSON, "name:/key" where a key is missing, unknown, or not
/// a whole number from 0 on.
Expected<BandaiLabel> ParseBandaiLabel(std::string_view bytes, const std::string& name);

}  // namespace mocurate
