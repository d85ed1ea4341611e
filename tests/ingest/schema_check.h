#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "tests/support/folders.h"

namespace mocurate {

/// Checks a document against the JSON Schema (draft 2020-12) keywords that the schema uses; any other is a fault.
class SchemaCheck {
 public:
  SchemaCheck() {
    const auto bytes = ReadFile(std::filesystem::path(kSourceFolder) / "docs/inspect.schema.json");
    schema_ = nlohmann::json::parse(bytes ? *bytes : "{}");
  }

  std::vector<std::string> Faults(const nlohmann::json& document) {
    faults_.clear();
    Check(schema_, document, "");
    return faults_;
  }

 private:
  void Fault(const std::string& place, const std::string& what) { faults_.push_back(place + ": " + what); }

  static bool Is(const nlohmann::json& value, const std::string& type) {
    if (type == "integer") return value.is_number_integer();
    if (type == "number") return value.is_number();
    if (type == "string") return value.is_string();
    if (type == "null") return value.is_null();
    return type == "array" ? value.is_array() : type == "object" && value.is_object();
  }

  void CheckObject(const nlohmann::json& schema, const nlohmann::json& value, const std::string& place) {
    const nlohmann::json own = schema.value("properties", nlohmann::json::object());
    for (const auto& [key, entry] : value.items()) {
      const nlohmann::json* rule = own.contains(key) ? &own.at(key) : nullptr;
      if (rule == nullptr && schema.contains("additionalProperties")) rule = &schema.at("additionalProperties");
      if (rule != nullptr) Check(*rule, entry, place + "/" + key);
    }
    for (const nlohmann::json& key : schema.value("required", nlohmann::json::array())) {
      if (!value.contains(key)) Fault(place, "has no " + key.dump());
    }
  }

  void CheckNumber(const std::string& keyword, double limit, double value, const std::string& place) {
    const bool fits = keyword == "minimum"            ? value >= limit
                      : keyword == "maximum"          ? value <= limit
                      : keyword == "exclusiveMinimum" ? value > limit
                                                      : false;
    if (!fits) Fault(place, keyword + " of " + std::to_string(value));
  }

  void CheckKeyword(const nlohmann::json& schema, const std::string& keyword, const nlohmann::json& value,
                    const std::string& place) {
    static const std::set<std::string> annotations = {"$schema",     "$defs",    "title",
                                                      "description", "required", "additionalProperties"};
    const nlohmann::json& constraint = schema.at(keyword);
    if (annotations.count(keyword) != 0) return;
    if (keyword == "$ref")
      return Check(schema_.at(nlohmann::json::json_pointer(constraint.get<std::string>().substr(1))), value, place);
    if (keyword == "type") {
      const nlohmann::json types = constraint.is_array() ? constraint : nlohmann::json::array({constraint});
      const auto is = [&](const nlohmann::json& type) { return Is(value, type); };
      if (std::none_of(types.begin(), types.end(), is)) Fault(place, value.dump() + " is no " + constraint.dump());
    } else if (keyword == "enum") {
      if (std::find(constraint.begin(), constraint.end(), value) == constraint.end())
        Fault(place, value.dump() + " is not one of the enum");
    } else if (keyword == "properties") {
      if (value.is_object()) CheckObject(schema, value, place);
    } else if (keyword == "items") {
      for (std::size_t i = 0; value.is_array() && i < value.size(); ++i) {
        Check(constraint, value[i], place + "/" + std::to_string(i));
      }
    } else if (keyword == "minItems" || keyword == "maxItems") {
      const bool least = keyword == "minItems";
      const auto limit = constraint.get<std::size_t>();
      if (value.is_array() && (least ? value.size() < limit : value.size() > limit)) Fault(place, keyword);
    } else if (keyword == "pattern") {
      if (value.is_string() && !std::regex_search(value.get<std::string>(), std::regex(constraint.get<std::string>())))
        Fault(place, value.dump() + " is not as the pattern");
    } else if (keyword == "minimum" || keyword == "maximum" || keyword == "exclusiveMinimum") {
      if (value.is_number()) CheckNumber(keyword, constraint, value, place);
    } else {
      Fault(place, "the schema's keyword " + keyword + " is not known");
    }
  }

  void Check(const nlohmann::json& schema, const nlohmann::json& value, const std::string& place) {
    if (schema.is_boolean()) {
      if (!schema.get<bool>()) Fault(place, "is not in the schema");
      return;
    }
    if (!schema.contains("properties") && schema.contains("additionalProperties") && value.is_object())
      CheckObject(schema, value, place);
    for (const auto& [keyword, constraint] : schema.items()) CheckKeyword(schema, keyword, value, place);
  }

  nlohmann::json schema_;
  std::vector<std::string> faults_;
};

}  // namespace mocurate
