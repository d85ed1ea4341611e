// The recorded sets are fitted from end to end, each by its own configuration, with its files in another place.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "core/store/store.h"
#include "tests/app/program.h"
#include "tests/support/folders.h"

namespace mocurate::program {
namespace {

/// A set's recorded files: the folder of the test data, and which of its files stand for it.
struct RecordedSet {
  const char* config;
  const char* folder;
  const char* files;
  int clips;
  bool truth = false;
  /// Of the person. Where it is not given, the size is measured in the clouds, which takes most of a run: see
  /// RenderedStills, Turntable and CloudsRun.
  const char* height = "";
};

void PrintTo(const RecordedSet& set, std::ostream* stream) { *stream << set.config; }

void CopyMatching(const fs::path& from, const std::regex& wanted, const fs::path& to) {
  for (const auto& entry : fs::recursive_directory_iterator(from)) {
    const std::string name = fs::relative(entry.path(), from).string();
    if (!entry.is_regular_file() || !std::regex_match(name, wanted)) continue;
    fs::create_directories((to / name).parent_path());
    fs::copy_file(entry.path(), to / name);
  }
}

double LargestBoneSpread(const Motion& motion) {
  double most = 0.0;
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 1; j < motion.joint_count(); ++j) {
      const int parent = motion.skeleton->joints[j].parent;
      const double length = (motion.joints.at(f, j) - motion.joints.at(f, parent)).norm();
      most = std::max(most, std::abs(length - motion.bone_length[j]));
    }
  }
  return most;
}

class Reannotation : public testing::TestWithParam<RecordedSet> {};

TEST_P(Reannotation, GivesClipsOfConstantBonesAndAPageForEach) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const RecordedSet& set = GetParam();
  const ScratchFolder folder;
  CopyMatching(fs::path(data) / set.folder, std::regex(set.files), folder / "files");
  const fs::path config = fs::path(kSourceFolder) / "configs/reannotate" / (set.config + std::string(".yaml"));
  std::vector<std::string> arguments = {"run",    config.string(),
                                        "-o",     (folder / "run").string(),
                                        "--jobs", "1",
                                        "--set",  "ingest.path=" + (folder / "files").string(),
                                        "--set",  "report.videos=false"};
  if (*set.height != 0)
    arguments.insert(arguments.end(), {"--set", std::string("fitting.point_clouds.height=") + set.height});
  const Result run = RunProgram(folder, arguments, SharedCache());
  ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
  const auto dataset = ReadDataset(folder / "run/dataset.h5");
  ASSERT_TRUE(dataset) << dataset.error().Message();
  EXPECT_EQ(static_cast<int>(dataset->clips.size()), set.clips);
  for (const Clip& clip : dataset->clips) {
    ASSERT_FALSE(clip.motion->joints_only()) << clip.id();
    EXPECT_LT(LargestBoneSpread(*clip.motion), 1e-5) << clip.id();
    EXPECT_GT(clip.fit_rms, 0.0) << clip.id();
    EXPECT_LT(clip.fit_rms, 0.15) << clip.id();
  }
  const int pages = std::min(set.clips, 5);
  for (int i = 1; i <= pages; ++i) {
    EXPECT_TRUE(fs::exists(folder / ("run/report/clip_00" + std::to_string(i) + ".html"))) << i;
  }
  const std::string index = ReadText(folder / "run/report/index.html");
  EXPECT_THAT(index, testing::HasSubstr("href=\"clip_001.html\""));
  EXPECT_EQ(run.out.find("error against the truth") != std::string::npos, set.truth);
}

const RecordedSet kSets[] = {
    {"kard", "kinect/kard", "a0[19]_s0[12]_e01_realworld.txt", 4},
    {"msr_action3d", "kinect/msr_action3d", "a0[16]_s0[12]_e01_skeleton3D.txt", 4},
    {"utkinect", "kinect/utkinect", "(walk|throw)_s0[12]_e01.txt", 4},
    {"florence3d", "kinect/florence3d", "a0[15]_s1_id[0-9]*.txt", 7},
    {"cad60", "kinect/cad60", "[0-9]*.txt", 3},
    {"ntu", "ntu", ".*skeleton", 5},
    {"rendered_seq", "clouds/rendered_seq", ".*", 1, true, "1.737 m"},
    {"rendered_body", "clouds/rendered_body", "male_wave.*", 1, true, "1.737 m"},
    {"rgbd100", "rgbd100", "views/00000000[0-9][05]_.*", 1, false, "1.79 m"},
    {"panoptic", "cameras/panoptic", ".*", 3},
    {"pose2sim_single", "pose2sim", "(single/.*|Calib.qca.txt)", 1},
    {"pose2sim_two", "pose2sim", "(two/.*|Calib.qca.txt)", 2},
    {"pose2sim_both", "pose2sim", "((single|two)/.*|Calib.qca.txt)", 4},
};

INSTANTIATE_TEST_SUITE_P(RecordedSets, Reannotation, testing::ValuesIn(kSets),
                         [](const auto& set) { return std::string(set.param.config); });

}  // namespace
}  // namespace mocurate::program
