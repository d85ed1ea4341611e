// Files that people exchange, from a stranger: nested without end, of wrong types, with references to the environment
// and includes of other files. They are refused with their name (3, or 2 for configurations), and read nothing else.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "tests/app/program.h"
#include "tests/store/builders.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::WriteText;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kSecret = "TOP_SECRET_4711";

std::string Nested() { return std::string(400000, '[') + std::string(400000, ']'); }

std::string Safetensors(const std::string& header) {
  std::string bytes;
  for (std::size_t i = 0; i < 8; ++i) bytes += static_cast<char>(header.size() >> (8 * i) & 0xFF);
  return bytes + header;
}

class ExchangedFiles : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }
  std::string Put(const std::string& name, const std::string& text) const {
    WriteText(folder_ / name, text);
    return Path(name);
  }
  std::string Dataset() const {
    const Status written = WriteDataset(test::MakeDataset(), folder_ / "set.h5");
    EXPECT_TRUE(written) << written.error().Message();
    return Path("set.h5");
  }
  /// With SECRET in the environment, 8 GB of address space (libraries of workers take most) and 20 s.
  Result Run(const std::vector<std::string>& arguments, const std::string& cache = "cache") const {
    program::Surroundings surroundings{cache};
    surroundings.before_start = [] {
      setenv("SECRET", kSecret, 1);
      const rlimit memory{rlim_t{8} << 30, rlim_t{8} << 30};
      setrlimit(RLIMIT_AS, &memory);
      alarm(20);
    };
    return RunProgram(folder_, arguments, surroundings);
  }
  void ExpectRefused(const std::vector<std::string>& arguments, int exit_code, const std::string& part) const {
    const Result result = Run(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << testing::PrintToString(arguments) << result.err;
    EXPECT_THAT(result.err, HasSubstr(part)) << testing::PrintToString(arguments);
  }

  const ScratchFolder folder_;
};

TEST_F(ExchangedFiles, NestedJsonIsRefusedByEveryVerb) {
  const std::string set = Dataset(), deep = Nested();
  const std::string key = Put("key.json", R"({"kind": )" + deep + "}");
  const std::string audit = Put("audit.json", R"({"findings": [{"code": )" + deep + "}]}");
  const std::string plan = Put("plan.json", R"({"mocurate_plan": )" + deep + ", \"tasks\": [\n");
  const std::string network = Put("net.safetensors", Safetensors(R"({"a": )" + deep + "}"));
  const std::string cameras = Put("cameras.json", R"({"cameras": )" + deep + "}");
  Put("run/run.json", R"({"created_by": "mocurate 1", "options": {"name": )" + deep + "}}");
  Put("slurm/slurm/run.json", R"({"config": )" + deep + "}");
  ExpectRefused({"survey", "tally", key, key, "-o", Path("tally")}, 3, "key.json:1:");
  ExpectRefused({"review", set, "--audit", audit, "-o", Path("page.html")}, 3, "audit.json:1:");
  ExpectRefused({"run", "--plan", plan, "--task", "0"}, 3, "plan.json:1:");
  ExpectRefused({"generate", network, "--label", "a", "-o", Path("made.h5")}, 3, "net.safetensors: header:1:");
  ExpectRefused({"inspect", cameras}, 3, "cameras.json");
  ExpectRefused({"inspect", Path("run")}, 3, "run");
  ExpectRefused({"jobs", Path("slurm")}, 3, "run.json:1:");
}

TEST_F(ExchangedFiles, NestedLinesOfRecordsAreSkipped) {
  Put("run/run.json", R"({"created_by": "mocurate 1", "options": {}, "started": "2020"})");
  Put("run/journal.jsonl", R"({"stage": "train", "item": )" + Nested() + "}\n");
  Put("run/curation_log.jsonl", R"({"decision": )" + Nested() + "}\n");
  EXPECT_EQ(Run({"inspect", Path("run")}).exit_code, 0);
  Put("run/journal.jsonl", "{\"stage\": 5, \"time\": \"2030\"}\n");
  EXPECT_EQ(Run({"inspect", Path("run")}).exit_code, 3) << "another type";
}

TEST_F(ExchangedFiles, OtherTypesAreErrorsOfTheFile) {
  for (const char* part : {R"("started": 5)", R"("to": [])", R"("ended": {"exit_code": "x"})", R"("ended": 5)",
                           R"("ended": {}, "stale": "x")", R"("job": [])"}) {
    Put("runs/a/run.json", std::string(R"({"created_by": "mocurate 1", "options": {"name": "x"}, )") + part + "}");
    for (const Result& result : {Run({"inspect", Path("runs/a")}), Run({"inspect", Path("runs")}),
                                 Run({"run", "-n", "-o", Path("runs/a"), "--to", "ingest"})}) {
      EXPECT_LE(result.exit_code, 3) << part << result.err;
    }
  }
}

TEST_F(ExchangedFiles, AWorkerEndsAtANestedMessage) {
  const std::string text = R"({"stage": )" + Nested() + "}";
  std::string frame;
  for (std::size_t i = 0; i < 4; ++i) frame += static_cast<char>(text.size() >> (8 * i) & 0xFF);
  const std::string message = Put("message", frame + text);
  for (const char* name : {"mocurate-annotate", "mocurate-video"}) {
    program::Surroundings surroundings;
    surroundings.program = fs::path(kBinaryFolder) / name;
    surroundings.before_start = [&] { dup2(open(message.c_str(), O_RDONLY), STDIN_FILENO); };
    EXPECT_EQ(RunProgram(folder_, {}, surroundings).exit_code, 3) << name;
  }
}

TEST_F(ExchangedFiles, DataDoNotReadTheEnvironment) {
  const std::string set = Dataset();
  const std::string clip = test::MakeDataset().clips[0].id();
  const std::string decisions =
      Put("decisions.yaml", "decisions:\n- {clip: '" + clip + "', finding: x, decision: drop, note: '${SECRET}'}\n");
  const std::string map = Put("map.yaml", "walk: '${SECRET}'\n");
  const Result applied = Run({"dataset", "apply", set, decisions, "-o", Path("applied.h5")});
  ASSERT_EQ(applied.exit_code, 0) << applied.err;
  const Result relabelled = Run({"dataset", "relabel", set, map, "-o", Path("relabelled.h5")});
  ASSERT_EQ(relabelled.exit_code, 0) << relabelled.err;
  for (const char* name : {"applied.h5", "relabelled.h5"}) {
    const auto read = ReadDataset(folder_ / name);
    ASSERT_TRUE(read) << read.error().Message();
    std::string texts;
    for (const Finding& finding : read->findings) texts += finding.message + "\n";
    for (const std::string& label : read->labels) texts += label + "\n";
    EXPECT_THAT(texts, HasSubstr("${SECRET}")) << name;
    EXPECT_THAT(texts, Not(HasSubstr(kSecret))) << name;
  }
  Put("data/${SECRET}_walk_01.bvh",
      "HIERARCHY\nROOT a\n{\n OFFSET 0 0 0\n CHANNELS 3 Xposition Yposition Zposition\n}\nMOTION\nFrames: 2\n"
      "Frame Time: 0.033\n0 0 0\n0 0 0\n");
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"config", "init", Path("data"), "-o", Path("data.yaml"), "--force"},
        {"config", "show", Path("data.yaml")},
        {"fit", Path("data"), "-o", Path("fit.h5"), "--force"}}) {
    const Result result = Run(arguments);
    EXPECT_THAT(result.out + result.err, Not(HasSubstr(kSecret))) << arguments[0];
  }
}

TEST_F(ExchangedFiles, DataIncludeNothingAndWaitForNothing) {
  const std::string set = Dataset(), secret = Put("secret.txt", std::string(kSecret) + ": 1\n" + kSecret + ": 2\n");
  ASSERT_EQ(mkfifo(Path("pipe").c_str(), 0600), 0);
  const std::string including = "include: " + secret + "\n";
  const std::string decisions = Put("decisions.yaml", including + "decisions: []\n");
  const std::string map = Put("map.yaml", including + "labels: {walk: run}\n");
  for (const std::string& data : {decisions, Path("pipe"), std::string("/dev/zero")}) {
    const Result result = Run({"dataset", "apply", set, data, "-o", Path("out.h5"), "--force"});
    EXPECT_THAT(result.exit_code, testing::AnyOf(2, 3)) << data << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr(kSecret)));
  }
  for (const std::string& data :
       {map, Path("pipe"), std::string("/dev/zero"), Put("table.yaml", "clips: /dev/zero\n")}) {
    const Result result = Run({"dataset", "relabel", set, data, "-o", Path("out.h5"), "--force"});
    EXPECT_THAT(result.exit_code, testing::AnyOf(2, 3)) << data << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr(kSecret)));
  }
}

TEST_F(ExchangedFiles, ConfigurationsIncludeFromBelowTheirFolder) {
  const std::string secret = Put("secret.yaml", std::string("name: x\n") + kSecret + ": 1\n");
  Put("jobs/parts/part.yaml", "include: kard.yaml\nname: below\n");
  const std::string outside = Put("jobs/outside.yaml", "include: ../secret.yaml\n");
  const std::string inside = Put("jobs/inside.yaml", "include: parts/part.yaml\n");
  const std::string device = Put("jobs/device.yaml", "include: /dev/zero\n");
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"config", "show", outside},
                                                    {"run", outside, "-n"},
                                                    {"plan", outside, "--stage", "ingest"},
                                                    {"inspect", Put("a.bvh", ""), "--source", outside},
                                                    {"doctor", "--source", outside},
                                                    {"synthesize", outside, "--show"},
                                                    {"eval", "--protocol", outside, "--generated", Dataset()}}) {
    const Result result = Run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments[0] << result.err;
    EXPECT_THAT(result.err, HasSubstr("outside.yaml:1:10")) << arguments[0];
    EXPECT_THAT(result.out + result.err, Not(HasSubstr(kSecret))) << arguments[0];
  }
  ExpectRefused({"config", "show", outside, "--allow-include"}, 2, kSecret);
  ExpectRefused({"config", "show", device, "--allow-include"}, 2, "device.yaml:1:10");
  const Result shown = Run({"config", "show", inside, "--set", "ingest.path=" + Path("data")});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("name: below"));
}

TEST_F(ExchangedFiles, ATaskNeedsThePermissionAsItsPlanDid) {
  Put("common.yaml", "name: demo\n");
  const std::string job = Put("jobs/job.yaml",
                              "include: [resource:demo.yaml, ../common.yaml]\n"
                              "ingest: {synthetic: {actions: [walk], subjects: 1, repetitions: 1, duration: 1.5 s}}\n");
  std::vector<std::string> capture = {"run", job, "-o", Path("r"), "--to", "ingest", "--allow-include"};
  ASSERT_EQ(Run(capture).exit_code, 0);
  std::vector<std::string> plan = {
      "plan", job, "--stage", "ingest", "-o", Path("p"), "--set", "ingest.path=" + Path("r/capture"), "--tasks", "1"};
  EXPECT_EQ(Run(plan, "other").exit_code, 2);
  plan.push_back("--allow-include");
  const Result planned = Run(plan, "other");
  ASSERT_EQ(planned.exit_code, 0) << planned.err;
  EXPECT_THAT(planned.out, HasSubstr("--task K --allow-include"));
  std::vector<std::string> task = {"run", "--plan", Path("p/plan/ingest.json"), "--task", "0"};
  ExpectRefused(task, 2, "job.yaml:1:");
  task.push_back("--allow-include");
  const Result done = Run(task, "other");
  EXPECT_EQ(done.exit_code, 0) << done.err;
}

}  // namespace
}  // namespace mocurate
