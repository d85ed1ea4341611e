#include <gtest/gtest.h>

#include <set>

#include "core/formats/amass.h"
#include "core/formats/babel.h"
#include "ingest/sources/babel_segments.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

BabelLabel Label(const std::string& name, double begin, double end, std::vector<std::string> categories = {}) {
  BabelLabel label;
  label.raw_label = label.proc_label = name;
  label.act_cat = std::move(categories);
  label.seg_id = name;
  label.start_t = begin;
  label.end_t = end;
  return label;
}

BabelSequence Sequence(const std::string& key, const std::string& feat_p, std::vector<BabelLabel> frames) {
  BabelSequence sequence;
  sequence.key = key;
  sequence.babel_sid = std::stoll(key);
  sequence.feat_p = feat_p;
  sequence.dur = 5.0;
  BabelAnnotation annotation;
  annotation.babel_lid = "l" + key;
  annotation.labels = {Label("the whole of it", 0, 0)};
  annotation.labels[0].start_t.reset();
  annotation.labels[0].end_t.reset();
  sequence.seq_anns = {annotation};
  if (!frames.empty()) {
    annotation.labels = std::move(frames);
    sequence.frame_anns = {annotation};
  }
  return sequence;
}

TEST(BabelNames, MatchBothReleasesOfAmass) {
  EXPECT_EQ(AmassNames("CMU/CMU/141/141_05_poses.npz"),
            (std::vector<std::string>{"CMU/141/141_05_poses.npz", "CMU/141/141_05_stageii.npz"}));
  EXPECT_EQ(AmassNames("BMLrub/BioMotionLab_NTroje/rub055/0020 lifting_poses.npz"),
            (std::vector<std::string>{
                "BioMotionLab_NTroje/rub055/0020 lifting_poses.npz", "BMLrub/rub055/0020 lifting_poses.npz",
                "BioMotionLab_NTroje/rub055/0020_lifting_stageii.npz", "BMLrub/rub055/0020_lifting_stageii.npz"}));
}

TEST(BabelSegments, AreSortedClippedAndExcludedWhenImpossible) {
  std::vector<Finding> findings;
  const BabelSequence sequence =
      Sequence("7692", "CMU/CMU/141/141_05_poses.npz",
               {Label("turn", 2.0, 5.5, {"turn"}), Label("walk", 0.5, 2.0, {"walk", "move"}), Label("stand", 1.0, 1.0),
                Label("sit", 7.0, 8.0), Label("rest", 3.0, 5.005)});
  const std::vector<Segment> segments = SegmentsOf(sequence, 5.0, 1.0 / 120.0, findings);
  ASSERT_EQ(segments.size(), 3u);
  EXPECT_EQ(segments[0].label, "walk");
  EXPECT_EQ(segments[0].category, "walk, move");
  EXPECT_EQ(segments[1].label, "turn");
  EXPECT_DOUBLE_EQ(segments[1].end_s, 5.0);
  EXPECT_DOUBLE_EQ(segments[2].end_s, 5.0) << "an excess below one frame is rounding";
  ASSERT_EQ(findings.size(), 3u);
  EXPECT_EQ(findings[0].code, "segment_times");
  EXPECT_EQ(findings[0].value, 0.5);
  EXPECT_EQ(findings[1].code, "segment_times");
  findings.clear();
  const std::vector<Segment> whole = SegmentsOf(Sequence("1", "A/A/b_poses.npz", {}), 5.0, 0.01, findings);
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_EQ(whole[0].label, "the whole of it");
  EXPECT_DOUBLE_EQ(whole[0].end_s, 5.0);
}

class AmassSource : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
    const auto read = ReadFile(TestData() + "/amass_babel/amass_sample.npz");
    ASSERT_TRUE(read);
    bytes_ = *read;
  }
  std::string bytes_;
};

TEST_F(AmassSource, ReadsSmplRotationsWithBabelSegments) {
  IngestOptions options = Declared("amass");
  options.path = FreshFolder("amass");
  Put(options.path / "CMU/141/141_05_poses.npz", bytes_);
  Put(options.path / "CMU/141/shape.npz", "not a motion");
  Put(options.path / "KIT/3/jump_poses.npz", bytes_);
  Put(options.path / "babel_v1.0_release/train.json",
      EncodeBabel({Sequence("7692", "CMU/CMU/141/141_05_poses.npz",
                            {Label("walk", 0.5, 2.0, {"walk"}), Label("late", 90.0, 95.0), Label("", 2.0, 3.0)}),
                   Sequence("5", "ACCAD/ACCAD/x/y_poses.npz", {})}));
  Put(options.path / "babel_v1.0_release/val.json", EncodeBabel({}));
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 2u);
  ASSERT_EQ(discovery->excluded.size(), 1u);
  EXPECT_EQ(discovery->excluded[0].outcome.findings.at(0).code, "motion_missing");
  EXPECT_EQ(discovery->excluded[0].outcome.findings.at(0).value, 1.0);
  const Ingested ingested = RunIngest(discovery->items[0], "amass");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const Clip& clip = ingested.clip;
  EXPECT_EQ(clip.id(), "amass/CMU.141/CMU.141.141_05_poses#0-601");
  ASSERT_EQ(clip.segments.size(), 1u);
  EXPECT_EQ(clip.segments[0].label, "walk");
  std::set<std::string> codes;
  for (const Finding& finding : ingested.outcome->findings) codes.insert(finding.code);
  EXPECT_EQ(codes, (std::set<std::string>{"bones_not_the_subjects", "label_withheld", "segment_times"}));
  const Motion& motion = *clip.motion;
  EXPECT_EQ(motion.rate, (FrameRate{120, 1}));
  ASSERT_EQ(motion.joint_count(), 24);
  const auto amass = ParseAmass(bytes_, "sample");
  ASSERT_TRUE(amass);
  const Matrix3d world_from_file = AxisConvention::Parse("+x -z +y")->canonical_from_source;
  for (const std::size_t f : {std::size_t{0}, std::size_t{300}, std::size_t{600}}) {
    for (std::size_t j = 0; j < 24; ++j) {
      const double* v = &amass->poses[f * amass->pose_columns + 3 * j];
      const Matrix3d file = j < 22 ? ExpMatrix(Vector3d(v[0], v[1], v[2])) : Matrix3d(Matrix3d::Identity());
      const Matrix3d expected = j == 0 ? Matrix3d(world_from_file * file) : file;
      EXPECT_LT((motion.rotation[f * 24 + j].toRotationMatrix() - expected).norm(), 1e-5) << f << " " << j;
    }
  }
  const int head = *motion.skeleton->FindJoint("head"), foot = *motion.skeleton->FindJoint("left_foot");
  EXPECT_GT(motion.joints.at(0, head).y() - motion.joints.at(0, foot).y(), 1.0) << "not upright";
  const Ingested other = RunIngest(discovery->items[1], "amass_other");
  ASSERT_TRUE(other.outcome) << other.outcome.error().Message();
  EXPECT_TRUE(other.clip.segments.empty());
  EXPECT_EQ(other.outcome->findings.at(1).code, "not_annotated");
}

TEST_F(AmassSource, RejectsALeftHandedFrameOrAnotherUnit) {
  IngestOptions options = Declared("amass");
  options.path = FreshFolder("amass_axes");
  options.source.annotations.clear();
  Put(options.path / "CMU/141/141_05_poses.npz", bytes_);
  options.source.axes = "+x +z +y";
  ExpectError(IngestOnly(options, "amass_axes"), ErrorCode::kConfig, "ingest.source.axes");
  options.source.units = "cm";
  ExpectError(IngestOnly(options, "amass_axes"), ErrorCode::kConfig, "ingest.source.units");
}

}  // namespace
}  // namespace mocurate
