// No verb passes on what a terminal obeys from the names in the files that it reads.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/store/store.h"
#include "tests/app/program.h"
#include "tests/support/swinging_clips.h"

namespace mocurate {
namespace {

using program::Result;
using program::RunProgram;
using program::WriteText;

/// Clears the screen, sets the title, C1's form of it, and turns the direction of writing.
const std::string kHostile =
    "\x1b[2J\x1b]0;t\x07\xC2\x9B"
    "2J\xE2\x80\xAE";

/// Whether a terminal only shows the text.
bool OnlyShows(const std::string& text) {
  for (const char* obeyed : {"\x1b", "\x07", "\x7f", "\r", "\xC2\x9B", "\xE2\x80\xAE"}) {
    if (text.find(obeyed) != std::string::npos) return false;
  }
  return true;
}

class HostileNames : public ::testing::Test {
 protected:
  void SetUp() override {
    Dataset set = SwingingSet("smpl24");
    auto tree = std::make_shared<Skeleton>(*set.skeleton);
    tree->joints.back().name = "hand" + kHostile;
    tree->name = "tree" + kHostile;
    set.skeleton = tree;
    set.labels[0] = kHostile;
    set.recipe = kHostile;
    set.splits[0].name = "split" + kHostile;
    for (Clip& clip : set.clips) {
      clip.motion->skeleton = tree;
      clip.identity.person += kHostile;
      clip.identity.licence = kHostile;
      if (clip.label == "walk") clip.label = kHostile;
    }
    Finding finding;
    finding.clip = set.clips[0].id();
    finding.code = "code" + kHostile;
    finding.message = kHostile;
    set.findings = {finding};
    const Status written = WriteDataset(set, folder_ / "set.h5");
    ASSERT_TRUE(written) << written.error().Message();
    set.clips.pop_back();
    for (Split& split : set.splits) split.test.pop_back();
    ASSERT_TRUE(WriteDataset(set, folder_ / "less.h5"));
    WriteText(folder_ / "a.bvh", "HIERARCHY\nROOT " + kHostile +
                                     "\n{\n OFFSET 0 0 0\n CHANNELS 3 Xposition Yposition Zposition\n}\nMOTION\n"
                                     "Frames: 2\nFrame Time: 0.033\n0 0 0\n0 1 " +
                                     kHostile + "\n");
    WriteText(folder_ / "a.npy", std::string("\x93NUMPY\x01\x00\x76\x00", 10) + "{'descr': '" + kHostile +
                                     "', 'fortran_order': False, 'shape': (3,), }" + std::string(100, ' ') + "\n");
  }

  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  ScratchFolder folder_;
};

TEST_F(HostileNames, AreEscapedOnStdoutAndStderr) {
  const std::string set = Path("set.h5"), out = Path("new.h5");
  const std::vector<std::vector<std::string>> calls = {
      {"inspect", set},
      {"inspect", Path("a.bvh")},
      {"inspect", Path("a.npy")},
      {"config", "init", Path("a.bvh")},
      {"audit", set},
      {"dataset", "card", set},
      {"dataset", "card", set, "--croissant"},
      {"dataset", "diff", set, Path("less.h5")},
      {"dataset", "subset", set, "--where", "label == '" + kHostile + "'", "-o", out, "--force"},
      {"dataset", "merge", set, Path("less.h5"), "-o", out, "--force"},
      {"export", set, "--layout", "csv", "-o", Path("csv"), "--force"},
      {"export", set, "--layout", "actor", "-o", Path("actor"), "--force"},
      {"export", Path("a.bvh"), "--layout", "csv", "-o", Path("bvh"), "--force"},
      {"fit", Path("a.bvh"), "-o", out, "--force"},
      {"run", "--set", "ingest.synthetic.actions=[" + kHostile + "]"},
      {kHostile}};
  for (const std::vector<std::string>& call : calls) {
    for (const bool json : {false, true}) {
      std::vector<std::string> arguments = call;
      if (json) arguments.emplace_back("--json");
      const Result result = RunProgram(folder_, arguments);
      const std::string name = call[0] + " " + (call.size() > 1 ? call[1] : "");
      EXPECT_TRUE(OnlyShows(result.out)) << name << "\n" << result.out;
      EXPECT_TRUE(OnlyShows(result.err)) << name << "\n" << result.err;
      EXPECT_NE(result.exit_code, 70) << name << "\n" << result.err;
      EXPECT_TRUE(!json || nlohmann::json::accept(result.out)) << name << "\n" << result.out;
    }
  }
}

}  // namespace
}  // namespace mocurate
