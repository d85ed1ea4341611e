// An excluded clip is no failure, and findings about a clip are in the dataset exactly once.

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>

#include "canon/options.h"
#include "canon/stages.h"
#include "canon/trim/trim.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

class Curation : public testing::Test {
 protected:
  Curation() {
    canon_.skeleton = "openni15";
    canon_.facing.rule = FacingRule::kNone;
    canon_.trim.rule = TrimRule::kMotionEnergy;
  }

  /// Evidence of a figure that travels at `speed`, with tracks and a given motion, and one finding of ingest.
  StageInput Evidence(const std::string& recording, double speed, int frames) const {
    const SkeletonPtr skeleton = *LoadSkeleton("openni15");
    JointTracks tracks;
    tracks.positions = JointPositions(frames, skeleton->joint_count());
    tracks.confidence.assign(static_cast<std::size_t>(frames) * skeleton->joint_count(), 1.0);
    for (int j = 0; j < skeleton->joint_count(); ++j) tracks.names.push_back(skeleton->joints[j].name);
    for (int f = 0; f < frames; ++f) {
      tracks.time_s.push_back(f / 30.0);
      for (int j = 0; j < skeleton->joint_count(); ++j) {
        const int parent = skeleton->joints[j].parent;
        Vector3d place = skeleton->joints[j].rest_offset;
        if (parent >= 0) place += tracks.positions.at(f, parent);
        tracks.positions.at(f, j) = place;
      }
      for (int j = 0; j < skeleton->joint_count(); ++j) tracks.positions.at(f, j).z() += speed * f / 30.0;
    }
    Clip clip;
    clip.identity.source = "test";
    clip.identity.person = "p1";
    clip.identity.recording = recording;
    clip.identity.end_frame = frames;
    clip.label = "walk";
    clip.rate = FrameRate{30, 1};
    clip.motion = MakeJointsOnly(skeleton, clip.rate, tracks.positions);
    clip.evidence.tracks = std::move(tracks);
    Finding finding;
    finding.clip = clip.id();
    finding.code = "handedness_contradiction";
    finding.message = "knees bend backwards";
    const auto path = folder_ / (recording + ".h5");
    const Status written = WriteEvidence(clip, path, {finding});
    EXPECT_TRUE(written) << written.error().Message();
    return {"motion", recording, path, "0"};
  }

  Expected<StageOutcome> Canon(StageInput evidence, const std::string& role) const {
    evidence.role = role;
    return CanonStage(
        {"canon", evidence.name, OptionsToJson(canon_), {evidence}, folder_ / (role + evidence.name), {}});
  }

  ScratchFolder folder_;
  CanonOptions canon_;
};

TEST_F(Curation, AClipThatNeverMovesOrIsTooShortIsExcludedByRuleWithTheRulesName) {
  const auto still = Canon(Evidence("still", 0.0, 60), "motion");
  ASSERT_TRUE(still) << still.error().Message();
  EXPECT_EQ(still->kind, OutcomeKind::kExcluded);
  EXPECT_EQ(still->findings.back().code, "never_moves");
  EXPECT_EQ(still->summary.at("threshold"), canon_.trim.still_speed);
  const auto brief = Canon(Evidence("brief", 1.0, 4), "motion");
  ASSERT_TRUE(brief) << brief.error().Message();
  EXPECT_EQ(brief->kind, OutcomeKind::kExcluded);
  EXPECT_EQ(brief->findings.back().code, "too_short");
  EXPECT_EQ(brief->summary.at("threshold"), canon_.trim.min_length_s);
  EXPECT_LT(brief->findings.back().value, canon_.trim.min_length_s);
}

TEST_F(Curation, AClipThatCannotBeUsedIsRefusedNotExcluded) {
  StageInput evidence = Evidence("walk", 1.0, 60);
  canon_.skeleton = "unknown";
  EXPECT_FALSE(Canon(evidence, "tracks"));
}

TEST(Annotations, OfTwoSegmentsOverTheSameFramesTheFirstIsKeptAndTheSecondIsAFinding) {
  Clip clip;
  clip.identity.recording = "r";
  clip.identity.end_frame = 60;
  clip.rate = FrameRate{30, 1};
  const SkeletonPtr skeleton = *LoadSkeleton("openni15");
  clip.motion = MakeJointsOnly(skeleton, clip.rate, JointPositions(60, skeleton->joint_count()));
  clip.segments = {{0.0, 1.0, "walk", "", ""}, {0.001, 1.0, "wave", "", ""}, {1.0, 2.0, "walk", "", ""}};
  TrimOptions options;
  options.rule = TrimRule::kAnnotated;
  std::vector<Finding> findings;
  const std::vector<KeptSpan> spans = FindSpans(options, clip, findings);
  ASSERT_EQ(spans.size(), 2u);
  EXPECT_EQ(spans[0].label, "walk");
  EXPECT_EQ(spans[1].begin, 30);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "same_frames");
  EXPECT_EQ(findings[0].severity, Severity::kWarning);
  EXPECT_EQ(findings[0].frame_begin, 0);
  EXPECT_EQ(findings[0].frame_end, 30);
  EXPECT_EQ(findings[0].message, "segment 'wave' has the same frames as segment 'walk', which was kept");
}

TEST_F(Curation, WhatIngestFoundStandsInTheDatasetOnceWhicheverWayTheClipCame) {
  for (const std::string role : {"motion", "tracks"}) {
    StageRequest assemble{"assemble", "dataset", OptionsToJson(AssembleOptions()), {}, folder_ / ("set_" + role), {}};
    for (const char* recording : {"a", "b"}) {
      const auto outcome = Canon(Evidence(recording, 1.0, 60), role);
      ASSERT_TRUE(outcome) << outcome.error().Message();
      ASSERT_EQ(outcome->kind, OutcomeKind::kDone);
      EXPECT_TRUE(outcome->findings.empty()) << "ingest has reported it already";
      assemble.inputs.push_back({"clip", recording, folder_ / (role + recording), "0"});
    }
    ASSERT_TRUE(AssembleStage(assemble));
    const auto dataset = ReadDataset(assemble.output);
    ASSERT_TRUE(dataset) << dataset.error().Message();
    ASSERT_EQ(dataset->findings.size(), 2u);
    EXPECT_EQ(dataset->findings[0].clip, "test/p1/a#0-60");
    EXPECT_EQ(dataset->findings[1].clip, "test/p1/b#0-60");
    EXPECT_EQ(dataset->findings[0].code, "handedness_contradiction");
  }
}

}  // namespace
}  // namespace mocurate
