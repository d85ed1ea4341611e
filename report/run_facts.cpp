#include "report/run_facts.h"

#include <cmath>
#include <limits>

#include "report/html.h"

namespace mocurate {

const nlohmann::json& Field(const nlohmann::json& json, const char* key) {
  static const nlohmann::json kNull;
  if (!json.is_object()) return kNull;
  const auto found = json.find(key);
  return found == json.end() ? kNull : *found;
}

const std::vector<nlohmann::json>& Elements(const nlohmann::json& json) {
  static const std::vector<nlohmann::json> kNone;
  return json.is_array() ? json.get_ref<const std::vector<nlohmann::json>&>() : kNone;
}

std::optional<double> NumberOf(const nlohmann::json& json, const char* key) {
  const nlohmann::json& field = Field(json, key);
  if (!field.is_number() || !std::isfinite(field.get<double>())) return std::nullopt;
  return field.get<double>();
}

long long CountOf(const nlohmann::json& json, const char* key) {
  return static_cast<long long>(NumberOf(json, key).value_or(0.0));
}

std::string TextOf(const nlohmann::json& json, const char* key) {
  const nlohmann::json& field = Field(json, key);
  return field.is_string() ? field.get<std::string>() : std::string();
}

std::vector<double> NumbersOf(const nlohmann::json& json) {
  std::vector<double> numbers;
  for (const nlohmann::json& element : Elements(json)) {
    numbers.push_back(element.is_number() ? element.get<double>() : std::numeric_limits<double>::quiet_NaN());
  }
  return numbers;
}

std::string TextCell(const nlohmann::json& json, const char* key) { return EscapeHtml(TextOf(json, key)); }

std::string CountCell(const nlohmann::json& json, const char* key) { return CountText(CountOf(json, key)); }

std::string NumberCell(const nlohmann::json& json, const char* key, int digits) {
  const auto value = NumberOf(json, key);
  return value ? FixedText(*value, digits) : "–";
}

std::vector<double> OverClips(const nlohmann::json& run, const char* part, const char* key) {
  std::vector<double> values;
  for (const nlohmann::json& clip : Elements(Field(run, "clips"))) {
    const nlohmann::json& figures = Field(clip, "fitting");
    if (const auto value = NumberOf(*part == '\0' ? figures : Field(figures, part), key)) values.push_back(*value);
  }
  return values;
}

}  // namespace mocurate
