// A capture with keypoints of colour cameras and images of depth cameras is one clip.

#include <gmock/gmock.h>

#include "core/formats/png.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

class DepthBeside : public Layouts {
 protected:
  void SetUp() override {
    Layouts::SetUp();
    StudioOptions options = Perfect(StudioLayout::kOpenPoseDepth);
    options.subjects = 1;
    options.actions = {"throw"};
    options.rig.kind = RigKind::kPhspd;
    options.depth = DepthSensorOptions{true, false, 0, 0.001, 0, 0, 0, 0, 8};
    Write(options);
    for (const auto& entry : std::filesystem::directory_iterator(folder / "openpose_depth")) {
      if (entry.is_directory()) take_ = entry.path();
    }
  }

  mocurate::Ingested Ingest(std::vector<std::string> assignments = {}) {
    assignments.push_back("ingest.path=" + (folder / "openpose_depth").string());
    const auto discovery = Discover(Declared("studio_keypoints_depth", assignments));
    if (!discovery) return {tl::unexpected<Error>(discovery.error()), {}, {}};
    EXPECT_TRUE(discovery->excluded.empty());
    return RunIngest(discovery->items.at(0), "depth_beside");
  }

  static std::vector<std::string> Codes(const Outcome& outcome) {
    std::vector<std::string> codes;
    for (const Finding& finding : outcome.findings) codes.push_back(finding.code);
    return codes;
  }

  std::filesystem::path take_;
};

TEST_F(DepthBeside, JoinsDepthAndKeypointsInOneClipAndWorldFrame) {
  const mocurate::Ingested ingested = Ingest();
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const Evidence& evidence = ingested.clip.evidence;
  ASSERT_EQ(evidence.keypoint_views.size(), 3u);
  ASSERT_EQ(evidence.depth_views.size(), 3u);
  const Motion& motion = truth.at(ingested.clip.id());
  const auto point = std::find(evidence.keypoint_names.begin(), evidence.keypoint_names.end(), "left_wrist");
  const auto wrist = static_cast<int>(point - evidence.keypoint_names.begin());
  for (const KeypointView& view : evidence.keypoint_views) {
    ASSERT_EQ(view.frames(), motion.frame_count());
    const double* detection = view.at(0, 0, wrist);
    const auto pixel = view.camera.ProjectWorld(motion.joints.at(0, *motion.skeleton->FindJoint("left_wrist")));
    if (detection[2] > 0.0) {
      EXPECT_LT((*pixel - Vector2d(detection[0], detection[1])).norm(), 30.0);
    }
  }
  for (const DepthView& view : evidence.depth_views) {
    ASSERT_EQ(static_cast<int>(view.files.size()), motion.frame_count());
    EXPECT_FALSE(view.files[8].empty());
    EXPECT_TRUE(view.files[9].empty()) << "no image for this frame";
    EXPECT_EQ(view.time_s, evidence.keypoint_views[0].time_s);
    const auto image = DecodeDepthPng(Bytes("openpose_depth/" + view.files[8].string()), "image");
    ASSERT_TRUE(image) << image.error().Message();
    const Vector3d pelvis = motion.joints.at(8, 0);
    const auto pixel = view.camera.ProjectWorld(pelvis);
    const double depth_m = image->values[static_cast<std::size_t>(std::lround(pixel->y())) * image->width +
                                         static_cast<std::size_t>(std::lround(pixel->x()))] *
                           view.metres_per_unit;
    EXPECT_NEAR(depth_m, (view.camera.camera_from_world * pelvis).z(), 0.25);
  }
  EXPECT_THAT(Codes(*ingested.outcome), ::testing::Each("depth_images_missing"))
      << "each camera has an image every eighth frame";
  EXPECT_EQ(ingested.outcome->findings.size(), 3u);
}

TEST_F(DepthBeside, WritesTheEstimatedNumberOfImages) {
  StudioOptions options = Perfect(StudioLayout::kOpenPoseDepth);
  options.subjects = 1;
  options.actions = {"throw"};
  options.rig.kind = RigKind::kPhspd;
  options.depth = DepthSensorOptions{true, false, 0, 0.001, 0, 0, 0, 0, 8};
  const auto estimate = EstimateStudioLayout(options, 1);
  const auto counts = WriteStudioLayout(options, FreshFolder("estimated"), 1);
  ASSERT_TRUE(estimate && counts);
  EXPECT_EQ(counts->images, estimate->images);
  EXPECT_GT(counts->files, 2 * counts->images) << "keypoint files are files but not images";
}

TEST_F(DepthBeside, ReportsMissingImagesAndKeepsTheKeypoints) {
  std::filesystem::remove_all(take_ / "depth");
  const mocurate::Ingested ingested = Ingest();
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_TRUE(ingested.clip.evidence.depth_views.empty());
  EXPECT_EQ(ingested.clip.evidence.keypoint_views.size(), 3u);
  EXPECT_THAT(Codes(*ingested.outcome), ::testing::Contains("depth_images_missing"));
}

TEST_F(DepthBeside, RejectsImageNumbersThatDoNotMatchTheKeypoints) {
  std::vector<std::filesystem::path> images;
  for (const auto& entry : std::filesystem::directory_iterator(take_ / "depth")) images.push_back(entry.path());
  for (const auto& image : images) {
    std::string name = image.filename().string();
    name[name.size() - 8] = '7';  // d1_0008.png -> d1_7008.png
    std::filesystem::rename(image, image.parent_path() / name);
  }
  const mocurate::Ingested ingested = Ingest();
  ExpectError(ingested.outcome, ErrorCode::kInconsistent, "throw_p01_r01/c1_json/c1.0000.json");
  EXPECT_THAT(ingested.outcome.error().Message(), HasSubstr(" 7000 "));
}

TEST_F(DepthBeside, RejectsAPatternWithoutACamera) {
  const mocurate::Ingested ingested = Ingest({"ingest.source.depth_files='depth_{frame}.png'"});
  ExpectError(ingested.outcome, ErrorCode::kConfig, "ingest.source.depth_files");
}

TEST_F(DepthBeside, ReadsFrameNumbersOfFixedWidth) {
  const mocurate::Ingested ingested =
      Ingest({"ingest.source.depth_files='{action}_p{person:2}_r{take:2}/depth/{camera}_{frame:4}.png'"});
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.evidence.depth_views.size(), 3u);
}

TEST_F(DepthBeside, RefusesTheClipAndNamesAnInvalidImage) {
  Put(take_ / "depth" / "d2_0000.png", "no picture");
  const mocurate::Ingested ingested = Ingest();
  ExpectError(ingested.outcome, ErrorCode::kMalformed, "throw_p01_r01/depth/d2_0000.png");
}

}  // namespace
}  // namespace mocurate
