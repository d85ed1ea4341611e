// Each stage's output on a small fixed input is recorded with its version in expected/, and one may not change without
// the other. Bytes may differ between processors, so that structure, texts and statistics are recorded and compared
// with a tolerance.

#include <gmock/gmock.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "canon/options.h"
#include "canon/stages.h"
#include "core/base/file.h"
#include "core/base/random.h"
#include "core/formats/npy.h"
#include "core/motion/kinematics.h"
#include "core/motion/request.h"
#include "eval/options.h"
#include "eval/stages.h"
#include "fitting/options.h"
#include "fitting/stages.h"
#include "ingest/options.h"
#include "ingest/stages.h"
#include "report/options.h"
#include "report/stages.h"
#include "tests/support/folders.h"
#include "tests/versions/fixed_inputs.h"
#include "tests/versions/stage_record.h"
#include "tests/versions/stage_versions.h"
#include "train/items.h"
#include "train/stages.h"

namespace mocurate::versions {
namespace {

// Measured with all vector instructions and without any: 1e-7 at most, in evaluation 3e-5.
constexpr double kComputed = 1e-5;  ///< doubles stored as float32
constexpr double kSolved = 1e-4;    ///< found by iterating in double
constexpr double kTrained = 5e-4;   ///< found by stochastic gradient steps in float32
constexpr double kRounded = 2e-3;   ///< rounded for readers

template <class T>
void Write(const T& written) {
  ASSERT_TRUE(written) << written.error().Message();
}

SourceOptions TableSource() {
  SourceOptions source;
  source.name = "fixed";
  source.format = "joint_table";
  source.files = "{action}_p{person}_r{repetition}.txt";
  source.units = "mm";
  source.axes = "+x +y -z";
  source.rate_hz = 30.0;
  source.skeleton = "openni15";
  source.columns = {"x", "y", "z", "confidence"};
  const Motion motion = Exercise(1, 1.0);
  for (int j = 1; j < motion.joint_count(); ++j) source.joints.push_back(motion.skeleton->joints[j].name);
  return source;
}

SyntheticOptions SmallCapture() {
  SyntheticOptions options;
  options.enabled = true;
  options.actions = {"wave", "walk"};
  options.subjects = 2;
  options.repetitions = 1;
  options.duration_s = 1.0;
  return options;
}

TEST_F(StageVersions, Capture) {
  Judge(CaptureDeclaration(), "capture", {"capture", OptionsToJson(SmallCapture()), {}}, kComputed);
}

TEST_F(StageVersions, Truth) {
  Judge(TruthDeclaration(), "truth", {"truth", {{"synthetic", OptionsToJson(SmallCapture())}}, {}}, kComputed);
}

TEST_F(StageVersions, IngestOfAJointTable) {
  Put("table.txt", JointTable(Exercise(20, 1.0)));
  Judge(IngestDeclaration(), "ingest_joint_table",
        {"fixed/1/wave_p1_r1", OptionsToJson(TableSource()), {Input("source", "wave_p1_r1.txt", "table.txt")}},
        kComputed);
}

TEST_F(StageVersions, IngestOfABvhFile) {
  Put("file.bvh", BvhText());
  SourceOptions source;
  source.name = "fixed";
  source.format = "bvh";
  source.files = "{action}_{person}.bvh";
  source.units = "cm";
  source.axes = "+x +y +z";
  Judge(IngestDeclaration(), "ingest_bvh",
        {"fixed/ann/kick_ann", OptionsToJson(source), {Input("source", "kick_ann.bvh", "file.bvh")}}, kComputed);
}

TEST_F(StageVersions, Duplicates) {
  ItemSpec item{"duplicates", OptionsToJson(CheckOptions()), {}};
  for (const char* recording : {"r1", "r2", "r3"}) {
    const Clip clip = TrackedClip("p1", recording, "wave", Exercise(30, recording[1] == '3' ? 0.5 : 1.0));
    Write(WriteEvidence(clip, Path(recording)));
    item.inputs.push_back(Input("evidence", std::string("fixed/p1/") + recording, recording));
  }
  const Motion motion = Exercise(40, 1.0);
  for (const char* recording : {"r4", "r5"}) {
    Clip clip = TrackedClip("p1", "r4", "wave", motion);
    clip.identity.recording = recording;
    Write(WriteEvidence(clip, Path(recording)));
    item.inputs.push_back(Input("evidence", std::string("fixed/p1/") + recording, recording));
  }
  Judge(DuplicatesDeclaration(), "duplicates", item, kComputed);
}

TEST_F(StageVersions, Proportions) {
  ItemSpec item{"p1", {}, {}};
  ProportionsOptions options;
  options.skeleton = "openni16";
  item.options = OptionsToJson(options);
  for (const char* recording : {"r1", "r2"}) {
    const Clip clip = TrackedClip("p1", recording, "wave", Exercise(30, recording[1] - '0'));
    Write(WriteEvidence(clip, Path(recording)));
    item.inputs.push_back(Input("evidence", clip.id(), recording));
  }
  Judge(ProportionsDeclaration(), "proportions", item, kSolved);
}

TEST_F(StageVersions, FittingOfJointTracks) {
  const Motion motion = Exercise(40, 1.0);
  const Clip clip = TrackedClip("p1", "r1", "wave", motion);
  Write(WriteEvidence(clip, Path("evidence.h5")));
  nlohmann::json proportions = {
      {"person", "p1"}, {"skeleton", "openni16"}, {"bone_length_m", nlohmann::json::object()}};
  const std::vector<double> bones = motion.skeleton->RestBoneLengths();
  for (int j = 1; j < motion.joint_count(); ++j) {
    proportions["bone_length_m"][motion.skeleton->joints[j].name] = std::round(1.03e4 * bones[j]) / 1e4;
  }
  Put("proportions.json", proportions.dump());
  FittingOptions options;
  options.skeleton = "openni16";
  Judge(FittingDeclaration(), "fitting_joint_tracks",
        {clip.id(),
         OptionsToJson(options),
         {Input("evidence", clip.id(), "evidence.h5"), Input("proportions", "p1", "proportions.json")}},
        kSolved);
}

/// Point clouds, keypoints and both mixtures, on one recording of three cameras.
TEST_F(StageVersions, FittingOfDepthAndKeypoints) {
  const Motion motion = Exercise(8, 1.0, "smpl24");
  const Clip clip = RecordedClip("p1", "r1", motion, Path("images"));
  Write(WriteEvidence(clip, Path("evidence.h5")));
  for (const auto& [name, method] : {std::pair{"fitting_point_clouds", FitMethod::kPointClouds},
                                     {"fitting_keypoints", FitMethod::kKeypoints},
                                     {"fitting_joints_and_clouds", FitMethod::kJointsAndClouds},
                                     {"fitting_keypoints_and_clouds", FitMethod::kKeypointsAndClouds}}) {
    SCOPED_TRACE(name);
    FittingOptions options;
    options.skeleton = "smpl24";
    options.method = method;
    options.UseSolver(PoseSolver::kBanded);
    Judge(FittingDeclaration(), name,
          {clip.id(), OptionsToJson(options), {Input("evidence", clip.id(), "evidence.h5")}}, kSolved);
  }
}

TEST_F(StageVersions, Rig) {
  const Motion motion = Exercise(12, 1.0, "smpl24");
  RigStageOptions options;
  options.config = "fixed.yaml";
  options.skeleton = "smpl24";
  ItemSpec item{"rig", OptionsToJson(options), {}};
  for (const char* recording : {"r1", "r2"}) {
    Clip clip = RecordedClip("p1", recording, motion, Path(std::string("images_") + recording));
    clip.evidence_sha256 = std::string(64, 'a');
    Write(WriteEvidence(clip, Path(recording)));
    item.inputs.push_back(Input("evidence", clip.id(), recording));
  }
  Judge(RigDeclaration(), "rig", item, kSolved);
}

TEST_F(StageVersions, FitError) {
  const Motion truth = Exercise(30, 1.0);
  Motion fit = Exercise(30, 0.9);
  Random random(13, "fixed errors");  // no two errors are equal but for rounding: their ranks are recorded
  const auto normal = [&random](double sigma) {
    return Vector3d(sigma * random.Normal(), sigma * random.Normal(), sigma * random.Normal());
  };
  for (Vector3d& root : fit.root_translation) root += normal(0.01);
  for (Quaterniond& rotation : fit.rotation) rotation = rotation * ExpQuaternion(normal(0.05));
  ComputeJoints(fit);
  for (int i = 0; i < fit.frame_count() * fit.joint_count(); ++i) {
    const float sigma = 0.005F * static_cast<float>(1 + i % 5);
    for (const float unit : {1.0F, 0.2F, 0.0F, 1.0F, 0.1F, 2.0F}) fit.position_cov.push_back(sigma * sigma * unit);
    fit.rotation_sigma.insert(fit.rotation_sigma.end(), {2.0F * sigma, 10.0F * sigma, sigma});
    fit.rotation_observed.insert(fit.rotation_observed.end(), {0.9F, 0.5F, 0.0F});
    fit.state.push_back(i % 7 == 0 ? JointState::kInferred : JointState::kObserved);
  }
  const Clip clip = TrackedClip("p1", "r1", "wave", truth);
  Write(WriteEvidence(clip, Path("evidence.h5")));
  Write(WriteDataset(FittedClip(clip, fit), Path("fit.h5")));
  Truth all;
  all.motion.emplace(clip.id(), truth);
  Write(WriteTruth(all, Path("truth.h5")));
  Judge(FitErrorDeclaration(), "fit_error",
        {"fit_error",
         nlohmann::json::object(),
         {Input("truth", "truth", "truth.h5"), Input("fit", clip.id(), "fit.h5"),
          Input("evidence", clip.id(), "evidence.h5")}},
        kComputed);
}

CanonOptions Trimmed() {
  CanonOptions options;
  options.skeleton = "openni15";
  options.trim.rule = TrimRule::kMotionEnergy;
  options.rate = "20";
  return options;
}

TEST_F(StageVersions, Level) {
  const Motion motion = Exercise(60, 1.0);
  const Clip clip = TrackedClip("p1", "r1", "wave", motion);
  Write(WriteDataset(FittedClip(clip, motion), Path("fit.h5")));
  LevelOptions options;
  options.rule = FloorRule::kTilt;
  Judge(LevelDeclaration(), "level", {"set", OptionsToJson(options), {Input("motion", clip.id(), "fit.h5")}}, kSolved);
}

TEST_F(StageVersions, CanonOfAFittedMotion) {
  const Motion motion = Exercise(60, 1.0);
  const Clip clip = TrackedClip("p1", "r1", "wave", motion);
  Write(WriteDataset(FittedClip(clip, motion), Path("fit.h5")));
  Judge(CanonDeclaration(), "canon_motion",
        {clip.id(), OptionsToJson(Trimmed()), {Input("motion", clip.id(), "fit.h5")}}, kComputed);
}

TEST_F(StageVersions, CanonOfUnfittedTracks) {
  const Clip clip = TrackedClip("p1", "r1", "wave", Exercise(60, 1.0));
  Write(WriteEvidence(clip, Path("evidence.h5")));
  Judge(CanonDeclaration(), "canon_tracks",
        {clip.id(), OptionsToJson(Trimmed()), {Input("tracks", clip.id(), "evidence.h5")}}, kComputed);
}

TEST_F(StageVersions, Assemble) {
  AssembleOptions options;
  options.recipe = "fixed";
  options.splits.resize(2);
  options.splits[0].name = "person";
  options.splits[0].by = SplitBy::kPerson;
  options.splits[0].test = {"p3"};
  options.splits[1].name = "share";
  options.splits[1].by = SplitBy::kFraction;
  ItemSpec item{"dataset", OptionsToJson(options), {}};
  const Dataset all = SmallDataset();
  for (const Clip& clip : all.clips) {
    const std::string file = clip.identity.person + clip.identity.recording + ".h5";
    Dataset one = FittedClip(clip, *clip.motion);
    one.joints_only = true;
    Write(WriteDataset(one, Path(file)));
    item.inputs.push_back(Input("clip", clip.id(), file));
  }
  Judge(AssembleDeclaration(), "assemble", item, kComputed);
}

TEST_F(StageVersions, AuditAndReview) {
  Write(WriteDataset(SmallDataset(), Path("dataset.h5")));
  const ItemResult audit =
      Judge(AuditDeclaration(), "audit",
            {"audit", OptionsToJson(AuditOptions()), {Input("dataset", "dataset", "dataset.h5")}}, kComputed);
  Judge(ReviewDeclaration(), "review",
        {"review",
         OptionsToJson(ReviewOptions()),
         {Input("dataset", "dataset", "dataset.h5"), {"audit", "audit", audit.artifact, audit.sha256}}},
        kRounded, {AuditDeclaration()});
  AnnotateOptions annotate;
  annotate.all = true;
  Judge(AnnotateDeclaration(), "annotate",
        {"annotate", OptionsToJson(annotate), {Input("dataset", "dataset", "dataset.h5")}}, kRounded);
  SurveyOptions survey;
  survey.kind = SurveyKind::kRealOrFake;
  survey.questions = 2;
  survey.clips = 4;
  Judge(SurveyDeclaration(), "survey",
        {"survey",
         OptionsToJson(survey),
         {Input("motions", "real", "dataset.h5"), Input("motions", "generated", "dataset.h5")}},
        kRounded);
}

NetworkOptions SmallRecogniser() {
  NetworkOptions options(NetworkKind::kGruRecogniser);
  options.seeds = {3};
  options.data.frames = 12;
  options.recogniser.hidden = 8;
  options.recogniser.epochs = 4;
  options.recogniser.check_every = 2;
  options.learning.batch = 4;
  return options;
}

NetworkOptions SmallGenerator() {
  NetworkOptions options(NetworkKind::kAction2Motion);
  options.data.frames = 8;
  options.action2motion.hidden = 8;
  options.action2motion.latent = 3;
  options.learning.iterations = 3;
  options.learning.batch = 4;
  return options;
}

TEST_F(StageVersions, TrainingAndEvaluating) {
  Write(WriteDataset(SmallDataset(), Path("dataset.h5")));
  const StageInput dataset = Input("dataset", "dataset", "dataset.h5");
  const ItemResult recogniser = Judge(TrainDeclaration(), "train_recogniser",
                                      {"recogniser/3", OptionsToJson(SmallRecogniser()), {dataset}}, kTrained);
  const ItemResult generator = Judge(TrainDeclaration(), "train_generator",
                                     {"Action2Motion", OptionsToJson(SmallGenerator()), {dataset}}, kTrained);
  ASSERT_FALSE(recogniser.artifact.empty() || generator.artifact.empty());
  MotionRequest request;
  request.frames = 6;
  request.seed = 4;
  Write(WriteRequests({request, request}, Path("requests.json")));
  Judge(GenerateDeclaration(), "generate",
        {"motions",
         nlohmann::json::object(),
         {{"generator", "network", generator.artifact, generator.sha256},
          Input("requests", "requests", "requests.json")}},
        kTrained, {TrainDeclaration()});
  if (HasFailure()) GTEST_SKIP() << "features are judged when their input, the networks, is as recorded";
  FeaturesOptions options;
  options.extractor.length = LengthRule::kResample;
  options.purpose = "generated";
  options.passes = 2;
  options.motions = 24;
  const StageInput motions{"motions", dataset.name, dataset.path, dataset.sha256};
  const StageInput weights{"weights", recogniser.item, recogniser.artifact, recogniser.sha256};
  const ItemResult real =
      Judge(FeaturesDeclaration(), "features", {"features/Real", OptionsToJson(options), {weights, motions}}, kTrained,
            {TrainDeclaration()});
  options.generated = true;
  const ItemResult generated =
      Judge(FeaturesDeclaration(), "features_of_generator",
            {"features/Action2Motion",
             OptionsToJson(options),
             {weights, motions, {"generator", generator.item, generator.artifact, generator.sha256}}},
            kTrained, {TrainDeclaration()});
  ASSERT_FALSE(real.artifact.empty() || generated.artifact.empty());
  ScoreOptions score;
  score.name = "Action2Motion";
  score.draw.repetitions = 2;
  score.metrics.diversity_pairs = 8;
  score.metrics.multimodality_quota = 4;
  const auto features = [](const char* role, const ItemResult& item) {
    return StageInput{role, item.item, item.artifact, item.sha256};
  };
  Judge(ScoreDeclaration(), "score",
        {"score/Action2Motion", OptionsToJson(score), {features("row", generated), features("reference_train", real)}},
        kTrained, {TrainDeclaration(), FeaturesDeclaration()});
  Judge(CompareDeclaration(), "compare",
        {"compare/a/b",
         OptionsToJson(score),
         {features("a", generated), features("b", real), features("reference_train", real)}},
        kTrained, {TrainDeclaration(), FeaturesDeclaration()});
}

TEST_F(StageVersions, MotionsOfAFile) {
  NpyArray array;
  array.shape = {2, 6, 24 * 3};
  array.dtype = "<f4";
  for (int i = 0; i < 2 * 6 * 72; ++i) array.values.push_back(0.01 * (i % 72) + 0.001 * (i / 72));
  Put("two.npy", WriteNpy(array));
  MotionsOptions options;
  SourceOptions& source = options.ingest.source;
  source.name = "fixed";
  source.format = "npy";
  source.files = "{recording}.npy";
  source.person = "p";
  source.label = "";
  source.units = "m";
  source.axes = "+x -y -z";
  source.rate_hz = 15.0;
  source.skeleton = "humanact12";
  source.checks.IgnoreAll();
  Judge(MotionsDeclaration(), "motions",
        {"motions/two", OptionsToJson(options), {Input("source", "two.npy", "two.npy")}}, kComputed);
}

TEST_F(StageVersions, ReportAndPicture) {
  const Motion motion = Exercise(40, 1.0);
  const Clip clip = TrackedClip("p1", "r1", "wave", motion);
  Write(WriteEvidence(clip, Path("evidence.h5")));
  Write(WriteDataset(FittedClip(clip, motion), Path("fit.h5")));
  Put("run.json", RunSummary(clip.id()).dump());
  const std::vector<StageInput> drawn = {Input("evidence", clip.id(), "evidence.h5"),
                                         Input("fit", clip.id(), "fit.h5")};
  ItemSpec report{"report", OptionsToJson(ReportOptions()), drawn};
  report.inputs.push_back(Input("run", "run.json", "run.json"));
  Judge(ReportDeclaration(), "report", report, kRounded);
  Judge(ClipPageDeclaration(), "clip_page", {clip.id(), OptionsToJson(ClipPageOptions()), drawn}, kRounded);
  Judge(ClipVideoDeclaration(), "clip_video", {clip.id(), nlohmann::json::object(), drawn}, kRounded);
}

TEST_F(StageVersions, PicturesOfMotions) {
  Write(WriteDataset(SmallDataset(), Path("dataset.h5")));
  const std::vector<StageInput> motions = {Input("motions", "real", "dataset.h5")};
  Judge(MotionPictureDeclaration(), "draw", {"motions", OptionsToJson(MotionPictureOptions()), motions}, kRounded);
  ViewerOptions whole;
  whole.page_bytes = 0.0;  // parts beside the page
  Judge(ViewDeclaration(), "view", {"view", OptionsToJson(whole), motions}, kRounded);
  MotionPictureOptions one;
  one.clips = {SmallDataset().clips.front().id()};
  Judge(MotionVideoDeclaration(), "draw_video", {"motions", OptionsToJson(one), motions}, kRounded);
}

std::string ReadText(const std::filesystem::path& path) {
  std::ifstream stream(path);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(StageRecords, EveryDeclaredStageHasOne) {
  std::set<std::string> recorded;
  for (const auto& entry : std::filesystem::directory_iterator(RecordFile("x").parent_path())) {
    recorded.insert(nlohmann::json::parse(ReadText(entry.path())).at("stage"));
  }
  std::set<std::string> declared;
  const std::regex declaration("StageDeclaration \\w+Declaration\\(\\) \\{ return \\{\"(\\w+)\"");
  for (const char* room : {"ingest", "fitting", "canon", "train", "eval", "report"}) {
    const std::string text = ReadText(std::filesystem::path(kSourceFolder) / room / "options.cpp");
    for (std::sregex_iterator it(text.begin(), text.end(), declaration), end; it != end; ++it)
      declared.insert((*it)[1]);
  }
  declared.erase(TrainCostDeclaration().name);  // a figure of the machine
  EXPECT_GE(declared.size(), 10u) << "the declarations were not found";
  EXPECT_EQ(declared, recorded) << "write a case for it in tests/versions/stages_test.cpp";
}

TEST(StageRecords, AChangeOfAThousandthIsDetectedAndTheLastDigitOfAFloatIsIgnored) {
  std::vector<double> values;
  for (int i = 0; i < 100; ++i) values.push_back(std::sin(0.1 * i));
  const nlohmann::json recorded = RecordJson(values);
  std::vector<double> touched = values;
  for (double& value : touched) value *= 1.0 + 1e-7;
  EXPECT_THAT(Differences(recorded, RecordJson(touched), 1e-5), testing::IsEmpty());
  for (double& value : touched) value *= 1.001;
  EXPECT_THAT(Differences(recorded, RecordJson(touched), 1e-5), testing::SizeIs(1));
  touched = values;
  std::swap(touched[3], touched[40]);
  EXPECT_THAT(Differences(recorded, RecordJson(touched), 1e-5), testing::SizeIs(1));
}

TEST(StageRecords, WordingIsComparedExactlyAndItsNumbersAreNot) {
  const nlohmann::json recorded = RecordJson({{"a", "fastest frame 0.3000001 m/s"}, {"created_by", "x"}});
  EXPECT_THAT(Differences(recorded, RecordJson({{"a", "fastest frame 0.3 m/s"}}), 1e-5), testing::IsEmpty());
  EXPECT_THAT(Differences(recorded, RecordJson({{"a", "fastest frame 0.4 m/s"}}), 1e-5), testing::SizeIs(1));
  EXPECT_THAT(Differences(recorded, RecordJson({{"a", "slowest frame 0.3 m/s"}}), 1e-5), testing::SizeIs(1));
  EXPECT_THAT(Differences(recorded, RecordJson({{"b", 1}}), 1e-5), testing::SizeIs(2));
}

}  // namespace
}  // namespace mocurate::versions
