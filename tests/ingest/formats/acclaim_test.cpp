#include <gtest/gtest.h>

#include <set>

#include "core/formats/amc.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

constexpr double kAcclaimMetres = 0.0254 / 0.45;  // metres per file unit

class Acclaim : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }
};

/// Largest distance in metres between the joints of a clip and the bone starts of AcclaimForward.
double AcclaimJointError(const Motion& motion, const Asf& asf, const Amc& amc) {
  double worst = 0.0;
  std::vector<Vector3d> ends;
  Vector3d root;
  for (int f = 0; f < amc.frames; ++f) {
    AcclaimForward(asf, amc, f, ends, &root);
    for (const AsfBone& bone : asf.bones) {
      const Vector3d start = bone.parent < 0 ? root : ends[static_cast<std::size_t>(bone.parent)];
      const int joint = *motion.skeleton->FindJoint(bone.name);
      worst = std::max(worst, (motion.joints.at(f, joint) - kAcclaimMetres * start).norm());
    }
  }
  return worst;
}

TEST_F(Acclaim, PlacesJointsAtTheStartsOfTheBones) {
  const auto discovery = Discover(Declared("cmu_amc"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 1u);
  EXPECT_EQ(discovery->items[0].item, "cmu/01/01_01");
  const Ingested ingested = RunIngest(discovery->items[0], "cmu");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.outcome->kind, OutcomeKind::kDone);
  ASSERT_TRUE(ingested.clip.motion);
  const Motion& motion = *ingested.clip.motion;
  const Status whole = motion.Check();
  EXPECT_TRUE(whole) << whole.error().Message();
  EXPECT_EQ(motion.rate, (FrameRate{120, 1}));
  EXPECT_EQ(motion.frame_count(), 2751);
  const auto skeleton = ReadFile(TestData() + "/cmu/asf_amc/01.asf");
  const auto text = ReadFile(TestData() + "/cmu/asf_amc/01_01.amc");
  ASSERT_TRUE(skeleton && text);
  const auto asf = ParseAsf(*skeleton, "01.asf");
  ASSERT_TRUE(asf);
  AmcOptions options;
  options.skeleton = &*asf;
  const auto amc = ParseAmc(*text, options, "01_01.amc");
  ASSERT_TRUE(amc);
  EXPECT_LT(AcclaimJointError(motion, *asf, *amc), 1e-4);
  EXPECT_EQ(ingested.clip.provenance.at("skeleton_file"), "01.asf");
}

/// A non-finite number in one frame, and a file that ends within a frame. The first frame is interpolated, the
/// second is excluded.
TEST_F(Acclaim, InterpolatesADamagedFrameAndExcludesATruncatedOne) {
  const auto discovery = Discover(Declared("cmu_amc"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested whole = RunIngest(discovery->items.at(0), "amc_whole");
  ASSERT_TRUE(whole.outcome) << whole.outcome.error().Message();
  const std::string text = *ReadFile(TestData() + "/cmu/asf_amc/01_01.amc");
  std::string large = text;
  const std::size_t root = large.find("root ", large.find("\n20"));
  large.replace(root, large.find('\n', root) - root, "root 1e300 0 0 0 0 0");
  const std::string cut = text.substr(0, text.find("lfemur", text.size() / 2));
  for (const auto& [damaged, frame] : {std::pair<std::string, int>{large, 19}, {cut, -1}}) {
    const std::filesystem::path folder = FreshFolder("amc_damaged");
    Put(folder / "01.asf", *ReadFile(TestData() + "/cmu/asf_amc/01.asf"));
    Put(folder / "01_01.amc", damaged);
    IngestOptions options = Declared("cmu_amc");
    options.path = folder;
    const auto found = Discover(options);
    ASSERT_TRUE(found) << found.error().Message();
    const Ingested ingested = RunIngest(found->items.at(0), "amc_damaged");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    const Motion& motion = *ingested.clip.motion;
    const int at = frame < 0 ? motion.frame_count() - 1 : frame;
    for (int j = 0; j < motion.joint_count(); ++j)
      EXPECT_LT((motion.joints.at(at, j) - whole.clip.motion->joints.at(at, j)).norm(), frame < 0 ? 1e-9 : 0.02) << j;
    EXPECT_EQ(motion.state.empty(), frame < 0);
    if (frame < 0) continue;
    EXPECT_EQ(motion.state[static_cast<std::size_t>(at) * motion.joint_count()], JointState::kInterpolated);
    EXPECT_EQ(motion.state[static_cast<std::size_t>(at - 1) * motion.joint_count()], JointState::kObserved);
  }
}

TEST_F(Acclaim, MatchesTheLegsOfTheBvhOfTheSameTake) {
  IngestOptions bvh;
  bvh.path = TestData() + "/cmu/asf_amc";
  bvh.source.name = "cmu_bvh";
  bvh.source.format = "bvh";
  bvh.source.files = "{person}_{take}.bvh";
  bvh.source.other_files = OtherFiles::kIgnore;
  bvh.source.units = "2.2222222222222 inch";
  bvh.source.axes = "+x +y +z";
  bvh.source.label = "";
  const auto converted = Discover(bvh);
  const auto recorded = Discover(Declared("cmu_amc"));
  ASSERT_TRUE(converted && recorded);
  const Ingested a = RunIngest(recorded->items.at(0), "cmu_a");
  const Ingested b = RunIngest(converted->items.at(0), "cmu_b");
  ASSERT_TRUE(a.outcome) << a.outcome.error().Message();
  ASSERT_TRUE(b.outcome) << b.outcome.error().Message();
  double worst = 0.0;
  for (int f = 0; f < a.clip.motion->frame_count(); f += 10) {
    for (const auto& [bone, joint] :
         {std::pair{"lfemur", "LeftUpLeg"}, {"ltibia", "LeftLeg"}, {"lfoot", "LeftFoot"}, {"rfoot", "RightFoot"}}) {
      const Vector3d amc = a.clip.motion->joints.at(f, *a.clip.motion->skeleton->FindJoint(bone));
      const Vector3d bvh_joint = b.clip.motion->joints.at(f + 1, *b.clip.motion->skeleton->FindJoint(joint));
      worst = std::max(worst, (amc - bvh_joint).norm());
    }
  }
  EXPECT_LT(worst, 1e-4) << "AMC frame k is BVH frame k + 1";
}

TEST_F(Acclaim, RefusesAMotionWithoutItsSkeletonFile) {
  const auto discovery = Discover(Declared("cmu_amc"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->excluded.size(), 3u) << "takes of subjects 2, 7 and 9 have no skeleton file";
  const ItemResult& file = discovery->excluded[0];
  EXPECT_EQ(file.item, "cmu/02/02_01");
  EXPECT_EQ(file.outcome.kind, OutcomeKind::kRefused);
  EXPECT_EQ(file.outcome.error.code, ErrorCode::kNotFound);
  EXPECT_EQ(file.outcome.error.where, "02_01.amc");
}

TEST_F(Acclaim, ReadsThirtyThreeHdm05ClipsOnTheSkeletonsOfThreeActors) {
  const auto discovery = Discover(Declared("hdm05"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_EQ(discovery->items.size(), 33u);
  EXPECT_TRUE(discovery->excluded.empty());
  int frames = 0;
  std::set<std::string> labels;
  std::map<std::string, double> thigh;
  for (const ItemSpec& item : discovery->items) {
    const Ingested ingested = RunIngest(item, "hdm05");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_EQ(ingested.outcome->kind, OutcomeKind::kDone) << item.item;
    const Motion& motion = *ingested.clip.motion;
    frames += motion.frame_count();
    labels.insert(ingested.clip.label);
    const double length = motion.bone_length[static_cast<std::size_t>(*motion.skeleton->FindJoint("ltibia"))];
    EXPECT_GT(length, 0.3);
    EXPECT_LT(length, 0.6);
    const auto known = thigh.emplace(ingested.clip.identity.person, length);
    EXPECT_NEAR(known.first->second, length, 1e-6);
  }
  EXPECT_EQ(frames, 8245);
  EXPECT_EQ(labels.size(), 11u);
  EXPECT_EQ(thigh.size(), 3u);
  EXPECT_NE(thigh["bd"], thigh["mm"]);
}

TEST(AcclaimDeclaration, NamesTheSkeletonFileAndTheUnit) {
  IngestOptions options = Declared("hdm05");
  options.path = FreshFolder("acclaim");
  options.source.skeleton_files = "";
  ExpectError(IngestOnly(options, "acclaim"), ErrorCode::kConfig, "ingest.source.skeleton_files");
  options.source.skeleton_files = "x.asf";
  options.source.units = "";
  ExpectError(IngestOnly(options, "acclaim"), ErrorCode::kConfig, "ingest.source.units");
}

}  // namespace
}  // namespace mocurate
