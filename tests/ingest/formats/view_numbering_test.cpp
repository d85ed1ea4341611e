// Cameras of one recording whose files are numbered apart: no frame is invented between their numbers.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "ingest/checks/clip_checks.h"
#include "ingest/inspect/inspect.h"
#include "ingest/sources/frame_files.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/inspections.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

std::set<long long> NumberRange(long long begin, long long end, long long step = 1) {
  std::set<long long> numbers;
  for (long long n = begin; n < end; n += step) numbers.insert(n);
  return numbers;
}

TEST(ViewNumbers, AreComparedWithThoseOfMostCameras) {
  const auto apart =
      FindApartViews({{"a", NumberRange(440, 470)}, {"b", NumberRange(0, 30)}, {"c", NumberRange(0, 28)}});
  ASSERT_THAT(apart, SizeIs(1));
  EXPECT_EQ(apart[0].camera, "a");
  EXPECT_EQ(apart[0].other, "b");
  EXPECT_EQ(apart[0].offset(), 440);
  EXPECT_EQ(apart[0].shared, 0u);
  EXPECT_EQ(apart[0].shorter, 30u);
  EXPECT_THAT(FindApartViews({{"a", NumberRange(0, 30)}, {"b", NumberRange(16, 46)}}), SizeIs(1));
  EXPECT_THAT(FindApartViews({{"a", NumberRange(0, 30)}, {"b", NumberRange(15, 45)}}), IsEmpty());
  EXPECT_THAT(FindApartViews({{"a", NumberRange(0, 30)}, {"b", NumberRange(10, 40)}, {"c", NumberRange(20, 50)}}),
              IsEmpty())
      << "together through b";
  EXPECT_THAT(FindApartViews({{"a", NumberRange(0, 300)}, {"b", NumberRange(0, 300, 8)}}), IsEmpty())
      << "a slower camera";
  EXPECT_THAT(FindApartViews({{"a", NumberRange(0, 30)}, {"b", {}}}), IsEmpty());
  EXPECT_THAT(FindApartViews({{"a", NumberRange(0, 30)}, {"b", NumberRange(20, 50)}}, {"b"}), IsEmpty()) << "declared";
  EXPECT_THAT(FindApartViews({{"a", NumberRange(0, 30)}, {"b", NumberRange(40, 70)}}, {"b"}), SizeIs(1));
}

class Numbering : public Layouts {
 protected:
  void SetUp() override {
    Layouts::SetUp();
    StudioOptions options = Perfect(StudioLayout::kOpenPoseDepth);
    options.subjects = 1;
    options.actions = {"throw"};
    options.rig.kind = RigKind::kPhspd;
    options.depth = DepthSensorOptions{true, false, 0, 0.001, 0, 0, 0, 0, 8};
    Write(options);
    below_ = folder / "openpose_depth";
    frames_ = static_cast<int>(std::distance(fs::directory_iterator(Camera("c1")), fs::directory_iterator()));
  }

  fs::path Camera(const std::string& camera) const { return below_ / "throw_p01_r01" / (camera + "_json"); }

  /// Adds `offset` to the numbers of the files of a camera's keypoints, from `first` to `last`; others are removed.
  void Renumber(const std::string& camera, int offset, int first = 0, int last = 100000) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(Camera(camera))) files.push_back(entry.path());
    for (const fs::path& file : files) {
      const std::string stem = file.stem().string();
      const int number = std::stoi(stem.substr(stem.rfind('.') + 1));
      if (number < first || number > last) {
        fs::remove(file);
        continue;
      }
      fs::rename(file, file.parent_path() / ("_" + camera + "." + std::to_string(number + offset) + ".json"));
    }
    files.clear();
    for (const auto& entry : fs::directory_iterator(Camera(camera))) files.push_back(entry.path());
    for (const fs::path& file : files) fs::rename(file, file.parent_path() / file.filename().string().substr(1));
  }

  IngestOptions Options(std::vector<std::string> assignments = {}, const char* declaration = "studio_keypoints") {
    assignments.push_back("ingest.path=" + below_.string());
    assignments.push_back("ingest.source.other_files=ignore");
    return Declared(declaration, assignments);
  }

  mocurate::Ingested Run(const IngestOptions& options) {
    const auto discovery = Discover(options);
    if (!discovery) return {tl::unexpected<Error>(discovery.error()), {}, {}};
    return RunIngest(discovery->items.at(0), "numbering");
  }

  static std::vector<std::string> FoundCodes(const Outcome& outcome) {
    std::vector<std::string> codes;
    for (const Finding& finding : outcome.findings) codes.push_back(finding.code);
    return codes;
  }

  fs::path below_;
  int frames_ = 0;
};

TEST_F(Numbering, ApartIsRefusedUnlessTheFirstFrameIsDeclared) {
  Renumber("c2", 440);
  const mocurate::Ingested apart = Run(Options());
  ASSERT_FALSE(apart.outcome);
  EXPECT_EQ(FaultCode(apart.outcome.error(), "openpose"), "view_numbering");
  EXPECT_EQ(apart.outcome.error().number, 440.0);
  const mocurate::Ingested declared = Run(Options({"ingest.source.first_frame={c2: 440}"}));
  ASSERT_TRUE(declared.outcome) << declared.outcome.error().Message();
  EXPECT_EQ(FrameCount(declared.clip), frames_);
  EXPECT_THAT(FoundCodes(*declared.outcome), Not(Contains("frames_missing")));
  const mocurate::Ingested wrong = Run(Options({"ingest.source.first_frame={c2: 4}"}));
  EXPECT_FALSE(wrong.outcome) << "the declared number leaves the cameras apart";
  ExpectError(Discover(Options({"ingest.source.first_frame={c4: 440}"})), ErrorCode::kConfig,
              "ingest.source.first_frame");
  ExpectError(Discover(Options({"ingest.source.first_frame={c2: begin}"})), ErrorCode::kConfig,
              "ingest.source.first_frame");
}

TEST_F(Numbering, ApartIsInspectedWithAndWithoutADeclaration) {
  Renumber("c2", 440);
  for (const std::optional<SourceOptions>& source :
       {std::optional<SourceOptions>(), std::optional<SourceOptions>(Options().source)}) {
    const nlohmann::json inspection = InspectPath(below_, source);
    const auto found = FindingsOf(inspection, "view_numbering");
    ASSERT_FALSE(found.empty()) << inspection.at("findings").dump(1);
    EXPECT_EQ(found[0].at("value"), 440);
    EXPECT_THAT(found[0].at("message").get<std::string>(), ::testing::HasSubstr("c2"));
  }
}

TEST_F(Numbering, OfDepthImagesFollowsTheKeypoints) {
  for (const char* camera : {"c1", "c2", "c3"}) Renumber(camera, 440);
  const IngestOptions options = Options({}, "studio_keypoints_depth");
  const mocurate::Ingested apart = Run(options);
  ASSERT_FALSE(apart.outcome);
  EXPECT_EQ(FaultCode(apart.outcome.error(), "openpose"), "view_numbering");
  const mocurate::Ingested declared =
      Run(Options({"ingest.source.first_frame={c1: 440, c2: 440, c3: 440}"}, "studio_keypoints_depth"));
  ASSERT_TRUE(declared.outcome) << declared.outcome.error().Message();
  EXPECT_EQ(FrameCount(declared.clip), frames_);
  EXPECT_EQ(declared.clip.evidence.depth_views.size(), 3u);
}

TEST_F(Numbering, OfACameraThatBeginsLateKeepsAllFrames) {
  Renumber("c2", 0, 10);
  const mocurate::Ingested late = Run(Options());
  ASSERT_TRUE(late.outcome) << late.outcome.error().Message();
  EXPECT_EQ(FrameCount(late.clip), frames_);
  Renumber("c2", -10);
  const mocurate::Ingested restarted = Run(Options({"ingest.source.first_frame={c2: -10}"}));
  ASSERT_TRUE(restarted.outcome) << restarted.outcome.error().Message();
  EXPECT_EQ(FrameCount(restarted.clip), frames_) << "its frame 0 is the tenth of the others";
  const KeypointView &before = late.clip.evidence.keypoint_views[1], &after = restarted.clip.evidence.keypoint_views[1];
  EXPECT_EQ(before.values, after.values);
}

TEST_F(Numbering, ByAClockIsRefused) {
  for (const char* camera : {"c1", "c2", "c3"}) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(Camera(camera))) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (std::size_t f = 0; f < files.size(); ++f) {
      const long long ms = 8981000 + std::llround(1000.0 * static_cast<double>(f) / 30.0);
      fs::rename(files[f], Camera(camera) / (std::string(camera) + "." + std::to_string(ms) + ".json"));
    }
  }
  const mocurate::Ingested ingested = Run(Options());
  ASSERT_FALSE(ingested.outcome);
  EXPECT_EQ(FaultCode(ingested.outcome.error(), "openpose"), "layout_contradiction");
}

TEST_F(Numbering, OfAnUncalibratedCameraAddsNoFrames) {
  fs::create_directories(Camera("spare"));
  for (int f = 0; f < 200; ++f) {
    Put(Camera("spare") / ("spare." + std::to_string(f) + ".json"), "{\"people\": []}");
  }
  const mocurate::Ingested ingested = Run(Options());
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(FrameCount(ingested.clip), frames_);
  EXPECT_THAT(FoundCodes(*ingested.outcome), Contains("camera_not_calibrated"));
}

}  // namespace
}  // namespace mocurate
