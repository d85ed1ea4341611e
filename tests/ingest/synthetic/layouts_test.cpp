// The studio writes files in the layouts of real sets; our readers recover the ground truth.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/formats/humanact12_pickle.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/uestc_info.h"
#include "core/formats/vibe_pickle.h"
#include "ingest/inspect/inspect.h"
#include "ingest/synthetic/body_points.h"
#include "tests/ingest/studio_folders.h"
#include "tests/support/humanact12_clips.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

double MaxDistance(const JointPositions& a, const JointPositions& b) {
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.joints, b.joints);
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.xyz.size(), b.xyz.size()); ++i) {
    most = std::max(most, std::abs(a.xyz[i] - b.xyz[i]));
  }
  return most;
}

/// Number of clips in a folder with one of these inspection findings.
std::size_t Affected(const fs::path& folder, const std::string& source, const std::set<std::string>& codes) {
  const nlohmann::json inspection = InspectPath(folder, Declared(source).source);
  std::set<std::string> clips;
  for (const nlohmann::json& finding : inspection.at("findings")) {
    const std::string where = finding.at("where");
    if (codes.count(finding.at("code")) != 0) clips.insert(where.substr(0, where.find(' ')));
  }
  return clips.size();
}

TEST_F(Layouts, TrackedPeopleHaveAsFewFindingsAsRecordedOnes) {
  // Recorded: 7 of KARD's 432 clips repeat a joint and none swaps sides; of MSR-Action3D's 448 it is 2 and 6.
  StudioOptions options;
  options.depth.enabled = false;
  options.layout = StudioLayout::kKard;
  Write(options);
  EXPECT_LE(Affected(folder / "kard", "kard", {"repeated_value", "swapped_sides", "rate_suspect"}), 2u) << "of 36";
}

TEST_F(Layouts, PeopleOfThreeSensorsHaveAsFewFindings) {
  StudioOptions options;
  options.depth.enabled = false;
  options.layout = StudioLayout::kNtu;
  Write(options);
  EXPECT_LE(Affected(folder / "nturgb+d_skeletons", "ntu", {"repeated_value", "swapped_sides", "rate_suspect"}), 5u)
      << "of 108";
  EXPECT_EQ(Affected(folder / "nturgb+d_skeletons", "ntu", {"name_contradiction"}), 0u) << "actions of NTU RGB+D 120";
}

TEST_F(Layouts, AmassMotionsObeyGravity) {
  StudioOptions options;
  options.layout = StudioLayout::kAmass;
  options.actions = {"jump", "run"};
  options.subjects = 3;
  options.clips = 2;
  Write(options);
  EXPECT_EQ(Affected(folder / "amass", "amass", {"rate_suspect", "position_jump"}), 0u);
}

constexpr double kFloat32Precision = 2e-6;  // float32 precision of the stored ground truth

TEST_F(Layouts, HumanAct12RoundTripsToTheGroundTruth) {
  StudioOptions options = Perfect(StudioLayout::kHumanAct12);
  Write(options);
  const auto clips = Ingested("humanact12_npy", "HumanAct12");
  ASSERT_EQ(clips.size(), truth.size());
  EXPECT_GT(clips.size(), 50u);
  for (const auto& [id, clip] : clips) {
    ASSERT_EQ(truth.count(id), 1u) << id;
    EXPECT_LT(MaxDistance(clip.motion->joints, truth.at(id).joints), kFloat32Precision) << id;
  }
  const std::string bytes = Bytes("humanact12poses.pkl");
  const auto pickle = ParseHumanAct12Pickle(bytes, "humanact12poses.pkl");
  ASSERT_TRUE(pickle) << pickle.error().Message();
  ASSERT_EQ(pickle->size(), clips.size());
  // The pickle has the same clips sorted by name, and the SMPL rotations of the same joints.
  std::size_t i = 0;
  for (const auto& [id, motion] : truth) {
    const HumanAct12Clip& clip = (*pickle)[i++];
    ASSERT_EQ(static_cast<int>(clip.frames), motion.frame_count());
    for (int f = 0; f < motion.frame_count(); ++f) {
      for (int j = 1; j < 24; ++j) {
        const double* vector = &clip.poses[static_cast<std::size_t>(f) * 72 + 3 * j];
        const Quaterniond rotation = ExpQuaternion(Vector3d(vector[0], vector[1], vector[2]));
        ASSERT_LT(rotation.angularDistance(motion.rotation_at(f, j)), 1e-5) << id;
      }
    }
  }
}

TEST_F(Layouts, KardRoundTripsToTheGroundTruth) {
  StudioOptions options = Perfect(StudioLayout::kKard);
  options.actions = {"walk", "sit_down", "drink"};
  Write(options);
  const auto clips = Ingested("kard", "kard");
  ASSERT_EQ(clips.size(), 6u);
  ASSERT_EQ(truth.size(), 6u);
  for (const auto& [id, clip] : clips) {
    ASSERT_EQ(truth.count(id), 1u) << id;
    const JointPositions points = PlacesOf(truth.at(id), KardPlaces());
    EXPECT_LT(MaxDistance(clip.evidence.tracks->positions, points), 1e-5) << id;
    EXPECT_EQ(clip.evidence.tracks->names, NamesOf(KardPlaces()));
  }
}

TEST_F(Layouts, NtuSkeletonsRoundTripToTheGroundTruthFromThreeSensors) {
  StudioOptions options = Perfect(StudioLayout::kNtu);
  options.actions = {"throw"};
  Write(options);
  const auto clips = Ingested("ntu", "nturgb+d_skeletons");
  ASSERT_EQ(clips.size(), 6u);
  for (const auto& [id, clip] : clips) {
    ASSERT_EQ(truth.count(id), 1u) << id;
    const JointPositions points = PlacesOf(truth.at(id), Kinect25Places());
    EXPECT_LT(MaxDistance(clip.evidence.tracks->positions, points), 5e-6) << id;
  }
  // Pixel positions in the file match the depth camera. C002 sees the front in the first repetition.
  const std::string text = Bytes("nturgb+d_skeletons/S001C002P001R001A007.skeleton");
  const auto skeleton = ParseNtuSkeleton(text, "S001C002P001R001A007.skeleton");
  ASSERT_TRUE(skeleton);
  int inferred = 0, joints = 0;
  for (const auto& bodies : skeleton->frames) {
    for (const NtuJoint& joint : bodies.at(0).joints) {
      EXPECT_NEAR(joint.depth_u, 255.5 + 365.0 * joint.x_m / joint.z_m, 1e-3);
      EXPECT_NEAR(joint.depth_v, 211.5 - 365.0 * joint.y_m / joint.z_m, 1e-3);
      inferred += joint.tracking == 1 ? 1 : 0;
      ++joints;
    }
  }
  EXPECT_LT(inferred, joints / 4) << "from the front most joints are visible";
}

TEST_F(Layouts, Cmu8RoundTripsToTheGroundTruthWithItsClasses) {
  Write(Perfect(StudioLayout::kCmu8));
  const auto clips = Ingested("cmu8", "cmu8");
  ASSERT_EQ(clips.size(), truth.size());
  std::set<std::string> labels;
  for (const auto& [id, clip] : clips) {
    ASSERT_EQ(truth.count(id), 1u) << id;
    EXPECT_LT(MaxDistance(clip.motion->joints, PlacesOf(truth.at(id), Cmu20Places())), 1e-5) << id;
    EXPECT_EQ(clip.motion->rate, (FrameRate{12, 1}));
    labels.insert(clip.label);
  }
  EXPECT_EQ(labels,
            (std::set<std::string>{"animal_behavior", "climb", "dance", "jump", "run", "step", "walk", "wash"}));
  const SkeletonPtr skeleton = *LoadSkeleton("cmu20");
  for (std::size_t j = 0; j < 20; ++j) EXPECT_EQ(Cmu20Places()[j].name, skeleton->joints[j].name);
}

TEST_F(Layouts, Ntu13VibeTracksRoundTripToTheGroundTruth) {
  Write(Perfect(StudioLayout::kNtuVibe));
  const std::string list = Bytes("ntu13/ntu_vibe_list.txt");
  EXPECT_EQ(std::count(list.begin(), list.end(), '\n'), 26);
  ASSERT_EQ(truth.size(), 26u);
  for (const auto& [id, motion] : truth) {
    const std::string recording = id.substr(id.rfind('/') + 1, 20);
    ASSERT_NE(list.find(recording + ".pkl\n"), std::string::npos) << recording;
    const std::string bytes = Bytes("ntu13/" + recording + ".pkl");
    const auto tracks = ParseVibeTracks(bytes, recording);
    ASSERT_TRUE(tracks) << tracks.error().Message();
    ASSERT_EQ(tracks->size(), 1u);
    const VibeTrack& track = tracks->front();
    EXPECT_EQ(track.id, 1);
    ASSERT_EQ(static_cast<int>(track.frames), motion.frame_count());
    const JointPositions points = PlacesOf(motion, Vibe49Places());
    for (int f = 0; f < points.frames; ++f) {
      for (int k = 0; k < 49; ++k) {
        const double* at = &track.joints3d[(static_cast<std::size_t>(f) * 49 + k) * 3];
        const Vector3d canonical(at[0], -at[1], -at[2]);
        ASSERT_LT((canonical - (points.at(f, k) - motion.root_translation[f])).norm(), 1e-5);
      }
      // z = 500 / (270 sx), x and y from the camera: the pelvis.
      const double* camera = &track.original_camera[4 * static_cast<std::size_t>(f)];
      const Vector3d pelvis(camera[2], camera[3], 500.0 / (270.0 * camera[0]));
      ASSERT_LT((Vector3d(pelvis.x(), -pelvis.y(), -pelvis.z()) - motion.root_translation[f]).norm(), 1e-5);
    }
  }
}

TEST_F(Layouts, UestcViewsAreRotatedToTheFront) {
  StudioOptions options = Perfect(StudioLayout::kUestc);
  options.subjects = 1;
  options.actions = {"punching", "squatting"};
  Write(options);
  const std::string names_text = Bytes("uestc/info/names.txt");
  const auto names = ParseUestcNames(names_text, "names.txt");
  ASSERT_TRUE(names);
  ASSERT_EQ(names->size(), 4u);
  const std::string frames_text = Bytes("uestc/info/num_frames_min.txt");
  const auto frames = ParseUestcFrameCounts(frames_text, "num_frames_min.txt", 4);
  ASSERT_TRUE(frames) << frames.error().Message();
  ASSERT_TRUE(ParseUestcActions(Bytes("uestc/info/action_classes.txt"), "action_classes.txt"));
  const std::string bytes = Bytes("uestc/vibe_cache_refined.pkl");
  const auto cache = VibeCache::Open(bytes, "vibe_cache_refined.pkl");
  ASSERT_TRUE(cache) << cache.error().Message();
  ASSERT_EQ(cache->size(), 4u);
  for (std::size_t i = 0; i < 4; i += 2) {
    const auto front = cache->Track(i);
    const auto side = cache->Track(i + 1);
    ASSERT_TRUE(front && side);
    EXPECT_EQ(static_cast<int>(front->frames), (*frames)[i]);
    ASSERT_EQ((*names)[i + 1].side, 2);
    ASSERT_GT((*names)[i + 1].view, 0);
    const double angle = -0.25 * 3.14159265358979323846 * (*names)[i + 1].view;
    const Quaterniond back(Eigen::AngleAxisd(angle, Vector3d::UnitY()));
    for (std::size_t k = 0; k < front->joints3d.size(); k += 3) {
      const Vector3d from_side(side->joints3d[k], side->joints3d[k + 1], side->joints3d[k + 2]);
      const Vector3d expected(front->joints3d[k], front->joints3d[k + 1], front->joints3d[k + 2]);
      ASSERT_LT((back * from_side - expected).norm(), 1e-9);
    }
  }
}

/// Largest root error (metres) or joint rotation error (radians), with the first roots aligned. VIBE's root is the
/// middle of the hips.
double MaxError(const Motion& estimate, const Motion& motion) {
  if (estimate.frame_count() != motion.frame_count()) return 1e9;
  double worst = 0.0;
  const Vector3d shift = motion.joints.at(0, 0) - estimate.joints.at(0, 0);
  for (int f = 0; f < estimate.frame_count(); ++f) {
    worst = std::max(worst, (estimate.joints.at(f, 0) + shift - motion.joints.at(f, 0)).norm());
    for (int j = 0; j < estimate.joint_count(); ++j) {
      worst = std::max(worst, estimate.rotation_at(f, j).angularDistance(motion.rotation_at(f, j)));
    }
  }
  return worst;
}

TEST_F(Layouts, BothUestcCamerasRoundTripToTheGroundTruth) {
  for (const auto& [layout, name] :
       {std::pair(StudioLayout::kUestc, "uestc"), {StudioLayout::kUestcVibe, "uestc_vibe"}}) {
    SCOPED_TRACE(name);
    fs::remove_all(folder);
    StudioOptions options = Perfect(layout);
    options.actions = {"punching", "left-kicking"};
    Write(options);
    const auto clips = Ingested(name, name);
    ASSERT_EQ(clips.size(), 8u) << "two actions, two people, two cameras";
    for (const auto& [id, clip] : clips) {
      ASSERT_EQ(truth.count(id), 1u) << id;
      EXPECT_LT(MaxError(*clip.motion, truth.at(id)), 0.01) << id;
    }
  }
}

TEST_F(Layouts, UestcPerformerIsSelectedAmongBystanders) {
  StudioOptions options = Perfect(StudioLayout::kUestcVibe);
  options.actions = {"punching", "left-kicking"};
  options.false_track_share = 1.0;
  Write(options);
  const auto clips = Ingested("uestc_vibe", "uestc_vibe");
  ASSERT_EQ(clips.size(), 8u);
  for (const auto& [id, clip] : clips) {
    EXPECT_EQ(clip.provenance.at("tracks"), "1+3") << id;
    EXPECT_LT(MaxError(*clip.motion, truth.at(id)), 0.3) << id << ": three frames are interpolated";
  }
}

TEST_F(Layouts, UestcCamerasHaveIndependentErrors) {
  StudioOptions options;
  options.layout = StudioLayout::kUestc;
  options.subjects = 1;
  options.actions = {"punching"};
  Write(options);
  const auto clips = Ingested("uestc", "uestc");
  ASSERT_EQ(clips.size(), 2u);
  const Motion& front = *clips.begin()->second.motion;
  const Motion& side = *clips.rbegin()->second.motion;
  double least = 1e9;
  for (int f = 0; f < front.frame_count(); ++f) {
    for (int j = 1; j < 24; ++j)
      least = std::min(least, front.rotation_at(f, j).angularDistance(side.rotation_at(f, j)));
  }
  EXPECT_GT(least, 1e-5) << "the poses differ between cameras";
}

TEST_F(Layouts, AmassAndBabelRoundTripToTheGroundTruth) {
  StudioOptions options = Perfect(StudioLayout::kAmass);
  options.clips = 2;
  Write(options);
  const auto clips = Ingested("amass", "amass");
  ASSERT_EQ(clips.size(), 4u);
  for (const auto& [id, clip] : clips) {
    ASSERT_EQ(truth.count(id), 1u) << id;
    const Motion& motion = truth.at(id);
    ASSERT_EQ(clip.motion->frame_count(), motion.frame_count());
    for (int f = 0; f < motion.frame_count(); ++f) {
      ASSERT_LT((clip.motion->root_translation[f] - motion.root_translation[f]).norm(), kFloat32Precision);
      // AMASS's body ends at the wrists: the hands are other joints.
      for (int j = 0; j < 22; ++j) {
        ASSERT_LT(clip.motion->rotation_at(f, j).angularDistance(motion.rotation_at(f, j)), 1e-5) << j;
      }
    }
    ASSERT_GE(clip.segments.size(), 5u) << "several actions and transitions";
    EXPECT_TRUE(std::any_of(clip.segments.begin(), clip.segments.end(),
                            [](const Segment& segment) { return segment.label == "transition"; }));
    for (const Segment& segment : clip.segments) EXPECT_LE(segment.end_s, clip.motion->duration() + 0.01);
  }
}

TEST_F(Layouts, TheSameSeedGivesTheSameBytesForAnyNumberOfJobs) {
  const std::pair<StudioLayout, std::vector<std::string>> layouts[] = {
      {StudioLayout::kHumanAct12, {"throw"}},    {StudioLayout::kNtu, {"throw"}},
      {StudioLayout::kKard, {"walk"}},           {StudioLayout::kNtuVibe, {}},
      {StudioLayout::kUestcVibe, {"punching"}},  {StudioLayout::kOpenPose, {"throw"}},
      {StudioLayout::kOpenPoseDepth, {"throw"}}, {StudioLayout::kAmass, {"jump", "run"}},
      {StudioLayout::kDepthSequence, {"throw"}}, {StudioLayout::kCmu8, {}}};
  for (const auto& [layout, actions] : layouts) {
    StudioOptions options;
    options.layout = layout;
    options.actions = actions;
    options.subjects = 1;
    options.rig.cameras = 2;
    options.depth.every = 50;
    const fs::path again = folder.string() + "_again", other = folder.string() + "_other";
    for (const fs::path& path : {folder, again, other}) fs::remove_all(path);
    ASSERT_TRUE(WriteStudioLayout(options, folder, 1));
    ASSERT_TRUE(WriteStudioLayout(options, again, 3));
    options.seed = 2;
    ASSERT_TRUE(WriteStudioLayout(options, other, 1));
    const auto first = BytesBelow(folder);
    EXPECT_EQ(first, BytesBelow(again));
    EXPECT_NE(first, BytesBelow(other));
    for (const fs::path& path : {again, other}) fs::remove_all(path);
  }
}

TEST_F(Layouts, ANonEmptyFolderIsNotOverwritten) {
  fs::create_directories(folder);
  Put(folder / "mine.txt", "mine");
  const auto counts = WriteStudioLayout(Perfect(StudioLayout::kKard), folder, 1);
  ASSERT_FALSE(counts);
  EXPECT_EQ(counts.error().code, ErrorCode::kCannotWrite);
  EXPECT_EQ(BytesBelow(folder).size(), 1u);
}

TEST_F(Layouts, AnUnknownActionIsReportedWithTheNearestOne) {
  StudioOptions options = Perfect(StudioLayout::kHumanAct12);
  options.actions = {"boxin"};
  const auto counts = WriteStudioLayout(options, folder, 1);
  ASSERT_FALSE(counts);
  EXPECT_EQ(counts.error().code, ErrorCode::kConfig);
  EXPECT_THAT(counts.error().Message(), ::testing::HasSubstr("'boxing'"));
  EXPECT_FALSE(fs::exists(folder));
}

}  // namespace
}  // namespace mocurate
