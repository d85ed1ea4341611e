// Exports as Python reads them: numpy, pickle and h5py, nothing of ours.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "core/geometry/rotation.h"
#include "tests/app/program.h"
#include "tests/support/folders.h"
#include "tests/support/swinging_clips.h"

namespace mocurate {
namespace {

using program::Result;
using program::RunProgram;

constexpr int kReadFrame = 5;  // that read_exports.py prints

/// Status and output of Debian's Python.
std::pair<int, std::string> RunPython(const std::vector<std::string>& words) {
  std::string command = "/usr/bin/python3";
  for (const std::string& word : words) command += " '" + word + "'";
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return {-1, ""};
  std::string text;
  char block[4096];
  for (std::size_t n = 0; (n = std::fread(block, 1, sizeof(block), pipe)) > 0;) text.append(block, n);
  return {::pclose(pipe), text};
}

class ExportsInPython : public ::testing::Test {
 protected:
  void SetUp() override {
    if (RunPython({"-c", "import h5py"}).first != 0) {
      if (std::getenv("MOCURATE_DATA") != nullptr) FAIL() << "python3-h5py is not installed";
      GTEST_SKIP() << "python3-h5py is not installed";
    }
    const Status written = WriteDataset(dataset_, folder_ / "set.h5");
    ASSERT_TRUE(written) << written.error().Message();
  }

  static nlohmann::json Answer(const std::vector<std::string>& arguments) {
    std::vector<std::string> words = {std::string(kSourceFolder) + "/tests/app/read_exports.py"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const auto [status, text] = RunPython(words);
    EXPECT_EQ(status, 0) << text;
    const nlohmann::json answer = nlohmann::json::parse(text, nullptr, false);
    EXPECT_TRUE(answer.is_object()) << text;
    return answer;
  }

  /// What Python reads of an export, by clip id.
  nlohmann::json Read(const std::string& layout, const std::vector<std::string>& more = {}) {
    const std::string output = (folder_ / layout).string();
    std::vector<std::string> words = {"export", (folder_ / "set.h5").string(), "-o", output, "--layout", layout};
    words.insert(words.end(), more.begin(), more.end());
    const Result result = RunProgram(folder_, words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Answer({layout, output});
  }

  const Motion& MotionOf(std::size_t i) const { return *dataset_.clips[i].motion; }
  std::string Id(std::size_t i) const { return dataset_.clips[i].id(); }

  /// Numbers of joint j of the frame that is printed.
  static Vector3d Three(const nlohmann::json& rows, int j) {
    return {rows[j][0].get<double>(), rows[j][1].get<double>(), rows[j][2].get<double>()};
  }

  const Dataset dataset_ = SwingingSet("smpl24");
  const ScratchFolder folder_;
};

TEST_F(ExportsInPython, ArraysHoldJointsRotationsAndRate) {
  const nlohmann::json read = Read("npz", {"--as", "axis_angle"});
  for (std::size_t i = 0; i < dataset_.clips.size(); ++i) {
    const nlohmann::json& clip = read.at(Id(i));
    EXPECT_EQ(clip["frames"], MotionOf(i).frame_count());
    EXPECT_NEAR(clip["rate"].get<double>(), 30000.0 / 1001.0, 1e-9);
    for (int j = 0; j < 24; ++j) {
      EXPECT_LT((Three(clip["joints"], j) - MotionOf(i).joints.at(kReadFrame, j)).norm(), 1e-5);
      EXPECT_LT(ExpQuaternion(Three(clip["poses"], j)).angularDistance(MotionOf(i).rotation_at(kReadFrame, j)), 1e-5);
    }
  }
}

TEST_F(ExportsInPython, HumanAct12HasJointsWithYDownAndNamesWithPersonAndLabel) {
  const nlohmann::json read = Read("humanact12");
  for (std::size_t i = 0; i < dataset_.clips.size(); ++i) {
    const nlohmann::json& clip = read.at(Id(i));
    EXPECT_EQ(clip["frames"], MotionOf(i).frame_count());
    EXPECT_EQ(clip["coarse"], i == 1 ? "02" : "01");
    EXPECT_EQ(clip["person"], i < 2 ? "P01" : "P02");
    for (int j = 0; j < 24; ++j) {
      const Vector3d own = MotionOf(i).joints.at(kReadFrame, j);
      EXPECT_LT((Three(clip["joints"], j) - Vector3d(own.x(), -own.y(), -own.z())).norm(), 1e-5);
    }
  }
  EXPECT_EQ(read.at(Id(1))["part"], "validation");
  EXPECT_EQ(read.at(Id(3))["part"], "test");
}

TEST_F(ExportsInPython, ActorHasRotationsOfTheCamerasAxesAndFurtherLists) {
  const nlohmann::json read = Read("actor");
  const Quaterniond half_turn(0.0, 1.0, 0.0, 0.0);  // y down from y up
  for (std::size_t i = 0; i < dataset_.clips.size(); ++i) {
    const nlohmann::json& clip = read.at(Id(i));
    EXPECT_EQ(clip["label"], dataset_.clips[i].label);
    EXPECT_EQ(clip["person"], dataset_.clips[i].identity.person);
    for (int j = 0; j < 24; ++j) {
      const Quaterniond own = MotionOf(i).rotation_at(kReadFrame, j);
      EXPECT_LT(ExpQuaternion(Three(clip["poses"], j)).angularDistance(j == 0 ? half_turn * own : own), 1e-5);
      const Vector3d place = half_turn * Vector3d(MotionOf(i).joints.at(kReadFrame, j));
      EXPECT_LT((Three(clip["joints"], j) - place).norm(), 1e-5);
    }
  }
  EXPECT_EQ(read.at(Id(0))["part"], "train");
  EXPECT_EQ(read.at(Id(1))["part"], "validation");
}

TEST_F(ExportsInPython, AmassHasSmplHWithZUpAndBabelTheLabelsOfItsSplit) {
  const nlohmann::json read = Read("amass_babel", {"--split", "persons"});
  for (std::size_t i = 0; i < dataset_.clips.size(); ++i) {
    const nlohmann::json& clip = read.at(Id(i));
    EXPECT_EQ(clip["part"], i < 2 ? "train" : "test");
    EXPECT_EQ(clip["label"], dataset_.clips[i].label);
    const Vector3d root = MotionOf(i).root_translation[kReadFrame];
    EXPECT_NEAR(clip["trans"][0].get<double>(), root.x(), 1e-6);
    EXPECT_NEAR(clip["trans"][1].get<double>(), -root.z(), 1e-6);
    EXPECT_NEAR(clip["trans"][2].get<double>(), root.y(), 1e-6) << "z points up";
    const Quaterniond z_up(Eigen::AngleAxisd(0.5 * 3.14159265358979323846, Vector3d::UnitX()));
    for (int j = 0; j < 22; ++j) {
      const Quaterniond own = MotionOf(i).rotation_at(kReadFrame, j);
      EXPECT_LT(ExpQuaternion(Three(clip["poses"], j)).angularDistance(j == 0 ? z_up * own : own), 1e-5);
    }
  }
  EXPECT_EQ(read.at(Id(2))["segments"], nlohmann::json::parse(R"([["step", 0.0, 0.25, ["walk", "step"]],
                                                        ["turn", 0.25, 0.6, ["turn"]]])"));
}

TEST_F(ExportsInPython, TablesHoldSecondsAndMetres) {
  const nlohmann::json read = Read("csv");
  for (std::size_t i = 0; i < dataset_.clips.size(); ++i) {
    const nlohmann::json& clip = read.at(Id(i));
    EXPECT_EQ(clip["frames"], MotionOf(i).frame_count());
    EXPECT_NEAR(clip["rate"].get<double>(), 30000.0 / 1001.0, 1e-3);
    for (int j = 0; j < 24; ++j) {
      EXPECT_LT((Three(clip["joints"], j) - MotionOf(i).joints.at(kReadFrame, j)).norm(), 1e-5);
    }
  }
}

TEST_F(ExportsInPython, TheExampleDatasetGivesWindowsAndClasses) {
  const nlohmann::json read =
      Answer({"dataset", (folder_ / "set.h5").string(), std::string(kSourceFolder) + "/examples/python"});
  ASSERT_EQ(read["whole"].size(), dataset_.clips.size());
  EXPECT_EQ(read["names"], nlohmann::json(dataset_.labels));
  for (std::size_t i = 0; i < dataset_.clips.size(); ++i) {
    const nlohmann::json& clip = read["whole"][i];
    EXPECT_EQ(clip["frames"], MotionOf(i).frame_count());
    EXPECT_EQ(clip["label"], dataset_.LabelIndex(dataset_.clips[i].label));
    for (int j = 0; j < 24; ++j) {
      EXPECT_LT((Three(clip["joints"], j) - MotionOf(i).joints.at(kReadFrame, j)).norm(), 1e-6);
    }
  }
  EXPECT_EQ(read["windows"], nlohmann::json::parse("[[10, 24, 4], [10, 24, 4]]"));
  EXPECT_EQ(read["held"], true) << "a clip that is too short stands still at its end";
}

}  // namespace
}  // namespace mocurate
