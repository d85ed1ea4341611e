// Sources with their own reader or table, on recorded files where available.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "core/formats/expmap_table.h"
#include "core/formats/npy.h"
#include "core/motion/kinematics.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"
#include "tests/support/expmap_writer.h"

namespace mocurate {
namespace {

constexpr double kCmuUnit = 0.0254 / 0.45;

TEST(CmuExpmap, ReadsAnUprightWalkAtWalkingSpeed) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto discovery = Discover(Declared("cmu_expmap"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  std::map<std::string, int> frames;
  for (const ItemSpec& item : discovery->items) {
    const Ingested ingested = RunIngest(item, "expmap");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_EQ(ingested.outcome->kind, OutcomeKind::kDone) << item.item << ingested.outcome->findings[0].message;
    const Motion& motion = *ingested.clip.motion;
    frames[ingested.clip.label] += motion.frame_count();
    const int head = *motion.skeleton->FindJoint("head");
    const int foot = *motion.skeleton->FindJoint("lfoot");
    double upright = 0.0;
    for (int f = 0; f < motion.frame_count(); ++f) {
      upright += (motion.joints.at(f, head).y() - motion.joints.at(f, foot).y()) / motion.frame_count();
    }
    EXPECT_GT(upright, 1.1) << item.item;
    if (ingested.clip.label != "walking") continue;
    const Vector3d way = motion.root_translation.back() - motion.root_translation.front();
    EXPECT_NEAR(way.z() / (motion.frame_count() / motion.rate.hz()), 1.4, 0.1) << "m/s forwards";
    EXPECT_LT(std::abs(way.x()), 0.1 * way.z());
  }
  EXPECT_EQ(frames, (std::map<std::string, int>{
                        {"basketball", 386}, {"jumping", 337}, {"running", 151}, {"soccer", 363}, {"walking", 317}}));
}

TEST(CmuExpmap, RecoversTheMotionThatWasWritten) {
  const std::filesystem::path folder = FreshFolder("expmap");
  const SkeletonPtr skeleton = *LoadSkeleton("cmu31");
  const IngestOptions options = Declared("cmu_expmap", {"ingest.path=" + folder.string()});
  const std::vector<std::string>& columns = options.source.joints;
  ASSERT_EQ(columns.size(), 38u);
  ExpmapTable table;
  table.frames = 6;
  table.joints = 38;
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation(6u * 31u);
  for (int f = 0; f < 6; ++f) {
    root.emplace_back(0.1 * f, 1.0, 0.2 * f);
    for (int i = 0; i < 3; ++i) table.root.push_back(root.back()[i] / kCmuUnit);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const double phase = 0.4 * f + static_cast<double>(k);
      Vector3d vector = 0.5 * Vector3d(std::sin(phase), std::cos(phase), std::sin(2.0 * phase));
      const auto joint = skeleton->FindJoint(columns[k]);
      if (!joint) vector.setZero();
      if (joint) rotation[static_cast<std::size_t>(f * 31 + *joint)] = ExpQuaternion(-vector);
      table.rotation_rad.insert(table.rotation_rad.end(), {vector.x(), vector.y(), vector.z()});
    }
  }
  const Motion truth = MakeMotion(skeleton, FrameRate{120, 1}, root, rotation, {});
  Put(folder / "train/walking/walking_1.txt", WriteExpmapTable(table));
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "expmap_back");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(discovery->items[0].item, "cmu_expmap/unknown/train_walking_1");
  for (int f = 0; f < 6; ++f) {
    for (int j = 0; j < 31; ++j) {
      EXPECT_LT((ingested.clip.motion->joints.at(f, j) - truth.joints.at(f, j)).norm(), 1e-5) << f << " " << j;
    }
  }
  std::string cut = WriteExpmapTable(table);
  cut.resize(cut.rfind(','));
  Put(folder / "train/walking/walking_1.txt", cut);
  const Ingested shorter = RunIngest(discovery->items.at(0), "expmap_cut");
  ASSERT_TRUE(shorter.outcome) << shorter.outcome.error().Message();
  EXPECT_EQ(shorter.clip.motion->frame_count(), 5) << "the last row is damaged";
  IngestOptions strict = options;
  strict.source.damaged_rows = DamagedRows::kRefuse;
  ExpectMalformed(IngestOnly(strict, "expmap_cut"), "train/walking/walking_1.txt:6");
}

TEST(Cmu8, ReadsClassesFromATableAndReportsUnlistedMotions) {
  const std::filesystem::path folder = FreshFolder("cmu8");
  const SkeletonPtr skeleton = *LoadSkeleton("cmu20");
  const std::vector<Quaterniond> rest(20 * 4, Quaterniond::Identity());
  const std::vector<Vector3d> root = {{0, 1, 0}, {0, 1, 0.1}, {0, 1, 0.2}, {0, 1, 0.3}};
  const Motion truth = MakeMotion(skeleton, FrameRate{12, 1}, root, rest, {});
  NpyArray array;
  array.shape = {4, 20, 3};
  array.dtype = "<f8";
  for (const double metres : truth.joints.xyz) array.values.push_back(metres / kCmuUnit);
  for (const char* name : {"13_29", "02_01", "99_99"}) {
    Put(folder / ("mocap_3djoints/" + std::string(name) + ".npy"), WriteNpy(array));
  }
  Put(folder / "pose_clip.csv", "motion,action_type\n02_01,Walk\r\n13_29,Animal Behavior\n");
  const IngestOptions options = Declared("cmu8", {"ingest.path=" + folder.string()});
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 2u);
  ASSERT_EQ(discovery->excluded.size(), 1u);
  EXPECT_EQ(discovery->excluded[0].outcome.error.code, ErrorCode::kInconsistent);
  EXPECT_EQ(discovery->excluded[0].outcome.error.where, "mocap_3djoints/99_99.npy");
  std::map<std::string, std::string> labels;
  for (const ItemSpec& item : discovery->items) {
    const Ingested ingested = RunIngest(item, "cmu8");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    labels[ingested.clip.identity.recording] = ingested.clip.label;
    for (int j = 0; j < 20; ++j) {
      EXPECT_LT((ingested.clip.motion->joints.at(3, j) - truth.joints.at(3, j)).norm(), 1e-6);
    }
  }
  EXPECT_EQ(labels, (std::map<std::string, std::string>{{"02_01", "walk"}, {"13_29", "animal_behavior"}}));
  Put(folder / "pose_clip.csv", "motion,action_type\n02_01,Walk\n02_01,Run\n");
  ExpectMalformed(Discover(options), "pose_clip.csv:3");
}

TEST(Bandai1, IsReadOnTheSkeletonOfBandai2) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto discovery = Discover(Declared("bandai1"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_EQ(discovery->items.size(), 74u);
  int frames = 0;
  std::set<std::string> labels, styles;
  for (const ItemSpec& item : discovery->items) {
    const Ingested ingested = RunIngest(item, "bandai1");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_EQ(ingested.outcome->kind, OutcomeKind::kDone) << item.item << ingested.outcome->findings[0].message;
    frames += ingested.clip.motion->frame_count();
    EXPECT_EQ(ingested.clip.rate, (FrameRate{30, 1}));
    labels.insert(ingested.clip.label);
    styles.insert(ingested.clip.identity.person);
  }
  EXPECT_EQ(frames, 12514);
  EXPECT_EQ(labels.size(), 15u);
  EXPECT_EQ(styles.size(), 6u);
}

TEST(Ntu13, ExcludesOtherActionsByRule) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const std::filesystem::path folder = FreshFolder("ntu13");
  for (const auto& [from, to] : std::map<std::string, std::string>{{"S001C001P001R001A011", "S001C001P001R001A006"},
                                                                   {"S002C001P003R001A003", "S002C001P003R001A102"},
                                                                   {"S004C002P003R001A017", "S004C002P003R001A017"}}) {
    std::filesystem::copy_file(TestData() + "/ntu/" + from + ".skeleton", folder / (to + ".skeleton"));
  }
  const auto discovery = Discover(Declared("ntu13", {"ingest.path=" + folder.string()}));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 2u);
  ASSERT_EQ(discovery->excluded.size(), 1u);
  EXPECT_EQ(discovery->excluded[0].outcome.kind, OutcomeKind::kExcluded);
  EXPECT_EQ(discovery->excluded[0].outcome.findings.at(0).code, "label_excluded");
  const Ingested ingested = RunIngest(discovery->items[0], "ntu13");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.label, "pick_up");
  EXPECT_EQ(ingested.clip.identity.person, "P001");
}

}  // namespace
}  // namespace mocurate
