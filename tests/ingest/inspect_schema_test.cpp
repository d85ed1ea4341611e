// docs/inspect.schema.json is true of what `mocurate inspect --json` prints.

#include <gmock/gmock.h>

#include <functional>
#include <regex>

#include "tests/ingest/inspections.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The keywords of JSON Schema (draft 2020-12) that the document uses; any other is told as a fault of the schema.
class SchemaCheck {
 public:
  explicit SchemaCheck(Json schema) : schema_(std::move(schema)) {}

  std::vector<std::string> Faults(const Json& document) {
    faults_.clear();
    Check(schema_, document, "");
    return faults_;
  }

 private:
  void Fault(const std::string& place, const std::string& what) { faults_.push_back(place + ": " + what); }

  static bool Is(const Json& value, const std::string& type) {
    if (type == "integer") return value.is_number_integer();
    if (type == "number") return value.is_number();
    if (type == "string") return value.is_string();
    if (type == "null") return value.is_null();
    return type == "array" ? value.is_array() : type == "object" && value.is_object();
  }

  void CheckObject(const Json& schema, const Json& value, const std::string& place) {
    const Json own = schema.value("properties", Json::object());
    for (const auto& [key, entry] : value.items()) {
      const Json* rule = own.contains(key) ? &own.at(key) : nullptr;
      if (rule == nullptr && schema.contains("additionalProperties")) rule = &schema.at("additionalProperties");
      if (rule != nullptr) Check(*rule, entry, place + "/" + key);
    }
    for (const Json& key : schema.value("required", Json::array())) {
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

  void CheckKeyword(const Json& schema, const std::string& keyword, const Json& value, const std::string& place) {
    static const std::set<std::string> words = {"$schema",     "$defs",    "title",
                                                "description", "required", "additionalProperties"};
    const Json& said = schema.at(keyword);
    if (words.count(keyword) != 0) return;
    if (keyword == "$ref")
      return Check(schema_.at(Json::json_pointer(said.get<std::string>().substr(1))), value, place);
    if (keyword == "type") {
      const Json types = said.is_array() ? said : Json::array({said});
      const auto is = [&](const Json& type) { return Is(value, type); };
      if (std::none_of(types.begin(), types.end(), is)) Fault(place, value.dump() + " is no " + said.dump());
    } else if (keyword == "enum") {
      if (std::find(said.begin(), said.end(), value) == said.end()) Fault(place, value.dump() + " is none of the enum");
    } else if (keyword == "properties") {
      if (value.is_object()) CheckObject(schema, value, place);
    } else if (keyword == "items") {
      for (std::size_t i = 0; value.is_array() && i < value.size(); ++i) {
        Check(said, value[i], place + "/" + std::to_string(i));
      }
    } else if (keyword == "minItems" || keyword == "maxItems") {
      const bool least = keyword == "minItems";
      const auto limit = said.get<std::size_t>();
      if (value.is_array() && (least ? value.size() < limit : value.size() > limit)) Fault(place, keyword);
    } else if (keyword == "pattern") {
      if (value.is_string() && !std::regex_search(value.get<std::string>(), std::regex(said.get<std::string>())))
        Fault(place, value.dump() + " is not as the pattern");
    } else if (keyword == "minimum" || keyword == "maximum" || keyword == "exclusiveMinimum") {
      if (value.is_number()) CheckNumber(keyword, said, value, place);
    } else {
      Fault(place, "the schema's keyword " + keyword + " is not known");
    }
  }

  void Check(const Json& schema, const Json& value, const std::string& place) {
    if (schema.is_boolean()) {
      if (!schema.get<bool>()) Fault(place, "is not in the schema");
      return;
    }
    if (!schema.contains("properties") && schema.contains("additionalProperties") && value.is_object())
      CheckObject(schema, value, place);
    for (const auto& [keyword, said] : schema.items()) CheckKeyword(schema, keyword, value, place);
  }

  Json schema_;
  std::vector<std::string> faults_;
};

SchemaCheck Schema() {
  const auto bytes = ReadFile(std::filesystem::path(MOCURATE_SOURCE_FOLDER) / "docs/inspect.schema.json");
  return SchemaCheck(Json::parse(bytes ? *bytes : "{}"));
}

TEST(InspectSchema, HoldsOfAllRecordedDataWithAndWithoutASource) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  SchemaCheck schema = Schema();
  const Json all = InspectPath(TestData(), std::nullopt);
  EXPECT_GT(all.at("clips").size(), 1000u);
  for (const char* part : {"groups", "cameras", "clouds", "companions", "findings"}) EXPECT_FALSE(all.at(part).empty());
  EXPECT_THAT(schema.Faults(all), IsEmpty());
  for (const char* source : {"kard", "ntu", "bandai2", "pose2sim_single"}) {
    const IngestOptions options = Declared(source);
    EXPECT_THAT(schema.Faults(InspectPath(options.path, options.source)), IsEmpty()) << source;
  }
}

TEST(InspectSchema, HoldsOfFilesThatCannotBeReadAreEmptyOrNotThere) {
  SchemaCheck schema = Schema();
  const std::filesystem::path folder = FreshFolder("schema");
  Put(folder / "cut.bvh", "HIERARCHY\nROOT hips\n{\nOFFSET 0 0");
  Put(folder / "empty.txt", "");
  Put(folder / "torn.json", "{\"people\": [");
  for (const std::filesystem::path& path : {folder, folder / "cut.bvh", folder / "torn.json", folder / "none.bvh"}) {
    const Json inspection = InspectPath(path, std::nullopt);
    EXPECT_FALSE(inspection.at("findings").empty()) << path;
    EXPECT_THAT(schema.Faults(inspection), IsEmpty()) << path;
  }
}

TEST(InspectSchema, TellsWhatIsNotInIt) {
  SchemaCheck schema = Schema();
  Json inspection = InspectPath(FreshFolder("schema_nothing"), std::nullopt);
  ASSERT_THAT(schema.Faults(inspection), IsEmpty());
  inspection["clips"].push_back({{"id", 3}});
  inspection["findings"].push_back(
      {{"code", "a b"}, {"severity", "fatal"}, {"where", ""}, {"value", 0}, {"message", ""}, {"more", 1}});
  const std::vector<std::string> faults = schema.Faults(inspection);
  for (const char* fault :
       {"/clips/0/id: 3 is no", "/clips/0: has no \"frames\"", "/code: \"a b\" is not as the pattern",
        "/severity: \"fatal\" is none", "/more: is not in the schema"}) {
    EXPECT_THAT(faults, Contains(HasSubstr(fault)));
  }
}

}  // namespace
}  // namespace mocurate
