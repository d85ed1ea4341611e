// Rates of declarations and files that contradict the motion: a run and an inspection report the same.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ingest/inspect/comparison.h"
#include "tests/ingest/changed_files.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;

class RecordedRates : public RecordedFormats {
 protected:
  /// Bandai's first set with another Frame Time in every file.
  static IngestOptions Marked(double rate_hz, const std::string& name) {
    IngestOptions options = Declared("bandai1");
    const fs::path folder = FreshFolder(name);
    for (const auto& entry : fs::directory_iterator(options.path)) {
      if (entry.path().extension() != ".bvh") continue;
      std::string text = *ReadFile(entry.path());
      const std::size_t begin = text.find("Frame Time:");
      text.replace(begin, text.find_first_of("\r\n", begin) - begin, "Frame Time: " + std::to_string(1.0 / rate_hz));
      Put(folder / entry.path().filename(), text);
    }
    options.path = folder;
    return options;
  }
};

/// 500 clips marked with 60 Hz, of which the first `denying` fit at most 30 Hz.
std::vector<ItemResult> ClipsThatDeny(std::size_t denying) {
  std::vector<ItemResult> clips(500);
  for (std::size_t i = 0; i < clips.size(); ++i) {
    clips[i].item = "set/p0/" + std::to_string(i);
    clips[i].summary.Set("rate_hz", 60.0);
    if (i < denying) clips[i].outcome.findings.push_back(MakeFinding("rate_suspect", Severity::kWarning, 30.0, ""));
  }
  return clips;
}

std::ptrdiff_t CountKind(const std::vector<ItemResult>& clips, OutcomeKind kind) {
  return std::count_if(clips.begin(), clips.end(), [&](const ItemResult& clip) { return clip.outcome.kind == kind; });
}

TEST(RatesOfSets, FiveClipsOf500LeaveTheOthersAsTheyAre) {
  for (const OnContradiction action : {OnContradiction::kFlag, OnContradiction::kRefuse}) {
    SourceOptions source;
    source.on_contradiction = action;
    std::vector<ItemResult> clips = ClipsThatDeny(5);
    EXPECT_TRUE(FindSetContradictions(source, clips).empty());
    EXPECT_EQ(CountKind(clips, OutcomeKind::kDone), 500);
  }
}

TEST(RatesOfSets, AreWrongWhereAsManyClipsAsOfAWrongSetDenyThem) {
  SourceOptions source;
  std::vector<ItemResult> clips = ClipsThatDeny(40);  // 8 %, as UTKinect with 4 times its rate
  const std::vector<Finding> findings = FindSetContradictions(source, clips);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "rate_suspect");
  EXPECT_EQ(findings[0].severity, Severity::kError);
  EXPECT_EQ(findings[0].value, 0.08);
  EXPECT_EQ(CountKind(clips, OutcomeKind::kSuspect), 500);
  source.on_contradiction = OnContradiction::kRefuse;
  clips = ClipsThatDeny(40);
  ASSERT_EQ(FindSetContradictions(source, clips).size(), 1u);
  EXPECT_EQ(CountKind(clips, OutcomeKind::kRefused), 500);
  EXPECT_EQ(clips[0].summary.at("threshold"), 0.05);
}

TEST_F(RecordedRates, UseTheDeclaredRateAndReportContradictoryFiles) {
  const IngestOptions options = Marked(60.0, "marked60");
  std::vector<ItemResult> clips = RunAll(options);
  ASSERT_GT(clips.size(), 50u);
  EXPECT_EQ(CountCode(clips, "rate_contradiction"), clips.size());
  EXPECT_EQ(CountCode(clips, "rate_suspect"), 0u) << "the declared rate is true";
  for (const ItemResult& clip : clips) EXPECT_EQ(clip.summary.at("rate_hz"), 30.0);
  const auto set_findings = FindSetContradictions(options.source, clips);
  ASSERT_EQ(set_findings.size(), 1u);
  EXPECT_EQ(set_findings[0].code, "rate_contradiction");
  const auto inspected = Codes(InspectPath(options.path, options.source), "error");
  EXPECT_EQ(static_cast<std::size_t>(std::count(inspected.begin(), inspected.end(), "rate_contradiction")),
            clips.size());
}

TEST_F(RecordedRates, ReportTheWholeSetWhenMotionsContradictAnUndeclaredRate) {
  IngestOptions options = Marked(60.0, "undeclared60");
  options.source.rate_hz.reset();
  std::vector<ItemResult> clips = RunAll(options);
  EXPECT_EQ(CountCode(clips, "rate_suspect"), 0u) << "for a single clip the rate of the file is only a warning";
  std::size_t contradicted = 0;
  for (const ItemResult& clip : clips) {
    for (const Finding& finding : FindingsOf(clip.outcome, "rate_suspect")) {
      ++contradicted;
      EXPECT_LT(finding.value, 60.0) << "the rate that the motion allows";
    }
  }
  EXPECT_GT(contradicted, 0u);
  const auto set_findings = FindSetContradictions(options.source, clips);
  ASSERT_EQ(set_findings.size(), 1u);
  EXPECT_EQ(set_findings[0].code, "rate_suspect");
  EXPECT_EQ(CountCode(clips, "rate_suspect"), clips.size());
  EXPECT_THAT(Codes(InspectPath(options.path, std::nullopt), "error"), Contains("rate_suspect"));
}

TEST_F(RecordedRates, RefuseTheSetWhenMotionsContradictTheDeclaredRate) {
  IngestOptions options = Declared("msr_action3d");
  options.source.rate_hz = 60.0;  // it is 15
  options.source.on_contradiction = OnContradiction::kRefuse;
  std::vector<ItemResult> clips = RunAll(options);
  const std::size_t contradicted = CountCode(clips, "rate_suspect");
  EXPECT_GT(contradicted, 50u);
  EXPECT_LT(contradicted, clips.size() / 2);
  ASSERT_EQ(FindSetContradictions(options.source, clips).size(), 1u);
  for (const ItemResult& clip : clips) EXPECT_FALSE(HasArtifact(clip.outcome.kind)) << clip.item;
}

TEST_F(RecordedRates, AcceptTheTrueRatesOfAllSets) {
  for (const char* source : {"bandai1", "bandai2", "hdm05", "cad60", "ntu", "florence3d", "utkinect"}) {
    const IngestOptions options = Declared(source);
    std::vector<ItemResult> clips = RunAllOnce(options);
    EXPECT_EQ(CountCode(clips, "rate_suspect") + CountCode(clips, "rate_contradiction"), 0u) << source;
    for (const Finding& finding : FindSetContradictions(options.source, clips)) ADD_FAILURE() << finding.message;
  }
}

}  // namespace
}  // namespace mocurate
