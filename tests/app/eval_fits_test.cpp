// `mocurate eval --fits`: fits with ground truth.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"
#include "tests/app/program.h"

namespace mocurate {
namespace {

using program::ReadText;
using program::Result;
using program::WriteText;
using ::testing::HasSubstr;

/// Files of fits and their truth: clip "a" with errors of the stated deviations, 5 and 40 mm, "b" without any.
class EvalFits : public testing::Test {
 protected:
  void SetUp() override {
    Random random(1, "fits");
    const SkeletonPtr skeleton = LoadSkeleton("kinect20").value();
    const int frames = 30, joints = skeleton->joint_count();
    std::vector<Vector3d> root(frames, Vector3d(0.0, 0.9, 0.0));
    std::vector<Quaterniond> rotation(static_cast<std::size_t>(frames * joints), Quaterniond::Identity());
    truth_ = MakeMotion(skeleton, FrameRate{30, 1}, root, rotation, skeleton->RestBoneLengths());
    Motion fitted = MakeJointsOnly(skeleton, truth_.rate, truth_.joints);
    for (int i = 0; i < frames * joints; ++i) {
      const double sigma = i % 2 == 0 ? 0.005 : 0.04;
      for (int k = 0; k < 3; ++k) fitted.joints.xyz[static_cast<std::size_t>(3 * i + k)] += sigma * random.Normal();
      for (const double unit : {1.0, 0.0, 0.0, 1.0, 0.0, 1.0})
        fitted.position_cov.push_back(static_cast<float>(unit * sigma * sigma));
    }
    Write("fits.h5", {ClipOf("a", fitted)});
    Write("plain.h5", {ClipOf("a", MakeJointsOnly(skeleton, truth_.rate, truth_.joints))});
    Write("other.h5", {ClipOf("other", fitted)});
    Write("both.h5", {ClipOf("a", fitted), ClipOf("b", fitted)});
    Motion brief = truth_;
    brief.joints.frames = 20;
    brief.joints.xyz.resize(static_cast<std::size_t>(20 * joints * 3));
    brief.root_translation.resize(20);
    brief.rotation.resize(static_cast<std::size_t>(20 * joints));
    WriteMotions({{ClipOf("a", truth_).id(), truth_}}, "truth/p.h5");
    WriteMotions({{ClipOf("a", truth_).id(), truth_}, {ClipOf("b", truth_).id(), brief}}, "brief.h5");
  }

  static Clip ClipOf(const std::string& recording, const Motion& motion) {
    Clip clip;
    clip.identity = {"studio", "p1", recording, "", "", "", 0, motion.frame_count()};
    clip.rate = motion.rate;
    clip.motion = motion;
    return clip;
  }

  void Write(const std::string& file, const std::vector<Clip>& clips) const {
    Dataset dataset;
    dataset.skeleton = truth_.skeleton;
    dataset.joints_only = true;
    dataset.clips = clips;
    const Status written = WriteDataset(dataset, folder_ / file);
    ASSERT_TRUE(written) << written.error().Message();
  }

  void WriteMotions(const std::map<std::string, Motion>& motions, const std::string& file) const {
    std::filesystem::create_directories((folder_ / file).parent_path());
    const Status written = WriteTruth(Truth{motions}, folder_ / file);
    ASSERT_TRUE(written) << written.error().Message();
  }

  Result Eval(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"eval", "-j", "1"});
    return program::RunProgram(folder_, arguments);
  }
  std::string Path(const std::string& file) const { return (folder_ / file).string(); }

  ScratchFolder folder_;
  Motion truth_;
};

TEST_F(EvalFits, MeasuresStatedUncertaintyOfEachSet) {
  const std::vector<std::string> arguments = {"--fits",  Path("fits.h5"), "--fits", "plain=" + Path("plain.h5"),
                                              "--truth", Path("truth"),   "-o",     Path("out")};
  std::vector<std::string> json = arguments;
  json.emplace_back("--json");
  const Result result = Eval(json);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(ReadText(folder_ / "out/metrics.json")), result.Json());
  const nlohmann::json& rows = result.Json()["rows"];
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0]["name"], "fits");
  EXPECT_EQ(rows[0]["clips"], 1);
  const nlohmann::json& positions = rows[0]["sigma"]["groups"]["all"]["positions"];
  EXPECT_EQ(positions["samples"], 600);
  EXPECT_NEAR(positions["within_one_sigma"], 0.683, 0.04);
  EXPECT_LT(positions["ece"], 0.03);
  EXPECT_GT(positions["spearman"], 0.75);
  EXPECT_GT(positions["auc"], 0.75);
  EXPECT_NEAR(positions["risk_coverage_mm"][4], 8.0, 0.5) << "the mean of Maxwell's distribution is 1.6 deviations";
  EXPECT_TRUE(rows[1]["sigma"]["groups"]["all"]["positions"]["ece"].is_null());
  EXPECT_NEAR(rows[1]["joint_mm"], 0.0, 1e-3);
  const nlohmann::json& warnings = result.Json()["warnings"];
  EXPECT_EQ(warnings[0]["code"], "no_rotation_sigma");
  EXPECT_EQ(warnings[1]["code"], "no_position_cov");
  EXPECT_EQ(warnings[1]["row"], "plain");

  const Result text = Eval(arguments);
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("| positions: all | 600 |"));
  EXPECT_THAT(text.out, HasSubstr("| rotations: legs | 0 | - |"));
  EXPECT_THAT(text.err, HasSubstr("plain: 1 clip: no position_cov, so their positions are not measured"));
}

TEST_F(EvalFits, AClipThatCannotBeComparedIsExitCode1AndTheOthersAreMeasured) {
  const Result result = Eval({"--fits", Path("both.h5"), "--truth", Path("brief.h5"), "--json"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.Json()["rows"][0]["frames"], 30);
  EXPECT_THAT(result.Json()["warnings"].dump(), HasSubstr("the fit has 30 frames, the truth 20"));
  const Result without = Eval({"--fits", Path("both.h5"), "--truth", Path("truth"), "--json"});
  EXPECT_EQ(without.exit_code, 0) << without.err;
  EXPECT_EQ(without.Json()["rows"][0]["without_truth"], nlohmann::json({"studio/p1/b#0-30"}));
  EXPECT_THAT(without.Json()["warnings"].dump(), HasSubstr("no_truth"));
  const Result sets = Eval({"--fits", Path("fits.h5"), "--fits", Path("other.h5"), "--truth", Path("truth"), "--json"});
  EXPECT_EQ(sets.exit_code, 1);
  EXPECT_THAT(sets.Json()["failed"]["other"].dump(), HasSubstr("no fitted clip has a truth of its id"));
}

TEST_F(EvalFits, WhatCannotBeUsedIsNamedWithItsPlace) {
  WriteText(folder_ / "text.h5", "no HDF5");
  std::filesystem::create_directories(folder_ / "empty");
  const std::string fits = Path("fits.h5"), truth = Path("truth");
  const struct {
    std::vector<std::string> arguments;
    int exit_code;
    std::string place, what;
  } cases[] = {{{"--fits", fits}, 2, "--fits", "--truth"},
               {{"--truth", truth}, 2, "--truth", "--fits"},
               {{"--fits", fits, "--truth", truth, "--protocol", "own"}, 2, "--fits", "--protocol"},
               {{"--fits", fits, "--truth", truth, "--set", "variant=paper"}, 2, "--fits", "--set"},
               {{}, 2, "command line", "neither --protocol nor --fits is given"},
               {{"--fits", Path("none.h5"), "--truth", truth}, 3, "none.h5", "no such file"},
               {{"--fits", Path("empty"), "--truth", truth}, 3, "empty/dataset.h5", "no such file"},
               {{"--fits", Path("text.h5"), "--truth", truth}, 3, "text.h5", "not a dataset"},
               {{"--fits", fits, "--truth", Path("empty")}, 3, "empty", "no truth file (.h5) is here"},
               {{"--fits", fits, "--truth", Path("text.h5")}, 3, "text.h5", "fits.h5"},
               {{"--fits", Path("other.h5"), "--truth", truth},
                3,
                "other.h5",
                "no fitted clip has a truth of its id: the first fit is 'studio/p1/other#0-30', the first truth "
                "'studio/p1/a#0-30'"}};
  for (const auto& one : cases) {
    const Result result = Eval(one.arguments);
    EXPECT_EQ(result.exit_code, one.exit_code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(one.place));
    EXPECT_THAT(result.err, HasSubstr(one.what));
    EXPECT_EQ(result.out, "");
  }
}

}  // namespace
}  // namespace mocurate
