#include <gtest/gtest.h>

#include "core/formats/ntu_skeleton.h"
#include "ingest/sources/source_file.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

class Ntu : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }
};

TEST_F(Ntu, ReadsTwoClipsFromAFileOfTwoPeople) {
  const auto discovery = Discover(Declared("ntu"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  std::vector<std::string> items;
  for (const ItemSpec& item : discovery->items) items.push_back(item.item);
  EXPECT_EQ(items, (std::vector<std::string>{"ntu/P001/S001C001P001R001A011", "ntu/P003/S002C001P003R001A003",
                                             "ntu/P003/S004C002P003R001A017", "ntu/P008a/S001C003P008R002A058",
                                             "ntu/P008b/S001C003P008R002A058"}));
  std::vector<Vector3d> pelvis;
  for (const ItemSpec& item : discovery->items) {
    const Ingested ingested = RunIngest(item, "ntu");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_EQ(ingested.outcome->kind, OutcomeKind::kDone) << item.item;
    EXPECT_EQ(ingested.clip.evidence.tracks->positions.joints, 25);
    if (ingested.clip.label != "shake_hands") continue;
    EXPECT_EQ(ingested.clip.evidence.tracks->positions.frames, 70);
    EXPECT_EQ(ingested.clip.identity.session, "S001");
    EXPECT_EQ(ingested.clip.identity.view, "C003");
    EXPECT_EQ(ingested.clip.provenance.at("performance"), "setup=001 person=008 repetition=002 action=058");
    pelvis.push_back(ingested.clip.evidence.tracks->positions.at(0, 0));
  }
  ASSERT_EQ(pelvis.size(), 2u);
  EXPECT_GT((pelvis[0] - pelvis[1]).norm(), 0.3) << "both clips show the same person";
}

TEST_F(Ntu, ConvertsTrackingStatesToConfidences) {
  const std::string name = "S001C001P001R001A011.skeleton";
  const auto bytes = ReadFile(TestData() + "/ntu/" + name);
  ASSERT_TRUE(bytes);
  const auto file = ParseNtuSkeleton(*bytes, name);
  ASSERT_TRUE(file) << file.error().Message();
  const auto discovery = Discover(Declared("ntu", {"ingest.source.inferred_confidence=0.25"}));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "ntu_states");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const JointTracks& tracks = *ingested.clip.evidence.tracks;
  int inferred = 0;
  for (std::size_t f = 0; f < file->frames.size(); ++f) {
    for (std::size_t j = 0; j < kNtuJoints; ++j) {
      const NtuJoint& joint = file->frames[f].at(0).joints[j];
      EXPECT_EQ(tracks.confidence[f * kNtuJoints + j], joint.tracking == 2 ? 1.0 : joint.tracking == 1 ? 0.25 : 0.0);
      inferred += joint.tracking == 1 ? 1 : 0;
      const Vector3d rotated(-joint.x_m, joint.y_m, -joint.z_m);
      EXPECT_TRUE(tracks.positions.at(static_cast<int>(f), static_cast<int>(j)).isApprox(rotated, 1e-6));
    }
  }
  EXPECT_GT(inferred, 0);
}

/// The joints of the file in a T-pose, y up, feet at 0.
std::vector<Vector3d> RestPose() {
  const SkeletonPtr tree = LoadSkeleton("ntu25").value();
  std::vector<Vector3d> place;
  for (const char* name : {"spine_base",     "spine_mid",     "neck",       "head",           "left_shoulder",
                           "left_elbow",     "left_wrist",    "left_hand",  "right_shoulder", "right_elbow",
                           "right_wrist",    "right_hand",    "left_hip",   "left_knee",      "left_ankle",
                           "left_foot",      "right_hip",     "right_knee", "right_ankle",    "right_foot",
                           "spine_shoulder", "left_hand_tip", "left_thumb", "right_hand_tip", "right_thumb"}) {
    Vector3d sum(0.0, 0.87, 0.0);
    for (int j = *tree->FindJoint(name); j > 0; j = tree->joints[static_cast<std::size_t>(j)].parent)
      sum += tree->joints[static_cast<std::size_t>(j)].rest_offset;
    place.push_back(sum);
  }
  return place;
}

/// One person who moves up and down, absent for some frames, and a motionless chair.
NtuSkeleton PersonAndChair() {
  const std::vector<Vector3d> rest = RestPose();
  NtuSkeleton skeleton;
  for (int f = 0; f < 20; ++f) {
    NtuBody chair, person;
    chair.id = 72057594037931101u;
    person.id = 72057594037931368u;
    for (std::size_t j = 0; j < kNtuJoints; ++j) {
      chair.joints[j].tracking = person.joints[j].tracking = 2;
      chair.joints[j].x_m = 1.0;
      chair.joints[j].z_m = 3.0;
      person.joints[j].x_m = -0.5 - rest[j].x();
      person.joints[j].y_m = rest[j].y() + 0.02 * f;
      person.joints[j].z_m = 3.0 - rest[j].z();
    }
    skeleton.frames.emplace_back();
    skeleton.frames.back().push_back(chair);
    if (f < 5 || f > 7) skeleton.frames.back().push_back(person);
  }
  return skeleton;
}

TEST(NtuPeople, SelectsThePersonAndRejectsAChairAsAFalseTrack) {
  IngestOptions options = Declared("ntu");
  options.path = FreshFolder("chair");
  Put(options.path / "S001C001P001R001A023.skeleton", WriteNtuSkeleton(PersonAndChair()));
  const Ingested ingested = RunIngest(Discover(options)->items.at(0), "chair");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.provenance.at("body_id"), "72057594037931368");
  std::map<std::string, double> found;
  for (const Finding& finding : ingested.outcome->findings) found[finding.code] = finding.value;
  EXPECT_EQ(found.at("false_track"), 20.0);
  EXPECT_EQ(found.count("bodies_skipped"), 0u);
  EXPECT_EQ(found.at("no_joint_seen"), 3.0);
}

TEST(NtuPeople, RefusesAnAbsentPersonAndAnAmbiguousDeclaration) {
  IngestOptions options = Declared("ntu");
  options.path = FreshFolder("three");
  Put(options.path / "S001C001P001R001A023.skeleton", WriteNtuSkeleton(PersonAndChair()));
  options.source.bodies = {{"A023", "3"}};
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 3u);
  ExpectError(RunIngest(discovery->items[2], "three").outcome, ErrorCode::kInconsistent,
              "S001C001P001R001A023.skeleton");
  options.source.person = "P{person}";
  ExpectError(IngestOnly(options, "three"), ErrorCode::kConfig, "ingest.source.bodies");
  options.source.bodies = {{"A023", "many"}};
  ExpectError(IngestOnly(options, "three"), ErrorCode::kConfig, "ingest.source.bodies");
}

TEST(NtuPeople, JoinsAPersonWhoReturnsUnderAnotherId) {
  NtuSkeleton skeleton = PersonAndChair();
  for (std::size_t f = 8; f < skeleton.frames.size(); ++f) skeleton.frames[f].back().id = 72057594037931999u;
  IngestOptions options = Declared("ntu");
  options.path = FreshFolder("returns");
  Put(options.path / "S001C001P001R001A023.skeleton", WriteNtuSkeleton(skeleton));
  const Ingested whole = RunIngest(Discover(options)->items.at(0), "returns");
  ASSERT_TRUE(whole.outcome) << whole.outcome.error().Message();
  EXPECT_EQ(whole.clip.provenance.at("body_id"), "72057594037931368+72057594037931999");
  EXPECT_NEAR(whole.outcome->summary["missing_share"].get<double>(), 3.0 / 20.0, 1e-9);
  options.source.people.rule = TrackRule::kOfficial;
  const Ingested official = RunIngest(Discover(options)->items.at(0), "returns");
  ASSERT_TRUE(official.outcome) << official.outcome.error().Message();
  EXPECT_EQ(official.clip.provenance.at("body_id"), "72057594037931999") << "the track of most variance, not joined";
}

TEST(NtuPeople, AppliesTheRoleOfThePerformerToBothPeople) {
  IngestOptions options = Declared("ntu");
  options.source.roles = {{"P008", "test"}};
  const auto named = ReadName(options.source, "S001C003P008R002A058.skeleton", 2);
  ASSERT_TRUE(named) << named.error().Message();
  EXPECT_EQ(named->identity.person, "P008b");
  EXPECT_EQ(named->role, "test");
}

}  // namespace
}  // namespace mocurate
