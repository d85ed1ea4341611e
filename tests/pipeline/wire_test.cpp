#include "core/pipeline/wire.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/pipeline/runner.h"

namespace mocurate {
namespace {

using nlohmann::json;

TEST(Wire, AnyBytesSurviveTheTripAndTheTextIsUtf8) {
  std::string bytes;
  for (int i = 1; i < 256; ++i) bytes += static_cast<char>(i);
  for (const std::string& text :
       {bytes, std::string("Gr\xc3\xbc\xc3\x9f\x65 \xe2\x82\xac \xf0\x9f\x98\x80"), std::string("100% %41 %"),
        std::string("\xff\xfe.bvh"), std::string("\xc0\x80\xed\xa0\x80"), std::string("cut \xe2\x82")}) {
    const json value = {{text, {text, 1.5, nullptr, true}}};
    const std::string written = CanonicalText(value);
    EXPECT_TRUE(json::accept(written));
    const Expected<json> read = FromCanonicalText(written);
    ASSERT_TRUE(read);
    EXPECT_TRUE(*read == value);
  }
}

TEST(Wire, NamesWithDifferentBytesHaveDifferentTexts) {
  EXPECT_NE(CanonicalText("\xff.bvh"), CanonicalText("\xfe.bvh"));
  EXPECT_NE(CanonicalText("\xff.bvh"), CanonicalText("%FF.bvh"));
}

TEST(Wire, TheOrderOfKeysDoesNotMatter) {
  json one, other;
  one["a"] = 1;
  one["b"] = 0.1;
  other["b"] = 0.1;
  other["a"] = 1;
  EXPECT_EQ(CanonicalText(one), CanonicalText(other));
}

TEST(Wire, MessagesAreReadOneByOneInAnyChunks) {
  const std::string stream = Frame({{"n", 1}}) + Frame({{"n", 2}});
  std::string buffer;
  int taken = 0;
  for (const char byte : stream) {
    buffer += byte;
    const Expected<std::optional<json>> message = TakeMessage(buffer);
    ASSERT_TRUE(message);
    if (!message->has_value()) continue;
    EXPECT_EQ((**message)["n"], ++taken);
  }
  EXPECT_EQ(taken, 2);
  EXPECT_TRUE(buffer.empty());
}

TEST(Wire, BytesThatAreNotAMessageAreAnError) {
  std::string noise = "hello, this is not a message";
  EXPECT_FALSE(TakeMessage(noise));
  std::string broken = std::string("\x02\x00\x00\x00", 4) + "{{";
  EXPECT_FALSE(TakeMessage(broken));
}

TEST(Wire, RequestsAndOutcomesKeepAllTheirParts) {
  const StageRequest request{"fitting",  "kard/s1\xff", {{"weight", 0.1}}, {{"evidence", "e", "/a b/\xff", "00"}},
                             "/tmp/out", "/tmp/scratch"};
  const Expected<StageRequest> back = RequestFromJson(*FromCanonicalText(CanonicalText(request)));
  ASSERT_TRUE(back);
  EXPECT_EQ(json(*back), json(request));
  EXPECT_EQ(back->inputs[0].path.native(), "/a b/\xff");

  StageOutcome outcome;
  outcome.kind = OutcomeKind::kRefused;
  outcome.findings.push_back(
      {"clip", "frozen", Severity::kError, 2, 5, "knee", 0.25, 0.0, "stands still", FindingAction::kFlagged});
  outcome.summary["rms_mm"] = 1.25;
  outcome.error = {ErrorCode::kMalformed, "what", "where", "hint"};
  const Expected<StageOutcome> read = OutcomeFromJson(*FromCanonicalText(CanonicalText(ToJson(outcome))));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->kind, outcome.kind);
  EXPECT_EQ(read->findings, outcome.findings);
  EXPECT_EQ(read->summary, outcome.summary);
  EXPECT_EQ(read->error, outcome.error);
  EXPECT_FALSE(OutcomeFromJson({{"kind", 3}}));
  EXPECT_FALSE(RequestFromJson({{"stage", "x"}}));
}

TEST(ItemSummaries, KeepWhatTheyAreGiven) {
  EXPECT_EQ(ItemSummary().Unpacked(), nlohmann::json::object());
  const nlohmann::json figures = {
      {"clip", "kard/s1\xff"}, {"rms_mm", 0.1}, {"frames", 30}, {"bones", {{"knee", -1e-13}}}, {"none", nullptr}};
  ItemSummary summary = figures;
  const ItemSummary copy = summary;
  summary.Set("threshold", 2.5);
  EXPECT_EQ(summary.value("threshold", 0.0), 2.5);
  EXPECT_EQ(copy.Unpacked(), figures) << "copies share what neither has changed";
  EXPECT_EQ(copy.at("clip"), "kard/s1\xff");
  EXPECT_EQ(copy.value("person", std::string("p")), "p");
  EXPECT_FALSE(copy == summary);
  summary.Set("rms_mm", std::nan(""));
  EXPECT_TRUE(std::isnan(summary.value("rms_mm", 0.0)));
}

TEST(ItemsOptions, TheirTextIsThatOfAllOfThem) {
  ItemOptions options = {{"b", 1}, {"a", "\xff"}};
  EXPECT_EQ(options.Text(), CanonicalText(options.Whole()));
  options.Set("b", 2);
  EXPECT_EQ(options.Whole(), nlohmann::json({{"b", 2}, {"a", "\xff"}}));
  EXPECT_EQ(options.Text(), CanonicalText(options.Whole()));
}

}  // namespace
}  // namespace mocurate
