// Review decisions about clips: reading, checking, applying, and reporting the stale ones.

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "canon/frames/facing.h"
#include "canon/review/review.h"
#include "canon/stages.h"
#include "core/base/file.h"
#include "tests/canon/moving_clips.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Reviewed : public testing::Test {
 protected:
  void SetUp() override {
    dataset_ = SetOf({ClipMoving("p1", "a", 40, 5, 30, 1), ClipMoving("p2", "a", 41, 5, 30, 1),
                      ClipMoving("p3", "b", 42, 5, 30, 1), ClipMoving("p4", "b", 43, 5, 30, 1)});
    for (Clip& clip : dataset_.clips) {
      Motion& motion = *clip.motion;  // an arm of three joints waves
      for (int f = 0; f < motion.frame_count(); ++f) {
        for (int j = motion.joint_count() - 3; j < motion.joint_count(); ++j) {
          motion.joints.at(f, j).y() += 0.3 * std::sin(0.01 * f * motion.frame_count());
        }
      }
    }
    dataset_.clips[1].segments = {{0.0, 1.0, "whole", "", "annotated"}};
    Split split;
    split.name = "persons";
    split.train = {0, 1};
    split.test = {2, 3};
    split.rule = "by person";
    split.leak_check = "ok";
    dataset_.splits = {split};
    Finding finding;
    finding.clip = dataset_.clips[1].id();
    finding.code = "position_jump";
    finding.frame_begin = 5;
    finding.frame_end = 15;
    dataset_.findings = {finding, finding};
    dataset_.findings[1].clip = dataset_.clips[0].id();
  }
  Decision About(int row, Verdict verdict) const {
    Decision decision;
    decision.verdict = verdict;
    decision.clip = dataset_.clips[static_cast<std::size_t>(row)].id();
    decision.content = MotionFingerprint(*dataset_.clips[static_cast<std::size_t>(row)].motion);
    decision.finding = "label_suspect";
    if (verdict == Verdict::kRelabel) decision.label = "b";
    if (verdict == Verdict::kCut) decision.begin = 10;
    if (verdict == Verdict::kCut) decision.end = 30;
    return decision;
  }

  /// As saved by the page, or written by hand.
  Expected<Review> Read(const std::vector<Decision>& decisions) const {
    EXPECT_TRUE(WriteFile(folder_ / "decisions.yaml", ReviewText({"set.h5", decisions})));
    return ReadReview(folder_ / "decisions.yaml");
  }

  std::vector<std::string> CodesOf(const AppliedReview& applied) const {
    std::vector<std::string> codes;
    for (const Finding& finding : applied.findings) codes.push_back(finding.code);
    return codes;
  }

  const ScratchFolder folder_;
  Dataset dataset_;
};

TEST_F(Reviewed, EveryVerdictIsCarriedOutAndSplitsAndFindingsFollow) {
  const std::string dropped = dataset_.clips[0].id(), cut = dataset_.clips[1].id(), kept = dataset_.clips[3].id();
  const auto review =
      Read({About(0, Verdict::kDrop), About(1, Verdict::kCut), About(1, Verdict::kRelabel), About(2, Verdict::kKeep)});
  ASSERT_TRUE(review) << review.error().Message();
  const auto applied = ApplyReview(*review, dataset_);
  ASSERT_TRUE(applied) << applied.error().Message();
  EXPECT_THAT(CodesOf(*applied), ElementsAre("review_drop", "review_cut", "review_relabel"));
  ASSERT_EQ(dataset_.clips.size(), 3u);
  ASSERT_EQ(applied->dropped.size(), 1u);
  EXPECT_EQ(applied->dropped[0].id(), dropped);
  const Clip& clip = dataset_.clips[0];
  EXPECT_EQ(clip.id(), applied->new_ids.at(cut));
  EXPECT_EQ(clip.motion->frame_count(), 20);
  EXPECT_EQ(clip.label, "b");
  EXPECT_NEAR(clip.segments.at(0).end_s, 20.0 / 30.0, 1e-9);
  ASSERT_EQ(dataset_.findings.size(), 1u) << "the other was about the clip that was dropped";
  EXPECT_EQ(dataset_.findings[0].clip, clip.id());
  EXPECT_EQ(dataset_.findings[0].frame_begin, 0);
  EXPECT_EQ(dataset_.findings[0].frame_end, 5);
  EXPECT_THAT(dataset_.splits[0].train, ElementsAre(0));
  EXPECT_THAT(dataset_.splits[0].test, ElementsAre(1, 2));
  EXPECT_EQ(dataset_.clips[2].id(), kept);
}

TEST_F(Reviewed, AClipThatWasCutIsKnownByItsNewIdAfterwards) {
  Dataset copy = dataset_;
  const auto first = ApplyReview(*Read({About(1, Verdict::kCut)}), copy);
  ASSERT_TRUE(first);
  Decision later;
  later.clip = first->new_ids.begin()->second;
  later.content = MotionFingerprint(*copy.clips[1].motion);
  later.verdict = Verdict::kDrop;
  const auto both = ApplyReview(*Read({About(1, Verdict::kCut), later}), dataset_);
  ASSERT_TRUE(both) << both.error().Message();
  EXPECT_EQ(dataset_.clips.size(), 3u);
}

TEST_F(Reviewed, WhatNoLongerFitsIsReportedAndNotCarriedOut) {
  Decision gone = About(0, Verdict::kDrop), changed = About(1, Verdict::kDrop);
  gone.clip = "test/p9/nowhere#0-10";
  changed.content = "0123456789abcdef";
  const auto applied = ApplyReview(*Read({gone, changed, About(2, Verdict::kKeep)}), dataset_);
  ASSERT_TRUE(applied);
  EXPECT_THAT(CodesOf(*applied), ElementsAre("review_stale", "review_stale"));
  EXPECT_THAT(applied->findings[0].message, AllOf(HasSubstr("decisions.yaml:3"), HasSubstr("drop")));
  EXPECT_EQ(dataset_.clips.size(), 4u);
  const auto none = ApplyReview(*Read({gone, changed}), dataset_);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kInconsistent);
}

TEST_F(Reviewed, AClipThatFacedFrontDoesSoAfterACut) {
  for (Clip& clip : dataset_.clips) ASSERT_TRUE(FaceFront(FacingOptions(), clip));
  const auto applied = ApplyReview(*Read({About(1, Verdict::kCut)}), dataset_);
  ASSERT_TRUE(applied) << applied.error().Message();
  EXPECT_LT(dataset_.clips[1].motion->joints.at(0, 0).norm(), 1e-6);
}

TEST_F(Reviewed, AClassOrFrameThatIsNotThereIsAnErrorWithItsPlace) {
  Decision relabel = About(0, Verdict::kRelabel), cut = About(0, Verdict::kCut);
  relabel.label = "c";
  cut.end = 41;
  for (const Decision& decision : {relabel, cut}) {
    Dataset copy = dataset_;
    const auto applied = ApplyReview(*Read({decision}), copy);
    ASSERT_FALSE(applied);
    EXPECT_EQ(applied.error().code, ErrorCode::kConfig);
    EXPECT_THAT(applied.error().where, HasSubstr("decisions.yaml:3"));
  }
}

TEST_F(Reviewed, DecisionsThatContradictEachOtherAreRefusedWithBothPlaces) {
  const auto with = [&](Verdict verdict, const std::string& label, int end, const std::string& finding) {
    Decision decision = About(0, verdict);
    if (verdict == Verdict::kRelabel) decision.label = label;
    if (verdict == Verdict::kCut) decision.end = end;
    decision.finding = finding;
    return decision;
  };
  Decision other_motion = About(0, Verdict::kKeep);
  other_motion.content = "0123456789abcdef";
  const std::pair<Decision, Decision> wrong[] = {
      {About(0, Verdict::kDrop), About(0, Verdict::kRelabel)},
      {About(0, Verdict::kDrop), About(0, Verdict::kCut)},
      {About(0, Verdict::kKeep), About(0, Verdict::kDrop)},
      {About(0, Verdict::kRelabel), with(Verdict::kRelabel, "a", 30, "leak")},
      {About(0, Verdict::kCut), with(Verdict::kCut, "b", 31, "leak")},
      {About(0, Verdict::kKeep), other_motion}};
  for (const auto& [a, b] : wrong) {
    const auto review = Read({a, b});
    ASSERT_FALSE(review);
    EXPECT_EQ(review.error().code, ErrorCode::kConfig);
    EXPECT_THAT(review.error().Message(), AllOf(HasSubstr("decisions.yaml:3"), HasSubstr("decisions.yaml:")));
  }
  EXPECT_TRUE(Read({About(0, Verdict::kKeep), with(Verdict::kDrop, "", 0, "leak")})) << "of two findings";
  for (const Verdict verdict : {Verdict::kDrop, Verdict::kCut}) {  // repeated, under two findings
    Decision again = About(0, verdict);
    again.finding = "outlier";
    Dataset copy = dataset_;
    const auto twice = ApplyReview(*Read({About(0, verdict), again}), copy);
    ASSERT_TRUE(twice) << twice.error().Message();
    EXPECT_EQ(twice->findings.size(), 1u);
  }
  std::vector<Decision> many(1000, About(0, Verdict::kDrop));
  EXPECT_TRUE(Read(many));
  many.push_back(About(0, Verdict::kDrop));
  EXPECT_EQ(Read(many).error().code, ErrorCode::kConfig) << "each is compared with the others of its clip";
  many.assign(4000, Decision());
  for (std::size_t i = 0; i < many.size(); ++i) {
    many[i].clip = "c" + std::to_string(i / 900);
    many[i].verdict = i % 2 == 0 ? Verdict::kDrop : Verdict::kCut;
    many[i].end = i % 2 == 0 ? 0 : 9;
  }
  const auto listed = Read(many);
  ASSERT_FALSE(listed);
  EXPECT_LT(listed.error().what.size(), 100000u) << "the first contradictions";
  EXPECT_FALSE(Read({About(0, Verdict::kUndecided)}));
  Decision endless = About(0, Verdict::kCut);
  endless.end = endless.begin;
  EXPECT_FALSE(Read({endless}));
  EXPECT_TRUE(WriteFile(folder_ / "x.yaml", "decisions: [{clip: a, descision: drop}]"));
  EXPECT_EQ(ReadReview(folder_ / "x.yaml").error().code, ErrorCode::kConfig);
  EXPECT_EQ(ReadReview(folder_ / "nowhere.yaml").error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(WriteFile(folder_ / "x.yaml", "include: decisions.yaml"));
  EXPECT_EQ(ReadReview(folder_ / "x.yaml").error().code, ErrorCode::kConfig);
}

TEST_F(Reviewed, NotesNameNoEnvironment) {
  Decision decision = About(0, Verdict::kDrop);
  for (const char* note : {"${HOME}", "$${HOME}", "a ${", "$"}) {
    decision.note = note;
    EXPECT_EQ(Read({decision})->decisions.at(0).note, note);
  }
}

TEST_F(Reviewed, AssemblingTakesDecisionsAndAnAuditIsSilentAboutWhatWasKept) {
  Dataset set = dataset_;
  set.clips.push_back(set.clips[3]);
  set.clips.back().identity.recording += "again";
  set.splits.clear();
  StageRequest request{"assemble", "dataset", OptionsToJson(AssembleOptions()), {}, folder_ / "dataset.h5", folder_};
  ASSERT_TRUE(WriteDataset(set, folder_ / "clips.h5"));
  ASSERT_TRUE(Read({About(0, Verdict::kDrop), About(1, Verdict::kRelabel)}));
  request.inputs = {{"clip", "clips", folder_ / "clips.h5", ""},
                    {kReviewRole, "decisions.yaml", folder_ / "decisions.yaml", ""}};
  const auto outcome = AssembleStage(request);
  ASSERT_TRUE(outcome) << outcome.error().Message();
  const Dataset made = *ReadDataset(folder_ / "dataset.h5");
  ASSERT_EQ(made.clips.size(), 4u);
  EXPECT_EQ(made.clips[0].label, "b");
  EXPECT_EQ(outcome->summary.at("excluded").size(), 1u);

  StageRequest audit{"audit", "audit", OptionsToJson(AuditOptions()), {}, folder_ / "audit.json", folder_};
  audit.inputs = {{"dataset", "dataset.h5", folder_ / "dataset.h5", ""}};
  const auto duplicates = [&] {
    const nlohmann::json all = nlohmann::json::parse(*ReadFile(audit.output));
    nlohmann::json found = nlohmann::json::array();
    for (const nlohmann::json& one : all.at("findings")) {
      if (one.at("code") == "duplicate") found.push_back(one);
    }
    return found;
  };
  ASSERT_TRUE(AuditStage(audit));
  const nlohmann::json findings = duplicates();
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].at("safe_to_drop"), set.clips.back().id());
  Decision keep = About(3, Verdict::kKeep);
  keep.finding = "duplicate";
  keep.clip = set.clips.back().id();  // the other one of the pair
  keep.other = dataset_.clips[3].id();
  ASSERT_TRUE(Read({keep}));
  audit.inputs.push_back({kReviewRole, "decisions.yaml", folder_ / "decisions.yaml", ""});
  const auto second = AuditStage(audit);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->summary.at("accepted"), 1);
  EXPECT_TRUE(duplicates().empty());
}

}  // namespace
}  // namespace mocurate
