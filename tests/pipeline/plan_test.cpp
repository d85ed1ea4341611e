// Plans: every item is in one task, a task reads its own items alone, and a damaged file is refused.

#include "core/pipeline/plan.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/base/random.h"
#include "tests/pipeline/runs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

PlanHead Head() {
  PlanHead head;
  head.stage = "fitting";
  head.stage_version = 7;
  head.program = "0.1.0";
  head.config = "kard\xff";
  head.config_sha256 = std::string(64, 'a');
  head.arguments = {"--set", "x=1"};
  head.instructions = "avx2";
  head.cache = "/cache";
  return head;
}

std::vector<ItemSpec> ManyItems(std::size_t count) {
  std::vector<ItemSpec> items;
  for (std::size_t i = 0; i < count; ++i) {
    items.push_back({"clip " + std::to_string(i) + "\n\xfe",
                     {{"sigma", i % 3}, {"name", "shared\xff"}},
                     {{"evidence", "a%b", "/cache/objects/" + std::to_string(i), std::string(64, 'b')}}});
  }
  return items;
}

void ExpectEqual(const ItemSpec& a, const ItemSpec& b) {
  EXPECT_EQ(a.item, b.item);
  EXPECT_EQ(a.options, b.options);
  ASSERT_EQ(a.inputs.size(), b.inputs.size());
  for (std::size_t i = 0; i < a.inputs.size(); ++i) {
    EXPECT_EQ(a.inputs[i].role, b.inputs[i].role);
    EXPECT_EQ(a.inputs[i].name, b.inputs[i].name);
    EXPECT_EQ(a.inputs[i].path, b.inputs[i].path);
    EXPECT_EQ(a.inputs[i].sha256, b.inputs[i].sha256);
  }
}

TEST(Plan, TasksHaveAllItemsInOrder) {
  const ScratchFolder folder;
  for (const std::size_t tasks : {1, 3, 7}) {
    const std::vector<ItemSpec> items = ManyItems(20);
    const fs::path file = folder / "plan.json";
    const std::vector<std::size_t> ends = CutByCost(std::vector<double>(items.size(), 1.0), tasks);
    ASSERT_TRUE(Plan::Write(file, Head(), items, ends));
    EXPECT_TRUE(nlohmann::json::accept(*ReadFile(file))) << "other programs may read it";
    const auto plan = Plan::Open(file);
    ASSERT_TRUE(plan) << plan.error().Message();
    EXPECT_EQ(plan->head().tasks, tasks);
    EXPECT_EQ(plan->head().config, Head().config);
    EXPECT_EQ(plan->head().stage_version, Head().stage_version);
    std::size_t next = 0;
    for (std::size_t k = 0; k < tasks; ++k) {
      const auto task = plan->Task(k);
      ASSERT_TRUE(task) << task.error().Message();
      for (const ItemSpec& item : *task) ExpectEqual(item, items[next++]);
    }
    EXPECT_EQ(next, items.size());
    ASSERT_FALSE(plan->Task(tasks));
    EXPECT_EQ(plan->Task(tasks).error().code, ErrorCode::kUsage);
  }
}

TEST(Plan, WithoutItemsHasNoTask) {
  const ScratchFolder folder;
  ASSERT_TRUE(Plan::Write(folder / "plan.json", Head(), {}, {}));
  const auto plan = Plan::Open(folder / "plan.json");
  ASSERT_TRUE(plan) << plan.error().Message();
  EXPECT_EQ(plan->head().tasks, 0u);
  EXPECT_FALSE(plan->Task(0));
}

TEST(Plan, ATaskReadsNothingOfOthers) {
  const ScratchFolder folder;
  const std::vector<ItemSpec> items = ManyItems(100);
  const fs::path file = folder / "plan.json";
  ASSERT_TRUE(Plan::Write(file, Head(), items, CutByCost(std::vector<double>(100, 1.0), 10)));
  std::string text = *ReadFile(file);
  const std::string last = "clip 99";
  text.replace(text.find(last), last.size(), "\"}]{[,:");
  ASSERT_TRUE(WriteFile(file, text));
  const auto plan = Plan::Open(file);
  ASSERT_TRUE(plan);
  EXPECT_TRUE(plan->Task(0));
  ASSERT_FALSE(plan->Task(9));
  EXPECT_EQ(plan->Task(9).error().code, ErrorCode::kMalformed);
}

TEST(Plan, DamagedFilesAreRefused) {
  const ScratchFolder folder;
  const fs::path file = folder / "plan.json";
  EXPECT_EQ(Plan::Open(folder / "none.json").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(Plan::Write(file, Head(), ManyItems(5), {2, 5}));
  const std::string whole = *ReadFile(file);
  for (std::size_t length = 0; length < whole.size(); length += 7) {
    ASSERT_TRUE(WriteFile(file, whole.substr(0, length)));
    const auto plan = Plan::Open(file);
    if (!plan) continue;
    const auto task = plan->Task(1);
    EXPECT_TRUE(!task || task->size() == 3) << length;
  }
  Random random(1, "plans", "damage");
  for (int i = 0; i < 300; ++i) {
    std::string damaged = whole;
    damaged[random.Below(damaged.size())] = static_cast<char>(random.Below(256));
    ASSERT_TRUE(WriteFile(file, damaged));
    if (const auto plan = Plan::Open(file)) {
      for (std::size_t k = 0; k < 2; ++k) (void)plan->Task(k);  // any answer, but one
    }
  }
  std::string other = whole;
  other.replace(other.find("plan\": 2"), 8, "plan\": 3");
  ASSERT_TRUE(WriteFile(file, other));
  EXPECT_EQ(Plan::Open(file).error().code, ErrorCode::kUnsupported);
}

TEST(CutByCost, TasksAreNotEmptyAndOfAboutEqualCost) {
  Random random(1, "plans", "costs");
  for (int i = 0; i < 200; ++i) {
    std::vector<double> costs;
    for (std::size_t n = 1 + random.Below(60); costs.size() < n;) costs.push_back(0.1 + 10.0 * random.Uniform());
    const std::size_t wanted = 1 + random.Below(80);
    const std::vector<std::size_t> ends = CutByCost(costs, wanted);
    EXPECT_EQ(ends.size(), std::min(wanted, costs.size()));
    EXPECT_EQ(ends.back(), costs.size());
    const double mean = std::accumulate(costs.begin(), costs.end(), 0.0) / static_cast<double>(ends.size());
    std::size_t begin = 0;
    for (const std::size_t end : ends) {
      ASSERT_GT(end, begin);
      const auto first = costs.begin() + static_cast<std::ptrdiff_t>(begin);
      EXPECT_LT(std::accumulate(first, costs.begin() + static_cast<std::ptrdiff_t>(end), 0.0), 2.0 * mean + 10.1);
      begin = end;
    }
  }
}

class Planning : public Runs {
 protected:
  Expected<StageReport> PlanOf(const std::string& stage, const std::vector<ItemSpec>& first, std::size_t pilot = 0) {
    options.dry_run = true;
    request.stages = {stage};
    request.most = 1;
    request.pilot = [pilot](const std::string&) { return pilot; };
    return Ask(stage, first);
  }

  /// `stage`: the last.
  Expected<StageReport> Ask(const std::string& stage, const std::vector<ItemSpec>& first) {
    options.dry_run = true;
    request.take = [this](const StageDeclaration& of, std::vector<ItemSpec> items, double s) {
      taken = of.name;
      missing = std::move(items);
      seconds = s;
      return Status();
    };
    options.plan = request;
    const Expected<std::unique_ptr<Runner>> runner = Runner::Make(options);
    if (!runner) return Forward(runner);
    if (auto before = (*runner)->Run(Stage("upper"), first); !before || stage == "upper") return before;
    return (*runner)->Run(Stage(stage), Many(3, {}));
  }

  PlanRequest request;
  std::string taken;
  std::vector<ItemSpec> missing;
  double seconds = 0.0;
};

TEST_F(Planning, GathersMissingItemsAndRunsFewLeftoversOfEarlierStages) {
  const std::vector<ItemSpec> items = {Over("a", Source("a", "1")), Over("b", Source("b", "2")),
                                       Over("c", Source("c", "3"))};
  ASSERT_TRUE(PlanOf("upper", items));
  EXPECT_EQ(missing.size(), 3u);
  EXPECT_EQ(missing[0].inputs[0].sha256.size(), 64u);
  const auto needs = PlanOf("progress", items);
  ASSERT_FALSE(needs);
  EXPECT_EQ(needs.error().code, ErrorCode::kInconsistent);
  options.dry_run = false;
  options.plan.reset();
  ASSERT_TRUE(Run(Stage("upper"), {items[0], items[2]}));
  ASSERT_TRUE(PlanOf("progress", items)) << "one of three is executed at once";
  EXPECT_EQ(missing.size(), 3u);
  ASSERT_TRUE(PlanOf("upper", items));
  EXPECT_EQ(missing.size(), 0u);
}

TEST_F(Planning, OfSeveralStagesTheFirstThatLacksItemsIsPlanned) {
  const std::vector<ItemSpec> items = {Over("a", Source("a", "1")), Over("b", Source("b", "2"))};
  request.stages = {"upper", "progress"};
  ASSERT_TRUE(Ask("progress", items));
  EXPECT_EQ(taken, "upper");
  EXPECT_EQ(missing.size(), 2u);
  request.given_up = {"upper"};
  request.tolerated = 0.9;
  const auto too_many = Ask("progress", items);
  ASSERT_FALSE(too_many);
  EXPECT_EQ(too_many.error().code, ErrorCode::kTooManyFailures);
  request.tolerated = 1.0;
  ASSERT_TRUE(Ask("progress", items)) << "all of its items may be left out";
  EXPECT_EQ(taken, "progress");
  EXPECT_EQ(missing.size(), 3u);
}

TEST_F(Planning, APilotMeasuresHowLongItemsTake) {
  std::vector<ItemSpec> items;
  for (int i = 0; i < 10; ++i) items.push_back(Over(std::to_string(i), Source(std::to_string(i), "x")));
  ASSERT_TRUE(PlanOf("upper", items, 4));
  EXPECT_EQ(missing.size(), 6u);
  EXPECT_GT(seconds, 0.0);
}

}  // namespace
}  // namespace mocurate
