#include "core/base/json_text.h"

#include <gtest/gtest.h>

#include "core/base/file.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

std::string Nested(int levels) {
  const auto count = static_cast<std::size_t>(levels);
  return std::string(count, '[') + std::string(count, ']');
}

TEST(Json, IsReadToADepthThatRecursionSurvives) {
  EXPECT_TRUE(ParseJson(Nested(kDeepestJson), "a.json"));
  EXPECT_TRUE(ParseJson(R"(["[[[\\", "\"[[[", )" + Nested(kDeepestJson - 1) + "]", "a.json")) << "brackets in texts";
  EXPECT_TRUE(ParseOrderedJson(Nested(kDeepestJson), "a.json"));
  std::string objects;
  for (int i = 0; i < 400000; ++i) objects += "{\"a\":";
  for (const std::string& deep : {Nested(kDeepestJson + 1), Nested(400000), objects, std::string(400000, '[')}) {
    const auto value = ParseJson(deep, "a.json");
    ASSERT_FALSE(value);
    EXPECT_EQ(value.error().code, ErrorCode::kMalformed);
  }
  EXPECT_EQ(ParseJson("{\n \"a\":" + Nested(kDeepestJson), "a.json").error().where, "a.json:2:205");
  EXPECT_FALSE(ParseOrderedJson(Nested(kDeepestJson + 1), "a.json"));
}

TEST(Json, DamageHasItsPlace) {
  EXPECT_EQ(ParseJson("{\n \"a\": x}", "a.json").error().where, "a.json:2:7");
  EXPECT_EQ(ParseJson("[1", "a.json").error().code, ErrorCode::kMalformed);
  EXPECT_EQ(ParseJson("[1e999]", "a.json").error().code, ErrorCode::kMalformed);
  EXPECT_EQ(ParseJson(" \n", "a.json").error().reason, Reason::kEmptyFile);
  EXPECT_EQ(ReadJson("no/such.json").error().code, ErrorCode::kNotFound);
  const ScratchFolder folder;
  ASSERT_TRUE(WriteFile(folder / "a.json", "[1, 2"));
  EXPECT_EQ(ReadJson(folder / "a.json").error().where, (folder / "a.json").native() + ":1:6");
}

TEST(Json, ARepeatedKeyIsFoundInAnyObjectOfALongList) {
  EXPECT_EQ(RepeatedKey(R"({"a": {"b": 1}, "b": [{"a": "b"}, {"a": 1}]})"), std::nullopt);
  EXPECT_EQ(RepeatedKey(R"({"a": {"b": 1, "c": {}, "b": 2}})"), "b");
  std::string list = "[";
  for (int i = 0; i < 1000000; ++i) list += "{},";
  EXPECT_EQ(RepeatedKey(list + R"({"a": 1, "a": 2}])"), "a");
}

TEST(Json, AValueOfAnotherTypeIsAnErrorOfTheFile) {
  const nlohmann::json value = {{"list", {1, 2}}};
  const auto read = [&](const char* key) {
    return GuardJson("a.json", [&] { return value.at(key).get<std::string>(); });
  };
  for (const char* key : {"list", "none"}) {
    ASSERT_FALSE(read(key));
    EXPECT_EQ(read(key).error().code, ErrorCode::kMalformed);
    EXPECT_EQ(read(key).error().where, "a.json");
  }
  const Status done = GuardJson("a.json", [&] { static_cast<void>(value.at("list").size()); });
  EXPECT_TRUE(done);
  const Expected<int> own = GuardJson("a.json", [&]() -> Expected<int> { return Fail(ErrorCode::kUsage, "own"); });
  EXPECT_EQ(own.error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace mocurate
