#include <nlohmann/json.hpp>

#include "core/base/config_parts.h"
#include "core/base/file.h"
#include "core/base/units.h"

namespace mocurate {
namespace {

using nlohmann::json;

constexpr const char* kReference = "\\$\\{";

std::string RegexOf(Unit unit) {
  const std::string number = "[-+]?[0-9.]+([eE][-+]?[0-9]+)?";
  return "^\\s*" + number + "(\\s*/\\s*" + number + ")?\\s*(" + SpellingsOf(unit, "|") + ")?\\s*$|" + kReference;
}

/// Collects the schema of every option; open groups and lists are on a stack.
class SchemaWriter final : public OptionVisitor {
 public:
  SchemaWriter() { open_.push_back({"", NewObject("")}); }
  json Result() { return std::move(open_.front().schema); }

  void Bool(const char* name, bool& value, const char* help) override {
    Put(name, {{"type", {"boolean", "string"}}, {"pattern", kReference}, {"default", value}}, help);
  }
  void Integer(const char* name, std::int64_t& value, Range range, const char* help) override {
    json schema = {{"type", {"integer", "string"}}, {"pattern", kReference}, {"default", value}};
    PutBounds(schema, range);
    Put(name, std::move(schema), help);
  }
  void Number(const char* name, double& value, Unit unit, Range range, const char* help) override {
    json schema = NumberSchema(unit, range);
    schema["default"] = value;
    Put(name, std::move(schema), help);
  }
  void OptionalNumber(const char* name, std::optional<double>& value, Unit unit, Range range,
                      const char* help) override {
    json schema = NumberSchema(unit, range);
    schema["type"].push_back("null");
    schema["default"] = value ? json(*value) : json();
    Put(name, std::move(schema), help);
  }
  void Text(const char* name, std::string& value, const char* help) override {
    json schema = TextSchema();
    schema["default"] = value;
    Put(name, std::move(schema), help);
  }
  void Path(const char* name, std::filesystem::path& value, const char* help) override {
    Put(name, {{"type", "string"}, {"default", DisplayPath(value)}}, help);
  }
  void Numbers(const char* name, std::vector<double>& value, Unit unit, Range range, const char* help) override {
    Put(name, {{"type", {"array", "null"}}, {"items", NumberSchema(unit, range)}, {"default", value}}, help);
  }
  void Texts(const char* name, std::vector<std::string>& value, const char* help) override {
    Put(name, {{"type", {"array", "null"}}, {"items", TextSchema()}, {"default", value}}, help);
  }
  void ChoiceList(const char* name, std::vector<std::string>& value, const std::vector<std::string>& names,
                  const char* help) override {
    Put(name, {{"type", {"array", "null"}}, {"items", {{"enum", names}}}, {"default", value}}, help);
  }
  void TextMap(const char* name, std::map<std::string, std::string>& value, const char* help) override {
    Put(name, {{"type", {"object", "null"}}, {"additionalProperties", TextSchema()}, {"default", value}}, help);
  }
  void ChoiceIndex(const char* name, std::size_t& index, const std::vector<std::string>& names,
                   const char* help) override {
    const json choices = {{{"enum", names}}, {{"type", "string"}, {"pattern", kReference}}};
    Put(name, {{"anyOf", choices}, {"default", names[index]}}, help);
  }

  void BeginGroup(const char* name, const char* help) override { open_.push_back({name, NewObject(help)}); }
  void EndGroup() override { Close(); }

  /// One default element describes all elements.
  std::size_t BeginList(const char* name, std::size_t, const char* help) override {
    json list = {{"type", {"array", "null"}}};
    if (*help != '\0') list["description"] = help;
    open_.push_back({name, std::move(list)});
    return 1;
  }
  bool ReplacesList() const override { return true; }
  void BeginElement(std::size_t) override { open_.push_back({"", NewObject("")}); }
  void EndElement() override {
    json element = std::move(open_.back().schema);
    open_.pop_back();
    open_.back().schema["items"] = std::move(element);
  }
  void EndList() override { Close(); }

 private:
  struct Open {
    std::string name;
    json schema;
  };

  static json NewObject(const char* help) {
    json schema = {{"type", {"object", "null"}}, {"additionalProperties", false}, {"properties", json::object()}};
    if (*help != '\0') schema["description"] = help;
    return schema;
  }

  static void PutBounds(json& schema, const Range& range) {
    if (range.min) schema["minimum"] = *range.min;
    if (range.max) schema["maximum"] = *range.max;
  }

  static json NumberSchema(Unit unit, const Range& range) {
    json schema = {{"type", {"number", "string"}}, {"pattern", RegexOf(unit)}};
    PutBounds(schema, range);
    if (unit != Unit::kNone) schema["$comment"] = "plain numbers are in " + std::string(Name(unit));
    return schema;
  }

  static json TextSchema() { return {{"type", {"string", "number", "boolean"}}}; }

  void Put(const std::string& name, json schema, const char* help) {
    if (*help != '\0') schema["description"] = help;
    open_.back().schema["properties"][name] = std::move(schema);
  }

  void Close() {
    Open closed = std::move(open_.back());
    open_.pop_back();
    open_.back().schema["properties"][closed.name] = std::move(closed.schema);
  }

  std::vector<Open> open_;
};

}  // namespace

namespace internal {

json SchemaOf(Declaration declaration) {
  SchemaWriter writer;
  declaration.declare(declaration.options, writer);
  json schema = writer.Result();
  schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  schema["properties"]["include"] = {{"type", {"string", "array"}},
                                     {"items", {{"type", "string"}}},
                                     {"description", "configurations to start from, the later over the earlier"}};
  return schema;
}

}  // namespace internal
}  // namespace mocurate
