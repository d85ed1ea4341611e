// BVH files with one defect: an inspection and a run report the cause without its consequences.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <regex>

#include "core/formats/bvh.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/changed_files.h"

namespace mocurate {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using Json = nlohmann::json;

class DamagedBvh : public ChangedFiles {
 protected:
  static constexpr const char* kTake = "dataset-1_bow_normal_001.bvh";
  static constexpr int kFrame = 40;

  static std::string Take() { return Recorded(std::string("bvh/bandai1/") + kTake); }
  /// [begin, end) of the row of a frame.
  static std::pair<std::size_t, std::size_t> RowOf(const std::string& text, int frame) {
    std::size_t begin = text.find('\n', text.find("Frame Time:")) + 1;
    for (int f = 0; f < frame; ++f) begin = text.find('\n', begin) + 1;
    return {begin, text.find('\n', begin)};
  }
  static std::string WithRow(int frame, const std::function<std::string(std::string)>& change) {
    std::string text = Take();
    const auto [begin, end] = RowOf(text, frame);
    return text.replace(begin, end - begin, change(text.substr(begin, end - begin)));
  }
  Ingested Ingest(const std::string& text) {
    Written(kTake, text);
    const auto discovery = Discover(From("bandai1"));
    EXPECT_TRUE(discovery && discovery->items.size() == 1);
    return RunIngest(discovery->items.at(0), "damaged");
  }
  Json WithFrameTime(const std::string& time) {
    Written(kTake, std::regex_replace(Take(), std::regex("Frame Time:[^\r\n]*"), "Frame Time: " + time));
    return Inspect();
  }
};

TEST_F(DamagedBvh, ReportsTwoJointsWithOneName) {
  std::string text = Take();
  Written(kTake, text.replace(text.find("JOINT Foot_R"), 12, "JOINT Foot_L"));
  EXPECT_THAT(Codes(Inspect(), "warning"), Contains("joint_twice"));
}

// Rows.

TEST_F(DamagedBvh, InterpolatesADamagedRowInARunAndReportsItInAnInspection) {
  const Ingested whole = Ingest(Take());
  ASSERT_TRUE(whole.outcome);
  const auto shorter = [](const std::string& row) { return row.substr(0, row.find_last_of(" \t", row.size() - 4)); };
  const auto word = [](const std::string& row) { return "x" + row; };
  const auto nan = [](const std::string& row) { return row.substr(0, row.find_first_of(" \t")) + " nan" + row; };
  const auto large = [](const std::string& row) { return "1e300" + row.substr(row.find_first_of(" \t")); };
  const std::vector<std::pair<std::function<std::string(std::string)>, std::string>> damages = {
      {shorter, "row_length"}, {word, "not_a_number"}, {nan, "not_a_number"}, {large, "number_too_large"}};
  for (const auto& [damage, code] : damages) {
    const Ingested damaged = Ingest(WithRow(kFrame, damage));
    ASSERT_TRUE(damaged.outcome) << code << damaged.outcome.error().Message();
    EXPECT_EQ(damaged.outcome->kind, OutcomeKind::kDone) << code;
    const Finding& reported = damaged.outcome->findings.at(0);
    EXPECT_EQ(reported.code, code);
    EXPECT_EQ(reported.frame_begin, kFrame);
    EXPECT_EQ(reported.action, FindingAction::kInterpolated);
    const Motion &before = *whole.clip.motion, &after = *damaged.clip.motion;
    ASSERT_EQ(after.frame_count(), before.frame_count());
    for (int f = 0; f < after.frame_count(); ++f) {
      const JointState state = after.state.at(static_cast<std::size_t>(f) * after.joint_count());
      EXPECT_EQ(state, f == kFrame ? JointState::kInterpolated : JointState::kObserved) << f;
      for (int j = 0; j < after.joint_count(); ++j)
        EXPECT_LT((after.joints.at(f, j) - before.joints.at(f, j)).norm(), f == kFrame ? 0.01 : 1e-9) << f;
    }
    const Json inspection = InspectPath(folder_ / kTake, std::nullopt);
    ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
    EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), before.frame_count());
    EXPECT_GT(Value(inspection.at("clips")[0], "missing_share"), 0.0);
    EXPECT_THAT(Codes(inspection, "warning"), Contains(code));
    for (const Json& finding : inspection.at("findings")) EXPECT_FALSE(finding.at("value").is_null()) << finding;
  }
}

TEST_F(DamagedBvh, RefusesAFileWhoseRowsMayBeSplitOrJoined) {
  const auto split = [](std::string row) { return row.replace(row.find_first_of(" \t", row.size() / 2), 1, "\n"); };
  std::string joined = Take();
  joined[RowOf(joined, kFrame).second] = ' ';
  for (const std::string& text : {WithRow(kFrame, split), joined}) {
    const Ingested refused = Ingest(text);
    EXPECT_THAT(Places(InspectPath(folder_ / kTake, std::nullopt)),
                ElementsAre(std::string("malformed ") + kTake + ":175"));
    ExpectMalformed(refused.outcome, kTake + std::string(":175"));
  }
}

TEST_F(DamagedBvh, CutsADamagedFirstFrame) {
  const int frames = Ingest(Take()).clip.motion->frame_count();
  const Ingested damaged = Ingest(WithRow(0, [](const std::string& row) { return "x" + row; }));
  ASSERT_TRUE(damaged.outcome) << damaged.outcome.error().Message();
  ASSERT_EQ(damaged.outcome->findings.size(), 2u);
  EXPECT_EQ(damaged.outcome->findings[0].code, "not_a_number");
  EXPECT_EQ(damaged.outcome->findings[1].code, "unobserved_ends");
  EXPECT_EQ(damaged.clip.motion->frame_count(), frames - 1);
  EXPECT_EQ(damaged.clip.identity.begin_frame, 1);
}

TEST_F(DamagedBvh, InfersMoreThanHalfASecond) {
  std::string text = Take();
  for (int f = kFrame; f < kFrame + 16; ++f) text[RowOf(text, f).first] = 'x';
  const Ingested inferred = Ingest(text);
  ASSERT_TRUE(inferred.outcome) << inferred.outcome.error().Message();
  const Motion& motion = *inferred.clip.motion;
  for (const int f : {kFrame, kFrame + 15})
    EXPECT_EQ(motion.state.at(static_cast<std::size_t>(f * motion.joint_count())), JointState::kInferred);
  const auto& findings = inferred.outcome->findings;
  EXPECT_TRUE(std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.code == "long_gap" && finding.frame_begin == kFrame && finding.frame_end == kFrame + 16;
  }));
}

TEST_F(DamagedBvh, KeepsCompleteRowsOfATruncatedFileAndReportsTheRest) {
  const std::string head =
      "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Xposition Yposition Zposition\nEnd Site\n{\nOFFSET 0 1 0\n}\n"
      "}\nMOTION\nFrames: ";
  const std::string rows = "\nFrame Time: 0.033\n1 90 0\n2 90 0\n3 90 0\n";
  IngestOptions options;
  options.path = folder_;
  options.source.name = "cut";
  options.source.format = "bvh";
  options.source.files = "{action}_{person}.bvh";
  options.source.units = "cm";
  options.source.axes = "+x +y +z";
  const std::vector<std::string> count = {"count_contradiction"}, cut = {"cut_off", "count_contradiction"};
  const std::pair<std::string, std::vector<std::string>> cases[] = {
      {"3" + rows, {}},          {"5" + rows, count},
      {"4" + rows + "4 9", cut}, {"4" + rows + "4 90\n", cut},
      {"4" + rows + "4 -", cut}, {"4" + rows + "4 90 1.5e", cut}};
  for (const auto& [motion, codes] : cases) {
    const Json inspection = InspectPath(Written("walk_p1.bvh", head + motion), std::nullopt);
    EXPECT_EQ(Codes(inspection, "error"), codes) << motion;
    ASSERT_EQ(inspection.at("clips").size(), 1u) << inspection.dump(1);
    EXPECT_EQ(Value(inspection.at("clips")[0], "frames"), 3);
    const StageOutcome clip = RunOne(options);
    EXPECT_EQ(ErrorCodes(clip), codes) << motion;
    EXPECT_EQ(clip.summary.at("frames"), 3);
    EXPECT_EQ(clip.kind, codes.empty() ? OutcomeKind::kDone : OutcomeKind::kSuspect);
  }
}

// Rates.

TEST_F(DamagedBvh, ReportsAnImplausibleFrameTimeWithTheLikelyOne) {
  struct Case {
    const char* time;
    double rate_hz;
    const char* meant;
  };
  for (const Case& c : {Case{"30", 1.0 / 30.0, "0.0333333"}, Case{"120", 1.0 / 120.0, "0.00833333"},
                        Case{"33.333", 1.0 / 33.333, "0.033333"}, Case{"33333", 1.0 / 33333.0, "0.033333"},
                        Case{"1", 1.0, "ingest.source.rate"}, Case{"0.00001", 1e5, "ingest.source.rate"}}) {
    SCOPED_TRACE(c.time);
    const Json inspection = WithFrameTime(c.time);
    EXPECT_THAT(Places(inspection), ElementsAre(std::string("rate_implausible ") + kTake));
    const Json finding = FindingsOf(inspection, "rate_implausible").at(0);
    EXPECT_NEAR(finding.at("value"), c.rate_hz, 1e-9 * c.rate_hz);
    EXPECT_THAT(finding.at("message").get<std::string>(),
                AllOf(StartsWith(std::string(kTake) + ":134:"), HasSubstr(c.meant)));
    EXPECT_THAT(Codes(inspection, "warning"), IsEmpty()) << "no check uses that rate";
    IngestOptions options = From("bandai1");
    options.source.rate_hz.reset();
    const StageOutcome refused = RunOne(options);
    EXPECT_EQ(refused.kind, OutcomeKind::kRefused);
    EXPECT_EQ(refused.error.code, ErrorCode::kInconsistent);
    EXPECT_THAT(ErrorCodes(refused), ElementsAre("rate_implausible"));
    options.source.rate_hz = 30.0;
    const StageOutcome declared = RunOne(options);
    EXPECT_NE(declared.kind, OutcomeKind::kRefused) << "the declared rate is used";
    EXPECT_EQ(declared.summary.at("rate_hz"), 30.0);
  }
  for (const char* time : {"0.0333333", "0.0083333", "0.04", "0.1", "0.001"})
    EXPECT_THAT(Codes(WithFrameTime(time), "error"), IsEmpty()) << time;
}

TEST_F(DamagedBvh, RejectsAnInvalidFrameTimeWithItsLine) {
  for (const char* time : {"0", "-0.0333", "nan", "1e-9", "inf"})
    EXPECT_THAT(Places(WithFrameTime(time)), Contains(std::string("malformed ") + kTake + ":134")) << time;
}

// Skeletons.

TEST_F(DamagedBvh, ReportsAnglesInRadians) {
  Bvh bvh = *ParseBvh(Take(), kTake);
  for (const BvhJoint& joint : bvh.joints) {
    for (std::size_t c = 0; c < joint.channels.size(); ++c) {
      for (int f = 0; f < bvh.frames && !IsPosition(joint.channels[c]); ++f)
        bvh.values[static_cast<std::size_t>(f) * bvh.channel_count + joint.first_channel + c] *= M_PI / 180.0;
    }
  }
  Written(kTake, WriteBvh(bvh));
  const Json inspection = Inspect();
  EXPECT_THAT(Codes(inspection, "error"), ElementsAre("angle_unit_contradiction"));
  EXPECT_THAT(Codes(inspection, "warning"), IsEmpty());
  EXPECT_EQ(inspection.at("clips")[0].at("up").at("from"), "unknown");
  EXPECT_THAT(ErrorCodes(RunOne(From("bandai1"))), ElementsAre("angle_unit_contradiction"));
}

TEST_F(DamagedBvh, RefusesAFileWithoutBonesInRunAndInspect) {
  Bvh bvh = *ParseBvh(Take(), kTake);
  for (BvhJoint& joint : bvh.joints) {
    joint.offset.setZero();
    joint.end_site.setZero();
    for (std::size_t c = 0; &joint != &bvh.joints[0] && c < joint.channels.size(); ++c) {
      for (int f = 0; IsPosition(joint.channels[c]) && f < bvh.frames; ++f)
        bvh.values[static_cast<std::size_t>(f) * bvh.channel_count + joint.first_channel + c] = 0.0;
    }
  }
  Written(kTake, WriteBvh(bvh));
  EXPECT_THAT(Places(Inspect()), Contains(std::string("malformed ") + kTake));
  ExpectError(IngestOnly(From("bandai1"), "no_bones"), ErrorCode::kInconsistent, kTake);
}

TEST_F(DamagedBvh, RecognisesSkeletonsBehindJointNamePrefixes) {
  const std::string text = Take();
  const Ingested plain = Ingest(text);
  ASSERT_TRUE(plain.outcome);
  for (const char* prefix : {"mixamorig:", "mixamorig_", "mixamorig1:", "Character1_", "Armature|"}) {
    const Ingested with =
        Ingest(std::regex_replace(text, std::regex("(ROOT|JOINT)([ \t]+)"), std::string("$1$2") + prefix));
    ASSERT_TRUE(with.outcome) << prefix << with.outcome.error().Message();
    EXPECT_EQ(with.clip.motion->skeleton->name, plain.clip.motion->skeleton->name);
    EXPECT_EQ(with.clip.motion->joints.xyz, plain.clip.motion->joints.xyz) << prefix;
    const Json clip = Inspect().at("clips")[0];
    EXPECT_EQ(Value(clip, "skeleton"), "bandai22") << prefix;
    EXPECT_EQ(Value(clip, "handedness"), "right") << prefix;
    EXPECT_THAT(Codes(Inspect(From("bandai1").source), "error"), IsEmpty()) << prefix;
  }
}

}  // namespace
}  // namespace mocurate
