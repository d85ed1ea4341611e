// Bodies are fitted to cloud files as to the depth images that the clouds come from.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/formats/point_cloud.h"
#include "core/store/store.h"
#include "fitting/clouds/cloud_proportions.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/depth_normals.h"
#include "fitting/clouds/fit_clouds.h"
#include "fitting/clouds/person_points.h"
#include "fitting/stages.h"
#include "ingest/discover.h"
#include "ingest/stages.h"
#include "tests/fitting/back_project.h"
#include "tests/fitting/cloud_takes.h"
#include "tests/fitting/fit_score.h"
#include "tests/support/cloud_writers.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

const double kVoxel = PointCloudOptions().voxel_size;

using ::testing::HasSubstr;

std::filesystem::path FolderOfClouds() {
  const std::filesystem::path folder = SharedScratch("cloud_files");
  std::filesystem::create_directories(folder);
  return folder;
}

/// Clouds of the world, metres, in files with their own axes and unit.
class CloudWriter {
 public:
  CloudWriter(std::string name, double metres_per_unit, const RigidTransform& world_from_file = Turned())
      : name_(std::move(name)) {
    files_.metres_per_unit = metres_per_unit;
    files_.world_from_file = world_from_file;
  }
  static RigidTransform Turned() { return {ExpQuaternion(Vector3d(1.2, 0.4, -0.3)), Vector3d(0.4, -1.0, 2.0)}; }

  void Add(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& normals, double time_s) {
    PlyElement vertex{"vertex", static_cast<std::size_t>(points.cols()), {}};
    const RigidTransform file_from_world = Inverse(files_.world_from_file);
    const double side = files_.metres_per_unit < 0.0 ? -1.0 : 1.0;
    for (int a = 0; a < 3; ++a) AddColumn({"xyz"[a]}, vertex);
    for (int a = 0; a < 3 && normals.cols() > 0; ++a) AddColumn({'n', "xyz"[a]}, vertex);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const Vector3d point = (file_from_world * Vector3d(points.col(i))) / files_.metres_per_unit;
      for (int a = 0; a < 3; ++a) vertex.properties[a].values.push_back(static_cast<float>(point[a]));
      if (normals.cols() == 0) continue;
      const Vector3d normal = side * (file_from_world.rotation * Vector3d(normals.col(i)));
      for (int a = 0; a < 3; ++a) vertex.properties[3 + a].values.push_back(static_cast<float>(normal[a]));
    }
    Ply ply;
    ply.encoding = Ply::Encoding::kBinaryLittleEndian;
    ply.elements = {std::move(vertex)};
    const std::string bytes = WritePly(ply);
    files_.files.push_back(FolderOfClouds() / (name_ + std::to_string(files_.files.size()) + ".ply"));
    EXPECT_TRUE(WriteFile(files_.files.back(), bytes));
    files_.sha256.push_back(Sha256Hex(bytes));
    files_.time_s.push_back(time_s);
  }

  const CloudFiles& files() const { return files_; }

 private:
  static void AddColumn(const std::string& name, PlyElement& vertex) {
    vertex.properties.push_back({name, kFloat32, {}, {}, {}});
  }

  std::string name_;
  CloudFiles files_;
};

/// All measured points of all views, without normals.
CloudFiles RawClouds(const std::vector<DepthView>& views, const std::string& name, double metres_per_unit) {
  CloudWriter writer(name, metres_per_unit);
  for (std::size_t f = 0; f < views[0].files.size(); ++f) {
    Eigen::Matrix3Xd points(3, 0);
    for (const DepthView& view : views) {
      const Eigen::Matrix3Xd of_view = BackProject(view, static_cast<int>(f)).value();
      points.conservativeResize(3, points.cols() + of_view.cols());
      points.rightCols(of_view.cols()) = of_view;
    }
    writer.Add(points, Eigen::Matrix3Xd(3, 0), views[0].time_s[f]);
  }
  return writer.files();
}

/// Points as scanning programs export them: one point per centimetre, with normals.
CloudFiles ScannedClouds(const std::vector<DepthView>& views, const std::string& name,
                         const RigidTransform& world_from_file = CloudWriter::Turned()) {
  CloudWriter writer(name, -0.01, world_from_file);
  for (std::size_t f = 0; f < views[0].files.size(); ++f) {
    const FusedCloud cloud = FuseViews(views, static_cast<int>(f), 0.01).value();
    writer.Add(cloud.points, cloud.normals, views[0].time_s[f]);
  }
  return writer.files();
}

TEST(CloudFiles, ThinningKeepsEmptyAndSmallClouds) {
  FusedCloud nothing{Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xd(3, 0), 0};
  EstimateNormals(Eigen::Matrix3Xd::Zero(3, 2), 0.02, nothing);
  EXPECT_EQ(nothing.size(), 0);
  for (const int count : {0, 1, 3}) {
    std::vector<Vector3d> points;
    for (int i = 0; i < count; ++i) points.emplace_back(0.5 * i, 1.0, 2.0 * i * i);
    const auto fused = FusePoints(points, {}, 0.02);
    ASSERT_TRUE(fused) << fused.error().Message();
    EXPECT_LE(fused->size(), count);
    EXPECT_TRUE(fused->normals.allFinite());
  }
}

/// The people of two of the studio's clips, as PHSPD's depth cameras see them.
class CloudFilesOfStudio : public ::testing::Test {
 protected:
  static std::vector<CloudTake> Takes(int clips, int frames, bool room) {
    CloudTakeOptions options;
    options.seed = 811;
    options.subjects = 1;
    options.clips = clips;
    options.frames = frames;
    options.room = room;
    return CloudTakes(options, FolderOfClouds() / (room ? "room" : "person"));
  }
  static void SetUpTestSuite() { takes_ = Takes(2, 5, false); }
  static void TearDownTestSuite() {
    takes_.clear();
    std::filesystem::remove_all(FolderOfClouds());
  }
  void SetUp() override {
    if (takes_.empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
    skeleton_ = *LoadSkeleton("smpl24");
    options_.solver = PoseSolver::kBanded;
  }

  static std::vector<Clip> Clips(const std::function<void(const CloudTake&, Evidence&)>& evidence_of) {
    std::vector<Clip> clips;
    for (const CloudTake& take : takes_) {
      clips.emplace_back();
      clips.back().rate = take.clip.truth.rate;
      evidence_of(take, clips.back().evidence);
    }
    return clips;
  }

  /// Joint errors of fits with this body, mm.
  double Error(const std::vector<Clip>& clips, const BodyFromClouds& body) {
    FitScore score;
    for (std::size_t i = 0; i < clips.size(); ++i) {
      PointCloudOptions options = options_;
      options.start.facing = takes_[i].reported_heading;
      const auto fit = FitClouds(clips[i], body.skeleton, body.bone_length, options);
      EXPECT_TRUE(fit) << fit.error().Message();
      if (fit) score.Add(*fit, takes_[i].clip);
    }
    return score.joint_mm();
  }

  static std::vector<CloudTake> takes_;
  SkeletonPtr skeleton_;
  PointCloudOptions options_;
};

std::vector<CloudTake> CloudFilesOfStudio::takes_;

/// Share of normals that agree with the nearest points of another cloud.
double FacingAs(const FusedCloud& other, const FusedCloud& cloud) {
  double agree = 0.0;
  for (int i = 0; i < cloud.size(); ++i) {
    Eigen::Index nearest = 0;
    (other.points.colwise() - cloud.points.col(i)).colwise().squaredNorm().minCoeff(&nearest);
    agree += cloud.normals.col(i).dot(other.normals.col(nearest)) > 0.0 ? 1.0 : 0.0;
  }
  return agree / cloud.size();
}

TEST_F(CloudFilesOfStudio, FitAsWellAsTheDepthImages) {
  const auto of_images = Clips([](const CloudTake& take, Evidence& evidence) { evidence = take.evidence; });
  const auto of_raw = Clips([](const CloudTake& take, Evidence& evidence) {
    evidence.clouds = RawClouds(take.evidence.depth_views, take.clip.name + "_raw_", 0.001);
  });
  const auto of_scans = Clips([](const CloudTake& take, Evidence& evidence) {
    evidence.clouds = ScannedClouds(take.evidence.depth_views, take.clip.name + "_scan_");
  });
  const auto body = MeasureBodyInClouds(of_images, skeleton_, options_);
  const auto body_in_scans = MeasureBodyInClouds(of_scans, skeleton_, options_);
  ASSERT_TRUE(body && body_in_scans);
  const double images = Error(of_images, *body), raw = Error(of_raw, *body);
  const double scanned = Error(of_scans, *body_in_scans);
  RecordProperty("mm", std::to_string(images) + " " + std::to_string(raw) + " " + std::to_string(scanned));
  EXPECT_LT(images, 20.0);
  EXPECT_LT(raw, images + 4.0);
  EXPECT_LT(scanned, images + 1.1);
}

TEST_F(CloudFilesOfStudio, AnyUnitAndHandednessGivesTheSamePoints) {
  const std::vector<DepthView>& views = takes_[0].evidence.depth_views;
  const FusedCloud images = PersonPoints(FuseViews(views, 0, kVoxel).value(), kVoxel);
  const FusedCloud one = ReadPersonCloud(RawClouds(views, "metres_", 1.0), 0, kVoxel).value();
  const FusedCloud other = ReadPersonCloud(RawClouds(views, "mirrored_", -0.001), 0, kVoxel).value();
  EXPECT_NEAR(one.size(), images.size(), 0.35 * images.size())
      << "files keep flying pixels, which only images can identify";
  EXPECT_NEAR(one.size(), other.size(), 0.01 * one.size());
  EXPECT_LT((one.points.rowwise().mean() - other.points.rowwise().mean()).norm(), 2e-3);
  EXPECT_GT(FacingAs(images, one), 0.9);
}

TEST_F(CloudFilesOfStudio, PersonInARoomIsFoundByNormals) {
  const std::vector<CloudTake> takes = Takes(1, 1, true);
  const std::vector<DepthView>& views = takes[0].evidence.depth_views;
  const FusedCloud images = PersonPoints(FuseViews(views, 0, kVoxel).value(), kVoxel);
  const FusedCloud scan = ReadPersonCloud(ScannedClouds(views, "room_"), 0, kVoxel).value();
  EXPECT_NEAR(scan.size(), images.size(), 0.15 * images.size());
  EXPECT_GT(scan.excluded, 10 * scan.size());
  EXPECT_GT(FacingAs(images, scan), 0.95);
}

/// Files as a run passes them on: centimetres in left-handed axes, ingested by a declaration.
TEST_F(CloudFilesOfStudio, StagesIngestMeasureAndFit) {
  IngestOptions ingest;
  ingest.path = FolderOfClouds();
  ingest.source.name = "studio";
  ingest.source.format = "clouds";
  ingest.source.files = "staged_{frame}.ply";
  ingest.source.other_files = OtherFiles::kIgnore;
  ingest.source.units = "cm";
  ingest.source.axes = "-x +y +z";
  ingest.source.rate_hz = takes_[0].clip.truth.rate.hz();
  ingest.source.person = "p1";
  ingest.source.recording = "r1";
  ingest.source.label = "";
  const RigidTransform half_turn{Quaterniond(0.0, 1.0, 0.0, 0.0), Vector3d::Zero()};
  const CloudFiles written_files = ScannedClouds(takes_[0].evidence.depth_views, "staged_", half_turn);
  const auto discovery = Discover(ingest);
  ASSERT_TRUE(discovery) << discovery.error().Message();
  ASSERT_EQ(discovery->items.size(), 1u);
  const ItemSpec& item = discovery->items[0];
  const std::filesystem::path evidence = FolderOfClouds() / "evidence.h5";
  const auto ingested = IngestStage({"ingest", item.item, item.options.Whole(), item.inputs, evidence, {}});
  ASSERT_TRUE(ingested) << ingested.error().Message();
  const auto clip = ReadEvidence(evidence);
  ASSERT_TRUE(clip) << clip.error().Message();
  EXPECT_EQ(clip->evidence.clouds->sha256, written_files.sha256);
  StageRequest request;
  request.inputs = item.inputs;
  request.inputs.push_back({"evidence", clip->id(), evidence, std::string(64, 'a')});
  request.options = {{"skeleton", "smpl24"}, {"method", "point_clouds"}};
  request.stage = "proportions";
  request.item = "p1";
  request.output = FolderOfClouds() / "proportions.json";
  const auto measured = ProportionsStage(request);
  ASSERT_TRUE(measured) << measured.error().Message();
  request.inputs.push_back({"proportions", "p1", request.output, ""});
  request.stage = "fitting";
  request.options["solver"] = "banded";
  request.options["check"] = 1.0;
  request.item = clip->id();
  request.output = FolderOfClouds() / "fit.h5";
  request.options["point_clouds"]["start"] = {{"facing", takes_[0].reported_heading}};
  const auto fitted = FittingStage(request);
  ASSERT_TRUE(fitted) << fitted.error().Message();
  const nlohmann::json& check = fitted->summary.at("check");
  EXPECT_EQ(check.at("solver"), "ceres");
  EXPECT_LT(check.at("joint_worst_mm"), 0.1) << "frames are solved together by either solver";
  EXPECT_LT(check.at("cost_difference"), 1e-6);
  EXPECT_EQ(check.at("differ"), false);
  const auto written = ReadDataset(request.output);
  ASSERT_TRUE(written) << written.error().Message();
  ASSERT_EQ(written->clips.size(), 1u);
  EXPECT_EQ(written->clips[0].motion->frame_count(), 5);
  EXPECT_LT(written->clips[0].fit_rms, 0.02);
}

TEST_F(CloudFilesOfStudio, MissingChangedAndUnreadableFilesAreNamed) {
  CloudFiles clouds = RawClouds(takes_[0].evidence.depth_views, "named_", 0.001);
  clouds.files[0].clear();
  EXPECT_EQ(ReadPersonCloud(clouds, 0, kVoxel).value().size(), 0);
  ASSERT_TRUE(WriteFile(clouds.files[1], "ply\nformat ascii 1.0\nend_header\n"));
  EXPECT_THAT(ReadPersonCloud(clouds, 1, kVoxel).error().Message(), HasSubstr("has changed since it was ingested"));
  clouds.sha256[1].clear();
  EXPECT_THAT(ReadPersonCloud(clouds, 1, kVoxel).error().Message(), HasSubstr("named_1.ply"));
  std::filesystem::remove(clouds.files[2]);
  EXPECT_EQ(ReadPersonCloud(clouds, 2, kVoxel).error().code, ErrorCode::kNotFound);
  Clip clip;
  clip.evidence.clouds = clouds;
  clip.evidence.clouds->time_s[2] = clip.evidence.clouds->time_s[1];
  EXPECT_THAT(FuseClip(clip, options_).error().Message(), HasSubstr("frame 2 of the clouds is not stamped later"));
}

}  // namespace
}  // namespace mocurate
