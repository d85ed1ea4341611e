#include <gtest/gtest.h>

#include <algorithm>

#include "core/formats/depth_sequence.h"
#include "ingest/inspect/declaration_writer.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

class RenderedSequence : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }
};

TEST_F(RenderedSequence, IsReadAsOneClipOfThreeViewsAndFiveSegments) {
  const auto discovery = Discover(Declared("rendered_seq"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 1u);
  EXPECT_EQ(discovery->items[0].item, "rendered_seq/male/seq_male");
  EXPECT_EQ(discovery->items[0].inputs.size(), 1u + 3 * 48);
  const Ingested ingested = RunIngest(discovery->items[0], "rendered");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const Clip& clip = ingested.clip;
  EXPECT_EQ(clip.id(), "rendered_seq/male/seq_male#0-48");
  EXPECT_EQ(clip.rate, (FrameRate{12, 1}));
  ASSERT_EQ(clip.evidence.depth_views.size(), 3u);
  const DepthView& view = clip.evidence.depth_views[1];
  EXPECT_EQ(view.camera.name, "d2");
  EXPECT_EQ(view.camera.width, 512);
  EXPECT_EQ(view.files[47].string(), "depth/d2_0047.png");
  EXPECT_EQ(view.sha256[47].size(), 64u);
  EXPECT_DOUBLE_EQ(view.metres_per_unit, 0.001);
  ASSERT_EQ(clip.segments.size(), 5u);
  EXPECT_EQ(clip.segments[1].label, "wave_right_hand");
  EXPECT_EQ(clip.segments[1].origin, "annotated");
  EXPECT_DOUBLE_EQ(clip.segments[1].begin_s, 0.5);
  EXPECT_DOUBLE_EQ(clip.segments[1].end_s, 23.0 / 12.0);
}

TEST_F(RenderedSequence, ProjectsTheGroundTruthIntoEveryView) {
  const auto discovery = Discover(Declared("rendered_seq"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->truth.size(), 1u);
  const Ingested ingested = RunIngest(discovery->items[0], "rendered_views");
  ASSERT_TRUE(ingested.outcome);
  StageRequest request;
  request.item = discovery->truth[0].item;
  request.options = discovery->truth[0].options.Whole();
  request.inputs = discovery->truth[0].inputs;
  request.output = SharedScratch("truth.h5");
  const auto outcome = TruthStage(request);
  ASSERT_TRUE(outcome) << outcome.error().Message();
  const auto truth = ReadTruth(request.output);
  ASSERT_TRUE(truth) << truth.error().Message();
  const Motion& motion = truth->motion.at(ingested.clip.id());
  const Status whole = motion.Check();
  EXPECT_TRUE(whole) << whole.error().Message();
  EXPECT_EQ(motion.skeleton->name, "smpl24");

  const auto bytes = ReadFile(discovery->truth[0].inputs[0].path);
  const auto raw = ParseDepthSequenceTruth(*bytes, "x");
  const auto sequence = ParseDepthSequence(*bytes, "x");
  ASSERT_TRUE(raw && sequence);
  double worst = 0.0;
  for (int f = 0; f < motion.frame_count(); ++f) {
    // y up: the head is above the pelvis; facing the sensor: the left hip is at +x.
    EXPECT_GT(motion.joints.at(f, 15).y(), motion.joints.at(f, 0).y());
    EXPECT_GT(motion.joints.at(f, 1).x(), motion.joints.at(f, 2).x());
    for (int j = 0; j < 24; ++j) {
      for (int v = 0; v < 3; ++v) {
        const Camera& camera = ingested.clip.evidence.depth_views[v].camera;
        const Vector3d here = camera.camera_from_world * motion.joints.at(f, j);
        const Vector3d there = sequence->views[v].camera_from_rig * raw->joint[f * 24 + j];
        worst = std::max(worst, (here - there).norm());
        EXPECT_TRUE(camera.ProjectWorld(motion.joints.at(f, j)).has_value());
      }
    }
  }
  EXPECT_LT(worst, 1e-5);
}

TEST_F(RenderedSequence, RefusesAMissingDepthImage) {
  auto discovery = Discover(Declared("rendered_seq"));
  ASSERT_TRUE(discovery);
  std::vector<StageInput>& inputs = discovery->items[0].inputs;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].name == "depth/d3_0010.png") inputs.erase(inputs.begin() + static_cast<std::ptrdiff_t>(i));
  }
  ExpectError(RunIngest(discovery->items[0], "rendered_gap").outcome, ErrorCode::kNotFound, "seq_male.json");
}

TEST_F(RenderedSequence, KeepsTheTimeOfAViewThatStartsLater) {
  auto discovery = Discover(Declared("rendered_seq"));
  ASSERT_TRUE(discovery);
  std::vector<StageInput>& inputs = discovery->items[0].inputs;
  const auto first = std::find_if(inputs.begin(), inputs.end(),
                                  [](const StageInput& input) { return input.name == "depth/d2_0000.png"; });
  ASSERT_NE(first, inputs.end());
  inputs.erase(first);
  ExpectError(RunIngest(discovery->items[0], "rendered_late").outcome, ErrorCode::kNotFound, "seq_male.json");
}

TEST_F(RenderedSequence, ChangesTheEvidenceHashWithADepthImage) {
  auto discovery = Discover(Declared("rendered_seq"));
  ASSERT_TRUE(discovery);
  const Ingested once = RunIngest(discovery->items[0], "rendered_once");
  const Ingested again = RunIngest(discovery->items[0], "rendered_again");
  ASSERT_TRUE(once.outcome && again.outcome);
  EXPECT_EQ(once.clip.evidence_sha256.size(), 64u);
  EXPECT_EQ(once.clip.evidence_sha256, again.clip.evidence_sha256);

  std::vector<StageInput>& inputs = discovery->items[0].inputs;
  const std::filesystem::path other = FreshFolder("other_image") / "changed.png";
  for (StageInput& input : inputs) {
    if (input.name != "depth/d1_0007.png") continue;
    std::filesystem::copy_file(inputs.back().path, other);
    input.path = other;
    input.sha256.clear();
  }
  const Ingested changed = RunIngest(discovery->items[0], "rendered_changed");
  ASSERT_TRUE(changed.outcome) << changed.outcome.error().Message();
  EXPECT_NE(once.clip.evidence_sha256, changed.clip.evidence_sha256);
}

/// Two takes of the rendered sequence: JSON files at `json`, images at `images`, below a folder.
std::filesystem::path TwoTakes(const std::string& name, const std::vector<std::string>& json,
                               const std::vector<std::string>& images) {
  const std::filesystem::path from = TestData() + "/clouds/rendered_seq", folder = FreshFolder(name);
  for (const std::string& file : json) Put(folder / file, *ReadFile(from / "seq_male.json"));
  for (const std::string& below : images) {
    std::filesystem::create_directories((folder / below).parent_path());
    std::filesystem::copy(from / "depth", folder / below);
  }
  return folder;
}

TEST_F(RenderedSequence, DeclaresTheImagesOfEachOfTwoTakes) {
  const std::vector<std::string> in_folders = {"p01/seq_p01.json", "p02/seq_p02.json"};
  const auto beside = EstimateDepthFiles(TwoTakes("beside", in_folders, {"p01/depth", "p02/depth"}), in_folders,
                                         "p{person}/seq_p{person2}.json");
  ASSERT_TRUE(beside) << beside.error().Message();
  EXPECT_EQ(*beside, "p{person}/depth/{view}_{frame:4}.png");
  const std::vector<std::string> in_one_folder = {"json/seq_p01.json", "json/seq_p02.json"};
  const auto apart = EstimateDepthFiles(TwoTakes("apart", in_one_folder, {"images/p01", "images/p02"}), in_one_folder,
                                        "json/seq_p{person}.json");
  ASSERT_TRUE(apart) << apart.error().Message();
  EXPECT_EQ(*apart, "images/p{person}/{view}_{frame:4}.png");
  const std::filesystem::path shared = TwoTakes("shared", in_one_folder, {"images"});
  ExpectError(EstimateDepthFiles(shared, in_one_folder, "json/seq_p{person}.json"), ErrorCode::kInconsistent,
              "json/seq_p{person}.json");
}

TEST_F(RenderedSequence, RejectsTwoTakesThatDeclareTheSameImages) {
  const std::filesystem::path folder =
      TwoTakes("claimed", {"p01/seq_p01.json", "p02/seq_p02.json"}, {"p01/depth", "p02/depth"});
  IngestOptions options = Declared("rendered_seq", {"ingest.path=" + folder.string()});
  ASSERT_TRUE(Discover(options));
  options.source.depth_files = "p01/depth/{view}_{frame:4}.png";
  ExpectError(Discover(options), ErrorCode::kConfig, "ingest.source.depth_files");
}

TEST_F(RenderedSequence, RejectsLeftHandedAxes) {
  ExpectError(IngestOnly(Declared("rendered_seq", {"ingest.source.axes='+x -y +z'"}), "rendered_left"),
              ErrorCode::kConfig, "ingest.source.axes");
}

}  // namespace
}  // namespace mocurate
