#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "tests/report/builders.h"

namespace mocurate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const char* const kSectionIds[] = {"funnel",    "quality", "truth", "filmstrips", "clips",   "table",    "recognisers",
                                   "generated", "curves",  "stops", "dataset",    "persons", "findings", "reading"};

std::string PageOf(SmallRun& run) {
  const auto page = run.Page();
  EXPECT_TRUE(page) << page.error().Message();
  return page.value_or("");
}

void ExpectAllSections(const std::string& page) {
  for (const char* id : kSectionIds) {
    EXPECT_THAT(page, HasSubstr("<section id=\"" + std::string(id) + "\"")) << id;
    EXPECT_THAT(page, HasSubstr("href=\"#" + std::string(id) + "\"")) << id;
  }
}

/// The headline with its attributes.
std::string HeadlineOf(SmallRun& run) {
  const std::string page = PageOf(run);
  const std::size_t begin = page.find("<p class=\"verdict\""), end = page.find("</p>", begin);
  EXPECT_NE(begin, std::string::npos);
  return page.substr(begin, end - begin);
}

TEST(ReportPage, SaysInItsHeadlineHowManyClipsAreSuspect) {
  SmallRun run;
  EXPECT_THAT(HeadlineOf(run), Not(HasSubstr("data-")));
  run.run["clips"][0]["suspect"] = false;
  run.run["clips"][1]["suspect"] = true;
  run.run["clips"][2]["suspect"] = true;
  const std::string headline = HeadlineOf(run);
  EXPECT_THAT(headline, HasSubstr("data-suspect-clips=\"2\""));
  EXPECT_THAT(headline, HasSubstr("15.0 mm RMS")) << "the largest of their residuals";
  EXPECT_THAT(headline, Not(HasSubstr("went through")));
}

TEST(ReportPage, NeverCallsFitsSoundThatLieFarFromTheTruth) {
  SmallRun run;
  run.run["fit_error"]["joint_mm"] = 427.0;
  for (const bool one : {false, true}) {
    if (one) {  // one clip of three, which the mean does not show
      run.run["fit_error"]["joint_mm"] = 149.0;
      run.run["clips"][0]["joint_error_mm"] = 8.0;
      run.run["clips"][1]["joint_error_mm"] = 427.0;
      run.run["clips"][2]["joint_error_mm"] = 12.0;
    }
    const std::string headline = HeadlineOf(run);
    EXPECT_THAT(headline, HasSubstr("data-joint-error-mm=\"427.0\""));
    EXPECT_THAT(headline, HasSubstr("427.0 mm"));
    EXPECT_THAT(headline, Not(HasSubstr("went through")));
  }
  run.run["clips"][1]["joint_error_mm"] = 150.0;
  EXPECT_THAT(HeadlineOf(run), Not(HasSubstr("data-joint-error-mm"))) << "within report.suspect_joint_error";
}

TEST(ReportPage, SaysInItsHeadlineThatFindingsAboutTheSetAreErrors) {
  SmallRun run;
  run.run["findings"] = {{{"code", "split_drawn"}, {"severity", "warning"}, {"message", "drawn"}}};
  EXPECT_THAT(HeadlineOf(run), Not(HasSubstr("data-set-errors")));
  run.run["findings"].push_back({{"code", "split_leak"}, {"severity", "error"}, {"message", "leaks"}});
  EXPECT_THAT(HeadlineOf(run), HasSubstr("data-set-errors=\"1\""));
}

TEST(ReportPage, SaysInItsHeadlineHowManyClipsLostTheirRecordedRotations) {
  SmallRun run;
  run.run["replaces_rotations"] = 0;
  EXPECT_THAT(HeadlineOf(run), Not(HasSubstr("data-replaces-rotations")));
  run.run["replaces_rotations"] = 2;
  EXPECT_THAT(HeadlineOf(run), HasSubstr("data-replaces-rotations=\"2\""));
}

TEST(ReportPage, HoldsEverySectionAndTheFiguresOfTheRun) {
  SmallRun run;
  const std::string page = PageOf(run);
  ExpectAllSections(page);
  EXPECT_THAT(page, HasSubstr("All 3 clips went through."));
  EXPECT_THAT(page, HasSubstr("Error against truth 30.0 mm before and 8.0 mm after fitting."));
  EXPECT_THAT(page, HasSubstr("classifies 95.0 % of the test clips correctly"));
  EXPECT_THAT(page, HasSubstr("<td>0.200 ± 0.100</td>"));
  EXPECT_THAT(page, HasSubstr("best fit, residual 5.0 mm RMS"));
  EXPECT_THAT(page, HasSubstr("median fit, residual 10.0 mm RMS"));
  EXPECT_THAT(page, HasSubstr("worst fit, residual 15.0 mm RMS"));
  EXPECT_THAT(page, HasSubstr("60.0</td>")) << "300 iterations of 8 over 40 clips are 60 passes";
  EXPECT_THAT(page, HasSubstr("missing_joints"));
  EXPECT_LT(page.size(), 5U << 20);
}

TEST(ReportPage, DrawsHowManyErrorsTheStatedUncertaintyCovers) {
  SmallRun run;
  EXPECT_EQ(PageOf(run).find("estimated standard deviations, %</figcaption>"), std::string::npos);
  run.run["fit_error"]["within_quarters_of_sigma"] = {0.2, 0.4, 0.6, 0.7};
  EXPECT_THAT(PageOf(run), HasSubstr("estimated standard deviations, %</figcaption>"));
}

TEST(ReportPage, TabulatesTheMeasuresOfTheStatedUncertainty) {
  SmallRun run;
  EXPECT_THAT(PageOf(run), Not(HasSubstr("errors above 50 mm")));
  const nlohmann::json measures = {{"samples", 1200},
                                   {"within_one_sigma", 0.7},
                                   {"within_two_sigma", 0.9},
                                   {"ece", 0.0625},
                                   {"spearman", 0.5},
                                   {"auc", nullptr},
                                   {"risk_coverage_mm", {2.0, 4.0}},
                                   {"ideal_risk_coverage_mm", {1.0, 4.0}}};
  const nlohmann::json groups = {{"all", {{"positions", measures}, {"rotations", {{"samples", 0}}}}},
                                 {"legs", {{"positions", measures}}}};
  run.run["fit_error"]["sigma"] = {{"large_error_mm", 50},
                                   {"groups", groups},
                                   {"by_evidence", {{"<keypoints>", groups}}},
                                   {"warnings", {{{"message", "2 clips: no truth"}}}}};
  const std::string page = PageOf(run);
  EXPECT_THAT(page, HasSubstr("AUC: of errors above 50 mm)</caption>"));
  const std::string cells = "<td>70.0</td><td>90.0</td><td>0.062</td><td>0.50</td><td>–</td>";
  for (const char* name : {"Positions: all joints", "Positions: legs", "Positions from &lt;keypoints&gt;"})
    EXPECT_THAT(page, HasSubstr(std::string(">") + name + "</th><td>1\u2009200</td>" + cells));
  EXPECT_THAT(page, Not(HasSubstr("Rotations: all joints")));
  EXPECT_THAT(page, HasSubstr("2 clips: no truth."));
  EXPECT_THAT(page, HasSubstr("smallest stated deviations, mm</figcaption>"));
}

TEST(ReportPage, LinksEveryClipThatHasAPageAndListsTheRest) {
  SmallRun run;
  run.run["pages"]["test/p1/b"] = {{"page", "clip_001.html"}, {"video", "clip_001.mp4"}};
  const std::string page = PageOf(run);
  EXPECT_THAT(page, HasSubstr("<a href=\"clip_001.html\">test/p1/b</a>, <a href=\"clip_001.mp4\">video</a>"));
  EXPECT_THAT(page, Not(HasSubstr("viewer.html")));
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">test/p1/c</th><td>15.0</td>"));
  EXPECT_LT(page.find(">test/p1/b</a>"), page.find("<th scope=\"row\">test/p1/a</th>"));
  run.run["viewers"]["clips"] = "viewer.html";
  run.inputs.push_back({"dataset", "dataset.h5", run.folder / "fit_b.h5", ""});
  EXPECT_THAT(PageOf(run), HasSubstr("<a href=\"viewer.html#clip=test%2Fp1%2Fb%230-40&amp;t=0.000\">3‑D</a>"));
}

TEST(ReportPage, EscapesTextsOfTheCapture) {
  const std::string evil = "</script><script>alert(1)</script>\"'&";
  SmallRun run(evil);
  run.run["name"] = evil;
  run.run["description"] = evil;
  run.run["clips"].push_back(FailedClip(evil, evil));
  run.run["persons"][evil] = {{"bone_length_m", {{evil, 0.3}}}};
  for (StageInput& input : run.inputs) {
    if (input.name == "test/p1/a") input.name = evil;
  }
  const std::string page = PageOf(run);
  EXPECT_THAT(page, Not(HasSubstr("alert(1)</script>")));
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;alert(1)"));
}

TEST(ReportPage, TheSameResultsGiveTheSameBytes) {
  SmallRun run;
  const auto first = run.Page("first.html");
  const auto second = run.Page("second.html");
  ASSERT_TRUE(first && second);
  EXPECT_EQ(*first, *second);
}

TEST(ReportPage, NeedsNothingOutsideItself) {
  SmallRun run;
  const std::string page = PageOf(run);
  EXPECT_THAT(page, Not(HasSubstr("http://")));
  EXPECT_THAT(page, Not(HasSubstr("https://")));
  EXPECT_THAT(page, Not(HasSubstr("@import")));
  EXPECT_THAT(page, Not(HasSubstr("url(")));
  const std::regex address("(src|href)=\"([^\"]*)\"");
  for (std::sregex_iterator it(page.begin(), page.end(), address), end; it != end; ++it) {
    const std::string target = (*it)[2].str().substr(0, 22);
    EXPECT_TRUE(target[0] == '#' || target.rfind("data:", 0) == 0) << target;
  }
}

TEST(ReportPage, StaysReadableWhenEveryClipFailed) {
  SmallRun run;
  run.run["clips"] = {FailedClip("a", "empty file"), FailedClip("b", "empty file")};
  for (const char* key : {"audit", "metrics", "fit_error", "table"}) run.run[key] = nullptr;
  run.run["persons"] = nlohmann::json::object();
  run.inputs.clear();
  const std::string page = PageOf(run);
  ExpectAllSections(page);
  EXPECT_THAT(page, HasSubstr("None of the 2 clips is in the dataset"));
  EXPECT_THAT(page, HasSubstr("empty file"));
  EXPECT_THAT(page, HasSubstr("No clip has a fit to draw."));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

TEST(ReportPage, ShowsNamesOfATableAsTheyAreWritten) {
  SmallRun run;
  const std::vector<std::vector<std::string>> rows = {{"method", "FID"}, {"a|b_c\\", "0.200"}};
  run.run["table"] = {{"title", "my_run"}, {"rows", rows}, {"notes", {"n_1."}}};
  const std::string page = PageOf(run);
  EXPECT_THAT(page, HasSubstr("my_run"));
  EXPECT_THAT(page, HasSubstr("a|b_c\\</th>"));
  EXPECT_THAT(page, HasSubstr("n_1."));
}

TEST(ReportPage, WithoutTestClipsTheNearestNeighbourIsNotScored) {
  SmallRun run;
  EXPECT_THAT(PageOf(run), HasSubstr("without training</th><td>0.800</td>"));
  run.run["metrics"]["nearest_neighbour"] = {{"split", "s"}, {"accuracy", 0.0}, {"correct", 0}, {"count", 0}};
  EXPECT_THAT(PageOf(run), HasSubstr("without training</th><td>not scored</td>"));
}

TEST(ReportPage, ARecogniserWithoutTestClipsIsNotScoredAndHasNoConfusion) {
  SmallRun run;
  EXPECT_THAT(PageOf(run), HasSubstr("<h3>Confusion"));
  run.run["metrics"]["recognisers"]["recogniser"] = {{"test_clips", 0}, {"scored", "no clip tests"}};
  run.run["audit"]["splits"] = {{{"name", "s"}, {"train", 3}, {"validation", 0}, {"test", 0}, {"rule", "by person"}}};
  const std::string page = PageOf(run);
  EXPECT_THAT(page, HasSubstr("recogniser</th><td>not scored: no clip tests</td>"));
  EXPECT_THAT(page, HasSubstr("The recogniser is not scored: no clip tests."));
  EXPECT_THAT(page, HasSubstr("0: no clip tests, nothing is scored"));
  EXPECT_THAT(page, Not(HasSubstr("<h3>Confusion")));
}

TEST(ReportPage, ShowsWhatWasFoundAboutTheSplits) {
  SmallRun run;
  EXPECT_THAT(PageOf(run), HasSubstr("Nothing was found wrong or suspect about the set and its splits."));
  run.run["findings"] = {{{"clip", ""},
                          {"code", "split_drawn"},
                          {"severity", "warning"},
                          {"message", "split 's': drawn instead: p<2 tests"},
                          {"action", "replaced"}},
                         {{"clip", ""},
                          {"code", "split_leak"},
                          {"severity", "error"},
                          {"message", "split 's': leaks: 1 clip of equal content in two parts"},
                          {"action", "flagged"}}};
  const std::string page = PageOf(run);
  EXPECT_THAT(page, HasSubstr("drawn instead: p&lt;2 tests"));
  EXPECT_THAT(page, HasSubstr("leaks: 1 clip of equal content in two parts"));
}

TEST(ReportPage, SaysHowLongAndInWhichBatchesNetworksWereTrained) {
  SmallRun run;
  run.run["training"]["recogniser/1"] = {{"kind", "gru_recogniser"},
                                         {"epochs", 40},
                                         {"batch", 32},
                                         {"history", {{"step", {10.0, 20.0}}, {"loss", {2.0, 1.0}}}}};
  const std::string page = PageOf(run);
  EXPECT_THAT(page, HasSubstr("recogniser: training loss by seed (40 epochs, batches of 32 clips)"));
  EXPECT_THAT(page, HasSubstr("loss (300 iterations, batches of 8 clips)"));
}

TEST(ReportPage, TheRunsOfAStageOnRawTracksBearTheirName) {
  SmallRun run;
  run.run["stages"].push_back({{"stage", "canon"}, {"branch", "raw tracks"}, {"items", 3}, {"done", 3}});
  EXPECT_THAT(PageOf(run), HasSubstr("canon (raw tracks)</th>"));
}

TEST(ReportPage, AnEvaluationThatFailedSaysWhyInPlaceOfTheTable) {
  SmallRun run;
  run.run["metrics"] = nullptr;
  run.run["table"] = nullptr;
  run.run["unevaluated"] = {{"code", "inconsistent"}, {"message", "class a<b is missing"}};
  EXPECT_THAT(PageOf(run), HasSubstr("There is no table: the evaluation failed. class a&lt;b is missing"));
}

TEST(ReportPage, SaysThatNothingFailed) {
  SmallRun run;
  EXPECT_THAT(PageOf(run), HasSubstr("No clip was excluded or refused."));
}

TEST(ReportPage, StaysReadableForAnEmptySummary) {
  SmallRun run;
  run.run = nlohmann::json::object();
  run.inputs.clear();
  const std::string page = PageOf(run);
  ExpectAllSections(page);
  EXPECT_THAT(page, HasSubstr("No clip was read."));
}

TEST(ReportPage, AClipThatCannotBeReadCostsOnlyItsStrip) {
  SmallRun run;
  ASSERT_TRUE(WriteFile(run.folder / "fit_b.h5", "damaged"));
  const std::string page = PageOf(run);
  EXPECT_THAT(page, HasSubstr("Not drawn: test/p1/b: "));
  EXPECT_THAT(page, HasSubstr("<h3>test/p1/c</h3>"));
}

TEST(ReportPage, ASummaryThatIsNoJsonIsRefused) {
  SmallRun run;
  ASSERT_TRUE(WriteFile(run.folder / "run.json", "{"));
  const auto outcome = ReportStage(run.Request("index.html"));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::kMalformed);
  EXPECT_FALSE(std::filesystem::exists(run.folder / "index.html"));
}

TEST(ReportPage, LongClipsAreThinnedToKeepThePageSmall) {
  SmallRun run;
  const SkeletonPtr skeleton = Walker();
  const Motion motion = Stepping(skeleton, 20000);
  Dataset fit;
  fit.skeleton = skeleton;
  fit.created_by = "mocurate test";
  Clip clip;
  clip.identity = {"test", "p1", "a", "", "", "", 0, 20000};
  clip.rate = motion.rate;
  clip.motion = motion;
  fit.clips.push_back(clip);
  ASSERT_TRUE(WriteDataset(fit, run.folder / "fit_a.h5"));
  EXPECT_LT(PageOf(run).size(), 5U << 20);
}

}  // namespace
}  // namespace mocurate::test
