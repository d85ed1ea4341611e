#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/finding.h"
#include "tests/base/sample_options.h"

namespace mocurate {
namespace {

std::string JsonMessage(const nlohmann::json& json) {
  const auto options = OptionsFromJson<SampleOptions>(json);
  return options ? "" : options.error().Message();
}

TEST(OptionsJson, DefaultsAreWrittenToo) {
  const nlohmann::json json = OptionsToJson(SampleOptions{});
  EXPECT_EQ(
      json.dump(),
      R"({"angle":0.5,"height":1.7,"joints":[{"name":"knee","weight":3.0}],"labels":{},"limit":null,"loss":"mse",)"
      R"("offsets":[0.0,1.0],"path":"","people":[],"rate":30.0,"seed":7,"share":0.5,"size":1000.0,"step":0.1,)"
      R"("title":"sample","trim":{"enabled":true,"still_speed":0.05}})");
}

TEST(OptionsJson, WhatIsWrittenReadsBack) {
  SampleOptions options;
  options.limit = 2.5;
  options.path = "data/\xff clip";
  options.labels = {{"a01", "walk"}};
  options.people = {"p1", ""};
  options.loss = Loss::kHuber;
  options.joints = {{"a", 1.0}, {"b", 2.0}};
  const nlohmann::json json = nlohmann::json::parse(OptionsToJson(options).dump());
  const auto back = OptionsFromJson<SampleOptions>(json);
  ASSERT_TRUE(back) << back.error().Message();
  EXPECT_EQ(OptionsToJson(*back).dump(), json.dump());
  EXPECT_EQ(back->path, options.path);
}

TEST(OptionsJson, MissingKeysKeepDefaultsAndAGivenListReplacesThem) {
  const auto options = OptionsFromJson<SampleOptions>({{"joints", {{{"name", "wrist"}}}}});
  ASSERT_TRUE(options) << options.error().Message();
  EXPECT_EQ(options->seed, 7);
  ASSERT_EQ(options->joints.size(), 1u);
  EXPECT_EQ(options->joints[0].weight, 1.0) << "not the 3 of the default list's first element";
}

TEST(OptionsJson, EveryProblemIsReportedAtOnce) {
  const nlohmann::json json = {{"seed", 1.5},
                               {"height", 9},
                               {"tittle", "x"},
                               {"limit", "none"},
                               {"offsets", {0, "a"}},
                               {"loss", "hubert"},
                               {"trim", {{"enabled", 1}, {"sped", 2}}},
                               {"joints", {{{"weight", -1}}, 5}}};
  EXPECT_EQ(JsonMessage(json),
            "options.seed: '1.5' must be a whole number\n"
            "options.height: '9' is out of range (allowed: 0.5 to 2.5 m)\n"
            "options.limit: 'none' must be a number in m (a value in quotes is text, remove the quotes)\n"
            "options.offsets.1: 'a' must be a number in m (a value in quotes is text, remove the quotes)\n"
            "options.loss: 'hubert' must be one of mse, huber (did you mean 'huber'?)\n"
            "options.trim.enabled: '1' must be true or false\n"
            "options.trim: unknown option 'options.trim.sped' (known here: enabled, still_speed)\n"
            "options.joints.0.weight: '-1' is out of range (allowed: 0 to 100)\n"
            "options.joints.1: '5' must be a mapping\n"
            "options: unknown option 'options.tittle' (did you mean 'title'?)");
}

TEST(OptionsJson, WrongShapesAreRefused) {
  EXPECT_EQ(JsonMessage(nlohmann::json::array()), "options: a list must be a mapping");
  EXPECT_EQ(JsonMessage({{"labels", {{"a", 1}}}}), "options.labels.a: '1' must be a text");
  EXPECT_EQ(JsonMessage({{"people", "p1"}}), "options.people: 'p1' must be a list of texts (write [a, b])");
  EXPECT_EQ(JsonMessage({{"joints", 1}}), "options.joints: '1' must be a list of mappings (write [a, b])");
  EXPECT_EQ(
      JsonMessage({{"seed", 18446744073709551615u}}),
      "options.seed: '18446744073709551615' does not fit 64 bits (whole numbers reach from -9223372036854775808 to "
      "9223372036854775807)");
  EXPECT_EQ(JsonMessage({{"height", nullptr}}), "options.height: no value must be a number in m");
}

TEST(Finding, SurvivesJson) {
  Finding finding{"clip_1", "jerk", Severity::kError, 3, 9, "knee", 0.25, 0.0, "too fast", FindingAction::kDropped};
  EXPECT_EQ(nlohmann::json(finding).get<Finding>(), finding);
  finding.value = std::numeric_limits<double>::quiet_NaN();
  finding.severity = Severity::kInfo;
  EXPECT_EQ(nlohmann::json::parse(nlohmann::json(finding).dump()).get<Finding>(), finding);
}

}  // namespace
}  // namespace mocurate
