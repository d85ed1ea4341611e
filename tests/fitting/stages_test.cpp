#include "fitting/stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/store/store.h"
#include "fitting/options.h"
#include "fitting/solver_check.h"
#include "tests/fitting/takes.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

/// Evidence of one person, as ingest writes it.
class FittingStages : public testing::Test {
 protected:
  void SetUp() override {
    auto skeleton = LoadSkeleton("openni16");
    ASSERT_TRUE(skeleton.has_value()) << skeleton.error().Message();
    std::vector<Quaterniond> rotation;
    std::vector<Vector3d> translation;
    std::vector<double> bones = (*skeleton)->RestBoneLengths();
    for (double& bone : bones) bone *= 1.05;
    for (int f = 0; f < 40; ++f) {
      translation.emplace_back(0.02 * f, 1.0, 0.0);
      for (int j = 0; j < (*skeleton)->joint_count(); ++j) {
        rotation.push_back(ExpQuaternion(0.3 * std::sin(0.1 * f + j) * Vector3d(1, 0.5, j % 2)));
      }
    }
    truth_ = MakeMotion(*skeleton, FrameRate{30, 1}, translation, rotation, bones);
    Clip clip;
    clip.identity.source = "studio";
    clip.identity.person = "p1";
    clip.identity.recording = "r1";
    clip.identity.end_frame = 40;
    clip.rate = truth_.rate;
    JointTracks tracks;
    tracks.positions = JointPositions(40, truth_.joint_count() - 1);
    tracks.confidence.assign(static_cast<std::size_t>(40) * tracks.positions.joints, 1.0);
    for (int f = 0; f < 40; ++f) tracks.time_s.push_back(truth_.rate.FrameTime(f));
    for (int j = 1; j < truth_.joint_count(); ++j) {  // the root has no track
      tracks.names.push_back((*skeleton)->joints[j].name);
      for (int f = 0; f < 40; ++f) tracks.positions.at(f, j - 1) = truth_.joints.at(f, j);
    }
    clip.evidence.tracks = tracks;
    clip_ = clip;
    const Status written = WriteEvidence(clip, folder_ / "evidence.h5");
    ASSERT_TRUE(written.has_value()) << written.error().Message();
  }
  StageRequest Request(const std::string& stage, const nlohmann::json& options) const {
    StageRequest request;
    request.stage = stage;
    request.item = stage == "proportions" ? "p1" : clip_.id();
    request.options = options;
    request.inputs.push_back({"evidence", clip_.id(), folder_ / "evidence.h5", std::string(64, 'a')});
    request.output = folder_ / (stage + ".out");
    return request;
  }

  ScratchFolder folder_;
  Motion truth_;
  Clip clip_;
};

TEST_F(FittingStages, FitAMotionWithOneSetOfBones) {
  const auto proportions = ProportionsStage(Request("proportions", {{"skeleton", "openni16"}}));
  ASSERT_TRUE(proportions.has_value()) << proportions.error().Message();
  EXPECT_EQ(proportions->summary["person"], "p1");
  EXPECT_NEAR(proportions->summary["bone_length_m"]["left_knee"].get<double>(), 0.43 * 1.05, 2e-4);

  StageRequest request =
      Request("fitting", {{"skeleton", "openni16"}, {"joint_tracks", {{"steps", {{{"relative_tolerance", 1e-8}}}}}}});
  request.inputs.push_back({"proportions", "p1", folder_ / "proportions.out", std::string(64, 'b')});
  const auto fitted = FittingStage(request);
  ASSERT_TRUE(fitted.has_value()) << fitted.error().Message();
  EXPECT_EQ(fitted->kind, OutcomeKind::kDone);
  for (const char* key :
       {"method", "residual_rms_mm", "residual_p95_mm", "iterations", "termination", "before", "after"}) {
    EXPECT_TRUE(fitted->summary.contains(key)) << key;
  }
  const auto dataset = ReadDataset(request.output);
  ASSERT_TRUE(dataset.has_value()) << dataset.error().Message();
  ASSERT_EQ(dataset->clips.size(), 1u);
  const Motion& motion = *dataset->clips[0].motion;
  EXPECT_FALSE(motion.joints_only());
  for (int f = 0; f < 40; ++f) {
    EXPECT_LT((motion.joints.at(f, 6) - truth_.joints.at(f, 6)).norm(), 0.005) << "frame " << f;
  }
  EXPECT_EQ(dataset->clips[0].id(), clip_.id());
}

TEST_F(FittingStages, CheckAShareOfTheClipsWithBothSolvers) {
  int checked = 0;
  for (int r = 0; r < 12; ++r) {
    clip_.identity.recording = "r" + std::to_string(r);
    ASSERT_TRUE(WriteEvidence(clip_, folder_ / "evidence.h5"));
    const auto fitted = FittingStage(Request("fitting", {{"skeleton", "openni16"}, {"check", 0.5}}));
    ASSERT_TRUE(fitted) << fitted.error().Message();
    if (!fitted->summary.contains("check")) continue;
    ++checked;
    EXPECT_EQ(fitted->summary["check"]["solver"], "banded");
    EXPECT_EQ(fitted->summary["check"]["differ"], false) << fitted->summary["check"];
  }
  EXPECT_GT(checked, 2);
  EXPECT_LT(checked, 10);
}

TEST_F(FittingStages, ReportSolversThatDiffer) {
  FitResult fit;
  fit.motion = truth_;
  fit.final_cost = 2.0;
  fit.converged = true;
  struct Case {
    double moved_m, cost;
    bool converged, fixed, own;  ///< whether they differ with fixed and with own matches
  };
  const double nan = std::nan("");
  for (const Case& of :
       {Case{0.0, 2.0, true, false, false}, Case{0.9e-4, 2.0, true, false, false}, Case{1.1e-4, 2.0, true, true, false},
        Case{4.9e-3, 2.0, true, true, false}, Case{5.1e-3, 2.0, true, true, true},
        Case{0.0, 2.00001, true, true, false}, Case{0.0, 2.003, true, true, true}, Case{0.0, 2.0, false, true, true},
        Case{nan, 2.0, true, true, true}, Case{0.0, nan, true, true, true}}) {
    FitResult other = fit;
    other.motion.joints.at(7, 3).x() += of.moved_m;
    other.final_cost = of.cost;
    other.converged = of.converged;
    for (const bool fixed : {true, false}) {
      std::vector<Finding> findings;
      const nlohmann::json check =
          CheckOfSolvers(fit, "banded", other, fixed ? SolverMatches::kFixed : SolverMatches::kOwn, findings);
      const bool differ = fixed ? of.fixed : of.own;
      EXPECT_EQ(check["differ"], differ) << check;
      ASSERT_EQ(findings.size(), differ ? 1u : 0u) << check;
    }
  }
  std::vector<Finding> findings;
  const Expected<FitResult> none = Fail(ErrorCode::kInconsistent, "no pose");
  EXPECT_EQ(CheckOfSolvers(fit, "ceres", none, SolverMatches::kFixed, findings)["differ"], true);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "solvers_differ");
}

TEST_F(FittingStages, ExcludeAClipInAnotherUnitFromThePersonAndRefuseIt) {
  StageRequest sound = Request("proportions", {{"skeleton", "openni16"}});
  ASSERT_TRUE(ProportionsStage(sound).has_value());
  const nlohmann::json alone = nlohmann::json::parse(*ReadFile(sound.output));
  for (const auto& [factor, unit] : {std::pair{1000.0, "millimetres read as metres"},
                                     {100.0, "centimetres read as metres"},
                                     {0.1, "centimetres read as millimetres"},
                                     {0.001, "metres read as millimetres"}}) {
    Clip other = clip_;
    other.identity.recording = "r2";
    for (double& value : other.evidence.tracks->positions.xyz) value *= factor;
    ASSERT_TRUE(WriteEvidence(other, folder_ / "other.h5"));
    StageRequest both = sound;
    both.inputs.push_back({"evidence", other.id(), folder_ / "other.h5", std::string(64, 'c')});
    both.output = folder_ / "both.out";
    const auto person = ProportionsStage(both);
    ASSERT_TRUE(person.has_value()) << person.error().Message();
    const nlohmann::json json = nlohmann::json::parse(*ReadFile(both.output));
    EXPECT_EQ(json["bone_length_m"], alone["bone_length_m"]) << factor;
    ASSERT_EQ(person->findings.size(), 1u) << factor;
    EXPECT_EQ(person->findings[0].code, "another_size");
    EXPECT_EQ(person->findings[0].clip, other.id());

    StageRequest request = Request("fitting", {{"skeleton", "openni16"}});
    request.inputs = {{"evidence", other.id(), folder_ / "other.h5", std::string(64, 'c')},
                      {"proportions", "p1", folder_ / "both.out", std::string(64, 'b')}};
    const auto fitted = FittingStage(request);
    ASSERT_FALSE(fitted.has_value()) << factor;
    EXPECT_NE(fitted.error().what.find(unit), std::string::npos) << fitted.error().what;
    EXPECT_FALSE(std::filesystem::exists(request.output));
  }
}

TEST_F(FittingStages, ReportAClipWhoseBonesDifferFromThePersons) {
  const StageRequest sound = Request("proportions", {{"skeleton", "openni16"}});
  ASSERT_TRUE(ProportionsStage(sound).has_value());
  for (const double factor : {0.95, 1.0, 1.05, 0.88, 1.15}) {
    Clip other = clip_;
    for (double& value : other.evidence.tracks->positions.xyz) value *= factor;
    ASSERT_TRUE(WriteEvidence(other, folder_ / "other.h5"));
    StageRequest request = Request("fitting", {{"skeleton", "openni16"}});
    request.inputs = {{"evidence", other.id(), folder_ / "other.h5", std::string(64, 'c')},
                      {"proportions", "p1", sound.output, std::string(64, 'b')}};
    const auto fitted = FittingStage(request);
    ASSERT_TRUE(fitted.has_value()) << fitted.error().Message();
    const auto reported = std::find_if(fitted->findings.begin(), fitted->findings.end(),
                                       [](const Finding& finding) { return finding.code == "size_differs"; });
    ASSERT_EQ(reported != fitted->findings.end(), std::abs(factor - 1.0) > 0.08) << factor;
    if (reported != fitted->findings.end()) {
      EXPECT_NEAR(reported->value, factor, 5e-3);
    }
    EXPECT_EQ(fitted->kind, OutcomeKind::kDone) << "reported only";
  }
}

TEST_F(FittingStages, RefuseTracksThatNoPoseExplainsWithValues) {
  Clip shuffled = clip_;
  std::reverse(shuffled.evidence.tracks->names.begin(), shuffled.evidence.tracks->names.end());
  ASSERT_TRUE(WriteEvidence(shuffled, folder_ / "evidence.h5"));
  const auto fitted = FittingStage(Request("fitting", {{"skeleton", "openni16"}}));
  ASSERT_FALSE(fitted.has_value());
  EXPECT_EQ(fitted.error().code, ErrorCode::kInconsistent) << fitted.error().what;
}

TEST_F(FittingStages, KeepTheFindingsOfIngest) {
  Finding finding;
  finding.clip = clip_.id();
  finding.code = "handedness_contradiction";
  finding.message = "knees bend backwards";
  ASSERT_TRUE(WriteEvidence(clip_, folder_ / "evidence.h5", {finding}));
  StageRequest request = Request("fitting", {{"skeleton", "openni16"}});
  const auto fitted = FittingStage(request);
  ASSERT_TRUE(fitted.has_value()) << fitted.error().Message();
  const auto dataset = ReadDataset(request.output);
  ASSERT_TRUE(dataset.has_value()) << dataset.error().Message();
  ASSERT_EQ(dataset->findings.size(), 1u + fitted->findings.size());
  EXPECT_EQ(dataset->findings[0], finding);
  for (const Finding& own : fitted->findings) EXPECT_NE(own.code, finding.code);
}

TEST_F(FittingStages, ReportWhichDepthViewsWereExcludedAndWhy) {
  Finding excluded;
  excluded.clip = clip_.id();
  excluded.code = "depth_excluded";
  excluded.message = "C001 lacks the depth images of 63 of 71 frames";
  excluded.action = FindingAction::kExcluded;
  Finding no_person = excluded;
  no_person.code = "no_person_in_view";
  no_person.message = "C002 shows no person in its 71 frames";
  ASSERT_TRUE(WriteEvidence(clip_, folder_ / "evidence.h5", {excluded, no_person}));
  const nlohmann::json options = {{"skeleton", "openni16"}, {"method", "joints_and_clouds"}};
  const auto refused = FittingStage(Request("fitting", options));
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().what,
            "ingest excluded all depth views of the clip: C001 lacks the depth images of 63 of 71 "
            "frames; C002 shows no person in its 71 frames");
  EXPECT_NE(refused.error().hint.find("fitting.method joint_tracks"), std::string::npos) << refused.error().hint;

  ASSERT_TRUE(WriteEvidence(clip_, folder_ / "evidence.h5"));
  const auto none = FittingStage(Request("fitting", options));
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().what, "the clip has no depth images or point clouds");
}

TEST_F(FittingStages, WriteTheSameBytesAgain) {
  StageRequest request = Request("fitting", {{"skeleton", "openni16"}});
  ASSERT_TRUE(FittingStage(request).has_value());
  const auto first = ReadFile(request.output);
  request.output = folder_ / "again.out";
  ASSERT_TRUE(FittingStage(request).has_value());
  EXPECT_EQ(*first, *ReadFile(request.output));
}

TEST_F(FittingStages, RefuseASkeletonWithoutTheTrackedJoints) {
  const auto fitted = FittingStage(Request("fitting", {{"skeleton", "a2m21"}}));
  ASSERT_FALSE(fitted.has_value());
  EXPECT_EQ(fitted.error().code, ErrorCode::kInconsistent);
}

TEST_F(FittingStages, RefuseAMissingSkeletonAndUnknownOptions) {
  EXPECT_FALSE(FittingStage(Request("fitting", {{"skeleton", "no_such_skeleton"}})).has_value());
  const auto fitted = FittingStage(Request("fitting", {{"skeletn", "openni16"}}));
  ASSERT_FALSE(fitted.has_value());
  EXPECT_EQ(fitted.error().code, ErrorCode::kConfig);
}

TEST_F(FittingStages, RefuseProportionsThatAreNotJson) {
  ASSERT_TRUE(WriteFile(folder_ / "bad.json", "{\"person\"").has_value());
  StageRequest request = Request("fitting", {{"skeleton", "openni16"}});
  request.inputs.push_back({"proportions", "p1", folder_ / "bad.json", std::string(64, 'b')});
  const auto fitted = FittingStage(request);
  ASSERT_FALSE(fitted.has_value());
  EXPECT_EQ(fitted.error().code, ErrorCode::kMalformed);
}

TEST_F(FittingStages, PassThroughRequiresAMotion) {
  const auto fitted = FittingStage(Request("fitting", {{"method", "none"}}));
  ASSERT_FALSE(fitted.has_value());
  EXPECT_EQ(fitted.error().code, ErrorCode::kInconsistent) << fitted.error().what;
  EXPECT_EQ(fitted.error().where, clip_.id());
}

}  // namespace
}  // namespace mocurate
