#include "core/pipeline/progress.h"

#include <fcntl.h>

#include <algorithm>

#include "core/base/file.h"
#include "core/base/json_text.h"

#include "tests/pipeline/runs.h"
#include "tests/support/terminal.h"

namespace mocurate {
namespace {

class OnATerminal : public Runs {
 protected:
  /// The output of a run of 20 short items on `stderr_file`, a descriptor that is read back from `read_file`.
  std::string Shown(int read_file, int stderr_file) {
    const pid_t pid = Fork([&] {
      dup2(stderr_file, STDERR_FILENO);
      SetLogLevel(LogLevel::kInfo);
      return ExitOf(Stage("sleep"), Many(20, {{"seconds", 0.03}}));
    });
    close(stderr_file);
    const std::string shown = ReadAll(read_file);
    EXPECT_EQ(Wait(pid), 0);
    return shown;
  }

  /// All that comes until the other end is closed; closes `file`.
  static std::string ReadAll(int file) {
    std::string text;
    char bytes[4096];
    for (ssize_t count = 0; (count = read(file, bytes, sizeof bytes)) > 0;) {
      text.append(bytes, static_cast<std::size_t>(count));
    }
    close(file);
    return text;
  }
};

TEST_F(OnATerminal, ALineShowsTheProgressOfTheStage) {
  const test::Terminal terminal;
  if (!terminal.exists()) GTEST_SKIP() << test::Terminal::kMissing;
  const std::string shown = Shown(dup(terminal.ours()), open(terminal.name().c_str(), O_RDWR | O_NOCTTY));
  EXPECT_NE(shown.find("\r\x1b[Ksleep "), std::string::npos) << shown;
  EXPECT_NE(shown.find("/20, "), std::string::npos) << shown;
  EXPECT_NE(shown.find(" s to go"), std::string::npos) << shown;
}

TEST_F(OnATerminal, ElsewhereThereIsOneLinePerStage) {
  int ends[2];
  ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
  const std::string shown = Shown(ends[0], ends[1]);
  EXPECT_EQ(shown.find('\r'), std::string::npos);
  EXPECT_EQ(std::count(shown.begin(), shown.end(), '\n'), 1) << shown;
  EXPECT_NE(shown.find("sleep: 20 items, 20 done, 0 from the cache, "), std::string::npos) << shown;
}

TEST_F(OnATerminal, OutputOfWorkersIsShownUnlessTheRunIsQuiet) {
  for (const bool quiet : {false, true}) {
    options.quiet = quiet;
    options.cache_folder = folder / (quiet ? "quiet" : "loud");
    int ends[2];
    ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
    const pid_t pid = Fork([&] {
      dup2(ends[1], STDERR_FILENO);
      return ExitOf(Stage("stdout_noise"), {Item("x")});
    });
    close(ends[1]);
    EXPECT_EQ(ReadAll(ends[0]).empty(), quiet);
    EXPECT_EQ(Wait(pid), 0);
  }
}

TEST(Progress, ItemsAtWorkAreRecordedUntilTheStageEnds) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / kProgressFile;
  ASSERT_TRUE(WriteFile(file, "of a run that was killed"));
  {
    Progress progress("train", 2, false, file);
    EXPECT_FALSE(std::filesystem::exists(file));
    progress.Detail("ACTOR/1", 0.25, "step 5 of 20");
    const auto record = ReadJson(file);
    ASSERT_TRUE(record) << record.error().Message();
    EXPECT_EQ(record->at("stage"), "train");
    EXPECT_EQ(record->at("items").at(0).at("item"), "ACTOR/1");
    EXPECT_EQ(record->at("items").at(0).at("share"), 0.25);
    EXPECT_EQ(record->at("items").at(0).at("text"), "step 5 of 20");
    progress.Count("ACTOR/1", true, false);
    EXPECT_TRUE(ReadJson(file)->at("items").empty());
  }
  EXPECT_FALSE(std::filesystem::exists(file));
  ASSERT_TRUE(WriteFile(folder / "a file", ""));
  Progress unwritable("train", 2, false, folder / "a file" / kProgressFile);  // has none, and goes on
  unwritable.Detail("ACTOR/1", 0.5, "");
  EXPECT_EQ(unwritable.Text(), "0/2, 50 % ");
}

TEST(Progress, FailuresAreCounted) {
  Progress progress("fitting", 4, false);
  progress.Count("a", true, true);
  progress.Count("b", false, false);
  EXPECT_EQ(progress.Text().substr(0, 3), "2/4");
  EXPECT_NE(progress.Text().find("1 failed"), std::string::npos);
}

}  // namespace
}  // namespace mocurate
