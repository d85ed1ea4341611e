#include <map>

#include "core/base/random.h"
#include "tests/pipeline/runs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

class Kills : public Runs {
 protected:
  /// A run of its own process whose one item writes its worker's pid and stays.
  pid_t StartStaying(double seconds) {
    const pid_t runner = Fork([&] {
      return ExitOf(Stage("pid"), {Item("first", {{"seconds", seconds}, {"pid_file", pid_file.native()}}),
                                   Item("second", {{"seconds", seconds}, {"pid_file", second_file.native()}})});
    });
    EXPECT_TRUE(Eventually([&] { return fs::exists(pid_file); }));
    return runner;
  }
  pid_t WorkerPid() const { return static_cast<pid_t>(std::stoi(ReadFile(pid_file).value())); }

  /// All artifacts of the slow stage, as one text.
  std::string AllBytes() {
    const auto report = Run(Stage("sleep"), slow);
    if (!report) return report.error().Message();
    std::string bytes;
    for (const ItemResult& item : report->items) bytes += Bytes(item) + "\n";
    return bytes;
  }

  fs::path pid_file = folder / "pid", second_file = folder / "second";
  std::vector<ItemSpec> slow = Many(60, {{"seconds", 0.03}});
};

TEST_F(Kills, WorkersDieWithTheirRunnerAlsoAfterSigkill) {
  const pid_t runner = StartStaying(3600.0);
  ASSERT_TRUE(Eventually([&] { return fs::exists(second_file); }));
  const pid_t second = static_cast<pid_t>(std::stoi(ReadFile(second_file).value()));
  EXPECT_TRUE(Alive(WorkerPid()));
  kill(runner, SIGKILL);
  EXPECT_EQ(Wait(runner), -SIGKILL);
  EXPECT_TRUE(Eventually([&] { return !Alive(WorkerPid()) && !Alive(second); }));
}

TEST_F(Kills, TwentyKillsAtAnyMomentLoseNoFinishedItem) {
  Random random(7, "moments of the kills");
  int killed = 0;
  for (int i = 0; i < 20; ++i) {
    const pid_t runner = Fork([&] { return ExitOf(Stage("sleep"), slow); });
    Pause(random.Uniform(0.005, 0.08));
    kill(runner, SIGKILL);
    killed += Wait(runner) == -SIGKILL ? 1 : 0;
  }
  EXPECT_GE(killed, 10);
  const std::string resumed = AllBytes();
  std::map<std::string, int> executed;
  for (const nlohmann::json& line : Journal()) {
    if (line["from_cache"] == false) executed[line["item"].get<std::string>()] += 1;
    EXPECT_EQ(line["outcome"], "done");
  }
  for (const auto& [item, times] : executed) EXPECT_EQ(times, 1) << item;
  EXPECT_TRUE(Cache(options.cache_folder).Verify().empty());

  options.cache_folder = folder / "undisturbed";
  EXPECT_EQ(resumed, AllBytes());
}

TEST_F(Kills, SigtermFinishesTheItemsInFlightAndEndsWith75) {
  options.jobs = 1;
  const pid_t runner = StartStaying(0.4);
  kill(runner, SIGTERM);
  EXPECT_EQ(Wait(runner), static_cast<int>(ExitCode::kInterrupted));
  const auto journal = Journal();
  ASSERT_EQ(journal.size(), 1u);
  EXPECT_EQ(journal[0]["item"], "first");
  EXPECT_EQ(journal[0]["outcome"], "done");
  EXPECT_FALSE(fs::exists(second_file));
}

TEST_F(Kills, TheMessageOfAnInterruptedRunExplainsHowToContinue) {
  const pid_t self = getpid();
  const pid_t caller = Fork([&] {
    if (!Eventually([&] { return fs::exists(pid_file); })) return 1;
    return kill(self, SIGINT);
  });
  options.jobs = 1;
  const auto report = Run(Stage("pid"), {Item("first", {{"seconds", 0.2}, {"pid_file", pid_file.native()}}),
                                         Item("second", {{"seconds", 0.2}, {"pid_file", pid_file.native()}})});
  EXPECT_EQ(Wait(caller), 0);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kInterrupted);
  EXPECT_NE(report.error().what.find("SIGINT in stage pid"), std::string::npos) << report.error().Message();
  EXPECT_EQ(report.error().hint, "run the same command again to continue");
}

TEST_F(Kills, ASecondSignalStopsAtOnce) {
  const pid_t runner = StartStaying(3600.0);
  const pid_t worker = WorkerPid();
  kill(runner, SIGINT);
  Pause(0.3);
  EXPECT_TRUE(Alive(worker));
  kill(runner, SIGINT);
  EXPECT_EQ(Wait(runner), static_cast<int>(ExitCode::kInterrupted));
  EXPECT_FALSE(Alive(worker));
  EXPECT_TRUE(Journal().empty());
}

TEST_F(Kills, ALongItemSavesItsStateAndContinuesFromThere) {
  const pid_t runner = Fork([&] { return ExitOf(Stage("patient"), {Item("training")}); });
  Pause(0.5);
  kill(runner, SIGTERM);
  EXPECT_EQ(Wait(runner), static_cast<int>(ExitCode::kInterrupted));
  const auto report = Run(Stage("patient"), {Item("training")});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->done, 1);
  EXPECT_GT(report->items[0].summary.at("begin").get<int>(), 5);
  EXPECT_TRUE(fs::is_empty(options.cache_folder / "scratch"));
}

TEST_F(Kills, TwoRunsDoNotShareARunFolder) {
  const pid_t runner = StartStaying(3600.0);
  const auto second = Runner::Make(options);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kUsage);
  EXPECT_NE(second.error().what.find("process " + std::to_string(runner)), std::string::npos);
  kill(runner, SIGKILL);
  EXPECT_EQ(Wait(runner), -SIGKILL);
  // A worker that was starting when its runner died holds the file until its exec.
  bool free = false;
  for (int i = 0; i < 100 && !free; ++i) {
    free = Runner::Make(options).has_value();
    if (!free) Pause(0.02);
  }
  EXPECT_TRUE(free) << "the lock ends with its holder";
}

}  // namespace
}  // namespace mocurate
