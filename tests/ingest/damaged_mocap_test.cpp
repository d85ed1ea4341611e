// Files of motion capture with one thing wrong: the cause is told, with its place and a way out, and nothing
// that only follows from it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "core/base/text.h"
#include "core/formats/amass.h"
#include "core/formats/amc.h"
#include "core/formats/bvh.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/runs.h"

namespace mocurate {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

class DamagedMocap : public WrittenFormats {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
    WrittenFormats::SetUp();
  }
  static std::string Recorded(const std::string& path) { return *ReadFile(TestData() + "/" + path); }
  Json Look() const { return InspectPath(folder_, std::nullopt); }
  static Json Told(const Json& inspection, const std::string& code) {
    for (const Json& finding : inspection.at("findings")) {
      if (finding.at("code") == code) return finding;
    }
    return {{"message", ""}, {"severity", ""}, {"where", ""}, {"value", 0.0}};
  }
  IngestOptions From(const std::string& recipe) const {
    IngestOptions options = Declared(recipe);
    options.path = folder_;
    options.source.annotations.clear();
    return options;
  }
};

// Rates.

class WrongRates : public DamagedMocap {
 protected:
  Json WithFrameTime(const std::string& time) {
    const std::string text = Recorded("bvh/bandai1/dataset-1_bow_normal_001.bvh");
    Written("dataset-1_bow_normal_001.bvh",
            std::regex_replace(text, std::regex("Frame Time:[^\r\n]*"), "Frame Time: " + time));
    return Look();
  }
};

TEST_F(WrongRates, AFrameTimeAtWhichNobodyRecordsIsAnErrorThatSaysWhatTheNumberLooksLike) {
  const std::pair<const char*, const char*> cases[] = {{"30", "30 looks like frames per second"},
                                                       {"120", "120 looks like frames per second"},
                                                       {"33.333", "looks like milliseconds per frame"},
                                                       {"33333", "looks like microseconds per frame"},
                                                       {"1", "declare ingest.source.rate"},
                                                       {"0.00001", "declare ingest.source.rate"}};
  for (const auto& [time, words] : cases) {
    const Json inspection = WithFrameTime(time);
    const Json told = Told(inspection, "rate_implausible");
    EXPECT_EQ(told.at("severity"), "error") << time;
    EXPECT_THAT(told.at("message"), AllOf(HasSubstr("dataset-1_bow_normal_001.bvh:134: "), HasSubstr(words)));
    EXPECT_EQ(Codes(inspection, "error").size(), 1u) << inspection.at("findings").dump(1);
    EXPECT_THAT(Codes(inspection, "warning"), IsEmpty()) << "nothing is judged by that rate: " << time;
    IngestOptions options = From("bandai1");
    options.source.rate_hz.reset();
    const auto refused = RunAll(options);
    ASSERT_EQ(refused.size(), 1u);
    EXPECT_EQ(refused[0].outcome.kind, OutcomeKind::kRefused) << time;
    EXPECT_THAT(refused[0].outcome.error.Message(), HasSubstr("declare ingest.source.rate"));
    options.source.rate_hz = 30.0;
    const auto declared = RunAll(options);
    EXPECT_NE(declared[0].outcome.kind, OutcomeKind::kRefused) << "the declared rate is used";
    EXPECT_EQ(declared[0].outcome.summary.at("rate_hz"), 30.0);
  }
  for (const char* time : {"0.0333333", "0.0083333", "0.04", "0.1", "0.001"})
    EXPECT_THAT(Codes(WithFrameTime(time), "error"), IsEmpty()) << time;
}

TEST_F(WrongRates, AFrameTimeThatIsNoTimeIsRefusedWithItsLineAndAWayOut) {
  for (const char* time : {"0", "-0.0333", "nan", "1e-9", "inf"}) {
    const Json told = Told(WithFrameTime(time), "malformed");
    EXPECT_THAT(told.at("message"), HasSubstr("0.0333333 for 30 frames a second")) << time;
    EXPECT_THAT(told.at("where"), HasSubstr(".bvh:134")) << time;
  }
}

TEST_F(WrongRates, ARateOfAmassThatIsSecondsPerFrameIsTold) {
  Amass amass = *ParseAmass(Recorded("amass_babel/amass_sample.npz"), "a");
  amass.rate_hz = 1.0 / 120.0;
  Written("CMU/01/walk_poses.npz", *EncodeAmass(amass, "a"));
  EXPECT_THAT(Told(Look(), "rate_implausible").at("message"), HasSubstr("looks like seconds per frame: write 120"));
  const auto clips = RunAll(From("amass"));
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_EQ(clips[0].outcome.kind, OutcomeKind::kRefused);
}

// Angles.

TEST_F(DamagedMocap, OfAnglesInAnotherUnitTheCauseIsToldAndNotWhatFollowsFromIt) {
  Amass amass = *ParseAmass(Recorded("amass_babel/amass_sample.npz"), "a");
  for (double& angle : amass.poses) angle *= 180.0 / M_PI;
  for (const bool markers : {true, false}) {
    if (!markers) amass.markers = 0;
    Written("CMU/01/walk_poses.npz", *EncodeAmass(amass, "a"));
    const Json inspection = Look();
    EXPECT_THAT(Codes(inspection, "error"), ElementsAre("angle_unit_contradiction"));
    EXPECT_THAT(Codes(inspection, "warning"), IsEmpty()) << inspection.at("findings").dump(1);
    if (markers) {
      EXPECT_EQ(Value(inspection.at("clips")[0], "up"), "+z") << "the markers still show it";
    }
    const auto clips = RunAll(From("amass"));
    ASSERT_EQ(clips.size(), 1u);
    EXPECT_THAT(ErrorCodes(clips[0].outcome), ElementsAre("angle_unit_contradiction"));
    EXPECT_EQ(clips[0].outcome.findings.size(), 2u) << "and the skeleton that is used";
    EXPECT_EQ(clips[0].outcome.kind, OutcomeKind::kDoubtful);
  }
}

TEST_F(DamagedMocap, ABvhInRadiansIsToldAndOneOfDegreesIsNot) {
  const char* const name = "dataset-1_bow_normal_001.bvh";
  Bvh bvh = *ParseBvh(Recorded(std::string("bvh/bandai1/") + name), name);
  for (const BvhJoint& joint : bvh.joints) {
    for (std::size_t c = 0; c < joint.channels.size(); ++c) {
      for (int f = 0; f < bvh.frames && !IsPosition(joint.channels[c]); ++f)
        bvh.values[static_cast<std::size_t>(f) * bvh.channel_count + joint.first_channel + c] *= M_PI / 180.0;
    }
  }
  Written(name, WriteBvh(bvh));
  const Json inspection = Look();
  EXPECT_THAT(Codes(inspection, "error"), ElementsAre("angle_unit_contradiction"));
  EXPECT_THAT(Codes(inspection, "warning"), IsEmpty());
  EXPECT_EQ(inspection.at("clips")[0].at("up").at("from"), "unknown");
  const auto clips = RunAll(From("bandai1"));
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_THAT(ErrorCodes(clips[0].outcome), ElementsAre("angle_unit_contradiction"));
}

class DamagedAcclaim : public DamagedMocap {
 protected:
  void Write(const std::string& motion) {
    Written("01.asf", Recorded("cmu/asf_amc/01.asf"));
    Written("01_01.amc", motion);
  }
  static std::string Motion() { return std::regex_replace(Recorded("cmu/asf_amc/01_01.amc"), std::regex("\r"), ""); }
  /// The row of a bone in a frame replaced.
  static std::string WithRow(std::string text, int frame, const std::string& bone, const std::string& row) {
    const std::size_t at = text.find("\n" + bone + " ", text.find("\n" + std::to_string(frame) + "\n")) + 1;
    return text.replace(at, text.find('\n', at) + 1 - at, row);
  }
};

TEST_F(DamagedAcclaim, AHeaderOfTheWrongUnitIsTheOnlyErrorOfAMotion) {
  std::string text = Motion();
  Write(text.replace(text.find(":DEGREES"), 8, ":RADIANS"));
  const Json inspection = Look();
  EXPECT_THAT(Codes(inspection, "error"), ElementsAre("angle_unit_contradiction"));
  EXPECT_THAT(Codes(inspection, "warning"), IsEmpty());
  for (const char* field : {"up", "handedness", "rate_hz"})
    EXPECT_EQ(inspection.at("clips")[0].at(field).at("from"), "unknown") << "nothing is measured of such poses";
  const auto clips = RunAll(From("cmu_amc"));
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_THAT(ErrorCodes(clips[0].outcome), ElementsAre("angle_unit_contradiction"));
  EXPECT_EQ(clips[0].outcome.findings.size(), 1u);
}

TEST_F(DamagedAcclaim, ACutMotionIsOneErrorAndKeepsItsWholeFramesInARunToo) {
  const std::string text = Motion();
  Write(text.substr(0, text.find("\nrradius", text.find("\n500\n")) + 5));
  const Json inspection = Look();
  EXPECT_THAT(Codes(inspection, "error"), ElementsAre("cut_off"));
  EXPECT_THAT(Codes(inspection, "warning"), IsEmpty());
  EXPECT_THAT(Told(inspection, "cut_off").at("message"), HasSubstr("within frame 500, which begins at line 14975"));
  EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), 499);
  const auto clips = RunAll(From("cmu_amc"));
  ASSERT_EQ(clips.size(), 1u);
  EXPECT_THAT(ErrorCodes(clips[0].outcome), ElementsAre("cut_off"));
  EXPECT_EQ(clips[0].outcome.summary.at("frames"), 499);
}

TEST_F(DamagedAcclaim, ARowThatIsMissingWithinAFrameIsBridgedAndTold) {
  Write(Motion());
  const auto whole = Discover(From("cmu_amc"));
  const Ingested before = RunIngest(whole->items.at(0), "whole");
  ASSERT_TRUE(before.outcome);
  for (const char* bone : {"rfemur", "root"}) {
    for (const char* row : {"", "thigh 1 2 3\n"}) {
      Write(WithRow(Motion(), 300, bone, row));
      const Ingested after = RunIngest(Discover(From("cmu_amc"))->items.at(0), "missing");
      ASSERT_TRUE(after.outcome) << after.outcome.error().Message();
      ASSERT_FALSE(after.outcome->findings.empty());
      const Finding& told = after.outcome->findings[0];
      EXPECT_EQ(told.code, *row == '\0' ? "bone_missing" : "bone_unknown");
      EXPECT_EQ(told.action, FindingAction::kInterpolated);
      EXPECT_EQ(told.frame_begin, 299);
      const int joints = before.clip.motion->joint_count();
      for (int f = 290; f < 310; ++f) {
        for (int j = 0; j < joints; ++j)
          EXPECT_LT((after.clip.motion->joints.at(f, j) - before.clip.motion->joints.at(f, j)).norm(), 0.01) << f;
      }
      EXPECT_THAT(Codes(Look(), "warning"), Contains(told.code));
    }
  }
}

TEST_F(DamagedAcclaim, AMotionWhoseHeaderIsGoneIsStillKnown) {
  const std::string text = Motion();
  Write(text.substr(text.find("\n1\n") + 1));
  const Json inspection = Look();
  ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
  EXPECT_EQ(inspection.at("clips")[0].at("format"), "amc");
}

// Labels.

TEST_F(DamagedMocap, ADamagedFileOfLabelsIsAnErrorAndOneOfAnotherSequenceIsTold) {
  Written("CMU/01/walk_poses.npz", Recorded("amass_babel/amass_sample.npz"));
  const auto labels = [&](const std::string& duration, const std::string& end) {
    return R"({"1": {"babel_sid": 1, "url": "u", "feat_p": "CMU/CMU/01/walk_poses.npz", "dur": )" + duration +
           R"(, "seq_ann": null, "frame_ann": {"babel_lid": "l", "anntr_id": "a", "mul_act": true, "labels": [)" +
           R"({"raw_label": "walk", "proc_label": "walk", "seg_id": "s", "act_cat": ["walk"], "start_t": 0, "end_t": )" +
           end + "}]}}}";
  };
  Written("train.json", labels("5.01", "\"2\""));
  EXPECT_THAT(Told(Look(), "malformed").at("where"), HasSubstr("train.json:/1/frame_ann/labels/0/end_t"));
  Written("train.json", labels("5.01", "2").substr(0, 150));
  EXPECT_THAT(Codes(Look(), "error"), ElementsAre("malformed"));
  IngestOptions options = From("amass");
  options.source.annotations = {"train.json"};
  for (const auto& [duration, told] : {std::pair{"5.01", false}, {"5.2", false}, {"50.1", true}}) {
    Written("train.json", labels(duration, "2"));
    EXPECT_THAT(Codes(Look(), "error"), IsEmpty());
    const auto clips = RunAll(options);
    ASSERT_EQ(clips.size(), 1u);
    bool found = false;
    for (const Finding& finding : clips[0].outcome.findings) found = found || finding.code == "annotation_duration";
    EXPECT_EQ(found, told) << duration;
  }
}

// Names.

TEST_F(DamagedMocap, WhatAnExporterPutsBeforeTheNamesOfJointsHidesNoSkeleton) {
  const std::string text = Recorded("bvh/bandai1/dataset-1_bow_normal_001.bvh");
  const char* const name = "dataset-1_bow_normal_001.bvh";
  Written(name, text);
  const Ingested plain = RunIngest(Discover(From("bandai1"))->items.at(0), "plain");
  ASSERT_TRUE(plain.outcome);
  for (const char* prefix : {"mixamorig:", "mixamorig_", "mixamorig1:", "Character1_", "Armature|"}) {
    Written(name, std::regex_replace(text, std::regex("(ROOT|JOINT)([ \t]+)"), std::string("$1$2") + prefix));
    const Json clip = Look().at("clips")[0];
    EXPECT_EQ(Value(clip, "skeleton"), "bandai22") << prefix;
    EXPECT_EQ(Value(clip, "handedness"), "right") << prefix;
    const Ingested with = RunIngest(Discover(From("bandai1"))->items.at(0), "prefix");
    ASSERT_TRUE(with.outcome) << prefix << with.outcome.error().Message();
    EXPECT_EQ(with.clip.motion->skeleton->name, plain.clip.motion->skeleton->name);
    EXPECT_EQ(with.clip.motion->joints.xyz, plain.clip.motion->joints.xyz) << prefix;
    EXPECT_THAT(Codes(InspectPath(folder_, From("bandai1").source), "error"), IsEmpty()) << prefix;
  }
}

}  // namespace
}  // namespace mocurate
