#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/file.h"
#include "tests/base/config_message.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

TEST(ConfigReference, KeysComeBeforeTheEnvironment) {
  ::setenv("title", "from the environment", 1);
  ::setenv("MOCURATE_CONFIG_TEST", "/data", 1);
  const auto options = ReadSample(
      "title: run ${trim.still_speed} of ${seed}\n"
      "seed: 3\n"
      "people: ['${title}', '${MOCURATE_CONFIG_TEST}', '$${title}', 'cost $5']\n"
      "path: ${MOCURATE_CONFIG_TEST}/kard\n"
      "height: ${trim.still_speed}\n"
      "offsets: ['${offsets_of.0}']\n"
      "trim: {still_speed: 2}\n");
  EXPECT_FALSE(options) << "a number in quotes stays text, and offsets_of is not a key";
  const auto good = ReadSample(
      "title: run ${trim.still_speed} of ${seed}\n"
      "seed: 3\n"
      "people: ['${title}', '${MOCURATE_CONFIG_TEST}', '$${title}', 'cost $5']\n"
      "path: ${MOCURATE_CONFIG_TEST}/kard\n"
      "height: ${trim.still_speed}\n"
      "step: ${seed} ms\n"
      "trim: {still_speed: 2}\n");
  ::unsetenv("title");
  ::unsetenv("MOCURATE_CONFIG_TEST");
  ASSERT_TRUE(good) << good.error().Message();
  EXPECT_EQ(good->title, "run 2 of 3");
  EXPECT_EQ(good->people, (std::vector<std::string>{"run 2 of 3", "/data", "${title}", "cost $5"}));
  EXPECT_EQ(good->path, "/data/kard");
  EXPECT_EQ(good->height, 2.0);
  EXPECT_DOUBLE_EQ(good->step, 0.003);
}

TEST(ConfigReference, MayNameAListAMappingOrAnElement) {
  const auto node = LoadConfig(ConfigSource{"a: {b: [x, {c: y}]}\nd: ${a}\ne: ${d.b.1.c}\nf: ${a.b}\n", "c.yaml", {}});
  ASSERT_TRUE(node) << node.error().Message();
  EXPECT_EQ(node->Find("e")->scalar, "y");
  EXPECT_EQ(node->Find("e")->origin.Text(), "c.yaml:3:4") << "where it is set";
  EXPECT_EQ(node->Find("f")->sequence.size(), 2u);
}

TEST(ConfigReference, AnEscapedReferenceStaysTextWhenItIsReferredTo) {
  const auto node = LoadConfig(ConfigSource{"a: {b: '$${x}'}\nc: ${a}\nd: ${c.b}\ne: ${d}\n", "c.yaml", {}});
  ASSERT_TRUE(node) << node.error().Message();
  EXPECT_EQ(node->Find("d")->scalar, "${x}");
  EXPECT_EQ(node->Find("e")->scalar, "${x}");
}

TEST(ConfigReference, APathIsRelativeToTheFileThatSetsIt) {
  const ScratchFolder folder;
  ASSERT_TRUE(MakeFolder(folder / "sub"));
  ASSERT_TRUE(WriteFile(folder / "sub/a.yaml", "title: data\n"));
  ASSERT_TRUE(WriteFile(folder / "main.yaml", "include: sub/a.yaml\npath: ${title}/kard\n"));
  const auto node = LoadConfig(folder / "main.yaml");
  ASSERT_TRUE(node) << node.error().Message();
  EXPECT_EQ(OptionsFromConfig<SampleOptions>(*node)->path, folder / "sub/data/kard");
}

TEST(ConfigReference, WhatNamesNothingIsReportedWithAWayOut) {
  EXPECT_EQ(MessageOf("title: x ${MOCURATE_NO_SUCH}\npath: ${titel}\nloss: ${trim.x}\ntrim: {enabled: '${'}"),
            "c.yaml:1:8: ${MOCURATE_NO_SUCH} names neither a key of this configuration nor an environment variable "
            "(export MOCURATE_NO_SUCH=..., or give the value with --set)\n"
            "c.yaml:2:7: ${titel} names neither a key of this configuration nor an environment variable (did you mean "
            "'title'?)\n"
            "c.yaml:3:7: ${trim.x} names neither a key of this configuration nor an environment variable (did you mean "
            "'trim'?)\n"
            "c.yaml:4:17: '${' without '}' in '${' (write $${ for a literal ${)");
  EXPECT_EQ(MessageOf("title: a ${trim}\ntrim: {enabled: true}"),
            "c.yaml:1:8: ${trim} inside a text must name a single value");
}

TEST(ConfigReference, AVariableThatIsNotSetIsKeptWhereThatIsAsked) {
  ::unsetenv("MOCURATE_NO_SUCH");
  const ConfigSource source{
      "path: ${MOCURATE_NO_SUCH}/kard\ntitle: ${path} and $${x}\npeople: ['${MOCURATE_NO_SUCH}', a]\n"
      "labels: {a: '${MOCURATE_NO_SUCH}', b: '$${x}'}\n",
      "c.yaml", "/folder"};
  EXPECT_FALSE(LoadConfig(source));
  const auto node = LoadConfig(source, {}, {false, UnsetVariables::kKeep});
  ASSERT_TRUE(node) << node.error().Message();
  EXPECT_TRUE(node->Find("path")->unset && node->Find("title")->unset);
  const auto options = OptionsFromConfig<SampleOptions>(*node);
  ASSERT_TRUE(options) << options.error().Message();
  EXPECT_EQ(options->path, "${MOCURATE_NO_SUCH}/kard") << "not below the folder of the file";
  const std::string shown = ShowOptions(*options, *node, false);
  EXPECT_NE(shown.find("path: \"${MOCURATE_NO_SUCH}/kard\"\n"), std::string::npos) << shown;
  EXPECT_NE(shown.find("people: [\"${MOCURATE_NO_SUCH}\", a]\n"), std::string::npos) << shown;
  EXPECT_NE(shown.find("  a: \"${MOCURATE_NO_SUCH}\"\n  b: \"$${x}\"\n"), std::string::npos) << shown;
  EXPECT_FALSE(LoadConfig(ConfigSource{"title: ${titel}", "c.yaml", {}}, {}, {false, UnsetVariables::kKeep}));
}

TEST(ConfigReference, ASetValueMakesAReferenceUnneeded) {
  EXPECT_EQ(MessageOf("path: ${MOCURATE_NO_SUCH}/kard", {"path=/data"}), "");
  EXPECT_EQ(ReadSample("title: a", {"people=['${title}']"})->people.front(), "a");
}

TEST(ConfigReference, CirclesAreRefused) {
  EXPECT_EQ(MessageOf("title: ${title}"), "c.yaml:1:8: ${title} leads back to itself");
  EXPECT_THAT(MessageOf("title: ${path}\npath: a${title}"),
              HasSubstr("leads back to itself (it starts at c.yaml:1:8)"));
  EXPECT_THAT(MessageOf("trim: {enabled: '${trim}'}"), HasSubstr("${trim} leads back to itself"));
}

TEST(ConfigReference, CannotGrowWithoutBound) {
  std::string texts = "a0: " + std::string(100, 'x') + "\n", lists = "a0: [x, x]\n";
  for (int i = 1; i < 60; ++i) {
    const std::string before = "${a" + std::to_string(i - 1) + "}", key = "a" + std::to_string(i) + ": ";
    texts += key + "b" + before + before + "\n";
    lists += key + "\n- " + before + "\n- " + before + "\n";
  }
  EXPECT_THAT(MessageOf(texts), HasSubstr("references written out take more than 16 MiB"));
  EXPECT_THAT(MessageOf(lists), HasSubstr("references written out take more than 16 MiB"));
  std::string wholes = "a: " + std::string(1000000, 'x') + "\nb:\n";
  for (int i = 0; i < 1000; ++i) wholes += "- ${a}\n";
  EXPECT_THAT(MessageOf(wholes), HasSubstr("references written out take more than 16 MiB"));
  std::string chain;
  for (int i = 0; i < 5000; ++i) chain += "a" + std::to_string(i) + ": ${a" + std::to_string(i + 1) + "}\n";
  EXPECT_THAT(MessageOf(chain + "a5000: 1\n"), HasSubstr("more than 500 references lead from one to the next"));
}

TEST(ConfigReference, ManyReferencesTakeTimeInProportion) {
  std::string none, known = "a: 1\n";
  for (int i = 0; i < 40000; ++i) {
    const std::string n = std::to_string(i);
    none += "k" + n + ": ${n" + n + "}\n";
    known += "k" + n + ": ${" + (i == 0 ? "a" : "k" + std::to_string(i - 1)) + "}\n";
  }
  EXPECT_THAT(MessageOf(none), HasSubstr("\nand 39950 more"));
  EXPECT_TRUE(LoadConfig(ConfigSource{known, "c.yaml", {}}));
}

}  // namespace
}  // namespace mocurate
