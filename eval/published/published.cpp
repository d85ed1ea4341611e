#include "eval/published/published.h"

#include <nlohmann/json.hpp>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr std::size_t kPublishedFields = 9;

/// Fields of a line; a field in quotes may hold commas.
std::vector<std::string> FieldsOfLine(std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

}  // namespace

Expected<std::vector<PublishedValue>> ParsePublished(std::string_view csv, const std::string& name) {
  std::vector<PublishedValue> values;
  int line_number = 0;
  for (const std::string_view line : SplitText(csv, '\n')) {
    ++line_number;
    if (line_number == 1 || line.empty()) continue;
    const std::vector<std::string> fields = FieldsOfLine(line);
    const auto number = fields.size() == kPublishedFields ? ParseDouble(fields[5]) : std::nullopt;
    if (!number) {
      return Fail(
          ErrorCode::kMalformed,
          std::to_string(fields.size()) + " fields, " + std::to_string(kPublishedFields) + " with a number are needed",
          name + ":" + std::to_string(line_number), "paper,table,dataset,method,metric,value,pm,pm_kind,source");
    }
    values.push_back(
        {fields[0], fields[1], fields[2], fields[3], fields[4], *number, ParseDouble(fields[6]), fields[7], fields[8]});
  }
  return values;
}

nlohmann::json PublishedOf(const std::vector<PublishedValue>& values, const std::string& paper,
                           const std::string& dataset) {
  nlohmann::json list = nlohmann::json::array();
  for (const bool own : {true, false}) {
    for (const PublishedValue& value : values) {
      if (value.dataset != dataset || (value.paper == paper) != own) continue;
      list.push_back({{"method", value.method},
                      {"dataset", value.dataset},
                      {"metric", value.metric},
                      {"value", value.value},
                      {"pm", value.pm ? nlohmann::json(*value.pm) : nlohmann::json()},
                      {"pm_kind", value.pm_kind},
                      {"table", value.table},
                      {"source", value.source}});
    }
  }
  return list;
}

}  // namespace mocurate
