#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/base/config_message.h"

namespace mocurate {
namespace {

constexpr const char* kYaml =
    "seed: 12\n"
    "height: 180 cm\n"
    "title: \"a: 'b' ${seed}\"\n"
    "labels: {a01: walk}\n"
    "trim:\n"
    "  enabled: false\n"
    "joints: [{name: x}, {name: '2', weight: 5}]\n";

TEST(ConfigShow, ReportsWhereEveryValueComesFrom) {
  const auto node = LoadConfig(ConfigSource{kYaml, "c.yaml", {}}, {"rate=25 fps"});
  const auto options = OptionsFromConfig<SampleOptions>(*node);
  ASSERT_TRUE(options) << options.error().Message();
  EXPECT_EQ(ShowOptions(*options, *node, true),
            "seed: 12  # c.yaml:1:7\n"
            "height: 1.8 m  # c.yaml:2:9\n"
            "angle: 0.5 rad  # default\n"
            "step: 0.1 s  # default\n"
            "rate: 25 Hz  # --set\n"
            "size: 1000 B  # default\n"
            "share: 0.5  # default\n"
            "limit: null  # default\n"
            "title: \"a: 'b' 12\"  # c.yaml:3:8\n"
            "path: \"\"  # default\n"
            "offsets: [0 m, 1 m]  # default\n"
            "people: []  # default\n"
            "labels:\n"
            "  a01: walk  # c.yaml:4:15\n"
            "loss: mse  # default\n"
            "trim:\n"
            "  enabled: false  # c.yaml:6:12\n"
            "  still_speed: 0.05 m/s  # default\n"
            "joints:\n"
            "  - name: x  # c.yaml:7:17\n"
            "    weight: 1  # default\n"
            "  - name: \"2\"  # c.yaml:7:28\n"
            "    weight: 5  # c.yaml:7:41\n");
}

TEST(ConfigShow, WhatIsShownReadsBackAsTheSameOptions) {
  SampleOptions options;
  options.title = "quote \" back\\slash ${seed} tab\t line\n \xc3\xa9";
  options.people = {"", "null", "1.5", "- x", "#no", "true", "a: b"};
  options.labels = {{"", "e"}, {"a b", "${x}"}};
  options.path = "/a b/\xff\\x";
  options.limit = 1.0 / 3.0;
  options.joints.clear();
  for (const bool origins : {false, true}) {
    const std::string shown = ShowOptions(options, ConfigNode{}, origins);
    const auto back = ReadSample(shown);
    ASSERT_TRUE(back) << back.error().Message() << "\n" << shown;
    EXPECT_EQ(OptionsToJson(*back).dump(), OptionsToJson(options).dump()) << shown;
  }
}

TEST(ConfigSchema, DescribesEveryOption) {
  const nlohmann::json schema = OptionsSchema<SampleOptions>();
  EXPECT_TRUE(schema["$schema"] == "https://json-schema.org/draft/2020-12/schema");
  EXPECT_TRUE(schema["additionalProperties"] == false);
  const nlohmann::json& height = schema["properties"]["height"];
  EXPECT_EQ(height["type"].dump(), R"(["number","string"])");
  EXPECT_TRUE(height["minimum"] == 0.5);
  EXPECT_TRUE(height["default"] == 1.7);
  EXPECT_TRUE(height["description"] == "of the person");
  EXPECT_EQ(schema["properties"]["loss"]["anyOf"][0]["enum"].dump(), R"(["mse","huber"])");
  EXPECT_TRUE(schema["properties"]["trim"]["properties"]["enabled"]["default"] == true);
  EXPECT_TRUE(schema["properties"]["joints"]["items"]["properties"]["weight"]["default"] == 1.0)
      << "the default of an element, not of the default list's first";
  EXPECT_TRUE(schema["properties"].contains("include"));
  const nlohmann::json options = OptionsToJson(SampleOptions{});
  for (const auto& [name, ignored] : options.items()) {
    EXPECT_TRUE(schema["properties"].contains(name)) << name;
  }
}

TEST(ConfigReferencePage, HasARowForEveryOption) {
  const std::string page = OptionsReference<SampleOptions>("Sample");
  EXPECT_EQ(page.substr(0, page.find("| `seed`")),
            "## Sample\n\n| Option | Type | Unit | Default | Allowed | Meaning |\n|---|---|---|---|---|---|\n");
  for (const char* row : {
           "| `seed` | whole number |  | `7` | 0 to 1000 | of all random numbers |\n",
           "| `height` | number | m | `1.7 m` | 0.5 to 2.5 m | of the person |\n",
           "| `limit` | number or null | m | `null` | at most 5 m | none by default |\n",
           "| `loss` | choice |  | `mse` | mse, huber | what is minimised |\n",
           "| `trim.enabled` | truth value |  | `true` |  | cut still frames \\| from both ends |\n",
           "| `joints[].weight` | number |  | `1` | 0 to 100 | how much it counts |\n",
       }) {
    EXPECT_NE(page.find(row), std::string::npos) << row << "\n" << page;
  }
}

}  // namespace
}  // namespace mocurate
