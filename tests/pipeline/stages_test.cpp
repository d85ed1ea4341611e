// The cases of the design, "Stages and the cache".

#include "core/base/sha256.h"
#include "core/pipeline/workspace.h"
#include "tests/pipeline/runs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// Two stages: every clip in upper case (per clip), then the sum of their bytes (over the set).
class TwoStages : public Runs {
 protected:
  TwoStages() {
    for (const char* name : {"a", "b", "c"}) Source(name, std::string("clip ") + name);
  }

  struct Result {
    StageReport upper, sum;
    int executed_upper() const { return static_cast<int>(upper.items.size()) - upper.from_cache; }
    int executed_sum() const { return static_cast<int>(sum.items.size()) - sum.from_cache; }
  };

  Expected<Result> RunBoth() {
    const Expected<std::unique_ptr<Runner>> runner = Runner::Make(options);
    if (!runner) return Forward(runner);
    std::vector<ItemSpec> clips;
    for (const char* name : {"a", "b", "c"}) clips.push_back(Over(name, folder / name, upper_options));
    Expected<StageReport> upper = (*runner)->Run(Stage("upper", upper_version), clips);
    if (!upper) return Forward(upper);
    ItemSpec set = Item("dataset", sum_options);
    for (const ItemResult& clip : upper->items) {
      if (!clip.artifact.empty()) set.inputs.push_back({"clip", clip.item, clip.artifact, clip.sha256});
    }
    Expected<StageReport> sum = (*runner)->Run(Stage("sum"), {set});
    if (!sum) return Forward(sum);
    return Result{*upper, *sum};
  }

  nlohmann::json upper_options = {{"suffix", "!"}};
  nlohmann::json sum_options = {{"factor", 1}};
  int upper_version = 1;
};

TEST_F(TwoStages, RunOnceAndAreThenServedFromTheCache) {
  const auto first = RunBoth();
  ASSERT_TRUE(first) << first.error().Message();
  EXPECT_EQ(first->executed_upper(), 3);
  EXPECT_EQ(first->upper.done, 3);
  EXPECT_EQ(Bytes(first->upper.items[1]), "CLIP B!");
  EXPECT_EQ(first->upper.items[1].summary.at("bytes"), 7);
  const auto again = RunBoth();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->executed_upper(), 0);
  EXPECT_EQ(again->executed_sum(), 0);
  EXPECT_EQ(again->upper.items[1].summary.at("bytes"), 7);
  EXPECT_EQ(Bytes(again->sum.items[0]), Bytes(first->sum.items[0]));
}

/// With the options and inputs that it was first made with, which the runner keeps packed.
TEST_F(TwoStages, AnArtifactThatDisappearsIsMadeAgain) {
  const Expected<std::unique_ptr<Runner>> runner = Runner::Make(options);
  ASSERT_TRUE(runner) << runner.error().Message();
  ItemSpec lower = Over("a", folder / "a", upper_options);
  lower.options.Set("suffix", "?\xff");
  lower.inputs.push_back({"source", "beside", folder / "b", {}});
  const auto upper = (*runner)->Run(Stage("upper"), {lower, Over("c", folder / "c", upper_options)});
  ASSERT_TRUE(upper) << upper.error().Message();
  const std::string bytes = Bytes(upper->items[0]);
  EXPECT_EQ(bytes, "CLIP A?\xff");
  ASSERT_TRUE(fs::remove(upper->items[0].artifact));
  ItemSpec set = Item("set", sum_options);
  for (const ItemResult& clip : upper->items) set.inputs.push_back({"clip", clip.item, clip.artifact, clip.sha256});
  const auto sum = (*runner)->Run(Stage("sum"), {set});
  ASSERT_TRUE(sum) << sum.error().Message();
  EXPECT_EQ(sum->done, 1) << sum->items[0].outcome.error.Message();
  EXPECT_EQ(Bytes(upper->items[0]), bytes);
}

TEST_F(TwoStages, AnOptionOfTheLaterStageDoesNotRerunTheEarlierOne) {
  ASSERT_TRUE(RunBoth());
  sum_options["factor"] = 2;
  const auto again = RunBoth();
  EXPECT_EQ(again->executed_upper(), 0);
  EXPECT_EQ(again->executed_sum(), 1);
}

TEST_F(TwoStages, TheContentOfOneFileRunsOnlyItsClip) {
  ASSERT_TRUE(RunBoth());
  Source("b", "clip B changed");
  const auto again = RunBoth();
  EXPECT_EQ(again->executed_upper(), 1);
  EXPECT_FALSE(again->upper.items[1].from_cache);
  EXPECT_EQ(again->executed_sum(), 1);
}

TEST_F(TwoStages, AFileRewrittenWithTheSameBytesRunsNothing) {
  ASSERT_TRUE(RunBoth());
  fs::remove(folder / "b");
  Source("b", "clip b");
  const auto again = RunBoth();
  EXPECT_EQ(again->executed_upper() + again->executed_sum(), 0);
}

TEST_F(TwoStages, ARerunWithTheSameBytesDoesNotRerunLaterStages) {
  ASSERT_TRUE(RunBoth());
  Source("b", "CLIP b");  // upper case is the same
  const auto again = RunBoth();
  EXPECT_EQ(again->executed_upper(), 1);
  EXPECT_EQ(again->executed_sum(), 0);
}

TEST_F(TwoStages, AnotherVersionOfAStageRunsItAgain) {
  ASSERT_TRUE(RunBoth());
  upper_version = 2;
  const auto again = RunBoth();
  EXPECT_EQ(again->executed_upper(), 3);
  EXPECT_EQ(again->executed_sum(), 0);
}

TEST_F(TwoStages, OneAndTwoJobsGiveTheSameBytes) {
  options.jobs = 1;
  const auto one = RunBoth();
  options.jobs = 2;
  options.cache_folder = folder / "other cache";
  const auto two = RunBoth();
  ASSERT_TRUE(one && two);
  EXPECT_EQ(two->executed_upper(), 3);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(one->upper.items[i].item, two->upper.items[i].item);
    EXPECT_EQ(one->upper.items[i].sha256, two->upper.items[i].sha256);
  }
  EXPECT_EQ(one->sum.items[0].sha256, two->sum.items[0].sha256);
}

TEST_F(TwoStages, TwoProcessesMayRaceForTheSameItems) {
  const auto racer = [&](const std::string& name) {
    return Fork([&, name] {
      options.run_folder = folder / name;
      return RunBoth() && ExitOf(Stage("sleep"), Many(20, {{"seconds", 0.005}})) == 0 ? 0 : 1;
    });
  };
  const pid_t one = racer("run 1"), two = racer("run 2");
  EXPECT_EQ(Wait(one), 0);
  EXPECT_EQ(Wait(two), 0);
  const Cache cache(options.cache_folder);
  EXPECT_EQ(cache.Stat().objects, 24u);
  EXPECT_TRUE(cache.Verify().empty());
  EXPECT_EQ(RunBoth()->executed_upper(), 0);
}

TEST_F(TwoStages, TwoProcessesMayTakeAndDiscardOneScratchFolder) {
  const auto racer = [&] {
    return Fork([&] {
      auto workspace = Workspace::Make(options.cache_folder, {});
      for (int round = 0; workspace && round < 2000; ++round) {
        const auto scratch = workspace->ScratchOf("key");
        if (!scratch || !WriteFile(scratch->folder / "state", "x")) return 1;
        workspace->Discard(*scratch);
      }
      return workspace ? 0 : 2;
    });
  };
  const pid_t one = racer(), two = racer();
  EXPECT_EQ(Wait(one), 0);
  EXPECT_EQ(Wait(two), 0);
}

/// Unfinished outputs of killed runs are removed; what lies beside them, or behind a link, is somebody's.
TEST_F(TwoStages, AWorkspaceRemovesItsOwnFoldersOnly) {
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  const fs::path tmp = options.cache_folder / "tmp" / host;
  for (const fs::path& made : {tmp / "thesis", tmp / "12-abc", tmp / "12-abcdef", folder / "home/thesis"})
    ASSERT_TRUE(MakeFolder(made));
  fs::create_directory_symlink(folder / "home", tmp / "13-abcdef");
  ASSERT_TRUE(Workspace::Make(options.cache_folder, {}));
  EXPECT_TRUE(fs::exists(tmp / "thesis"));
  EXPECT_TRUE(fs::exists(tmp / "12-abc"));
  EXPECT_FALSE(fs::exists(tmp / "12-abcdef"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "home"), {}), 1) << "no lock file either";
  for (const fs::path& place : {tmp, tmp.parent_path(), options.cache_folder / "scratch"}) {
    fs::remove_all(place);
    fs::create_directory_symlink(folder / "home", place);
    auto workspace = Workspace::Make(options.cache_folder, {});
    const bool scratch = place.filename() == "scratch";
    ASSERT_EQ(workspace.has_value(), scratch);
    EXPECT_EQ(scratch ? workspace->ScratchOf("key").error().code : workspace.error().code, ErrorCode::kCannotWrite);
    fs::remove(place);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder / "home"), {}), 1);
  }
}

/// A task of a plan takes inputs by their hashes: another file under such a hash would be served to later runs.
TEST_F(TwoStages, ATaskRefusesAnInputWithOtherBytesThanPlanned) {
  RunnerOptions task = options;
  task.task_journal = folder / "task.jsonl";
  ItemSpec mine = Over("a", folder / "a", upper_options), other = Over("a", folder / "b", upper_options);
  mine.inputs[0].sha256 = other.inputs[0].sha256 = *Sha256OfFile(folder / "a");
  ItemSpec endless = mine;
  endless.inputs[0].path = fs::path("/dev/zero");
  const auto runner = Runner::Make(task);
  ASSERT_TRUE(runner) << runner.error().Message();
  for (const ItemSpec& item : {other, endless}) {
    const auto report = (*runner)->Run(Stage("upper"), {item});
    ASSERT_TRUE(report) << report.error().Message();
    EXPECT_EQ(report->refused, 1);
    EXPECT_EQ(report->unrecorded, 1);
  }
  const auto report = (*runner)->Run(Stage("upper"), {mine});
  ASSERT_TRUE(report) << report.error().Message();
  EXPECT_EQ(report->done, 1);
  EXPECT_EQ(report->from_cache, 0) << "nothing was kept of the others";
  EXPECT_EQ(Bytes(report->items[0]), "CLIP A!");
}

TEST_F(TwoStages, ADryRunReportsWhatWouldRunAndTouchesNothing) {
  options.dry_run = true;
  const auto before = RunBoth();
  ASSERT_TRUE(before);
  EXPECT_EQ(before->upper.from_cache, 0);
  EXPECT_EQ(before->upper.items.size(), 3u);
  EXPECT_TRUE(before->upper.items[0].artifact.empty());
  EXPECT_FALSE(fs::exists(options.run_folder));
  EXPECT_FALSE(fs::exists(options.cache_folder));
  options.dry_run = false;
  ASSERT_TRUE(RunBoth());
  const std::size_t lines = Journal().size();
  Source("c", "new");
  options.dry_run = true;
  const auto after = RunBoth();
  EXPECT_EQ(after->upper.from_cache, 2);
  EXPECT_EQ(after->upper.done, 2);
  EXPECT_EQ(Journal().size(), lines);
}

TEST_F(TwoStages, TheJournalHasALinePerItem) {
  ASSERT_TRUE(RunBoth());
  ASSERT_TRUE(RunBoth());
  const std::vector<nlohmann::json> journal = Journal();
  ASSERT_EQ(journal.size(), 8u);
  EXPECT_EQ(journal[3]["stage"], "sum");
  EXPECT_EQ(journal[3]["item"], "dataset");
  EXPECT_EQ(journal[3]["outcome"], "done");
  EXPECT_EQ(journal[3]["from_cache"], false);
  EXPECT_EQ(journal[3]["key"].get<std::string>().size(), 64u);
  EXPECT_TRUE(journal[3]["seconds"].is_number());
  EXPECT_EQ(journal[3]["time"].get<std::string>().back(), 'Z');
  EXPECT_EQ(journal[7]["from_cache"], true);
}

TEST_F(TwoStages, NamesMayHoldSpacesAndBytesThatAreNotUtf8) {
  const fs::path odd = folder / "a b \xff";
  ASSERT_TRUE(MakeFolder(odd));
  options.run_folder = odd / "run \xfe";
  options.cache_folder = odd / "cache \xfd";
  const std::string name = "clip \xfc\n%41.bvh";
  const fs::path file = Source(name, "bytes");
  const auto report = Run(Stage("upper"), {Over(name, file, {{"suffix", "\xfb"}})});
  ASSERT_TRUE(report) << report.error().Message();
  EXPECT_EQ(report->items[0].item, name);
  EXPECT_EQ(Bytes(report->items[0]), "BYTES\xfb");
  EXPECT_EQ(Run(Stage("upper"), {Over(name, file, {{"suffix", "\xfb"}})})->from_cache, 1);
  EXPECT_EQ(Run(Stage("upper"), {Over(name, file, {{"suffix", "\xfa"}})})->from_cache, 0);
  EXPECT_EQ(Journal().size(), 3u);
}

TEST_F(TwoStages, AFolderCanBeInputAndArtifact) {
  const auto made = Run(Stage("folder"), {Item("set")});
  ASSERT_TRUE(made) << made.error().Message();
  ASSERT_EQ(made->done, 1);
  EXPECT_EQ(ReadFile(fs::path(made->items[0].artifact) / "sub" / "b").value(), "setsub/b");
  EXPECT_EQ(Run(Stage("folder"), {Item("set")})->from_cache, 1);
  const ItemSpec over = Over("clip", made->items[0].artifact);
  EXPECT_EQ(Run(Stage("environment"), {over})->from_cache, 0);
  EXPECT_EQ(Run(Stage("environment"), {over})->from_cache, 1);
}

TEST_F(TwoStages, WorkersGetOneThreadAndANeutralLocale) {
  const auto report = Run(Stage("environment"), {Item("x")});
  ASSERT_TRUE(report);
  EXPECT_EQ(Bytes(report->items[0]), "OPENBLAS_NUM_THREADS=1\nOMP_NUM_THREADS=1\nGLOG_minloglevel=2\nLC_ALL=C\n");
}

TEST_F(TwoStages, AStageWithoutItemsIsDoneAtOnce) {
  const auto report = Run(Stage("upper"), {});
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->items.empty());
}

}  // namespace
}  // namespace mocurate
