// Keypoints of several calibrated cameras as evidence: the Pose2Sim demo, and small recordings with one defect.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/formats/openpose.h"
#include "ingest/inspect/inspect.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/sources.h"
#include "tests/support/linear_triangulation.h"

namespace mocurate {
namespace {

class Pose2Sim : public ::testing::Test {
 protected:
  void SetUp() override {
    if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }
};

const ItemSpec* Find(const Discovery& discovery, const std::string& item) {
  for (const ItemSpec& candidate : discovery.items) {
    if (candidate.item == item) return &candidate;
  }
  ADD_FAILURE() << "no item " << item;
  return nullptr;
}

std::vector<std::string> CodesOfOutcome(const Outcome& outcome) {
  std::vector<std::string> codes;
  for (const Finding& finding : outcome.findings) codes.push_back(finding.code);
  return codes;
}

int DetectedPeople(const KeypointView& view, int frame) {
  int detected = 0;
  for (int p = 0; p < view.people; ++p) {
    bool any = false;
    for (int k = 0; k < view.points(); ++k) any = any || view.at(frame, p, k)[2] > 0.0;
    detected += any ? 1 : 0;
  }
  return detected;
}

TEST_F(Pose2Sim, ReadsARecordingAsOneClipOfAllCameras) {
  const auto discovery = Discover(Declared("pose2sim_single"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 1u);
  EXPECT_TRUE(discovery->excluded.empty());
  const ItemSpec* item = Find(*discovery, "pose2sim/p1/single");
  ASSERT_NE(item, nullptr);
  const Ingested ingested = RunIngest(*item, "pose2sim_single");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_TRUE(CodesOfOutcome(*ingested.outcome).empty()) << ingested.outcome->findings[0].message;
  const Clip& clip = ingested.clip;
  EXPECT_EQ(clip.id(), "pose2sim/p1/single#0-80");
  EXPECT_EQ(clip.rate, (FrameRate{60, 1}));
  const Evidence& evidence = clip.evidence;
  EXPECT_EQ(evidence.subject, 0);
  ASSERT_EQ(evidence.keypoint_names.size(), 25u);
  EXPECT_EQ(evidence.keypoint_names[13], "left_knee");
  ASSERT_EQ(evidence.keypoint_views.size(), 4u);
  EXPECT_EQ(evidence.keypoint_views[0].people, 3);
  EXPECT_EQ(evidence.keypoint_views[3].people, 1);
  for (const KeypointView& view : evidence.keypoint_views) {
    EXPECT_EQ(view.frames(), 80);
    EXPECT_EQ(view.camera.width, 1088);
    EXPECT_GT(view.camera.Centre().y(), 1.5) << "the cameras are above the floor, y up";
  }
}

/// Median and 90th percentile in px, and share of points, of the subject (the first entry, by the README of the set).
/// Each point is triangulated from the best set of three or four cameras.
struct Reprojection {
  double median = 0.0;
  double p90 = 0.0;
  double share = 0.0;
};

Reprojection Reproject(const Evidence& evidence, int frames) {
  std::vector<double> errors;
  int points = 0;
  for (int f = 0; f < frames; ++f) {
    for (std::size_t k = 0; k < evidence.keypoint_names.size(); ++k) {
      std::vector<ImageObservation> observations;
      for (const KeypointView& view : evidence.keypoint_views) {
        const double* v = view.at(f, 0, static_cast<int>(k));
        if (v[2] > 0.0) observations.push_back({&view.camera, Vector2d(v[0], v[1]), 1.0});
      }
      std::vector<double> best;
      double least = 30.0;
      for (std::size_t out = 0; out <= observations.size() && observations.size() >= 3; ++out) {
        std::vector<ImageObservation> used = observations;
        if (out < observations.size()) used.erase(used.begin() + static_cast<std::ptrdiff_t>(out));
        if (used.size() < 3) continue;
        const auto point = TriangulateLinear(used);
        if (!point) continue;
        std::vector<double> own;
        for (const ImageObservation& observation : used)
          own.push_back(ReprojectionError(observation, *point).value_or(1e3));
        const double worst = *std::max_element(own.begin(), own.end());
        if (worst < least) least = worst, best = own;
      }
      points += best.empty() ? 0 : 1;
      errors.insert(errors.end(), best.begin(), best.end());
    }
  }
  std::sort(errors.begin(), errors.end());
  if (errors.empty()) return {};
  return {errors[errors.size() / 2], errors[errors.size() * 9 / 10], points / (25.0 * frames)};
}

TEST_F(Pose2Sim, TriangulatesTheSubjectConsistently) {
  // README_multiview.md, section 6: median <= 8.5 px, p90 <= 17 px, >= 79 % of all joints.
  const auto discovery = Discover(Declared("pose2sim_single"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const Ingested ingested = RunIngest(*Find(*discovery, "pose2sim/p1/single"), "pose2sim_dlt");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const Reprojection found = Reproject(ingested.clip.evidence, 80);
  EXPECT_LT(found.median, 8.5);
  EXPECT_LT(found.p90, 17.0);
  EXPECT_GT(found.share, 0.75);
}

TEST_F(Pose2Sim, ReadsTheSameCamerasFromEveryCalibrationDialect) {
  std::vector<Camera> first;
  for (const std::string calibration :
       {"[Calib.qca.txt]", "[Calib_converted.toml]", "[calib_converted.json]", "[intri.yml, extri.yml]"}) {
    IngestOptions options = Declared("pose2sim_static", {"ingest.source.calibration=" + calibration});
    const std::filesystem::path folder = FreshFolder("dialects");
    for (const char* name : {"Calib.qca.txt", "Calib_converted.toml", "calib_converted.json"}) {
      std::filesystem::copy_file(options.path / name, folder / name);
    }
    for (const char* name : {"intri.yml", "extri.yml"}) {
      std::filesystem::copy_file(options.path.parent_path() / "cameras" / "opencv_yml" / name, folder / name);
    }
    std::filesystem::copy(options.path / "static_p1", folder / "static_p1", std::filesystem::copy_options::recursive);
    options.path = folder;
    const auto discovery = Discover(options);
    ASSERT_TRUE(discovery) << discovery.error().Message();
    const Ingested ingested = RunIngest(discovery->items.at(0), "dialect");
    ASSERT_TRUE(ingested.outcome) << calibration << ": " << ingested.outcome.error().Message();
    ASSERT_EQ(ingested.clip.evidence.keypoint_views.size(), 4u) << calibration;
    std::vector<Camera> cameras;
    for (const KeypointView& view : ingested.clip.evidence.keypoint_views) cameras.push_back(view.camera);
    if (first.empty()) first = cameras;
    for (std::size_t c = 0; c < 4; ++c) {
      const Vector3d point(0.2, 1.1, -1.3);
      EXPECT_LT((*cameras[c].ProjectWorld(point) - *first[c].ProjectWorld(point)).norm(), 1e-3) << calibration;
    }
  }
}

TEST_F(Pose2Sim, ReadsStaticTrialsAsOnePersonEach) {
  const auto discovery = Discover(Declared("pose2sim_static"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 2u);
  for (const ItemSpec& item : discovery->items) {
    const Ingested ingested = RunIngest(item, "static");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_TRUE(CodesOfOutcome(*ingested.outcome).empty()) << ingested.outcome->findings[0].message;
    ASSERT_EQ(ingested.clip.evidence.keypoint_views.size(), 4u);
    for (const KeypointView& view : ingested.clip.evidence.keypoint_views) EXPECT_EQ(view.people, 1);
    EXPECT_EQ(ingested.clip.identity.end_frame, 12);
  }
}

TEST_F(Pose2Sim, ReadsTwoPeopleAsTwoClipsOfTheSameViews) {
  const auto discovery = Discover(Declared("pose2sim_two"));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 2u);
  const Ingested a = RunIngest(*Find(*discovery, "pose2sim_two/pa/two"), "two_a");
  const Ingested b = RunIngest(*Find(*discovery, "pose2sim_two/pb/two"), "two_b");
  ASSERT_TRUE(a.outcome) << a.outcome.error().Message();
  ASSERT_TRUE(b.outcome) << b.outcome.error().Message();
  EXPECT_EQ(a.clip.evidence.subject, 0);
  EXPECT_EQ(b.clip.evidence.subject, 1);
  ASSERT_EQ(a.clip.evidence.keypoint_views.size(), 4u);
  double least_u = 0.0;
  for (std::size_t v = 0; v < 4; ++v) {
    const KeypointView& view = a.clip.evidence.keypoint_views[v];
    EXPECT_EQ(view.values, b.clip.evidence.keypoint_views[v].values);
    for (std::size_t i = 0; i < view.values.size(); i += 3) least_u = std::min(least_u, view.values[i]);
  }
  EXPECT_LT(least_u, 0.0) << "points outside the image are kept as detected";
  // Frame 1 of cam01 lists a person without keypoints.
  const std::string name = "two/cam01_json/cam01.0001.json";
  const auto listed = ParseOpenPose(*ReadFile(Declared("pose2sim_two").path / name), name);
  ASSERT_TRUE(listed) << listed.error().Message();
  EXPECT_EQ(DetectedPeople(a.clip.evidence.keypoint_views[0], 1) + 1, static_cast<int>(listed->people.size()));
  EXPECT_THAT(CodesOfOutcome(*a.outcome), ::testing::Not(::testing::Contains("keypoint_count")));
}

TEST_F(Pose2Sim, ReportsRotatedCamerasAsAContradiction) {
  const auto discovery = Discover(Declared("pose2sim_single", {"ingest.source.axes='+x +y +z'"}));
  ASSERT_TRUE(discovery);
  const Ingested ingested = RunIngest(*Find(*discovery, "pose2sim/p1/single"), "sideways");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_THAT(CodesOfOutcome(*ingested.outcome), ::testing::Contains("up_contradiction"));
}

/// The first frames of a trial in a test folder.
class BrokenRecording : public Pose2Sim {
 protected:
  void SetUp() override {
    Pose2Sim::SetUp();
    if (IsSkipped()) return;
    options_ = Declared("pose2sim_single");
    const std::filesystem::path from = options_.path;
    folder_ = FreshFolder("broken");
    for (const char* camera : {"cam01", "cam02", "cam03", "cam04"}) {
      for (const char* frame : {"0000", "0001", "0002", "0003"}) {
        const std::string name = "single/" + std::string(camera) + "_json/" + camera + "." + frame + ".json";
        std::filesystem::create_directories((folder_ / name).parent_path());
        std::filesystem::copy_file(from / name, folder_ / name);
      }
    }
    std::filesystem::copy_file(from / "Calib.qca.txt", folder_ / "Calib.qca.txt");
    options_.path = folder_;
  }

  Ingested Ingest(const std::string& name) {
    const auto discovery = Discover(options_);
    if (!discovery) return {tl::unexpected<Error>(discovery.error()), {}, {}};
    return RunIngest(discovery->items.at(0), name);
  }

  IngestOptions options_;
  std::filesystem::path folder_;
};

TEST_F(BrokenRecording, DropsOnlyTheFrameOfTheViewWithAnUnreadableFile) {
  std::filesystem::remove(folder_ / "single/cam02_json/cam02.0001.json");
  Put(folder_ / "single/cam03_json/cam03.0002.json", "{\"people\": [{\"pose_keypoints_2d\": [1, 2");
  const Ingested ingested = Ingest("broken_frames");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_THAT(CodesOfOutcome(*ingested.outcome), ::testing::ElementsAre("frames_missing", "unreadable_frames"));
  EXPECT_EQ(ingested.outcome->findings[0].frame_begin, 1);
  EXPECT_EQ(ingested.outcome->findings[1].frame_begin, 2);
  const auto& views = ingested.clip.evidence.keypoint_views;
  ASSERT_EQ(views.size(), 4u);
  const auto detects = [&](int view, int frame) {
    return DetectedPeople(views[static_cast<std::size_t>(view)], frame) > 0;
  };
  EXPECT_FALSE(detects(1, 1));
  EXPECT_FALSE(detects(2, 2));
  EXPECT_TRUE(detects(1, 2)) << "later frames keep their time";
  EXPECT_TRUE(detects(2, 3));
  EXPECT_EQ(ingested.clip.id(), "pose2sim/p1/single#0-4");
}

TEST_F(BrokenRecording, CountsPointsWithoutConfidenceAsUndetected) {
  for (const char* name : {"single/cam02_json/cam02.0001.json", "single/cam02_json/cam02.0002.json"}) {
    auto document = nlohmann::json::parse(*ReadFile(folder_ / name));
    nlohmann::json& points = document["people"][0]["pose_keypoints_2d"];
    ASSERT_GT(points[2].get<double>(), 0.0);
    points[2] = 0.0;
    Put(folder_ / name, document.dump());
  }
  const Ingested ingested = Ingest("uncertain_points");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_THAT(CodesOfOutcome(*ingested.outcome), ::testing::ElementsAre("uncertain_points"));
  EXPECT_EQ(ingested.outcome->findings[0].value, 2.0);
  std::vector<nlohmann::json> findings;
  const nlohmann::json inspection = InspectPath(folder_, std::nullopt);
  for (const nlohmann::json& finding : inspection.at("findings")) {
    if (finding.at("code") == "uncertain_points") findings.push_back(finding);
  }
  ASSERT_EQ(findings.size(), 1u) << inspection.at("findings").dump(1);
  EXPECT_EQ(findings[0].at("value"), 2.0);
}

TEST_F(BrokenRecording, CountsPointsThatAreNoNumbersAsUndetected) {
  const std::filesystem::path file = folder_ / "single/cam02_json/cam02.0001.json";
  auto document = nlohmann::json::parse(*ReadFile(file));
  document["people"][0]["pose_keypoints_2d"][0] = nullptr;
  Put(file, document.dump());
  EXPECT_THAT(CodesOfOutcome(*Ingest("not_finite").outcome), ::testing::ElementsAre("keypoints_not_finite"));
}

TEST_F(BrokenRecording, ReportsNumbersOutOfRangeInRunAndInspect) {
  const auto change = [&](const auto& of_point) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "single")) {
      if (entry.path().extension() != ".json") continue;
      OpenPoseFrame frame = *ParseOpenPose(*ReadFile(entry.path()), "frame");
      for (OpenPosePerson& person : frame.people) {
        for (DetectedKeypoint& point : person.pose) of_point(point);
      }
      Put(entry.path(), WriteOpenPose(frame));
    }
  };
  const auto inspect_and_run = [&](const std::string& code) {
    const Ingested ingested = Ingest("range");
    ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
    EXPECT_THAT(CodesOfOutcome(*ingested.outcome), ::testing::Contains(code));
    bool found = false;
    const nlohmann::json inspection = InspectPath(folder_, std::nullopt);
    for (const nlohmann::json& finding : inspection.at("findings")) found = found || finding.at("code") == code;
    EXPECT_TRUE(found) << code;
  };
  change([](DetectedKeypoint& point) { point.confidence *= 100.0; });
  inspect_and_run("confidence_range");
  change([](DetectedKeypoint& point) {
    point.confidence /= 100.0;
    point.u_px /= 1088.0, point.v_px /= 1920.0;
  });
  inspect_and_run("keypoints_not_pixels");
}

TEST_F(BrokenRecording, RejectsAFrameOfMoreThanAHundredPeople) {
  const std::string name = "single/cam03_json/cam03.0002.json";
  auto frame = ParseOpenPose(*ReadFile(folder_ / name), name);
  ASSERT_TRUE(frame) << frame.error().Message();
  const OpenPosePerson person = frame->people.at(0);
  frame->people.assign(100, person);
  Put(folder_ / name, WriteOpenPose(*frame));
  const Ingested hundred = Ingest("hundred");
  ASSERT_TRUE(hundred.outcome) << hundred.outcome.error().Message();
  EXPECT_THAT(CodesOfOutcome(*hundred.outcome), ::testing::IsEmpty());
  EXPECT_EQ(hundred.clip.evidence.keypoint_views.at(2).people, 100);
  frame->people.push_back(person);
  Put(folder_ / name, WriteOpenPose(*frame));
  const Ingested crowd = Ingest("crowd");
  ASSERT_TRUE(crowd.outcome) << crowd.outcome.error().Message();
  ASSERT_THAT(CodesOfOutcome(*crowd.outcome), ::testing::ElementsAre("unreadable_frames"));
  EXPECT_EQ(crowd.outcome->findings[0].frame_begin, 2);
  EXPECT_LT(crowd.clip.evidence.keypoint_views.at(2).people, 10);
  EXPECT_EQ(DetectedPeople(crowd.clip.evidence.keypoint_views.at(2), 2), 0);
}

TEST_F(BrokenRecording, NamesCamerasWithoutPartners) {
  std::filesystem::rename(folder_ / "single/cam04_json", folder_ / "single/gopro_json");
  for (const char* frame : {"0000", "0001", "0002", "0003"}) {
    std::filesystem::rename(folder_ / ("single/gopro_json/cam04." + std::string(frame) + ".json"),
                            folder_ / ("single/gopro_json/gopro." + std::string(frame) + ".json"));
  }
  const Ingested ingested = Ingest("partners");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_THAT(CodesOfOutcome(*ingested.outcome),
              ::testing::ElementsAre("camera_not_calibrated", "camera_without_files"));
  for (const Finding& finding : ingested.outcome->findings) EXPECT_EQ(finding.value, 1.0) << finding.code;
  EXPECT_EQ(ingested.clip.evidence.keypoint_views.size(), 3u);
  options_.source.cameras = {{"gopro", "cam_04"}};
  const Ingested paired = Ingest("partners_reported");
  ASSERT_TRUE(paired.outcome) << paired.outcome.error().Message();
  EXPECT_EQ(paired.clip.evidence.keypoint_views.size(), 4u);
  EXPECT_TRUE(CodesOfOutcome(*paired.outcome).empty());
}

TEST_F(BrokenRecording, RefusesTheClipWithAnUnreadableCalibration) {
  Put(folder_ / "Calib.qca.txt", "<calibration><cameras><camera serial=\"cam_01\">");
  ExpectMalformed(Ingest("calibration_broken").outcome, "Calib.qca.txt:1");
  std::filesystem::remove(folder_ / "Calib.qca.txt");
  ExpectError(Discover(options_), ErrorCode::kNotFound, folder_.string());
}

TEST_F(BrokenRecording, ReportsMoreDeclaredPeopleThanDetected) {
  options_.source.subjects = 5;
  options_.source.person = "p{body}";
  const Ingested ingested = Ingest("five_people");
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_THAT(CodesOfOutcome(*ingested.outcome), ::testing::ElementsAre("people_missing"));
}

TEST_F(BrokenRecording, IgnoresAFileWithAnOutlyingFrameNumber) {
  std::filesystem::copy_file(folder_ / "single/cam01_json/cam01.0000.json",
                             folder_ / "single/cam01_json/cam01.20240101.json");
  ExpectError(Ingest("far_number").outcome, ErrorCode::kInconsistent, "single/cam01_json/cam01.0000.json");
}

TEST_F(BrokenRecording, RejectsDeclarationsThatDoNotIdentifyAClip) {
  options_.source.recording = "{file}";
  ExpectError(Discover(options_), ErrorCode::kConfig, "ingest.source.recording");
  options_.source.recording = "single";
  options_.source.keypoints = "BODY_25C";
  ExpectError(Discover(options_), ErrorCode::kConfig, "ingest.source.keypoints");
  options_.source.keypoints = "measured";
  options_.source.subjects = 2;
  ExpectError(Discover(options_), ErrorCode::kConfig, "ingest.source.bodies");
  options_.source.subjects = 1;
  options_.source.calibration.clear();
  ExpectError(Discover(options_), ErrorCode::kConfig, "ingest.source.calibration");
}

}  // namespace
}  // namespace mocurate
