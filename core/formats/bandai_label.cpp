#include "core/formats/bandai_label.h"

#include <limits>

#include "core/base/json_text.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

using nlohmann::json;

Expected<int> Index(const json& label, const char* key, const std::string& name) {
  const auto found = label.find(key);
  if (found == label.end()) return Fail(ErrorCode::kMalformed, std::string("the key '") + key + "' is missing", name);
  const bool whole = found->is_number_unsigned() && found->get<std::uint64_t>() <= std::numeric_limits<int>::max();
  if (!whole) {
    return Fail(ErrorCode::kMalformed,
                "expected a whole number of at least 0, found " + Shown(found->dump(-1, ' ', true)), name + ":/" + key);
  }
  return found->get<int>();
}

}  // namespace

Expected<BandaiLabel> ParseBandaiLabel(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kLargest = 4096;  // a label is thirty bytes
  if (bytes.size() > kLargest) return Fail(ErrorCode::kMalformed, "the label is too long", name);
  const Expected<json> label = ParseJson(bytes, name);
  if (!label) return Forward(label);
  if (!label->is_object()) return Fail(ErrorCode::kMalformed, "the label is not a JSON object", name + ":/");
  for (const auto& item : label->items()) {
    if (item.key() == "content" || item.key() == "style") continue;
    return Fail(ErrorCode::kMalformed, "unknown key '" + Shown(item.key()) + "'", name + ":/",
                "a label has content and style");
  }
  const Expected<int> content = Index(*label, "content", name);
  if (!content) return Forward(content);
  const Expected<int> style = Index(*label, "style", name);
  if (!style) return Forward(style);
  return BandaiLabel{*content, *style};
}

}  // namespace mocurate
