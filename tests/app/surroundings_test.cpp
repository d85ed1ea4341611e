// Environments of the program: a terminal or a pipe, a locale, unusual file names, a warm or a cold cache.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <clocale>
#include <map>

#include "tests/app/program.h"
#include "tests/support/terminal.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::SmallJob;
using program::Started;
using program::Surroundings;
using program::WriteText;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::string> With(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// Every file below a folder with its bytes and time.
std::map<std::string, std::string> Snapshot(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string time = std::to_string(fs::last_write_time(entry).time_since_epoch().count());
    files[entry.path().native()] = entry.is_regular_file() ? time + ReadText(entry.path()) : time;
  }
  return files;
}

TEST(DryRun, OfAColdCacheReportsWorkAndWritesNothing) {
  const ScratchFolder folder;
  const Result result = RunProgram(folder, With(SmallJob(folder, "r"), {"--dry-run"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              HasSubstr("dry run: 1 item would run, and the items that depend on it up to the stage assemble"));
  EXPECT_FALSE(fs::exists(folder / "r"));
  EXPECT_FALSE(fs::exists(folder / "cache"));
}

TEST(DryRun, OfAWarmCacheReportsNoWorkAndWritesNothing) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "r")).exit_code, 0);
  const auto run = Snapshot(folder / "r"), cache = Snapshot(folder / "cache");
  const Result result = RunProgram(folder, With(SmallJob(folder, "r"), {"--dry-run"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("dry run: nothing would run: every item is in the cache"));
  EXPECT_THAT(result.out, ::testing::ContainsRegex("fitting +15 items from the cache, 0 would run"));
  EXPECT_THAT(result.out, Not(HasSubstr("0 kept"))) << "of a run that was not";
  EXPECT_EQ(RunProgram(folder, With(SmallJob(folder, "r"), {"--dry-run", "--json"})).Json()["executed"], 0);
  EXPECT_TRUE(run == Snapshot(folder / "r"));
  EXPECT_TRUE(cache == Snapshot(folder / "cache"));

  const Result changed =
      RunProgram(folder, With(SmallJob(folder, "r"), {"--dry-run", "--json", "--set", "canon.facing.anchor=last"}));
  EXPECT_EQ(changed.Json()["executed"], changed.Json()["clips"]) << "every clip is canonicalised again";
}

/// What a program prints to a terminal.
std::string OnATerminal(const ScratchFolder& folder, const std::vector<std::string>& arguments) {
  const test::Terminal terminal;
  EXPECT_TRUE(terminal.exists()) << test::Terminal::kMissing;
  Surroundings surroundings;
  surroundings.before_start = [name = terminal.name()] { dup2(open(name.c_str(), O_RDWR | O_NOCTTY), STDERR_FILENO); };
  Started run(folder, arguments, surroundings);
  std::string text;
  char bytes[4096];
  while (true) {
    const bool running = run.Running();
    pollfd wait{terminal.ours(), POLLIN, 0};
    const ssize_t count = poll(&wait, 1, 50) > 0 ? read(terminal.ours(), bytes, sizeof bytes) : 0;
    if (count > 0) text.append(bytes, static_cast<std::size_t>(count));
    if (!running && count <= 0) break;
  }
  EXPECT_EQ(run.Wait().exit_code, 0) << text;
  return text;
}

TEST(Progress, IsDrawnOnATerminalUnlessQuiet) {
  if (!test::Terminal().exists()) GTEST_SKIP() << test::Terminal::kMissing;
  const ScratchFolder folder;
  const std::string terminal = OnATerminal(folder, SmallJob(folder, "r"));
  EXPECT_THAT(terminal, HasSubstr("\r\x1b[Kfitting "));
  EXPECT_THAT(terminal, HasSubstr("/15"));
  EXPECT_THAT(OnATerminal(folder, With(SmallJob(folder, "quiet"), {"--quiet"})), Not(HasSubstr("\x1b[K")));
}

TEST(Progress, IsOneLineAStageInAPipe) {
  const ScratchFolder folder;
  const Result piped = RunProgram(folder, SmallJob(folder, "r"), program::SharedCache());
  EXPECT_EQ(piped.exit_code, 0);
  EXPECT_THAT(piped.err, Not(HasSubstr("\r")));
  EXPECT_THAT(piped.err, Not(HasSubstr("\x1b")));
  EXPECT_THAT(piped.err, HasSubstr("fitting: 15 items"));
}

/// Makes a locale with a decimal comma below `folder`, and the variables to use it.
Surroundings CommaLocale(const ScratchFolder& folder) {
  const pid_t made = fork();
  const std::string target = folder / "de_DE.UTF-8";
  if (made == 0) {
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    execlp("localedef", "localedef", "-i", "de_DE", "-f", "UTF-8", target.c_str(), nullptr);
    _exit(127);
  }
  waitpid(made, nullptr, 0);
  Surroundings surroundings;
  surroundings.before_start = [path = folder.path().native()] {
    setenv("LOCPATH", path.c_str(), 1);
    setenv("LC_ALL", "de_DE.UTF-8", 1);
    setenv("LANG", "de_DE.UTF-8", 1);
    if (setlocale(LC_ALL, "") == nullptr || std::string(localeconv()->decimal_point) != ",") _exit(99);
  };
  return surroundings;
}

TEST(Locale, ADecimalCommaChangesNoByteAndNoNumber) {
  const ScratchFolder folder;
  Surroundings comma = CommaLocale(folder);
  const std::vector<std::string> rate = {"--json", "--set", "canon.trim.margin=0.25 s"};
  const Result point = RunProgram(folder, With(SmallJob(folder, "point"), rate), program::SharedCache());
  ASSERT_EQ(point.exit_code, 0) << point.err;
  comma.cache = "comma_cache";
  const Result german = RunProgram(folder, With(SmallJob(folder, "comma"), rate), comma);
  ASSERT_EQ(german.exit_code, 0) << "99: no locale with a decimal comma, install `locales`; " << german.err;
  EXPECT_EQ(point.Json()["fit_error"], german.Json()["fit_error"]);
  EXPECT_TRUE(ReadText(folder / "point/dataset.h5") == ReadText(folder / "comma/dataset.h5"));
  EXPECT_EQ(ReadText(folder / "point/curation_log.jsonl"), ReadText(folder / "comma/curation_log.jsonl"));
  for (const std::vector<std::string>& verb :
       {std::vector<std::string>{"config", "show", "--set", "ingest.synthetic.dropout=0.125"},
        {"inspect", (folder / "point/dataset.h5").string()},
        {"inspect", (folder / "point/capture").string()},
        {"config", "schema"}}) {
    const Result here = RunProgram(folder, verb);
    EXPECT_EQ(here.exit_code, 0) << here.err;
    EXPECT_EQ(here.out, RunProgram(folder, verb, comma).out) << verb[0];
  }
}

TEST(FileNames, MayHoldBytesThatAreNotUtf8UnderThePlainLocale) {
  const ScratchFolder folder;
  Surroundings plain{program::SharedCache()};
  plain.before_start = [] { setenv("LC_ALL", "C", 1); };
  ASSERT_EQ(RunProgram(folder, SmallJob(folder, "r"), plain).exit_code, 0);
  fs::copy(folder / "r/capture", folder / "odd c\xe4pture");
  fs::path chosen;
  for (const auto& entry : fs::directory_iterator(folder / "odd c\xe4pture")) chosen = std::max(chosen, entry.path());
  fs::rename(chosen, chosen.parent_path() / "wave_p99_rJ\xf6rg.txt");
  const Result described = RunProgram(folder, {"inspect", (folder / "odd c\xe4pture").string(), "--json"}, plain);
  EXPECT_EQ(described.exit_code, 0) << described.err;
  EXPECT_THAT(described.Json().dump(), HasSubstr("odd c\\\\xe4pture"));
  EXPECT_THAT(described.out, HasSubstr("J\\\\xf6rg"));

  fs::rename(folder / "odd c\xe4pture", folder / "capture");
  const Result with_name =
      RunProgram(folder,
                 With(SmallJob(folder, "odd r\xfcn"), {"--set", "ingest.synthetic.enabled=false", "--set",
                                                       "ingest.path=" + (folder / "capture").string(), "--json"}),
                 plain);
  EXPECT_EQ(with_name.exit_code, 0) << with_name.err;
  EXPECT_EQ(with_name.Json()["kept"], with_name.Json()["clips"]);
  EXPECT_TRUE(fs::exists(folder.path() / "odd r\xfcn" / "dataset.h5"));
  EXPECT_THAT(ReadText(folder.path() / "odd r\xfcn" / "curation_log.jsonl"), HasSubstr("xf6rg"));
}

}  // namespace
}  // namespace mocurate
