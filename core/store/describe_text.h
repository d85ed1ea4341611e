#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace mocurate {

/// The result of DescribeStore as a few lines of text.
std::string StoreText(const nlohmann::json& description);

/// Lines of these texts: "  name        text" (none for an empty text), and "9: a (12), b (3) and 7 more" of names with
/// their counts.
std::string DescriptionLine(const std::string& name, const std::string& text);
std::string TallyText(const nlohmann::json& tally);

}  // namespace mocurate
