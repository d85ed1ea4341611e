#include <sys/resource.h>
#include <sys/stat.h>

#include "core/pipeline/workspace.h"
#include "tests/pipeline/runs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

class Faults : public Runs {
 protected:
  /// Three items of which only "bad" misbehaves.
  static std::vector<ItemSpec> OneBad() {
    return {Item("good", {{"only", "bad"}}), Item("bad", {{"only", "bad"}}), Item("fine", {{"only", "bad"}})};
  }
};

TEST_F(Faults, AWorkerThatAbortsFailsItsItemWithAReason) {
  for (const int jobs : {1, 2}) {
    options.jobs = jobs;
    options.cache_folder = folder / ("cache" + std::to_string(jobs));
    const auto report = Run(Stage("abort"), OneBad());
    ASSERT_TRUE(report) << report.error().Message();
    EXPECT_EQ(report->done, 2);
    EXPECT_EQ(report->crashed, 1);
    EXPECT_EQ(report->items[1].outcome.kind, OutcomeKind::kCrashed);
    EXPECT_EQ(report->items[1].outcome.error.what,
              "worker killed by SIGABRT; last output line: terminate called: bad joint");
    EXPECT_EQ(Bytes(report->items[2]), "fine");
  }
  // A crash is never served from the cache: the item is tried again.
  const auto again = Run(Stage("abort"), OneBad());
  EXPECT_EQ(again->from_cache, 2);
  EXPECT_EQ(again->crashed, 1);
}

TEST_F(Faults, AKilledWorkerFailsOnlyItsItem) {
  const fs::path pid_file = folder / "pid";
  const pid_t killer = Fork([&] {
    if (!Eventually([&] { return fs::exists(pid_file); })) return 1;
    return kill(static_cast<pid_t>(std::stoi(ReadFile(pid_file).value())), SIGKILL) == 0 ? 0 : 1;
  });
  std::vector<ItemSpec> items = Many(6, {{"seconds", 0.02}, {"pid_file", (folder / "other").native()}});
  items[2].options = {{"seconds", 60.0}, {"pid_file", pid_file.native()}};
  const auto report = Run(Stage("pid"), items);
  EXPECT_EQ(Wait(killer), 0);
  ASSERT_TRUE(report) << report.error().Message();
  EXPECT_EQ(report->done, 5);
  EXPECT_EQ(report->crashed, 1);
  EXPECT_EQ(report->items[2].outcome.error.what, "worker killed by SIGKILL");
  EXPECT_EQ(Journal().size(), 6u);
}

TEST_F(Faults, AnItemThatHangsIsEndedByItsTimeLimit) {
  options.item_timeout_s = 0.5;
  const auto report = Run(Stage("hang"), OneBad());
  ASSERT_TRUE(report);
  EXPECT_EQ(report->done, 2);
  EXPECT_EQ(report->items[1].outcome.kind, OutcomeKind::kCrashed);
  EXPECT_EQ(report->items[1].outcome.error.what, "worker ran past the time limit of 0.5 s");
}

TEST_F(Faults, AnItemThatTakesTooMuchMemoryIsEnded) {
  options.item_memory_bytes = std::uint64_t{100} << 20;
  const auto report = Run(Stage("hog"), {Item("x")});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->crashed, 1);
  EXPECT_EQ(report->items[0].outcome.error.what, "worker ran past the memory limit of 104857600 bytes");
}

TEST_F(Faults, AStageHasItsOwnLimitsWhichARunMayReplace) {
  StageDeclaration hang = Stage("hang");
  hang.limits.time_s = 0.5;
  const auto own = Run(hang, OneBad());
  ASSERT_TRUE(own);
  EXPECT_EQ(own->items[1].outcome.error.what, "worker ran past the time limit of 0.5 s");
  EXPECT_EQ(own->items[1].outcome.error.hint, "pipeline.item_timeout sets it");
  options.time_factor = 2.0;  // more work was asked for
  EXPECT_EQ(Run(hang, OneBad())->items[1].outcome.error.what, "worker ran past the time limit of 1 s");
  options.item_timeout_s = 0.25;  // a limit of the run replaces that of the stage
  EXPECT_EQ(Run(hang, OneBad())->items[1].outcome.error.what, "worker ran past the time limit of 0.25 s");
  StageDeclaration hog = Stage("hog");
  hog.limits.memory_bytes = std::uint64_t{100} << 20;
  options.item_timeout_s.reset();
  EXPECT_EQ(Run(hog, {Item("x")})->items[0].outcome.error.hint, "pipeline.item_memory sets it");
  options.item_memory_bytes = std::uint64_t{50} << 20;
  EXPECT_EQ(Run(hog, {Item("x")})->items[0].outcome.error.what, "worker ran past the memory limit of 52428800 bytes");
}

TEST_F(Faults, AnItemExcludedByARuleIsNotAFailureAndIsCachedWithItsRule) {
  for (const int from_cache : {0, 1}) {
    const auto report = Run(Stage("exclude"), {Item("clip")});
    ASSERT_TRUE(report);
    EXPECT_EQ(report->excluded, 1);
    EXPECT_EQ(report->refused + report->crashed + report->done, 0);
    EXPECT_EQ(report->from_cache, from_cache);
    const Outcome& outcome = report->items[0].outcome;
    EXPECT_EQ(outcome.kind, OutcomeKind::kExcluded);
    EXPECT_FALSE(IsFailure(outcome.kind));
    EXPECT_EQ(outcome.findings.at(0).code, "too_short");
    EXPECT_EQ(outcome.error.what, "0.1 s, the least is 0.5 s");
    EXPECT_TRUE(report->items[0].artifact.empty());
  }
  EXPECT_EQ(Journal().at(0).at("outcome"), "excluded");
  EXPECT_EQ(Journal().at(0).at("reason"), "clip: 0.1 s, the least is 0.5 s");
}

TEST_F(Faults, AnExceptionOfAStageFailsItsItem) {
  const auto report = Run(Stage("throw"), {Item("x"), Item("y")});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->crashed, 2);
  EXPECT_EQ(report->items[0].outcome.error.what, "unexpected exception: joint 99 of 24");
}

TEST_F(Faults, AStageThatWritesNothingIsNotDone) {
  const auto report = Run(Stage("silent"), {Item("x")});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->crashed, 1);
}

TEST_F(Faults, ARefusalKeepsItsReasonAndIsServedFromTheCache) {
  for (const int from_cache : {0, 1}) {
    const auto report = Run(Stage("refuse"), {Item("clip")});
    ASSERT_TRUE(report);
    EXPECT_EQ(report->refused, 1);
    EXPECT_EQ(report->from_cache, from_cache);
    EXPECT_EQ(report->items[0].outcome.error,
              (Error{ErrorCode::kMalformed, "not a motion", "clip:3", "look at line 3"}));
    EXPECT_TRUE(report->items[0].artifact.empty());
  }
}

TEST_F(Faults, AMissingFileIsSearchedAgain) {
  EXPECT_EQ(Run(Stage("missing"), {Item("clip")})->refused, 1);
  EXPECT_EQ(Run(Stage("missing"), {Item("clip")})->from_cache, 0);
  const auto report = Run(Stage("upper"), {Over("gone", folder / "gone")});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->refused, 1);
  EXPECT_EQ(report->items[0].outcome.error.code, ErrorCode::kNotFound);
}

TEST_F(Faults, OutputOfALibraryDoesNotDisturbTheProtocol) {
  const auto report = Run(Stage("stdout_noise"), {Item("x"), Item("y"), Item("z")});
  ASSERT_TRUE(report) << report.error().Message();
  EXPECT_EQ(report->done, 3);
  EXPECT_EQ(Bytes(report->items[0]), "nothing on stdin");
}

TEST_F(Faults, ProgressOfAnItemIsNotAnOutcome) { EXPECT_EQ(Run(Stage("progress"), {Item("x")})->done, 1); }

TEST_F(Faults, AMissingWorkerProgramIsNamedWithARemedy) {
  const auto report = Run({"upper", 1, "mocurate-nowhere"}, {Item("x")});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kMissingOnHost);
  EXPECT_NE(report.error().what.find("mocurate-nowhere"), std::string::npos);
  EXPECT_FALSE(report.error().hint.empty());
}

TEST_F(Faults, AWorkerProgramThatDoesNotStartEndsTheRun) {
  const fs::path programs = folder / "programs";
  ASSERT_TRUE(MakeFolder(programs));
  for (const auto& [name, script] :
       {std::pair<std::string, std::string>{"unlinked", "echo libtorch.so: not found >&2; exit 127"},
        {"broken", "echo cannot start >&2; exit 3"}}) {
    ASSERT_TRUE(WriteFile(programs / name, "#!/bin/sh\n" + script + "\n"));
    chmod((programs / name).c_str(), 0755);
    options.worker_folder = programs;
    const auto report = Run({"upper", 1, name}, Many(8, {}));
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::kMissingOnHost);
    EXPECT_NE(report.error().what.find("does not start: ended with exit status"), std::string::npos);
    EXPECT_NE(report.error().what.find(name == "broken" ? "cannot start" : "libtorch"), std::string::npos);
  }
}

TEST_F(Faults, AWorkerThatDoesNotKnowTheStageEndsTheRun) {
  const auto report = Run(Stage("unheard_of"), {Item("x")});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kMissingOnHost);
}

TEST_F(Faults, AFullDiskEndsTheRunAndTheNextOneContinues) {
  std::vector<ItemSpec> items = Many(4, {{"seconds", 0.0}});
  ASSERT_EQ(Run(Stage("sleep"), {items[0], items[1]})->done, 2);
  const auto full = Run(Stage("write_fail"), items);
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kCannotWrite);
  EXPECT_EQ(full.error().where, "/dev/full");
  const auto next = Run(Stage("sleep"), items);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->from_cache, 2);
  EXPECT_EQ(next->done, 4);
}

TEST_F(Faults, AFullDiskEndsWith74AndTheRunCanBeContinued) {
  const pid_t pid = Fork([&] {
    const rlimit small{200000, 200000};
    setrlimit(RLIMIT_FSIZE, &small);
    return ExitOf(Stage("large"), Many(3, nlohmann::json::object()));
  });
  EXPECT_EQ(Wait(pid), static_cast<int>(ExitCode::kCannotWrite));
  EXPECT_EQ(Cache(options.cache_folder).Stat().objects, 0u);
  EXPECT_EQ(Run(Stage("large"), Many(3, nlohmann::json::object()))->done, 3);
}

TEST_F(Faults, NoRoomForTheJournalEndsWith74) {
  ASSERT_EQ(Run(Stage("sleep"), Many(2, {{"seconds", 0.0}}))->done, 2);
  const auto size = fs::file_size(options.run_folder / "journal.jsonl");
  const pid_t pid = Fork([&] {
    const rlimit small{size + 20, size + 20};
    setrlimit(RLIMIT_FSIZE, &small);
    return ExitOf(Stage("sleep"), Many(2, {{"seconds", 0.0}}));
  });
  EXPECT_EQ(Wait(pid), static_cast<int>(ExitCode::kCannotWrite));
  ASSERT_EQ(Run(Stage("sleep"), Many(2, {{"seconds", 0.0}}))->from_cache, 2);
}

TEST_F(Faults, AReadOnlyFolderIsNamed) {
  for (const bool run_folder : {true, false}) {
    const fs::path locked = folder / "read only";
    ASSERT_TRUE(MakeFolder(locked));
    chmod(folder.path().c_str(), 0777);
    chmod(locked.c_str(), 0555);
    (run_folder ? options.run_folder : options.cache_folder) = locked / "below";
    const pid_t pid = Fork([&] {
      if (geteuid() == 0 && setuid(65534) != 0) return 1;
      const auto report = Run(Stage("sleep"), Many(1, {{"seconds", 0.0}}));
      if (report) return 0;
      return report.error().Message().find("read only") == std::string::npos
                 ? 2
                 : static_cast<int>(ExitCodeOf(report.error().code));
    });
    EXPECT_EQ(Wait(pid), static_cast<int>(ExitCode::kCannotWrite));
    options.run_folder = folder / "run2";
  }
}

TEST_F(Faults, FilesKeptByARefusedItemAreNotRemoved) {
  const auto left = [&] {
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(options.cache_folder / "scratch")) {
      files += entry.path().filename() == "evidence" ? 1 : 0;
    }
    return files;
  };
  for (int run = 0; run < 2; ++run) {  // the second from the cache
    EXPECT_EQ(Run(Stage("refuse"), {Item("a", {{"keeps", true}}), Item("b", {{"keeps", false}})})->refused, 2);
    EXPECT_EQ(left(), 1);
    EXPECT_EQ(std::distance(fs::directory_iterator(options.cache_folder / "scratch"), {}), 1);
  }
}

TEST_F(Faults, OutputsOfKilledRunsAreClearedAway) {
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  const fs::path tmp = options.cache_folder / "tmp" / host;
  const pid_t pid = Fork([&] { return ExitOf(Stage("hang"), {Item("x")}); });
  ASSERT_TRUE(Eventually([&] {
    std::error_code missing;
    for (const auto& entry : fs::directory_iterator(tmp, missing)) {
      if (!fs::exists(entry.path() / "0")) continue;
      const fs::directory_iterator scratch(options.cache_folder / "scratch", missing);
      return scratch != fs::directory_iterator();
    }
    return false;
  }));
  kill(pid, SIGKILL);
  EXPECT_EQ(Wait(pid), -SIGKILL);
  EXPECT_EQ(Run(Stage("sleep"), Many(1, {{"seconds", 0.0}}))->done, 1);
  int left = 0;
  for (const auto& entry : fs::directory_iterator(tmp)) left += entry.is_directory() ? 1 : 0;
  EXPECT_EQ(left, 0);
  EXPECT_EQ(std::distance(fs::directory_iterator(options.cache_folder / "scratch"), {}), 1)
      << "that of the killed item";
}

TEST_F(Faults, ALinkInsteadOfTheLockOrTheJournalEndsWith74) {
  const fs::path victim = Source("victim", "old");
  for (const char* name : {"lock", "journal.jsonl"}) {
    for (const char* kind : {"link", "dangling link", "hard link", "pipe"}) {
      options.run_folder = folder / name / kind;
      ASSERT_TRUE(MakeFolder(options.run_folder));
      const fs::path file = options.run_folder / name;
      if (kind == std::string("link")) fs::create_symlink(victim, file);
      if (kind == std::string("dangling link")) fs::create_symlink(folder / "none", file);
      if (kind == std::string("hard link")) fs::create_hard_link(victim, file);
      if (kind == std::string("pipe")) mkfifo(file.c_str(), 0666);
      EXPECT_EQ(ExitOf(Stage("sleep"), Many(1, {{"seconds", 0.0}})), static_cast<int>(ExitCode::kCannotWrite)) << file;
      fs::remove(file);
    }
  }
  EXPECT_EQ(ReadFile(victim).value(), "old");
  EXPECT_FALSE(fs::exists(folder / "none"));
}

TEST_F(Faults, WhatAWorkerWritesStaysInACacheWithLinks) {
  const fs::path outside = folder / "outside", victim = outside / "victim";
  ASSERT_TRUE(MakeFolder(outside) && WriteFile(victim, "old"));
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  const fs::path &cache = options.cache_folder, tmp = cache / "tmp" / host;
  ASSERT_TRUE(MakeFolder(tmp) && MakeFolder(cache / "scratch/with_link"));
  fs::create_directory_symlink(outside, tmp / "killed");
  fs::create_symlink(victim, cache / "scratch/with_link/state");
  fs::create_directory_symlink(outside, cache / "scratch/is_link");
  auto workspace = Workspace::Make(cache, {});
  ASSERT_TRUE(workspace) << workspace.error().Message();
  const auto cleared = workspace->ScratchOf("with_link");
  ASSERT_TRUE(cleared) << cleared.error().Message();
  EXPECT_TRUE(cleared->lock) << "the folder of the key, without the link";
  EXPECT_TRUE(WriteFile(cleared->folder / "state", "x"));
  const auto refused = workspace->ScratchOf("is_link");
  EXPECT_TRUE(!refused && refused.error().code == ErrorCode::kCannotWrite);

  ASSERT_TRUE(MakeFolder(folder / "node"));
  fs::create_directory_symlink(outside, folder / "node" / ("mocurate-" + std::to_string(geteuid())));
  EXPECT_FALSE(Workspace::Make(cache, folder / "node"));
  EXPECT_EQ(ReadFile(victim).value(), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(outside), {}), 1);
}

TEST_F(Faults, AFolderOfTheNodeThatAnotherUserMadeIsRefused) {
  const fs::path node = folder / "node", ours = node / ("mocurate-" + std::to_string(geteuid()));
  ASSERT_TRUE(MakeFolder(ours));
  ASSERT_EQ(chmod(node.c_str(), 01777), 0);
  EXPECT_TRUE(Workspace::Make(options.cache_folder, node));
  if (geteuid() != 0 || chown(ours.c_str(), 65534, 65534) != 0) GTEST_SKIP() << "needs the administrator";
  EXPECT_FALSE(Workspace::Make(options.cache_folder, node));
}

}  // namespace
}  // namespace mocurate
