// Sources of SMPL rotations and joints: written in the layout of the source and read back to the ground truth.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/formats/humanact12_pickle.h"
#include "core/formats/phspd_text.h"
#include "core/formats/uestc_info.h"
#include "core/formats/vibe_pickle.h"
#include "core/motion/kinematics.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/smpl_people.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Not;

double WorstAngle(const Motion& a, const Motion& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.rotation.size(); ++i)
    worst = std::max(worst, AngleBetween(a.rotation[i], b.rotation[i]));
  return worst;
}

double WorstPlace(const JointPositions& a, const JointPositions& b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.xyz.size(); ++i) worst = std::max(worst, std::abs(a.xyz[i] - b.xyz[i]));
  return worst;
}

IngestOptions Recipe(const std::string& name, const std::filesystem::path& folder) {
  IngestOptions options = Declared(name, {"ingest.path=" + folder.string()});
  return options;
}

TEST(HumanAct12Pickle, ReadsOneItemPerClipWithRotationsAndPositionsOfTheFile) {
  const std::filesystem::path folder = FreshFolder("humanact12_pickle");
  std::vector<Motion> truth = {MovingPerson(9, 1), MovingPerson(14, 2), MovingPerson(11, 3)};
  std::vector<HumanAct12Clip> clips;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    clips.push_back({static_cast<std::size_t>(truth[i].frame_count()), Vectors(truth[i], kHalfTurn),
                     Places(truth[i], kHalfTurn), static_cast<int>(4 * i)});
  }
  Put(folder / "humanact12poses.pkl", *EncodeHumanAct12Pickle(clips, "humanact12poses.pkl"));
  const auto discovery = Discover(Recipe("humanact12_poses", folder));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 3u);
  EXPECT_EQ(discovery->items[1].item, "humanact12/unknown/c0002");
  const char* const labels[] = {"warm_up", "drink", "turn_steering_wheel"};
  std::set<std::string> evidence;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Ingested ingested = RunIngest(discovery->items[i], "humanact12");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_TRUE(ingested.outcome->findings.empty()) << ingested.outcome->findings[0].message;
    ASSERT_TRUE(ingested.clip.motion);
    EXPECT_LT(WorstAngle(*ingested.clip.motion, truth[i]), 1e-6);
    EXPECT_LT(WorstPlace(ingested.clip.motion->joints, truth[i].joints), 2e-6);
    EXPECT_EQ(ingested.clip.rate, (FrameRate{15, 1}));
    EXPECT_EQ(ingested.clip.label, labels[i]) << i;
    evidence.insert(ingested.clip.evidence_sha256);
  }
  EXPECT_EQ(evidence.size(), 3u) << "clips of one file have different evidence hashes";
}

TEST(HumanAct12Pickle, ReportsDisplacedJointsAndKeepsRotations) {
  const std::filesystem::path folder = FreshFolder("humanact12_displaced");
  const Motion truth = MovingPerson(9, 1);
  std::vector<double> places = Places(truth, kHalfTurn);
  for (std::size_t i = 2; i < places.size(); i += 6) places[i] += 0.05;
  Put(folder / "humanact12poses.pkl", *EncodeHumanAct12Pickle({{9, Vectors(truth, kHalfTurn), places, 0}}, "x"));
  const auto discovery = Discover(Recipe("humanact12_poses", folder));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "humanact12_displaced");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  ASSERT_EQ(ingested.outcome->findings.size(), 1u);
  EXPECT_EQ(ingested.outcome->findings[0].code, "joints_displaced");
  EXPECT_LT(WorstAngle(*ingested.clip.motion, truth), 1e-6);
}

/// Finding codes of a run, then of an inspection, of a file with these clips.
std::array<std::vector<std::string>, 2> ReportedCodes(const std::vector<HumanAct12Clip>& clips) {
  const std::filesystem::path folder = FreshFolder("humanact12_reported");
  Put(folder / "humanact12poses.pkl", *EncodeHumanAct12Pickle(clips, "x"));
  const IngestOptions options = Recipe("humanact12_poses", folder);
  std::vector<std::string> run, inspection;
  const Ingested ingested = RunIngest(Discover(options)->items.at(0), "humanact12_reported");
  for (const Finding& finding : ingested.outcome->findings) run.push_back(finding.code);
  const nlohmann::json report = InspectPath(folder, options.source);
  for (const auto& finding : report.at("findings")) inspection.push_back(finding.at("code"));
  return {run, inspection};
}

TEST(HumanAct12Pickle, ReportsPosesInDegreesInRunAndInspect) {
  const Motion truth = MovingPerson(9, 1);
  const HumanAct12Clip sound{9, Vectors(truth, kHalfTurn), Places(truth, kHalfTurn), 0};
  HumanAct12Clip degrees = sound;
  for (double& angle : degrees.poses) angle *= 57.29577951308232;
  EXPECT_THAT(ReportedCodes({degrees}), Each(Contains("angle_unit_contradiction")));
  EXPECT_THAT(ReportedCodes({sound}), Each(Not(Contains("angle_unit_contradiction"))));
}

TEST(HumanAct12Pickle, SkipsOnlyADamagedEntryInAnInspection) {
  const Motion truth = MovingPerson(9, 1);
  const HumanAct12Clip sound{9, Vectors(truth, kHalfTurn), Places(truth, kHalfTurn), 0};
  HumanAct12Clip broken = sound;
  broken.joints[100] = std::nan("");
  const std::filesystem::path folder = FreshFolder("humanact12_broken");
  Put(folder / "humanact12poses.pkl", *EncodeHumanAct12Pickle({sound, broken, sound}, "x"));
  const nlohmann::json inspection = InspectPath(folder, Recipe("humanact12_poses", folder).source);
  EXPECT_EQ(inspection.at("clips").size(), 2u);
  EXPECT_THAT(Places(inspection), ElementsAre("malformed humanact12poses.pkl:/joints3D/1"));
}

TEST(Uestc, RotatesVideosByTheirViewAndMovesThemByTheCamera) {
  const std::filesystem::path folder = FreshFolder("uestc");
  const std::vector<UestcVideo> videos = {{7, 0, 1, 1}, {7, 3, 1, 2}, {12, 8, 3, 2}, {39, 8, 3, 1}};
  const Motion truth = MovingPerson(12, 5);
  std::vector<VibeTrack> tracks;
  std::vector<Quaterniond> world_from_file;
  for (const UestcVideo& video : videos) {
    const double angle = video.side == 1 ? 0.0 : -0.25 * EIGEN_PI * video.view;
    world_from_file.push_back(kHalfTurn * ExpQuaternion(Vector3d(0.0, angle, 0.0)));
    tracks.push_back(SmplTrack(truth, world_from_file.back().conjugate()));
  }
  Put(folder / "vibe_cache_refined.pkl", *EncodeVibeCache(tracks, "cache"));
  Put(folder / "info/names.txt", WriteUestcNames(videos));
  Put(folder / "info/num_frames_min.txt", WriteUestcFrameCounts({12, 10, 12, 12}));
  std::string classes;
  for (int a = 0; a < 40; ++a) classes += "action " + std::to_string(a) + "\n";
  Put(folder / "info/action_classes.txt", classes);
  const auto discovery = Discover(Recipe("uestc", folder));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 3u);
  ASSERT_EQ(discovery->excluded.size(), 1u);
  EXPECT_EQ(discovery->excluded[0].outcome.kind, OutcomeKind::kExcluded);
  for (std::size_t i = 0; i < 2; ++i) {
    const Ingested ingested = RunIngest(discovery->items[i], "uestc");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    const Motion& motion = *ingested.clip.motion;
    EXPECT_EQ(motion.frame_count(), i == 0 ? 12 : 10) << "from info/num_frames_min.txt";
    EXPECT_EQ(ingested.clip.label, "action 7");
    EXPECT_EQ(ingested.clip.role, "train");
    EXPECT_EQ(ingested.clip.identity.person, "p001");
    for (int f = 0; f < motion.frame_count(); ++f) {
      const double z = 500.0 / 270.0 * (1.0 / (0.7 + 0.01 * f) - 1.0 / 0.7);
      const Vector3d wanted = world_from_file[i] * Vector3d(0.1 * f + 0.08, 0.0, z + 0.001 * f);
      EXPECT_LT((motion.root_translation[static_cast<std::size_t>(f)] - wanted).norm(), 1e-6) << i << " frame " << f;
      for (int j = 0; j < kJoints; ++j) {
        const std::size_t at = static_cast<std::size_t>(f) * kJoints + j;
        EXPECT_LT(AngleBetween(motion.rotation[at], truth.rotation[at]), 1e-6) << i;
      }
    }
  }
  const auto last = RunIngest(discovery->items[2], "uestc");
  ASSERT_TRUE(last.outcome) << last.outcome.error().Message();
  EXPECT_EQ(last.clip.role, "test");
  EXPECT_EQ(last.clip.identity.recording, "a39_d8_p003_c1");
}

TEST(Uestc, NamesAMissingCompanionFile) {
  const std::filesystem::path folder = FreshFolder("uestc_bare");
  ExpectError(Discover(Recipe("uestc", folder)), ErrorCode::kNotFound, (folder / "vibe_cache_refined.pkl").string());
  Put(folder / "vibe_cache_refined.pkl", *EncodeVibeCache({SmplTrack(MovingPerson(4, 1), kHalfTurn)}, "cache"));
  ExpectError(Discover(Recipe("uestc", folder)), ErrorCode::kNotFound, "info/names.txt");
  Put(folder / "info/names.txt", WriteUestcNames({{0, 0, 1, 1}, {1, 0, 1, 1}}));
  Put(folder / "info/num_frames_min.txt", WriteUestcFrameCounts({4, 4}));
  std::string classes;
  for (int a = 0; a < 40; ++a) classes += "action " + std::to_string(a) + "\n";
  Put(folder / "info/action_classes.txt", classes);
  ExpectError(Discover(Recipe("uestc", folder)), ErrorCode::kInconsistent, "vibe_cache_refined.pkl");
}

TEST(Uestc, ReportsRotationsInDegreesInRunAndInspect) {
  const std::filesystem::path folder = FreshFolder("uestc_degrees");
  VibeTrack track = SmplTrack(MovingPerson(8, 1), kHalfTurn);
  for (double& angle : track.pose) angle *= 57.29577951308232;
  Put(folder / "vibe_cache_refined.pkl", *EncodeVibeCache({track}, "cache"));
  Put(folder / "info/names.txt", WriteUestcNames({{0, 0, 1, 1}}));
  Put(folder / "info/num_frames_min.txt", WriteUestcFrameCounts({8}));
  std::string classes;
  for (int a = 0; a < 40; ++a) classes += "action " + std::to_string(a) + "\n";
  Put(folder / "info/action_classes.txt", classes);
  const auto discovery = Discover(Recipe("uestc", folder));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "uestc_degrees");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const auto& found = ingested.outcome->findings;
  EXPECT_TRUE(std::any_of(found.begin(), found.end(),
                          [](const Finding& finding) { return finding.code == "angle_unit_contradiction"; }));
  const nlohmann::json inspection = InspectPath(folder, Recipe("uestc", folder).source);
  EXPECT_THAT(Codes(inspection, "error"), Contains("angle_unit_contradiction"));
}

TEST(Ntu13Vibe, ReadsEighteenJointsInPaperOrderAndThirteenActions) {
  const std::filesystem::path folder = FreshFolder("ntu13_vibe");
  const VibeTrack track = SmplTrack(MovingPerson(8, 2), kHalfTurn.conjugate());
  VibeTrack other = track;
  other.id = 4;
  for (const char* action : {"A006", "A038", "A102", "A058"}) {
    Put(folder / ("S001C002P003R001" + std::string(action) + ".pkl"), *EncodeVibeTracks({track, other}, "tracks"));
  }
  Put(folder / "S001C002P003R002A006.pkl", *EncodeVibeTracks({other}, "tracks"));
  Put(folder / "ntu_vibe_list.txt", "S001C002P003R001A006.pkl\n");
  IngestOptions recipe = Recipe("ntu13_vibe", folder);
  recipe.source.checks.actions["not_joint_positions"] = OnFinding::kReport;  // the positions form no body
  const auto discovery = Discover(recipe);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 4u);
  ASSERT_EQ(discovery->excluded.size(), 1u);
  EXPECT_EQ(discovery->excluded[0].outcome.findings.at(0).code, "label_excluded");
  EXPECT_EQ(discovery->excluded[0].outcome.kind, OutcomeKind::kExcluded);
  const Ingested ingested = RunIngest(discovery->items[0], "ntu13");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.label, "pick_up");
  const Motion& motion = *ingested.clip.motion;
  EXPECT_TRUE(motion.rotation.empty());
  const int order[] = {8, 1, 2, 3, 4, 5, 6, 7, 0, 9, 10, 11, 12, 13, 14, 21, 24, 38};
  ASSERT_EQ(motion.joint_count(), 18);
  for (int j = 0; j < 18; ++j) {
    const std::size_t at = static_cast<std::size_t>(3 * (49 + order[j]));
    const Vector3d file(track.joints3d[at], track.joints3d[at + 1], track.joints3d[at + 2]);
    EXPECT_LT((motion.joints.at(1, j) - kHalfTurn * file).norm(), 1e-6) << j;
  }
  ExpectError(RunIngest(discovery->items[3], "ntu13_without").outcome, ErrorCode::kInconsistent,
              "S001C002P003R002A006.pkl");
}

TEST(Ntu13Vibe, ReadsRotationsOnTheSmplSkeleton) {
  const std::filesystem::path folder = FreshFolder("ntu13_rotations");
  const Motion truth = MovingPerson(8, 2);
  Put(folder / "S001C002P003R001A006.pkl", *EncodeVibeTracks({SmplTrack(truth, kHalfTurn)}, "tracks"));
  const auto discovery = Discover(Declared(
      "ntu13_vibe", {"ingest.path=" + folder.string(), "ingest.source.skeleton=smpl24", "ingest.source.joints=[]"}));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "ntu13_rotations");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_LT(WorstAngle(*ingested.clip.motion, truth), 1e-6);
}

TEST(Ntu13Vibe, FillsFramesWithoutARowAndKeepsLaterTimes) {
  const std::filesystem::path folder = FreshFolder("ntu13_gap");
  VibeTrack track = SmplTrack(MovingPerson(12, 2), kHalfTurn);
  for (std::size_t f = 5; f < track.frames; ++f) track.frame_ids[f] += 3;
  Put(folder / "S001C001P001R001A006.pkl", *EncodeVibeTracks({track}, "x"));
  const auto discovery = Discover(Declared(
      "ntu13_vibe", {"ingest.path=" + folder.string(), "ingest.source.skeleton=smpl24", "ingest.source.joints=[]"}));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(discovery->items.at(0), "ntu13_gap");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.motion->frame_count(), 15);
  int count = 0;
  for (const Finding& finding : ingested.outcome->findings) {
    if (finding.code != "frames_filled") continue;
    ++count;
    EXPECT_EQ(finding.frame_begin, 5);
    EXPECT_EQ(finding.frame_end, 8);
  }
  EXPECT_EQ(count, 1);
}

TEST(Phspd, MarksUnannotatedFramesMissing) {
  const std::filesystem::path folder = FreshFolder("phspd");
  const Motion truth = MovingPerson(3, 4);
  PhspdPose pose;
  pose.frame = {17, 18, 21};
  pose.position_m = Places(truth, kHalfTurn);
  Put(folder / "pose/subject03_group2_time4/pose.txt", WritePhspdPose(pose));
  Put(folder / "pose/subject03_group2_time4/shape_smpl.txt", "");
  const auto discovery = Discover(Recipe("phspd", folder));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 1u);
  EXPECT_EQ(discovery->items[0].item, "phspd/P03/subject03_group2_time4");
  const Ingested ingested = RunIngest(discovery->items[0], "phspd");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const JointTracks& tracks = *ingested.clip.evidence.tracks;
  ASSERT_EQ(tracks.positions.frames, 5);
  EXPECT_NEAR(tracks.time_s[4], 4.0 / 15.0, 1e-12);
  const int frame_of[] = {0, 1, 4};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < kJoints; ++j) {
      EXPECT_LT((tracks.positions.at(frame_of[i], j) - truth.joints.at(i, j)).norm(), 1e-6);
      EXPECT_EQ(tracks.confidence[static_cast<std::size_t>(frame_of[i] * kJoints + j)], 1.0);
    }
  }
  EXPECT_EQ(tracks.confidence[2 * kJoints], 0.0);
  ASSERT_EQ(ingested.outcome->findings.size(), 1u);
  EXPECT_EQ(ingested.outcome->findings[0].code, "time_gap");
  EXPECT_EQ(ingested.outcome->findings[0].frame_begin, 2);
  EXPECT_EQ(ingested.outcome->findings[0].frame_end, 4);
  EXPECT_EQ(ingested.clip.provenance.at("first_frame"), "17");
}

TEST(Phspd, DropsOnlyTheFrameOfAShortRow) {
  const std::filesystem::path folder = FreshFolder("phspd_short");
  const Motion truth = MovingPerson(5, 4);
  PhspdPose pose;
  pose.frame = {7, 8, 9, 10, 11};
  pose.position_m = Places(truth, kHalfTurn);
  std::string text = WritePhspdPose(pose);
  const std::size_t third = text.find("\n9 ") + 1;
  text.replace(third, text.find('\n', third) - third, "9 0.5 1.5");
  Put(folder / "pose/subject03_group2_time4/pose.txt", text);
  for (const bool refuse : {false, true}) {
    IngestOptions options = Recipe("phspd", folder);
    if (refuse) options.source.damaged_rows = DamagedRows::kRefuse;
    const auto discovery = Discover(options);
    ASSERT_TRUE(discovery) << discovery.error().Message();
    const Ingested ingested = RunIngest(discovery->items.at(0), "phspd_short");
    if (refuse) {
      ExpectMalformed(ingested.outcome, "pose/subject03_group2_time4/pose.txt:3");
      continue;
    }
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    const JointTracks& tracks = *ingested.clip.evidence.tracks;
    ASSERT_EQ(tracks.positions.frames, 5);
    for (int f = 0; f < 5; ++f) {
      EXPECT_EQ(tracks.confidence[static_cast<std::size_t>(f * kJoints)], f == 2 ? 0.0 : 1.0) << f;
      if (f == 2) continue;
      EXPECT_LT((tracks.positions.at(f, 0) - truth.joints.at(f, 0)).norm(), 1e-6) << f;
    }
    ASSERT_EQ(ingested.outcome->findings.size(), 1u);
    EXPECT_EQ(ingested.outcome->findings[0].code, "row_length");
    EXPECT_EQ(ingested.outcome->findings[0].frame_begin, 2);
  }
}

}  // namespace
}  // namespace mocurate
