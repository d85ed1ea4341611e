// A rig that was audited with some takes is a file that other takes use.

#include "fitting/rig_file.h"

#include <gmock/gmock.h>

#include <cstdlib>

#include "core/base/file.h"
#include "core/base/random.h"
#include "fitting/audit/rig_corrections.h"
#include "fitting/audit/rig_samples.h"
#include "fitting/rig_of_takes.h"
#include "fitting/triangulation/keypoint_tracks.h"
#include "tests/fitting/keypoint_faults.h"
#include "tests/fitting/keypoint_takes.h"
#include "tests/fitting/studio_views.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

const Skeleton& BodyOfRigs() {
  static const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  return *skeleton;
}

std::vector<TakeOfRig> TakesOf(const std::vector<Evidence>& evidence) {
  std::vector<TakeOfRig> takes;
  for (const Evidence& one : evidence) takes.push_back({"take" + std::to_string(takes.size() + 1), "ab12", one});
  return takes;
}

/// Audits takes, writes the file, and gives its path.
std::filesystem::path Audited(const ScratchFolder& folder, const std::vector<Evidence>& evidence,
                              RigOfTakes* to = nullptr, const std::string& name = "rig.yaml") {
  auto audited = AuditTakes(TakesOf(evidence), BodyOfRigs(), {});
  EXPECT_TRUE(audited) << audited.error().Message();
  if (!audited) return {};
  EXPECT_TRUE(WriteFile(folder / name, RigText(audited->rig)));
  if (to != nullptr) *to = *std::move(audited);
  return folder / name;
}

Expected<KeypointTracks> WithFile(const Evidence& evidence, const std::filesystem::path& rig) {
  KeypointFitOptions options;
  options.rig = rig;
  return TriangulateKeypoints(evidence, BodyOfRigs(), options);
}

long FindingsOfCode(const std::vector<Finding>& findings, const std::string& code) {
  return std::count_if(findings.begin(), findings.end(), [&](const Finding& finding) { return finding.code == code; });
}

RigFile SomeRig() {
  RigFile rig;
  rig.config = "my ${x} job.yaml";
  rig.takes = {{"s/p1/take#0-10", "00ff", {{"cam1", "kept"}, {"cam2", "ambiguous"}}, ""},
               {"s/p1/two", "11", {}, "no: 'x'"}};
  rig.place_covariance << 1.5e-4, 1e-5, 0, 1e-5, 2e-4, 1.0 / 3e6, 0, 1.0 / 3e6, 1e-6;
  for (const Camera& camera : Ring(3)) {
    RigCamera one;
    one.camera = camera;
    one.files_of = camera.name;
    rig.cameras.push_back(one);
  }
  std::swap(rig.cameras[0].files_of, rig.cameras[1].files_of);
  RigCamera& last = rig.cameras.back();
  last.mirrored = last.sides_exchanged = true;
  last.pixel_scale = 1.0 / 3.0;
  last.unit_scale = 1000.0;
  last.clock_s = -0.0123456789012345;
  last.moved_m = 0.12;
  last.rotated_rad = 0.02;
  last.verdict = RigVerdict::kCorrected;
  last.confidence = 0.99917;
  last.confidence_of = ConfidenceOf::kTakes;
  return rig;
}

TEST(RigFile, IsReadBackExactly) {
  const ScratchFolder folder;
  const RigFile rig = SomeRig();
  ASSERT_TRUE(WriteFile(folder / "rig.yaml", RigText(rig)));
  const auto read = ReadRigFile(folder / "rig.yaml");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_EQ(RigText(*read), RigText(rig));
  EXPECT_EQ(read->config, rig.config);
  EXPECT_EQ(read->takes[0].verdicts, rig.takes[0].verdicts);
  EXPECT_EQ(read->place_covariance, rig.place_covariance);
  ASSERT_EQ(read->cameras.size(), 3u);
  for (std::size_t v = 0; v < 3; ++v) {
    const Camera &is = read->cameras[v].camera, &was = rig.cameras[v].camera;
    EXPECT_EQ(is.camera_from_world.translation, was.camera_from_world.translation);
    EXPECT_EQ(is.camera_from_world.rotation.coeffs(), was.camera_from_world.rotation.coeffs());
    EXPECT_EQ(is.distortion.k1, was.distortion.k1);
    EXPECT_EQ(is.width, was.width);
    EXPECT_EQ(read->cameras[v].files_of, rig.cameras[v].files_of);
  }
  EXPECT_EQ(read->cameras[2].clock_s, rig.cameras[2].clock_s);
  EXPECT_EQ(read->cameras[2].confidence, rig.cameras[2].confidence);
  EXPECT_EQ(read->cameras[2].confidence_of, ConfidenceOf::kTakes);
  EXPECT_EQ(read->cameras[1].confidence, std::nullopt);
}

TEST(RigFile, IsRefusedWhereItIsWrong) {
  const ScratchFolder folder;
  const std::string sound = RigText(SomeRig());
  const std::pair<std::string, std::string> changes[] = {
      {"version: 1", "version: 2"},
      {"version: 1\n", ""},
      {"name: cam2", "name: cam1"},
      {"files_of: cam1", "files_of: cam9"},
      {"files_of: cam3", "files_of: cam1"},
      {"fx: 1150", "fx: 0"},
      {"fx: 1150\n", "fx: wide\n"},
      {"width: 1280", "width: -1280"},
      {"verdict: corrected", "verdict: perfect"},
      {"confidence: 0.99917", "confidence: 99.9"},
      {"mirrored: true", "mirorred: true"},
      {"    clock_s: 0\n", ""},
      {"      w: ", "      w: 1"},
      {"cameras:", "cameras: []\nothers:"},
      {sound, ""},
      {sound, "version: 1\n"},
      {sound, "version: [1"},
      {sound, std::string("\x89PNG\r\n\0", 7)},
  };
  for (const auto& [from, to] : changes) {
    const std::size_t at = sound.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    ASSERT_TRUE(WriteFile(folder / "bad.yaml", std::string(sound).replace(at, from.size(), to)));
    const auto read = ReadRigFile(folder / "bad.yaml");
    ASSERT_FALSE(read) << from << " -> " << to;
    EXPECT_EQ(read.error().code, ErrorCode::kMalformed) << to << ": " << read.error().Message();
    EXPECT_NE(read.error().Message().find("bad.yaml"), std::string::npos) << read.error().Message();
    EXPECT_FALSE(read.error().hint.empty());
  }
  EXPECT_EQ(ReadRigFile(folder / "none.yaml").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(ReadRigFile(folder).error().code, ErrorCode::kNotFound);
}

TEST(RigFile, OfOtherCamerasIsRefused) {
  RigFile rig = SomeRig();
  rig.cameras[0].files_of = "cam1", rig.cameras[1].files_of = "cam2";
  const Evidence evidence = Detections(Ring(3), {Swinging(10)}, 2.0);
  ASSERT_TRUE(WithRig(evidence, rig));
  const auto refused = [&](const Evidence& take, const RigFile& of) {
    const auto read = WithRig(take, of);
    return !read && read.error().code == ErrorCode::kInconsistent && !read.error().hint.empty();
  };
  Evidence renamed = evidence;
  renamed.keypoint_views[1].camera.name = "cam7";
  EXPECT_TRUE(refused(renamed, rig));
  Evidence resized = evidence;
  resized.keypoint_views[2].camera.height = 720;
  EXPECT_TRUE(refused(resized, rig));
  Evidence unknown_size = evidence;
  unknown_size.keypoint_views[2].camera.height = 0;
  EXPECT_FALSE(refused(unknown_size, rig));
  Evidence fewer = evidence;
  fewer.keypoint_views.pop_back();
  EXPECT_FALSE(refused(fewer, rig)) << "a take may lack a camera";
  std::swap(rig.cameras[1].files_of, rig.cameras[2].files_of);
  EXPECT_TRUE(refused(fewer, rig)) << "but not one whose files are another camera's";
}

/// Takes of a studio rig whose last camera was moved after its calibration.
std::vector<StudioView> TakesOfAMovedRig(int count) {
  StudioOptions options = FourViews(23);
  options.rig.moved = 0.12;
  return StudioViews(options, count);
}

TEST(RigOfTakes, TwoTakesNameTheMovedCameraAndTheFileCorrectsAThird) {
  const ScratchFolder folder;
  const std::vector<StudioView> takes = TakesOfAMovedRig(3);
  RigOfTakes audited;
  const auto file = Audited(folder, {takes[0].evidence, takes[1].evidence}, &audited);
  const auto rig = ReadRigFile(file);
  ASSERT_TRUE(rig) << rig.error().Message();
  ASSERT_EQ(rig->takes.size(), 2u);
  const Camera& calibrated = takes[0].evidence.keypoint_views[3].camera;
  for (const RigCamera& camera : rig->cameras) {
    const bool moved = camera.camera.name == calibrated.name;
    EXPECT_EQ(camera.verdict, moved ? RigVerdict::kCorrected : RigVerdict::kKept) << camera.camera.name;
    EXPECT_EQ(camera.confidence.has_value(), moved);
    if (!moved) continue;
    EXPECT_EQ(camera.confidence_of, ConfidenceOf::kTakes);
    EXPECT_NEAR(camera.moved_m, 0.12, 0.05);
    EXPECT_LT((camera.camera.Centre() - takes[0].faults.real[3].Centre()).norm(), 0.04);
  }
  EXPECT_TRUE(audited.findings.empty());

  const auto corrected = WithFile(takes[2].evidence, file);
  const auto own = TriangulateKeypoints(takes[2].evidence, BodyOfRigs(), {});
  ASSERT_TRUE(corrected && own);
  EXPECT_TRUE(corrected->report.faults.empty()) << FaultsText(corrected->report.faults);
  EXPECT_EQ(FindingsOfCode(corrected->findings, kRigContradicted), 0);
  EXPECT_LT(MeanError(corrected->tracks, takes[2].truth), 1.1 * MeanError(own->tracks, takes[2].truth));
}

TEST(RigOfTakes, OneTakeStatesTheRepeatabilityOfItsSpans) {
  const ScratchFolder folder;
  const std::vector<StudioView> takes = TakesOfAMovedRig(1);
  const auto rig = ReadRigFile(Audited(folder, {takes[0].evidence}));
  ASSERT_TRUE(rig) << rig.error().Message();
  const RigCamera& moved = rig->cameras.back();
  EXPECT_EQ(moved.verdict, RigVerdict::kCorrected);
  ASSERT_TRUE(moved.confidence);
  EXPECT_GE(*moved.confidence, 0.99);
  EXPECT_EQ(moved.confidence_of, ConfidenceOf::kSpansOfOneTake);
}

TEST(RigOfTakes, ASoundRigIsKept) {
  const ScratchFolder folder;
  std::vector<Evidence> takes;
  for (const StudioView& take : StudioViews(FourViews(21), 3)) takes.push_back(take.evidence);
  const auto rig = ReadRigFile(Audited(folder, takes));
  ASSERT_TRUE(rig) << rig.error().Message();
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(rig->cameras[v].verdict, RigVerdict::kKept);
    EXPECT_EQ(rig->cameras[v].camera.camera_from_world.translation,
              takes[0].keypoint_views[v].camera.camera_from_world.translation);
  }
  for (const AuditedTake& take : rig->takes) {
    for (const auto& [camera, verdict] : take.verdicts) EXPECT_EQ(verdict, "kept") << camera;
  }
}

TEST(RigOfTakes, ACameraThatMovedBetweenTakesIsAmbiguous) {
  const ScratchFolder folder;
  StudioOptions sound = FourViews(23);
  const std::vector<StudioView> before = StudioViews(sound, 2), after = TakesOfAMovedRig(4);
  const auto rig =
      ReadRigFile(Audited(folder, {before[0].evidence, before[1].evidence, after[2].evidence, after[3].evidence}));
  ASSERT_TRUE(rig) << rig.error().Message();
  EXPECT_EQ(rig->cameras[3].verdict, RigVerdict::kAmbiguous);
  EXPECT_EQ(rig->takes[0].verdicts.at(rig->cameras[3].camera.name), "kept");
  EXPECT_EQ(rig->takes[3].verdicts.at(rig->cameras[3].camera.name), "corrected");
}

TEST(RigOfTakes, ATakeThatContradictsTheFileIsReportedAndNotCorrected) {
  const ScratchFolder folder;
  const std::vector<StudioView> sound = StudioViews(FourViews(23), 2), moved = TakesOfAMovedRig(3);
  const auto file = Audited(folder, {sound[0].evidence, sound[1].evidence});
  const auto found = WithFile(moved[2].evidence, file);
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_GE(FindingsOfCode(found->findings, kRigContradicted), 1);
  for (const RigFault& fault : found->report.faults) EXPECT_FALSE(fault.corrected && fault.limb.empty()) << fault.code;
  const auto own = TriangulateKeypoints(moved[2].evidence, BodyOfRigs(), {});
  ASSERT_TRUE(own);
  EXPECT_LT(MeanError(own->tracks, moved[2].truth), MeanError(found->tracks, moved[2].truth));
}

TEST(RigOfTakes, ExchangedFilesMirroredImagesAndClocksAreOfTheRig) {
  const ScratchFolder folder;
  StudioOptions options = FourViews(24);
  options.rig.kind = RigKind::kHuman36m;
  const std::vector<StudioView> takes = StudioViews(options, 3);
  std::vector<Evidence> altered;
  for (const StudioView& take : takes) {
    altered.push_back(take.evidence);
    ExchangeFiles(altered.back(), 0, 2);
  }
  const auto file = Audited(folder, {altered[0], altered[1]});
  const auto rig = ReadRigFile(file);
  ASSERT_TRUE(rig) << rig.error().Message();
  EXPECT_EQ(rig->cameras[0].files_of, rig->cameras[2].camera.name);
  EXPECT_EQ(rig->cameras[2].files_of, rig->cameras[0].camera.name);
  EXPECT_EQ(rig->cameras[1].verdict, RigVerdict::kKept);
  const auto found = WithFile(altered[2], file);
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_EQ(FindingsOfCode(found->findings, kRigContradicted), 0);
  EXPECT_LT(MeanError(found->tracks, takes[2].truth), 0.04);

  RigFile all = SomeRig();
  const Motion person = Swinging(40);
  const Evidence given = Detections(Ring(3), {person}, 1.0);
  Evidence wrong = given;
  Mirror(wrong.keypoint_views[2]);
  Enlarge(wrong.keypoint_views[1], 0.5);
  ExchangeSides(wrong.keypoint_views[0], wrong.keypoint_names);
  for (double& time : wrong.keypoint_views[1].time_s) time -= 0.25;
  for (RigCamera& camera : all.cameras) {
    RigCamera plain;
    plain.camera = camera.camera;
    plain.files_of = camera.camera.name;
    camera = plain;
  }
  all.cameras[2].mirrored = true;
  all.cameras[1].pixel_scale = 2.0;
  all.cameras[1].clock_s = 0.25;
  all.cameras[0].sides_exchanged = true;
  const auto read = WithRig(wrong, all);
  ASSERT_TRUE(read) << read.error().Message();
  for (std::size_t v = 0; v < 3; ++v) {
    const KeypointView &is = read->keypoint_views[v], &was = given.keypoint_views[v];
    ASSERT_EQ(is.values.size(), was.values.size());
    for (std::size_t i = 0; i < is.values.size(); ++i) ASSERT_NEAR(is.values[i], was.values[i], 1e-9) << v;
    for (std::size_t f = 0; f < is.time_s.size(); ++f) ASSERT_NEAR(is.time_s[f], was.time_s[f], 1e-12);
  }
}

TEST(RigOfTakes, TakesOfOtherRigsAreRefused) {
  const Evidence one = Detections(Ring(4), {Swinging(30)}, 2.0);
  Evidence renamed = one, recalibrated = one, fewer = one, other_points = one;
  renamed.keypoint_views[0].camera.name = "cam9";
  recalibrated.keypoint_views[0].camera.fx *= 1.01;
  fewer.keypoint_views.pop_back();
  std::swap(other_points.keypoint_names[1], other_points.keypoint_names[2]);
  for (const Evidence& other : {renamed, recalibrated, fewer, other_points}) {
    const auto audited = AuditTakes(TakesOf({one, other}), BodyOfRigs(), {});
    ASSERT_FALSE(audited);
    EXPECT_EQ(audited.error().code, ErrorCode::kInconsistent);
    EXPECT_EQ(audited.error().where, "take2");
  }
}

/// AuditTakes with one group of options changed.
Expected<RigOfTakes> AuditedWith(const std::vector<Evidence>& evidence, const KeypointAuditOptions& audit) {
  KeypointFitOptions options;
  options.audit = audit;
  return AuditTakes(TakesOf(evidence), BodyOfRigs(), options);
}

TEST(RigOfTakes, MirroredImagesOfAnotherSizeAreReadAsTheAuditFoundThem) {
  const ScratchFolder folder;
  StudioOptions options = FourViews(24);
  options.rig.kind = RigKind::kHuman36m;
  const std::vector<StudioView> takes = StudioViews(options, 2);
  std::vector<Evidence> altered;
  for (const StudioView& take : takes) {
    altered.push_back(take.evidence);
    Mirror(altered.back().keypoint_views[2]);
    for (KeypointView& view : altered.back().keypoint_views) Enlarge(view, 0.5);
  }
  const auto rig = ReadRigFile(Audited(folder, altered));
  ASSERT_TRUE(rig) << rig.error().Message();
  EXPECT_TRUE(rig->cameras[2].mirrored);
  EXPECT_EQ(rig->cameras[2].pixel_scale, 2.0);
  const auto read = WithRig(altered[0], *rig);
  ASSERT_TRUE(read) << read.error().Message();
  const KeypointView &is = read->keypoint_views[2], &was = takes[0].evidence.keypoint_views[2];
  for (std::size_t i = 0; i < is.values.size(); ++i) ASSERT_NEAR(is.values[i], was.values[i], 1e-9) << i;
}

TEST(RigOfTakes, ATakeWithoutDetectionsOfACameraSaysNothingAboutIt) {
  EXPECT_EQ(GainOfTakes({0.0, 10.0}, {1.0, 2.0, 11.0, 12.0}, {3.0, 4.0, 5.0, 6.0}, {2.0, 4.0, 5.0, 6.0}),
            (std::vector<std::optional<double>>{0.5, std::nullopt}));
  std::vector<Evidence> takes;
  for (const StudioView& take : TakesOfAMovedRig(3)) takes.push_back(take.evidence);
  std::vector<double>& values = takes[2].keypoint_views[3].values;
  std::fill(values.begin(), values.end(), 0.0);
  const auto audited = AuditedWith(takes, {});
  ASSERT_TRUE(audited) << audited.error().Message();
  EXPECT_EQ(audited->rig.cameras[3].verdict, RigVerdict::kCorrected);
  EXPECT_GE(audited->rig.cameras[3].confidence.value_or(0.0), 0.9);
  EXPECT_EQ(FindingsOfCode(audited->findings, "takes_disagree"), 0);
}

TEST(RigOfTakes, TheConfidenceOfAUnitIsALikelihood) {
  const ScratchFolder folder;
  Evidence take = StudioViews(FourViews(21), 1)[0].evidence;
  for (KeypointView& view : take.keypoint_views) view.camera.camera_from_world.translation *= 1000.0;
  KeypointAuditOptions audit;
  audit.unit = AuditAction::kCorrect;
  const auto audited = AuditedWith({take}, audit);
  ASSERT_TRUE(audited) << audited.error().Message();
  ASSERT_TRUE(WriteFile(folder / "rig.yaml", RigText(audited->rig)));
  const auto rig = ReadRigFile(folder / "rig.yaml");
  ASSERT_TRUE(rig) << rig.error().Message();
  for (const RigCamera& camera : rig->cameras) {
    EXPECT_EQ(camera.unit_scale, 1000.0);
    EXPECT_TRUE(camera.confidence.has_value());
    EXPECT_EQ(camera.confidence_of, ConfidenceOf::kModel);
  }
}

TEST(RigOfTakes, WhatCannotBeAuditedIsNotKept) {
  const Evidence whole = StudioViews(FourViews(21), 1)[0].evidence;
  const Evidence brief = FramesOf(whole, 0, 3);
  Evidence two_views = whole, still = FramesOf(whole, 0, 40), equal = still;
  two_views.keypoint_views.resize(2);
  for (KeypointView& view : equal.keypoint_views) {  // the first frame forty times
    const std::size_t frame = view.values.size() / 40;
    for (std::size_t i = 0; i < view.values.size(); ++i) view.values[i] = view.values[i % frame];
  }
  still = Detections(Ring(4), {Swinging(1)}, 0.0);
  Random random(5, "still");
  for (KeypointView& view : still.keypoint_views) {  // one posture, with noise
    const std::vector<double> frame = view.values;
    view.values.clear();
    view.time_s.clear();
    for (int f = 0; f < 40; ++f) {
      view.time_s.push_back(f / 30.0);
      for (std::size_t i = 0; i < frame.size(); ++i) {
        view.values.push_back(i % 3 == 2 ? frame[i] : frame[i] + 2.0 * random.Normal());
      }
    }
  }
  for (const Evidence& take : {brief, two_views, equal, still}) {
    const auto audited = AuditedWith({take}, {});
    ASSERT_FALSE(audited);
    EXPECT_EQ(audited.error().code, ErrorCode::kInconsistent);
  }
  const auto both = AuditedWith({whole, brief}, {});
  ASSERT_TRUE(both) << both.error().Message();
  EXPECT_EQ(FindingsOfCode(both->findings, "take_not_audited"), 1);
  EXPECT_FALSE(both->rig.takes[1].not_audited.empty());
  for (const auto& [camera, verdict] : both->rig.takes[1].verdicts) EXPECT_EQ(verdict, "not_audited") << camera;
  for (const auto& [camera, verdict] : both->rig.takes[0].verdicts) EXPECT_EQ(verdict, "kept") << camera;
}

TEST(RigOfTakes, AStillTakeOfAMovedRigIsNotCorrected) {
  Evidence take = TakesOfAMovedRig(1)[0].evidence;
  for (KeypointView& view : take.keypoint_views) {
    const std::size_t frame = view.values.size() / view.time_s.size();
    for (std::size_t i = 0; i < view.values.size(); ++i) view.values[i] = view.values[i % frame];
  }
  const auto found = TriangulateKeypoints(take, BodyOfRigs(), {});
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_TRUE(found->report.faults.empty()) << FaultsText(found->report.faults);
  EXPECT_EQ(FindingsOfCode(found->findings, kRigNotAudited), 1);
}

TEST(RigOfTakes, ReportedFaultsAreFindingsWithAVerdict) {
  const std::vector<StudioView> takes = TakesOfAMovedRig(2);
  KeypointAuditOptions audit;
  audit.moved = AuditAction::kReport;
  audit.clocks = AuditAction::kOff;
  const auto audited = AuditedWith({takes[0].evidence, takes[1].evidence}, audit);
  ASSERT_TRUE(audited) << audited.error().Message();
  const RigCamera& moved = audited->rig.cameras[3];
  EXPECT_EQ(moved.verdict, RigVerdict::kReported);
  EXPECT_EQ(moved.moved_m, 0.0);
  EXPECT_EQ(FindingsOfCode(audited->findings, "camera_moved"), 1);
  EXPECT_EQ(audited->rig.audit.at("moved"), "report");
  EXPECT_EQ(audited->rig.audit.at("clocks"), "off");
}

TEST(RigOfTakes, AnyFaultAgainstTheFileIsAContradiction) {
  const ScratchFolder folder;
  const std::vector<StudioView> sound = StudioViews(FourViews(23), 2), moved = TakesOfAMovedRig(6);
  const auto file = Audited(folder, {sound[0].evidence, sound[1].evidence});
  for (const StudioView& take : moved) {
    const auto found = WithFile(take.evidence, file);
    ASSERT_TRUE(found) << found.error().Message();
    long faults = 0;
    for (const RigFault& fault : found->report.faults) {
      faults += fault.limb.empty() ? 1 : 0;
      if (fault.code == "camera_moved") {
        EXPECT_GE(fault.confidence, KeypointAuditOptions().sure);
      }
    }
    EXPECT_EQ(FindingsOfCode(found->findings, kRigContradicted), faults) << FaultsText(found->report.faults);
    EXPECT_EQ(FindingsOfCode(found->findings, "rig_used"), 1);
    EXPECT_EQ(found->report.suspect, faults > 0);
  }
}

/// With three cameras the pose of a camera explains what a clock offset explains.
TEST(RigOfTakes, ThreeCamerasGiveNoClockThatAPoseExplainsAsWell) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const std::filesystem::path set = std::filesystem::path(data) / "pose2sim";
  for (const char* trial : {"single", "two"}) {
    const Evidence four = ReadPose2Sim(set, trial);
    for (std::size_t without = 0; without < 4; ++without) {
      Evidence three = four;
      three.keypoint_views.erase(three.keypoint_views.begin() + static_cast<std::ptrdiff_t>(without));
      const auto found = TriangulateKeypoints(three, BodyOfRigs(), {});
      ASSERT_TRUE(found) << found.error().Message();
      for (const RigFault& fault : found->report.faults) {
        EXPECT_NE(fault.code, "camera_clock_off") << trial << " without camera " << without << ": " << fault.message;
      }
    }
  }
}

/// The confidence of a recorded trial's moved camera is the number that `audit.sure` tests.
TEST(RigOfTakes, ARecordedTrialContradictsItsCalibration) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const ScratchFolder folder;
  const Evidence trial = ReadPose2Sim(std::filesystem::path(data) / "pose2sim", "single");
  RigFile calibrated;
  for (const KeypointView& view : trial.keypoint_views) {
    RigCamera camera;
    camera.camera = view.camera;
    camera.files_of = view.camera.name;
    calibrated.cameras.push_back(camera);
  }
  ASSERT_TRUE(WriteFile(folder / "rig.yaml", RigText(calibrated)));
  const auto found = WithFile(trial, folder / "rig.yaml");
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_GE(FindingsOfCode(found->findings, kRigContradicted), 1);
  EXPECT_EQ(FindingsOfCode(found->findings, "camera_moved"), 0);
  EXPECT_TRUE(found->report.suspect);
  for (const RigFault& fault : found->report.faults) {
    if (fault.code == "camera_moved") {
      EXPECT_GE(fault.confidence, KeypointAuditOptions().sure);
    }
  }
}

/// Both recorded trials are of one rig. Their own audits blame different cameras; one file gives one answer.
TEST(RigOfTakes, BothRecordedTrialsHaveOneRig) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const ScratchFolder folder;
  const std::filesystem::path set = std::filesystem::path(data) / "pose2sim";
  const std::vector<Evidence> trials = {ReadPose2Sim(set, "single"), ReadPose2Sim(set, "two")};
  RigOfTakes audited;
  const auto file = Audited(folder, trials, &audited);
  const auto rig = ReadRigFile(file);
  ASSERT_TRUE(rig) << rig.error().Message();
  EXPECT_EQ(rig->takes.size(), 2u);
  for (const RigCamera& camera : rig->cameras) {
    std::printf("%s: %s, %.1f mm, confidence %.4f of %s; alone %s and %s\n", camera.camera.name.c_str(),
                Name(camera.verdict).c_str(), 1e3 * camera.moved_m, camera.confidence.value_or(-1.0),
                std::string(Name(camera.confidence_of)).c_str(), rig->takes[0].verdicts.at(camera.camera.name).c_str(),
                rig->takes[1].verdicts.at(camera.camera.name).c_str());
    EXPECT_TRUE(!camera.confidence || camera.confidence_of == ConfidenceOf::kTakes);
  }
  for (const Evidence& trial : trials) {
    const auto found = WithFile(trial, file);
    ASSERT_TRUE(found) << found.error().Message();
    for (const RigFault& fault : found->report.faults)
      EXPECT_FALSE(fault.corrected && fault.limb.empty()) << fault.code;
    EXPECT_EQ(FindingsOfCode(found->findings, kRigContradicted), 0);
    EXPECT_EQ(found->report.place_covariance, rig->place_covariance);
    EXPECT_FALSE(found->report.suspect);
    std::printf("median %.2f px, p90 %.2f px, triangulated %.3f, findings %s\n", found->report.median_px,
                found->report.p90_px, found->report.triangulated, FaultsText(found->report.faults).c_str());
  }
}

}  // namespace
}  // namespace mocurate
