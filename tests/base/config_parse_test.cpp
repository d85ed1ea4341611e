#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/base/config_message.h"

namespace mocurate {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Config, ADuplicateKeyIsRefused) {
  EXPECT_EQ(MessageOf("seed: 1\ntrim: {enabled: true, enabled: false}\nseed: 2\n"),
            "c.yaml:2:23: key 'enabled' appears twice, first in line 2 (keep one of them)\n"
            "c.yaml:3:1: key 'seed' appears twice, first in line 1 (keep one of them)");
}

TEST(Config, BrokenYamlIsReportedWithItsPlace) {
  EXPECT_THAT(MessageOf("seed: 1\n  bad: [1, 2\n"), StartsWith("c.yaml:2:6: not YAML: "));
  EXPECT_THAT(MessageOf("a: 'open"), StartsWith("c.yaml:1:9: not YAML: "));
  EXPECT_THAT(MessageOf("seed: *none"), HasSubstr("c.yaml:1:7: not YAML: "));
}

TEST(Config, AReferenceThatNeedsQuotesIsReportedSo) {
  EXPECT_THAT(MessageOf("title: x\npeople: [${title}]\n"),
              AllOf(StartsWith("c.yaml:2:"), EndsWith("(inside [ ] and { }, ${...} must be in quotes)")));
}

TEST(Config, OnlyPlainMappingsOfTextsAreTaken) {
  EXPECT_EQ(MessageOf("[a]: 1"), "c.yaml:1:1: a key must be a text (put it in quotes)");
  EXPECT_EQ(MessageOf("null: 1"), "c.yaml:1:1: a key must be a text (put it in quotes)");
  EXPECT_EQ(MessageOf("seed: !!int 1"),
            "c.yaml:1:7: the YAML tag 'tag:yaml.org,2002:int' has no meaning here (leave it out)");
  EXPECT_EQ(MessageOf("a: &x {seed: 1}\n<<: *x"),
            "c.yaml:2:1: the merge key '<<' is not read (use include:, or write the values out)");
  EXPECT_EQ(MessageOf("seed: 1\n---\nseed: 2"),
            "c.yaml: more than one YAML document (keep one, and remove the line '---')");
}

TEST(Config, BytesThatAreNotTextAreRefusedWithTheirPosition) {
  EXPECT_EQ(MessageOf("seed: 1\ntitle: \xff"), "c.yaml:2:8: a byte that is not UTF-8 (save the file as UTF-8)");
  EXPECT_EQ(MessageOf(std::string("seed: 1\0", 8)), "c.yaml:1:8: a control character (code 0) (is this a text file?)");
  EXPECT_EQ(MessageOf("title: a\x04seed: 2"), "c.yaml:1:9: a control character (code 4) (is this a text file?)");
  EXPECT_EQ(MessageOf(std::string((16u << 20) + 1, ' ')), "c.yaml: is larger than 16 MiB (is this a configuration?)");
}

TEST(Config, AnchorsAreReadAndTheOriginIsThatOfTheAlias) {
  const auto options = ReadSample("title: &t abc\npeople: [*t, *t]\n");
  ASSERT_TRUE(options) << options.error().Message();
  EXPECT_EQ(options->people, (std::vector<std::string>{"abc", "abc"}));
  EXPECT_EQ(MessageOf("title: &t abc\nseed: *t\n"), "c.yaml:2:7: seed: 'abc' must be a whole number");
  EXPECT_EQ(MessageOf("joints: &j [*j]"),
            "c.yaml:1:13: an alias is inside the value that it names (write the value out)");
}

TEST(Config, NestedAliasesCannotGrowWithoutBound) {
  std::string yaml = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 30; ++i) {
    const std::string before = "*a" + std::to_string(i - 1), own = "a" + std::to_string(i);
    yaml += own + ": &" + own + " [" + before;
    for (int k = 0; k < 9; ++k) yaml += ", " + before;
    yaml += "]\n";
  }
  EXPECT_THAT(MessageOf(yaml), HasSubstr("more than 100000 values"));
}

TEST(Config, CopiesOfLongTextsAndNestedAnchorsCannotGrowWithoutBound) {
  std::string texts = "a: &x " + std::string(1000000, 'v') + "\nb: [";
  for (int i = 0; i < 1000; ++i) texts += "*x, ";
  EXPECT_THAT(MessageOf(texts + "*x]"), HasSubstr("16 MiB of text"));
  std::string nested = "a: ";
  for (int i = 0; i < 60; ++i) nested += "&a" + std::to_string(i) + " [";
  for (int i = 0; i < 10000; ++i) nested += "1,";
  EXPECT_THAT(MessageOf(nested + "1" + std::string(60, ']')), HasSubstr("more than 100000 values"));
}

TEST(Config, BracketsAreCountedBeforeTheyAreRead) {
  EXPECT_THAT(MessageOf("a: [" + std::string(2000001, '[')), HasSubstr("more than 2000000"));
}

TEST(Config, DeepNestingIsRefusedEarly) {
  EXPECT_EQ(MessageOf("a: " + std::string(63, '[') + std::string(63, ']')),
            "c.yaml:1:1: unknown option 'a' (known here: seed, height, angle, step, rate, size, share, limit, title, "
            "path, offsets, people, labels, loss, trim, joints)");
  EXPECT_EQ(MessageOf("a: " + std::string(64, '[') + std::string(64, ']')),
            "c.yaml:1:67: nested deeper than 64 levels");
  EXPECT_THAT(MessageOf("a: " + std::string(1000000, '[')), EndsWith(": nested deeper than 64 levels"));
  EXPECT_THAT(MessageOf("a: " + std::string(1000000, '{')), EndsWith(": nested deeper than 64 levels"));
}

TEST(Config, WindowsLineEndsAndAByteOrderMarkAreRead) {
  const auto options = ReadSample("\xEF\xBB\xBFseed: 3\r\ntitle: x\r\n");
  ASSERT_TRUE(options) << options.error().Message();
  EXPECT_EQ(options->seed, 3);
  EXPECT_EQ(options->title, "x");
}

TEST(Config, MappingsKeepTheOrderOfTheFile) {
  const auto node = LoadConfig(ConfigSource{"b: 1\na: 2\nc: [x, {d: 'e'}]\n", "c.yaml", {}});
  ASSERT_TRUE(node);
  ASSERT_EQ(node->mapping.size(), 3u);
  EXPECT_EQ(node->mapping[0].first, "b");
  EXPECT_EQ(node->mapping[1].first, "a");
  const ConfigNode& element = node->Find("c")->sequence[1];
  EXPECT_EQ(element.Find("d")->origin.Text(), "c.yaml:3:12");
  EXPECT_EQ(element.Find("d")->key_origin.Text(), "c.yaml:3:9");
  EXPECT_TRUE(element.Find("d")->quoted);
  EXPECT_EQ(element.Find("x"), nullptr);
}

}  // namespace
}  // namespace mocurate
