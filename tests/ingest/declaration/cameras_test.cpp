// Sources of several cameras on recorded files: a turntable, rendered stills with ground truth, people in a dome.
// Synthetic keypoints, read back to the ground truth.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/sha256.h"
#include "core/formats/png.h"
#include "ingest/expected_files.h"
#include "ingest/inspect/file_names.h"
#include "ingest/inspect/inspect.h"
#include "ingest/inspect/source_declaration.h"
#include "tests/ingest/jpeg_masks.h"
#include "tests/ingest/studio_folders.h"
#include "tests/support/linear_triangulation.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class RecordedViews : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }

  /// Reads the first image of a view from its source.
  static DepthImage Depth(const IngestOptions& options, const DepthView& view) {
    const auto image = DecodeDepthPng(*ReadFile(options.path / view.files[0]), "depth");
    EXPECT_TRUE(image) << image.error().Message();
    return image.value_or(DepthImage{});
  }
};

TEST_F(RecordedViews, ReadTheTurntableAsOneFrameOfEightyViews) {
  const IngestOptions options = Declared("rgbd100");
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 1u);
  EXPECT_TRUE(discovery->excluded.empty());
  const Ingested ingested = RunIngest(discovery->items[0], "rgbd100");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_TRUE(ingested.outcome->findings.empty()) << ingested.outcome->findings[0].message;
  EXPECT_EQ(ingested.clip.id(), "rgbd100/a1/a1#0-1");
  const auto& views = ingested.clip.evidence.depth_views;
  ASSERT_EQ(views.size(), 80u);
  for (const std::size_t v : {0u, 20u, 40u, 60u}) {
    const DepthView& view = views[v];
    EXPECT_EQ(view.camera.width, 640);
    EXPECT_EQ(view.camera.height, 480);
    ASSERT_EQ(view.masks.size(), 1u);
    EXPECT_EQ(view.mask_sha256[0].size(), 64u);
    const PixelMask mask = test::JpegMask(*ReadFile(options.path / view.masks[0]));
    const std::vector<Vector3d> points = BackProject(Depth(options, view), view.camera, view.metres_per_unit, &mask);
    ASSERT_GT(points.size(), 30'000u);
    // README_multiview.md, section 2: x 0.39-0.86, y 0.38-1.01 (down), z 0.70-0.94 m.
    const RigidTransform world_from_camera = Inverse(view.camera.camera_from_world);
    const auto there = std::count_if(points.begin(), points.end(), [&](const Vector3d& point) {
      const Vector3d p = world_from_camera * point;
      return p.x() > 0.36 && p.x() < 0.89 && -p.y() > 0.35 && -p.y() < 1.04 && -p.z() > 0.65 && -p.z() < 0.99;
    });
    EXPECT_GT(static_cast<double>(there), 0.97 * static_cast<double>(points.size())) << view.camera.name;
  }
}

TEST_F(RecordedViews, EstimateTheTurntableCameraConvention) {
  const auto declared = Discover(Declared("rgbd100"));
  const auto silent = Discover(Declared("rgbd100", {"ingest.source.camera_pose=measured", "ingest.source.units=''"}));
  ASSERT_TRUE(declared && silent);
  const Ingested a = RunIngest(declared->items[0], "rgbd_declared");
  const Ingested b = RunIngest(silent->items[0], "rgbd_silent");
  ASSERT_TRUE(a.outcome && b.outcome);
  EXPECT_THAT(b.clip.provenance.at("calibration"), HasSubstr("pose camera_to_world (measured"));
  const Camera& first = a.clip.evidence.depth_views[33].camera;
  const Camera& second = b.clip.evidence.depth_views[33].camera;
  EXPECT_LT((first.Centre() - second.Centre()).norm(), 1e-12);
  const auto wrong = Discover(Declared("rgbd100", {"ingest.source.camera_pose=world_to_camera"}));
  ASSERT_TRUE(wrong);
  const Ingested suspect = RunIngest(wrong->items[0], "rgbd_wrong");
  ASSERT_TRUE(suspect.outcome);
  EXPECT_EQ(suspect.outcome->kind, OutcomeKind::kSuspect);
  EXPECT_EQ(suspect.outcome->findings[0].code, "calibration_contradiction");
}

TEST_F(RecordedViews, ReadRenderedStillsAsOneFrameClipsWithGroundTruth) {
  const IngestOptions options = Declared("rendered_body");
  const auto discovery = Discover(options);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  EXPECT_TRUE(discovery->excluded.empty());
  ASSERT_EQ(discovery->items.size(), 6u);
  ASSERT_EQ(discovery->truth.size(), 6u);
  std::set<std::string> labels;
  for (std::size_t i = 0; i < 6; ++i) {
    const Ingested ingested = RunIngest(discovery->items[i], "still");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    labels.insert(ingested.clip.label);
    ASSERT_EQ(ingested.clip.evidence.depth_views.size(), 3u);
    const auto folder = FreshFolder("still_truth");
    const StageRequest request{"truth",
                               discovery->truth[i].item,
                               discovery->truth[i].options.Whole(),
                               discovery->truth[i].inputs,
                               folder / "truth.h5",
                               folder};
    const auto outcome = TruthStage(request);
    ASSERT_TRUE(outcome) << outcome.error().Message();
    const auto truth = ReadTruth(request.output);
    ASSERT_TRUE(truth) << truth.error().Message();
    const Motion& motion = truth->motion.at(ingested.clip.id());
    ASSERT_EQ(motion.frame_count(), 1);
    EXPECT_GT(motion.joints.at(0, 15).y(), motion.joints.at(0, 0).y()) << "the head is above the pelvis";
    for (const DepthView& view : ingested.clip.evidence.depth_views) {
      EXPECT_EQ(view.camera.width, 512);
      const DepthImage image = Depth(options, view);
      const Vector3d chest = view.camera.camera_from_world * Vector3d(motion.joints.at(0, 9));
      const auto pixel = view.camera.Project(chest);
      ASSERT_TRUE(pixel);
      const auto at =
          static_cast<std::size_t>(std::lround(pixel->y())) * 512 + static_cast<std::size_t>(std::lround(pixel->x()));
      const double surface = image.values.at(at) * view.metres_per_unit;
      EXPECT_GT(surface, chest.z() - 0.6) << ingested.clip.id();
      EXPECT_LT(surface, chest.z()) << "the skin is in front of the joint";
    }
  }
  EXPECT_EQ(labels, (std::set<std::string>{"squat", "stand", "walk", "wave"}));
}

TEST_F(RecordedViews, ReadThreePeopleOfTheBandInMetres) {
  const auto discovery = Discover(Declared("panoptic"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 3u);
  std::vector<double> thighs, shoulders;
  double missing = 0.0;
  std::set<std::string> bodies;
  for (const ItemSpec& item : discovery->items) {
    const Ingested ingested = RunIngest(item, "panoptic");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    const JointTracks& tracks = *ingested.clip.evidence.tracks;
    EXPECT_EQ(tracks.positions.frames, 20);
    ASSERT_EQ(tracks.names.size(), 19u);
    EXPECT_EQ(tracks.names[7], "left_knee");
    bodies.insert(ingested.clip.provenance.at("body_id"));
    for (int f = 0; f < 20; ++f) {
      const auto detected = [&](int j) { return tracks.confidence[static_cast<std::size_t>(f * 19 + j)] > 0.0; };
      const auto at = [&](int j) { return Vector3d(tracks.positions.at(f, j)); };
      if (detected(6) && detected(7)) thighs.push_back((at(6) - at(7)).norm());
      if (detected(3) && detected(9)) shoulders.push_back((at(3) - at(9)).norm());
      if (detected(1) && detected(8)) {
        EXPECT_GT(at(1).y(), at(8).y() + 0.5) << "the nose is above the ankle";
      }
      for (int j = 0; j < 19; ++j) missing += detected(j) ? 0.0 : 1.0 / (3 * 20 * 19);
    }
    for (const Finding& finding : ingested.outcome->findings) {
      EXPECT_NE(finding.severity, Severity::kError) << finding.message;
      EXPECT_NE(finding.code, "rate_contradiction") << finding.message;
    }
  }
  EXPECT_EQ(bodies.size(), 3u);
  std::sort(thighs.begin(), thighs.end());
  std::sort(shoulders.begin(), shoulders.end());
  // README_multiview.md, section 5: medians 43.1 and 32.0 cm, 7 % of the joints missing.
  EXPECT_NEAR(thighs[thighs.size() / 2], 0.431, 0.002);
  EXPECT_NEAR(shoulders[shoulders.size() / 2], 0.320, 0.002);
  EXPECT_NEAR(missing, 0.07, 0.01);
}

TEST_F(RecordedViews, FindTheExpectedFilesOfEverySource) {
  for (const char* name :
       {"pose2sim_single", "pose2sim_two", "pose2sim_static", "rgbd100", "rendered_body", "panoptic"}) {
    const auto expected = ExpectedFiles(Declared(name), true);
    ASSERT_TRUE(expected) << expected.error().Message();
    for (const ExpectedFile& file : *expected) EXPECT_GT(file.found, 0u) << name << ": " << file.pattern;
  }
}

TEST(GroupedNames, TakeTheCameraFromTheFolderAndTheFrameFromTheLastDigits) {
  const auto pattern = [](const std::vector<std::string>& names, bool cameras) {
    const auto guessed = EstimateFramePattern(names, cameras);
    return guessed ? guessed->pattern : std::string();
  };
  EXPECT_EQ(pattern({"walk/cam01_json/cam01.0000.json", "run/cam02_json/cam02.0000.json"}, true),
            "{recording}/{camera}_json/{camera}.{frame}.json");
  EXPECT_EQ(pattern({"left/video_000000000000_keypoints.json", "right/video_000000000000_keypoints.json"}, true),
            "{camera}/video_{frame}_keypoints.json");
  EXPECT_EQ(pattern({"band/body3DScene_00000168.json"}, false), "{recording}/body3DScene_{frame}.json");
  EXPECT_EQ(pattern({"a/cam1/x.json"}, true), "") << "no frame number";
}

TEST(NamesOfCameras, DoNotCountALetterInPrefixAndSuffix) {
  const CameraNames names = NamesOfCameras({"cam_1.xml", "cam_1_1.xml", "cam_1.xml"});
  EXPECT_EQ(names.before, "cam_");
  EXPECT_EQ(names.after, ".xml");
  EXPECT_EQ(names.cameras, (std::vector<std::string>{"1", "1_1"}));
}

std::string MatrixText(const std::string& key, int rows, int columns, const std::string& numbers) {
  return key + ": !!opencv-matrix\n   rows: " + std::to_string(rows) + "\n   cols: " + std::to_string(columns) +
         "\n   dt: d\n   data: [ " + numbers + " ]\n";
}

TEST(DeclaredCameras, AreFoundDirectlyInTheFolder) {
  const std::filesystem::path folder = FreshFolder("rig_directly") / "data";
  const std::string head = "%YAML:1.0\n---\nnames:\n   - cam1\n   - cam2\n";
  std::string intri = head, extri = head;
  DepthImage image{64, 48, std::vector<std::uint16_t>(64 * 48, 1500)};
  for (const std::string camera : {"cam1", "cam2"}) {
    intri += MatrixText("K_" + camera, 3, 3, "1000, 0, 500, 0, 1000, 400, 0, 0, 1");
    intri += MatrixText("dist_" + camera, 1, 5, "0, 0, 0, 0, 0");
    extri += MatrixText("R_" + camera, 3, 1, camera == "cam1" ? "0, 0, 0" : "0, 1, 0");
    extri += MatrixText("T_" + camera, 3, 1, "0, 0, 3");
    Put(folder / (camera + "_0.png"), *EncodePng(image));
  }
  Put(folder / "intri.yml", intri);
  Put(folder / "extri.yml", extri);
  const auto written = DeclareSource(InspectPath(folder, std::nullopt), folder, "mine");
  ASSERT_TRUE(written) << written.error().Message();
  for (const char* line :
       {"format: depth_views", "files: \"{camera}_{frame:1}.png\"", "calibration: [extri.yml, intri.yml]"}) {
    EXPECT_THAT(written->yaml, HasSubstr(line));
  }
  std::filesystem::remove_all(folder.parent_path());
}

TEST_F(RecordedViews, WriteADeclarationOfKeypointsFromTheFolder) {
  const std::filesystem::path folder = Declared("pose2sim_single").path;
  const auto written = DeclareSource(InspectPath(folder, std::nullopt), folder, "mine");
  ASSERT_TRUE(written) << written.error().Message();
  for (const char* line : {"format: openpose", "files: \"{recording}/{camera}_json/{camera}.{frame}.json\"",
                           "calibration: [Calib.qca.txt]", "axes: \"+x -z +y\"", "keypoints: BODY_25B"}) {
    EXPECT_THAT(written->yaml, HasSubstr(line));
  }
  EXPECT_THAT(written->unknown, ElementsAre("person", "label", "rate")) << written->yaml;
}

TEST_F(Layouts, IngestedKeypointsTriangulateToTheGroundTruth) {
  StudioOptions options = Perfect(StudioLayout::kOpenPose);
  options.subjects = 1;
  Write(options);
  const auto clips = Ingested("studio_keypoints", "openpose");
  ASSERT_EQ(clips.size(), truth.size());
  for (const auto& [id, clip] : clips) {
    ASSERT_EQ(truth.count(id), 1u) << id;
    const Motion& motion = truth.at(id);
    const Evidence& evidence = clip.evidence;
    const auto point = std::find(evidence.keypoint_names.begin(), evidence.keypoint_names.end(), "left_knee");
    ASSERT_NE(point, evidence.keypoint_names.end());
    const auto k = static_cast<int>(point - evidence.keypoint_names.begin());
    const int joint = *motion.skeleton->FindJoint("left_knee");
    int met = 0;
    for (int f = 0; f < motion.frame_count(); f += 7) {
      std::vector<ImageObservation> observations;
      for (const KeypointView& view : evidence.keypoint_views) {
        const double* v = view.people > 0 ? view.at(f, 0, k) : nullptr;
        if (v != nullptr && v[2] > 0.0) observations.push_back({&view.camera, Vector2d(v[0], v[1]), 1.0});
      }
      const auto place = TriangulateLinear(observations);
      if (!place) continue;
      EXPECT_LT((*place - Vector3d(motion.joints.at(f, joint))).norm(), 0.03) << id << " frame " << f;
      ++met;
    }
    EXPECT_GT(met, 3) << id;
  }
}

}  // namespace
}  // namespace mocurate
