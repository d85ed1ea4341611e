// Splits: assignment of groups to parts, and leaks.

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "canon/audit/audit.h"
#include "canon/options.h"
#include "canon/splits/groups.h"
#include "canon/splits/splits.h"
#include "canon/stages.h"
#include "tests/canon/moving_clips.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

TEST(Split, ByPersonNeverSharesAPerson) {
  std::vector<Finding> findings;
  const Dataset dataset = SetOf(
      {ClipMoving("p1", "a", 40, 5, 30, 1), ClipMoving("p2", "a", 41, 5, 30, 1), ClipMoving("p3", "b", 42, 5, 30, 1)});
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.test = {"p3"};
  options.validation = {"p2"};
  const auto split = MakeSplit(options, dataset, findings);
  ASSERT_TRUE(split) << split.error().Message();
  EXPECT_EQ(split->train, std::vector<int>{0});
  EXPECT_EQ(split->validation, std::vector<int>{1});
  EXPECT_EQ(split->test, std::vector<int>{2});
  EXPECT_THAT(split->leak_check, HasSubstr("ok"));
}

TEST(Split, CamerasOfOnePerformanceAreOfOnePartAndSessionsWhereAsked) {
  std::vector<Clip> clips;
  for (int k = 0; k < 60; ++k) {
    Clip clip = ClipMoving("p1", "a", 40 + k, 5, 30, 1);
    clip.identity.recording = "r" + std::to_string(k);
    clip.identity.view = "C" + std::to_string(k % 3);
    clip.identity.session = "s" + std::to_string(k / 6);
    clip.provenance["performance"] = "take=" + std::to_string(k / 3);
    clips.push_back(std::move(clip));
  }
  const Dataset dataset = SetOf(std::move(clips));
  SplitOptions options;
  options.test_share = 0.4;
  std::vector<Finding> findings;
  for (const bool together : {false, true}) {
    options.sessions_together = together;
    const auto split = MakeSplit(options, dataset, findings);
    ASSERT_TRUE(split) << split.error().Message();
    EXPECT_THAT(split->leak_check, HasSubstr("ok"));
    EXPECT_FALSE(split->test.empty());
    std::map<std::string, std::set<std::string>> parts;
    const std::pair<const char*, const std::vector<int>*> rows[] = {
        {"train", &split->train}, {"validation", &split->validation}, {"test", &split->test}};
    for (const auto& [part, of_part] : rows) {
      for (const int row : *of_part) {
        const Clip& clip = dataset.clips[static_cast<std::size_t>(row)];
        parts[together ? clip.identity.session : clip.provenance.at("performance")].insert(part);
      }
    }
    EXPECT_EQ(parts.size(), together ? 10u : 20u);
    for (const auto& [group, in] : parts) EXPECT_EQ(in.size(), 1u) << group;
  }
}

TEST(Split, EqualClipsOfTwoPersonsLeak) {
  std::vector<Finding> findings;
  Dataset dataset = SetOf({ClipMoving("p1", "a", 40, 5, 30, 1), ClipMoving("p2", "a", 40, 5, 30, 1)});
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.test = {"p2"};
  const auto split = MakeSplit(options, dataset, findings);
  ASSERT_TRUE(split);
  EXPECT_THAT(split->leak_check, HasSubstr("1 clip of equal content"));
}

TEST(Split, ANameThatNoClipHasIsAnErrorThatProposesTheNearest) {
  Dataset dataset = SetOf({ClipMoving("p01", "a", 40, 5, 30, 1), ClipMoving("p02", "a", 41, 5, 30, 1)});
  for (Clip& clip : dataset.clips) clip.provenance["style"] = clip.identity.person == "p01" ? "lively" : "calm";
  using Names = std::vector<std::string>;
  struct Absent {
    SplitBy by;
    Names test, validation, train;
    const char* near;
  };
  for (const Absent& absent :
       {Absent{SplitBy::kPerson, {"P1"}, {}, {}, "'p01'"}, Absent{SplitBy::kPerson, {"p01"}, {"p2"}, {}, "'p02'"},
        Absent{SplitBy::kPerson, {}, {}, {"p9"}, "p01, p02"},
        Absent{SplitBy::kPerson, {"p01", "p9"}, {}, {}, "p01, p02"},
        Absent{SplitBy::kStyle, {"livly"}, {}, {}, "'lively'"}}) {
    SplitOptions options;
    options.by = absent.by;
    options.test = absent.test;
    options.validation = absent.validation;
    options.train = absent.train;
    std::vector<Finding> findings;
    const auto split = MakeSplit(options, dataset, findings);
    ASSERT_FALSE(split) << absent.near;
    EXPECT_EQ(split.error().code, ErrorCode::kConfig);
    EXPECT_THAT(split.error().hint, HasSubstr(absent.near));
    EXPECT_TRUE(findings.empty());
  }
}

TEST(Split, ByFractionOrRoleHasNoNamesAndByRoleNeedsRoles) {
  Dataset dataset = SetOf({ClipMoving("p01", "a", 40, 5, 30, 1), ClipMoving("p02", "a", 41, 5, 30, 1)});
  std::vector<Finding> findings;
  SplitOptions options;
  options.test = {"p01"};
  EXPECT_FALSE(MakeSplit(options, dataset, findings));
  options.by = SplitBy::kRole;
  EXPECT_FALSE(MakeSplit(options, dataset, findings));
  options.test.clear();
  EXPECT_FALSE(MakeSplit(options, dataset, findings)) << "no clip has a role";
  options.absent = AbsentGroups::kDraw;
  const auto all_train = MakeSplit(options, dataset, findings);
  ASSERT_TRUE(all_train);
  EXPECT_EQ(all_train->train.size(), 2u);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "split_name_absent");
  options.absent = AbsentGroups::kRefuse;
  dataset.clips[0].role = "test";
  const auto split = MakeSplit(options, dataset, findings);
  ASSERT_TRUE(split) << split.error().Message();
  EXPECT_EQ(split->test, std::vector<int>{0});
}

TEST(Split, OneFileUnderTwoPersonsNamesLeaksThoughItsFitsDiffer) {
  Dataset dataset = SetOf({ClipMoving("p1", "a", 40, 5, 30, 1), ClipMoving("p2", "a", 40, 5, 30, 1.1)});
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.test = {"p2"};
  std::vector<Finding> findings;
  EXPECT_THAT(MakeSplit(options, dataset, findings)->leak_check, HasSubstr("ok"));
  for (Clip& clip : dataset.clips) clip.evidence_sha256 = std::string(64, 'a');
  EXPECT_THAT(MakeSplit(options, dataset, findings)->leak_check, HasSubstr("1 clip of equal content"));
}

TEST(Split, PeopleOfOneFileAreNotEqualClips) {
  Dataset dataset = SetOf({ClipMoving("p1", "a", 40, 5, 30, 1), ClipMoving("p2", "a", 40, 5, 30, 1.1)});
  for (Clip& clip : dataset.clips) {
    clip.evidence_sha256 = std::string(64, 'a');
    clip.provenance["file"] = "both.skeleton";
  }
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.test = {"p2"};
  std::vector<Finding> findings;
  const auto split = MakeSplit(options, dataset, findings);
  ASSERT_TRUE(split);
  EXPECT_EQ(split->leak_check.rfind("ok", 0), 0u);
  EXPECT_EQ(KeptApart(*split), SplitBy::kPerson);
  dataset.clips[1].motion = dataset.clips[0].motion;
  EXPECT_THAT(MakeSplit(options, dataset, findings)->leak_check, HasSubstr("1 clip of equal content"))
      << "one file under two names";
  Split merged;
  merged.rule = "kard: by person; test: p1; ntu: by person; test: p2";
  EXPECT_EQ(KeptApart(merged), SplitBy::kPerson);
  merged.rule = "kard: by person; test: p1; ntu: by performance";
  EXPECT_EQ(KeptApart(merged), std::nullopt);
}

TEST(Split, ClipsThatAreLeftAsideDoNotLeak) {
  Dataset dataset = SetOf(
      {ClipMoving("p1", "a", 40, 5, 30, 1), ClipMoving("p2", "a", 40, 5, 30, 1), ClipMoving("p1", "b", 60, 5, 30, 1)});
  for (int i : {0, 1}) dataset.clips[static_cast<std::size_t>(i)].evidence_sha256 = std::string(64, 'a');
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.test = {"p2"};
  std::vector<Finding> findings;
  EXPECT_NE(MakeSplit(options, dataset, findings)->leak_check.rfind("ok", 0), 0u);
  options.min_train_frames = 50;
  const auto split = MakeSplit(options, dataset, findings);
  EXPECT_EQ(split->train, std::vector<int>{2});
  EXPECT_EQ(split->leak_check.rfind("ok", 0), 0u);
}

TEST(Split, TakesAtMostSoManyClipsOfALabelWhateverTheOthersAre) {
  std::vector<Clip> clips;
  for (int i = 0; i < 12; ++i)
    clips.push_back(ClipMoving("p" + std::to_string(i % 3), i < 9 ? "a" : "b", 40 + i, 5, 30, 1));
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.test = {"p2"};
  options.most_per_label = 2;
  std::vector<Finding> findings;
  const Dataset whole = SetOf(clips);
  const auto split = MakeSplit(options, whole, findings);
  std::map<std::string, int> of_label;
  for (const int row : split->train) ++of_label[whole.clips[static_cast<std::size_t>(row)].label];
  EXPECT_EQ(of_label, (std::map<std::string, int>{{"a", 2}, {"b", 2}}));
  // A clip that is drawn stays so when clips of other labels go.
  const Dataset fewer = SetOf({clips.begin(), clips.begin() + 9});
  const auto again = MakeSplit(options, fewer, findings);
  std::set<std::string> before, after;
  for (const int row : split->train) {
    if (whole.clips[static_cast<std::size_t>(row)].label == "a")
      before.insert(whole.clips[static_cast<std::size_t>(row)].id());
  }
  for (const int row : again->train) after.insert(fewer.clips[static_cast<std::size_t>(row)].id());
  EXPECT_EQ(before, after);
}

TEST(Split, OtherPersonsOfTheSameSourceAreDrawnAndThatIsSaid) {
  const Dataset dataset = SetOf({ClipMoving("p9", "a", 40, 5, 30, 1), ClipMoving("p10", "a", 41, 5, 30, 1),
                                 ClipMoving("p11", "b", 42, 5, 30, 1)});
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.absent = AbsentGroups::kDraw;
  options.test = {"p7", "p8"};
  std::vector<Finding> findings;
  const auto split = MakeSplit(options, dataset, findings);
  ASSERT_TRUE(split) << split.error().Message();
  EXPECT_EQ(split->test.size(), 1u);
  EXPECT_EQ(split->train.size(), 2u);
  EXPECT_THAT(split->rule, HasSubstr("drawn"));
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].code, "split_name_absent");
  EXPECT_THAT(findings[0].message, HasSubstr("'p7, p8'"));
  EXPECT_EQ(findings[1].code, "split_drawn");
}

TEST(Split, OnePersonWhoIsThereTestsAloneAndNoOneIsDrawn) {
  const Dataset dataset = SetOf({ClipMoving("p1", "a", 40, 5, 30, 1), ClipMoving("p7", "a", 41, 5, 30, 1)});
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.absent = AbsentGroups::kDraw;
  options.test = {"p7", "p8"};
  std::vector<Finding> findings;
  const auto split = MakeSplit(options, dataset, findings);
  ASSERT_TRUE(split);
  EXPECT_EQ(split->test, std::vector<int>{1});
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_THAT(findings[0].message, HasSubstr("'p8'"));
}

TEST(Split, WhereAllAreNamedToTestNoPersonTrainsAndTheSplitIsRefused) {
  const Dataset dataset = SetOf({ClipMoving("p7", "a", 40, 5, 30, 1), ClipMoving("p8", "a", 41, 5, 30, 1)});
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.test = {"p7", "p8"};
  std::vector<Finding> findings;
  const auto split = MakeSplit(options, dataset, findings);
  ASSERT_FALSE(split);
  EXPECT_EQ(split.error().code, ErrorCode::kConfig);
  EXPECT_THAT(split.error().Message(), HasSubstr("none is left to train: p7, p8"));
  EXPECT_TRUE(ResolveGroups(options, {"p7", "p8", "p1"}, findings)) << "p1 trains";
}

TEST(Split, WhoIsNamedPlaysThatPartWhateverIsDrawnBesideIt) {
  std::vector<Clip> clips;
  for (int i = 1; i <= 6; ++i) clips.push_back(ClipMoving("p" + std::to_string(i), "a", 40 + i, 5, 30, 1));
  const Dataset dataset = SetOf(clips);
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.absent = AbsentGroups::kDraw;
  options.test = {"p9"};
  options.validation = {"p2"};
  options.train = {"p5", "p6"};
  for (options.seed = 1; options.seed < 20; ++options.seed) {
    std::vector<Finding> findings;
    const auto split = MakeSplit(options, dataset, findings);
    ASSERT_TRUE(split) << split.error().Message();
    EXPECT_EQ(split->validation, std::vector<int>{1});
    EXPECT_THAT(split->train, ::testing::IsSupersetOf({4, 5}));
    EXPECT_EQ(split->test.size(), 1u) << "drawn of p1, p3 and p4";
    EXPECT_EQ(findings.back().code, "split_drawn");
  }
}

TEST(Split, AMissingValidationPersonIsReplacedAndTheTestPersonStays) {
  const Dataset dataset = SetOf(
      {ClipMoving("p1", "a", 40, 5, 30, 1), ClipMoving("p2", "a", 41, 5, 30, 1), ClipMoving("p3", "b", 42, 5, 30, 1)});
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.absent = AbsentGroups::kDraw;
  options.test = {"p3"};
  options.validation = {"p4"};
  std::vector<Finding> findings;
  const auto split = MakeSplit(options, dataset, findings);
  ASSERT_TRUE(split) << split.error().Message();
  EXPECT_EQ(split->test, std::vector<int>{2});
  EXPECT_EQ(split->validation.size(), 1u);
  EXPECT_EQ(split->train.size(), 1u);
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_THAT(findings[1].message, HasSubstr("selects"));
}

TEST(Split, APartThatNoPersonCanPlayBesideThoseWhoAreNamedIsRefused) {
  const Dataset dataset = SetOf({ClipMoving("p1", "a", 40, 5, 30, 1), ClipMoving("p2", "a", 41, 5, 30, 1)});
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.absent = AbsentGroups::kDraw;
  options.test = {"p7"};
  options.validation = {"p2"};
  std::vector<Finding> findings;
  auto split = MakeSplit(options, dataset, findings);
  ASSERT_FALSE(split);
  EXPECT_THAT(split.error().Message(), HasSubstr("the test part would be empty: none of 'p7' is in the set"));
  options.test = {"p2"};
  split = MakeSplit(options, dataset, findings);
  ASSERT_FALSE(split);
  EXPECT_THAT(split.error().Message(), HasSubstr("'p2' is named under `test` and under `validation`"));
}

TEST(Split, OnePersonAloneTrainsAndNothingTests) {
  const Dataset dataset = SetOf({ClipMoving("p1", "a", 40, 5, 30, 1)});
  SplitOptions options;
  options.by = SplitBy::kPerson;
  options.absent = AbsentGroups::kDraw;
  options.test = {"p7"};
  std::vector<Finding> findings;
  const auto split = MakeSplit(options, dataset, findings);
  ASSERT_TRUE(split);
  EXPECT_TRUE(split->test.empty());
  EXPECT_EQ(split->train, std::vector<int>{0});
}

TEST(Split, ByFractionDoesNotDependOnWhichOtherClipsThereAre) {
  std::vector<Finding> findings;
  std::vector<Clip> clips;
  for (int i = 0; i < 60; ++i) clips.push_back(ClipMoving("p", "a", 40 + i, 5, 30, 1));
  SplitOptions options;
  options.test_share = 0.3;
  const auto all = MakeSplit(options, SetOf(clips), findings);
  clips.resize(30);
  const auto half = MakeSplit(options, SetOf(clips), findings);
  ASSERT_TRUE(all && half);
  for (const int row : half->test) EXPECT_THAT(all->test, ::testing::Contains(row));
  EXPECT_NEAR(static_cast<double>(all->test.size()), 18.0, 9.0);
}

TEST(NearestNeighbour, RecognisesMotionsThatDiffer) {
  const Dataset dataset = SetOf({ClipMoving("p1", "a", 40, 5, 30, 1.0), ClipMoving("p1", "b", 40, 5, 30, -1.0),
                                 ClipMoving("p2", "a", 50, 6, 38, 0.9), ClipMoving("p2", "b", 50, 6, 38, -0.9)});
  Split split;
  split.train = {0, 1};
  split.test = {2, 3};
  const auto result = NearestNeighbour(dataset, split);
  EXPECT_EQ(result.correct, 2);
  EXPECT_EQ(result.count, 2);
}

TEST(Stages, CanonOfAnnotatedClipsReportsTheLabelsThatThereAre) {
  const ScratchFolder folder;
  Clip clip = ClipMoving("p1", "", 90, 5, 80, 1);
  for (const auto& [label, begin] : {std::pair("walk", 0.0), {"transition", 1.0}, {"kick", 2.0}}) {
    Segment segment;
    segment.label = label;
    segment.begin_s = begin;
    segment.end_s = begin + 1.0;
    clip.segments.push_back(segment);
  }
  ASSERT_TRUE(WriteDataset(SetOf({clip}), folder / "fit.h5"));
  CanonOptions options;
  options.trim.rule = TrimRule::kAnnotated;
  options.trim.drop_labels = {"transition"};
  const auto outcome = CanonStage(
      {"canon", "x", OptionsToJson(options), {{"motion", "x", folder / "fit.h5", ""}}, folder / "canon.h5", folder});
  ASSERT_TRUE(outcome) << outcome.error().Message();
  EXPECT_EQ(outcome->summary.at("clips"), 2);
  EXPECT_EQ(outcome->summary.at("labels"), nlohmann::json({"kick", "transition", "walk"}));
}

TEST(Stages, CanonTakesNoSamplesBetweenFramesThatLieFarApart) {
  const ScratchFolder folder;
  Clip clip = ClipMoving("p1", "", 90, 5, 80, 1);
  CanonOptions options;
  options.facing.rule = FacingRule::kNone;
  options.rate = "30";
  for (const FrameRate rate : {FrameRate{2, 1}, FrameRate{1, 1}}) {
    clip.rate = clip.motion->rate = rate;
    ASSERT_TRUE(WriteDataset(SetOf({clip}), folder / "fit.h5"));
    const auto outcome = CanonStage(
        {"canon", "x", OptionsToJson(options), {{"motion", "x", folder / "fit.h5", ""}}, folder / "canon.h5", folder});
    EXPECT_EQ(outcome.has_value(), rate.numerator == 2) << (outcome ? "" : outcome.error().Message());
    EXPECT_TRUE(outcome || outcome.error().code == ErrorCode::kInconsistent);
  }
}

TEST(Stages, CanonThenAssembleGivesAReadableDataset) {
  const ScratchFolder folder;
  AssembleOptions options;
  options.splits.resize(1);
  options.splits[0].by = SplitBy::kPerson;
  options.splits[0].test = {"p2"};
  StageRequest assemble{"assemble", "dataset", OptionsToJson(options), {}, folder / "dataset.h5", folder};
  int n = 0;
  for (const char* person : {"p1", "p2"}) {
    for (const char* label : {"a", "b"}) {
      Dataset one = SetOf({ClipMoving(person, label, 40 + n, 5, 30, 1)});
      one.labels.clear();
      const auto input = folder / ("fit" + std::to_string(n) + ".h5");
      ASSERT_TRUE(WriteDataset(one, input));
      const auto output = folder / ("canon" + std::to_string(n++) + ".h5");
      const StageRequest canon{"canon", "x",   OptionsToJson(CanonOptions()), {{"motion", "x", input, ""}},
                               output,  folder};
      const auto outcome = CanonStage(canon);
      ASSERT_TRUE(outcome) << outcome.error().Message();
      EXPECT_EQ(outcome->summary.at("clips"), 1);
      assemble.inputs.push_back({"clip", "x", output, ""});
    }
  }
  const auto assembled = AssembleStage(assemble);
  ASSERT_TRUE(assembled) << assembled.error().Message();
  const auto dataset = ReadDataset(folder / "dataset.h5");
  ASSERT_TRUE(dataset) << dataset.error().Message();
  EXPECT_EQ(dataset->clips.size(), 4u);
  EXPECT_EQ(dataset->labels.size(), 2u);
  ASSERT_EQ(dataset->splits.size(), 1u);
  EXPECT_EQ(dataset->splits[0].test.size(), 2u);
}

}  // namespace
}  // namespace mocurate
