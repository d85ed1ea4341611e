#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/units.h"
#include "tests/base/config_message.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

TEST(Config, ReadsEveryTypeOfOption) {
  const auto options = ReadSample(
      "seed: 12\n"
      "height: 180 cm\n"
      "angle: 90 deg\n"
      "step: 1/30 s\n"
      "rate: 25 fps\n"
      "size: 10 MB\n"
      "share: 20 %\n"
      "limit: 300mm\n"
      "title: 007\n"
      "path: data/x\n"
      "offsets: [10 cm, -0.5]\n"
      "people: [p1, 'p 2']\n"
      "labels: {a01: walk, 2: '3'}\n"
      "loss: huber\n"
      "trim: {enabled: false, still_speed: 36 km/h}\n"
      "joints:\n"
      "- name: wrist\n"
      "- {name: ankle, weight: 2}\n");
  ASSERT_TRUE(options) << options.error().Message();
  EXPECT_EQ(options->seed, 12);
  EXPECT_DOUBLE_EQ(options->height, 1.8);
  EXPECT_DOUBLE_EQ(options->angle, 1.5707963267948966);
  EXPECT_DOUBLE_EQ(options->step, 1.0 / 30.0);
  EXPECT_EQ(options->rate, 25.0);
  EXPECT_EQ(options->size, 1e7);
  EXPECT_EQ(options->share, 0.2);
  EXPECT_EQ(options->limit, 0.3);
  EXPECT_EQ(options->title, "007");
  EXPECT_EQ(options->path, "folder/data/x");
  EXPECT_EQ(options->offsets, (std::vector<double>{0.1, -0.5}));
  EXPECT_EQ(options->people, (std::vector<std::string>{"p1", "p 2"}));
  EXPECT_EQ(options->labels, (std::map<std::string, std::string>{{"a01", "walk"}, {"2", "3"}}));
  EXPECT_EQ(options->loss, Loss::kHuber);
  EXPECT_FALSE(options->trim.enabled);
  EXPECT_DOUBLE_EQ(options->trim.still_speed, 10.0);
  ASSERT_EQ(options->joints.size(), 2u);
  EXPECT_EQ(options->joints[0].weight, 1.0);
  EXPECT_EQ(options->joints[1].weight, 2.0);
}

TEST(Config, AnEmptyFileOrGroupKeepsTheDefaults) {
  const nlohmann::json defaults = OptionsToJson(SampleOptions{});
  for (const char* yaml : {"", "\n", "# only a remark\n", "---\n", "{}", "trim:\njoints:\nlimit: null\n"}) {
    const auto options = ReadSample(yaml);
    ASSERT_TRUE(options) << options.error().Message();
    EXPECT_EQ(OptionsToJson(*options).dump(), defaults.dump()) << yaml;
  }
}

TEST(Config, ReportsAllProblemsAtOnceWithTheirPlaces) {
  EXPECT_EQ(MessageOf("seed: x\n"
                      "heigth: 1.8\n"
                      "trim:\n"
                      "  enabled: yes\n"
                      "  speed: 3\n"
                      "joints:\n"
                      "- weight: 101\n"
                      "loss: hubert\n"),
            "c.yaml:1:7: seed: 'x' must be a whole number\n"
            "c.yaml:8:7: loss: 'hubert' must be one of mse, huber (did you mean 'huber'?)\n"
            "c.yaml:4:12: trim.enabled: 'yes' must be true or false\n"
            "c.yaml:5:3: unknown option 'trim.speed' (known here: enabled, still_speed)\n"
            "c.yaml:7:11: joints.0.weight: '101' is out of range (allowed: 0 to 100)\n"
            "c.yaml:2:1: unknown option 'heigth' (did you mean 'height'?)");
}

TEST(Config, AWholeNumberBeyond64BitsIsRefusedByItsName) {
  for (const char* text : {"18446744073709551616", "-9223372036854775809"}) {
    EXPECT_EQ(MessageOf(std::string("seed: ") + text),
              "c.yaml:1:7: seed: '" + std::string(text) +
                  "' does not fit 64 bits (whole numbers reach from -9223372036854775808 to 9223372036854775807)");
  }
}

TEST(Config, AValueInQuotesIsNeverANumber) {
  EXPECT_EQ(MessageOf("height: '1.8'"),
            "c.yaml:1:9: height: '1.8' must be a number in m (a value in quotes is text, remove the quotes)");
  EXPECT_EQ(MessageOf("seed: \"3\""),
            "c.yaml:1:7: seed: '3' must be a whole number (a value in quotes is text, remove the quotes)");
  EXPECT_EQ(MessageOf("trim: {enabled: 'true'}"), "c.yaml:1:17: trim.enabled: 'true' must be true or false");
  EXPECT_EQ(MessageOf("seed: !!str 3"),
            "c.yaml:1:7: seed: '3' must be a whole number (a value in quotes is text, remove the quotes)");
}

TEST(Config, UnitsAreChecked) {
  EXPECT_EQ(MessageOf("rate: 30 deg"),
            "c.yaml:1:7: rate: '30 deg' is in deg, which cannot be turned into Hz (units here: Hz, kHz, fps)");
  EXPECT_EQ(MessageOf("angle: 30 degrees"),
            "c.yaml:1:8: angle: '30 degrees': unknown unit 'degrees' (units here: rad, mrad, deg, turn)");
  EXPECT_EQ(MessageOf("share: 3 mm"), "c.yaml:1:8: share: '3 mm' has a unit, a plain number is expected");
  EXPECT_EQ(MessageOf("height: 30000 mm"), "c.yaml:1:9: height: '30000 mm' is out of range (allowed: 0.5 to 2.5 m)");
  EXPECT_EQ(MessageOf("step: -1 ms"), "c.yaml:1:7: step: '-1 ms' is out of range (allowed: at least 0 s)");
  EXPECT_EQ(MessageOf("limit: 6"), "c.yaml:1:8: limit: '6' is out of range (allowed: at most 5 m)");
}

TEST(Config, OnlyFiniteDecimalNumbersAreNumbers) {
  for (const char* value : {".nan", "nan", "inf", "-.inf", "1e999", "0x10", "1,5", "1/0 s", "1/2/3", "s", "1 s s"}) {
    const auto options = ReadSample(std::string("step: ") + value);
    ASSERT_FALSE(options) << value;
    EXPECT_EQ(options.error().where, "c.yaml:1:7") << value;
  }
}

TEST(Config, WrongShapesAreRefused) {
  EXPECT_EQ(MessageOf("trim: 3"), "c.yaml:1:7: trim: '3' must be a mapping");
  EXPECT_EQ(MessageOf("height: [1]"), "c.yaml:1:9: height: a list must be a number in m");
  EXPECT_EQ(MessageOf("height:"), "c.yaml:1:1: height: no value must be a number in m");
  EXPECT_EQ(MessageOf("title:"), "c.yaml:1:1: title: no value must be a text (write '' for none)");
  EXPECT_EQ(MessageOf("title: {}"), "c.yaml:1:8: title: a mapping must be a text");
  EXPECT_EQ(MessageOf("people: p1"), "c.yaml:1:9: people: 'p1' must be a list of texts (write [a, b])");
  EXPECT_EQ(MessageOf("joints: {name: x}"), "c.yaml:1:9: joints: a mapping must be a list of mappings");
  EXPECT_EQ(MessageOf("labels: [a]"), "c.yaml:1:9: labels: a list must be a mapping of texts");
  EXPECT_EQ(MessageOf("- a\n- b"), "c.yaml:1:1: a configuration must be a mapping (lines of 'key: value')");
  EXPECT_EQ(MessageOf("path: ~/data"), "c.yaml:1:7: path: '~/data': '~' has no meaning here (write ${HOME})");
}

TEST(Config, AnAbsolutePathIsKeptAndAnEmptyOneStaysEmpty) {
  EXPECT_EQ(ReadSample("path: /data/../x")->path, "/x");
  EXPECT_EQ(ReadSample("path: ''")->path, "");
  EXPECT_EQ(ReadSample("path: 'a\\xff'")->path.native(), "folder/a\xff");
}

TEST(Config, EverySpellingOfAUnitIsRead) {
  const auto read = [](const std::string& yaml) { return ReadSample(yaml).value(); };
  EXPECT_DOUBLE_EQ(read("height: 2 m").height, 2.0);
  EXPECT_DOUBLE_EQ(read("height: 20 dm").height, 2.0);
  EXPECT_DOUBLE_EQ(read("height: 1.5e6 um").height, 1.5);
  EXPECT_DOUBLE_EQ(read("height: 0.002 km").height, 2.0);
  EXPECT_DOUBLE_EQ(read("height: 50 in").height, 1.27);
  EXPECT_DOUBLE_EQ(read("height: 6 ft").height, 1.8288);
  EXPECT_DOUBLE_EQ(read("step: 2 min").step, 120.0);
  EXPECT_DOUBLE_EQ(read("step: 40 ms").step, 0.04);
  EXPECT_DOUBLE_EQ(read("step: 40us").step, 4e-5);
  EXPECT_DOUBLE_EQ(read("step: 1.5 h").step, 5400.0);
  EXPECT_DOUBLE_EQ(read("step: 1001/30000").step, 1001.0 / 30000.0);
  EXPECT_DOUBLE_EQ(read("angle: 250 mrad").angle, 0.25);
  EXPECT_DOUBLE_EQ(read("angle: -0.25 turn").angle, -1.5707963267948966);
  EXPECT_DOUBLE_EQ(read("rate: 0.1 kHz").rate, 100.0);
  EXPECT_DOUBLE_EQ(read("rate: 30000/1001 Hz").rate, 30000.0 / 1001.0);
  EXPECT_DOUBLE_EQ(read("size: 2 KiB").size, 2048.0);
  EXPECT_DOUBLE_EQ(read("size: 1 GiB").size, 1073741824.0);
  EXPECT_DOUBLE_EQ(read("trim: {still_speed: 50 mm/s}").trim.still_speed, 0.05);
}

TEST(Config, ThePageForUsersListsEveryUnit) {
  const std::string page = ReadFile(std::string(kSourceFolder) + "/docs/configuration.md").value();
  for (const UnitSpelling& unit : UnitSpellings()) {
    EXPECT_NE(page.find("`" + std::string(unit.spelling) + "`"), std::string::npos) << unit.spelling;
  }
}

}  // namespace
}  // namespace mocurate
