// Runs that train: networks are independent items, and the failure of one is reported and does not stop the others.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/formats/npz.h"
#include "core/store/store.h"
#include "tests/app/program.h"
#include "tests/support/folders.h"
#include "tests/support/other_fields.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using ::testing::HasSubstr;
using ::testing::Not;

/// A few synthetic clips, the smallest networks, the shortest evaluation.
std::vector<std::string> TrainingJob(const ScratchFolder& folder, const std::vector<std::string>& assignments) {
  std::vector<std::string> arguments = {"run", "-o", (folder / "r").string(), "--json", "--jobs", "1"};
  std::vector<std::string> sets = {
      "ingest.synthetic.subjects=3",
      "ingest.synthetic.repetitions=1",
      "ingest.synthetic.duration=1.5 s",
      "ingest.synthetic.actions=[wave, kick]",
      "assemble.splits=[{name: s, by: fraction, test_share: 0.3, validation_share: 0}, {name: all_test, "
      "by: fraction, test_share: 1, validation_share: 0}]",
      "train.networks=[{kind: action2motion, name: Action2Motion, split: s, input: resample, frames: 10, hidden: 4, "
      "iterations: 1}, {kind: gru_recogniser, name: recogniser, split: s, seeds: [1, 2], frames: 10, hidden: 4, "
      "epochs: "
      "2}]",
      "audit.split=s",
      "evaluate.repetitions=1",
      "evaluate.motions=10",
      "evaluate.diversity_pairs=2",
      "evaluate.multimodality_quota=1",
      "report.videos=false"};
  sets.insert(sets.end(), assignments.begin(), assignments.end());
  for (const std::string& assignment : sets) arguments.insert(arguments.end(), {"--set", assignment});
  return arguments;
}

Result TrainingProgram(const ScratchFolder& folder, const std::vector<std::string>& arguments) {
  return RunProgram(folder, arguments, program::SharedCache());
}

int StagesNamed(const nlohmann::json& document, const std::string& name) {
  int count = 0;
  for (const auto& stage : document["stages"]) count += stage["stage"] == name ? 1 : 0;
  return count;
}

TEST(TrainingRun, OnePersonAloneIsTrainedOnAndNothingIsScored) {
  const ScratchFolder folder;
  std::vector<std::string> arguments = TrainingJob(
      folder, {"ingest.synthetic.subjects=1", "assemble.splits=[{name: s, by: person, test: [p09], absent: draw}]"});
  arguments.erase(std::find(arguments.begin(), arguments.end(), "--json"));
  const Result result = TrainingProgram(folder, arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("not scored: "));
  EXPECT_THAT(result.err, HasSubstr("it trains and "));
  const std::string page = ReadText(folder / "r/report/index.html");
  EXPECT_THAT(page, HasSubstr("The recogniser is not scored: "));
  EXPECT_THAT(page, HasSubstr("0: no clip tests, nothing is scored"));
  EXPECT_THAT(page, HasSubstr("; no test part"));
  EXPECT_THAT(page, HasSubstr("split_drawn"));
}

TEST(TrainingRun, AGivenFolderReplacesTheCapture) {
  const ScratchFolder folder;
  const Result result = TrainingProgram(folder, TrainingJob(folder, {"ingest.path=" + (folder / "nowhere").string()}));
  EXPECT_EQ(result.exit_code, 3) << result.out;
  EXPECT_THAT(result.err, HasSubstr("nowhere: the folder does not exist"));
}

TEST(TrainingRun, AllNetworksAreItemsOfOneStageAndPagesHaveVideos) {
  const ScratchFolder folder;
  std::vector<std::string> arguments = TrainingJob(folder, {"report.videos=true", "report.pages=1"});
  *std::next(std::find(arguments.begin(), arguments.end(), "--jobs")) = "2";
  const Result result = TrainingProgram(folder, arguments);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json document = result.Json();
  EXPECT_EQ(StagesNamed(document, "train"), 1);
  for (const auto& stage : document["stages"]) {
    if (stage["stage"] != "train") continue;
    EXPECT_EQ(stage["items"], 3);
  }
  for (const char* name : {"recogniser_1", "recogniser_2", "Action2Motion_1"}) {
    EXPECT_TRUE(fs::exists(folder / ("r/checkpoints/" + std::string(name) + ".h5"))) << name;
  }
  EXPECT_TRUE(fs::exists(folder / "r/report/clip_001.mp4"));
  const std::string page = ReadText(folder / "r/report/index.html");
  for (const char* link : {"href=\"viewer.html#clip=", "href=\"viewer.html\"", "href=\"generated.html\""}) {
    EXPECT_THAT(page, HasSubstr(link));
  }
  const auto index = [&](const char* file) {
    const std::string text = ReadText(folder / "r/report" / file), begin = "id=\"viewer-index\">";
    const std::size_t at = text.find(begin) + begin.size();
    return nlohmann::json::parse(text.substr(at, text.find("</script>", at) - at));
  };
  const nlohmann::json clips = index("viewer.html"), generated = index("generated.html");
  ASSERT_EQ(clips["clips"].size(), 12u) << "six and their truth";
  for (const nlohmann::json& clip : clips["clips"]) {
    EXPECT_EQ(clip.contains("points"), clip["source"] == 0) << "as tracked";
    EXPECT_EQ(clip.contains("map"), clip["source"] == 0);
    EXPECT_EQ(clip.value("nearest", nlohmann::json::array()).size(), clip["source"] == 0 ? 4u : 0u);
  }
  ASSERT_EQ(generated["sources"].size(), 2u);
  EXPECT_EQ(generated["sources"][1]["name"], "Action2Motion");
  EXPECT_EQ(std::count_if(generated["clips"].begin(), generated["clips"].end(),
                          [](const nlohmann::json& clip) { return clip["source"] == 1 && clip["group"] == "kick"; }),
            3);
}

TEST(TrainingRun, AFailedGeneratorLeavesTheRecognisersAndIsReported) {
  const ScratchFolder folder;
  const Result result = TrainingProgram(folder, TrainingJob(folder, {"train.networks.0.split=all_test"}));
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("1 of 3 networks was not trained; Action2Motion/1"));
  EXPECT_THAT(result.err, HasSubstr("all_test"));
  const nlohmann::json document = result.Json();
  EXPECT_TRUE(document["untrained"].contains("Action2Motion/1"));
  EXPECT_EQ(document["metrics"]["recognisers"]["recogniser"]["test_accuracy"].size(), 2u);
  ASSERT_EQ(document["metrics"]["rows"].size(), 1u);
  EXPECT_EQ(document["metrics"]["rows"][0]["name"], "Real");
  const std::string page = ReadText(folder / "r/report/index.html");
  EXPECT_THAT(page, HasSubstr("Not trained"));
  EXPECT_THAT(page, HasSubstr("all_test"));
  EXPECT_THAT(page, HasSubstr("recogniser: training loss by seed (2 epochs, "));
}

/// Files that run.json marks as stale, with their stages.
std::map<std::string, std::string> StaleStages(const fs::path& run) {
  std::map<std::string, std::string> stale;
  const nlohmann::json file = nlohmann::json::parse(ReadText(run / "run.json"));
  for (const auto& output : file.at("stale")) {
    stale[output.at("file")] = output.at("stage");
  }
  return stale;
}

TEST(TrainingRun, OutputsThatALaterRunDoesNotWriteStayAndAreStale) {
  const ScratchFolder folder;
  ASSERT_EQ(TrainingProgram(folder, TrainingJob(folder, {})).exit_code, 0);
  for (const char* name : {"metrics.json", "tables/table.md", "checkpoints/recogniser_2.h5", "report/index.html"}) {
    ASSERT_TRUE(fs::exists(folder / ("r/" + std::string(name)))) << name;
  }
  const std::vector<std::string> mine = {"notes.txt", "tables/mine.md", "checkpoints/recogniser_best.h5"};
  for (const std::string& name : mine) program::WriteText(folder / ("r/" + name), "mine");

  std::vector<std::string> dry = TrainingJob(folder, {});
  dry.insert(dry.end(), {"--dry-run", "--to", "canon"});
  ASSERT_EQ(TrainingProgram(folder, dry).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "r/metrics.json")) << "a dry run changes nothing";

  const Result failed =
      TrainingProgram(folder, TrainingJob(folder, {"ingest.synthetic.enabled=false", "ingest.path=/nix"}));
  EXPECT_NE(failed.exit_code, 0);
  EXPECT_THAT(failed.err, HasSubstr("metrics.json"));
  EXPECT_TRUE(fs::exists(folder / "r/dataset.h5")) << "a mistyped path removes nothing";
  EXPECT_EQ(StaleStages(folder / "r")["dataset.h5"], "assemble");

  const std::string generator = ReadText(folder / "r/checkpoints/Action2Motion_1.h5");
  ASSERT_EQ(
      TrainingProgram(folder, TrainingJob(folder, {"train.networks=[{kind: gru_recogniser, name: recogniser, split: s, "
                                                   "frames: 10, hidden: 4, epochs: 2}]"}))
          .exit_code,
      0);
  EXPECT_EQ(ReadText(folder / "r/checkpoints/Action2Motion_1.h5"), generator);
  const std::map<std::string, std::string> fewer = StaleStages(folder / "r");
  EXPECT_EQ(fewer.count("checkpoints/recogniser_1.h5"), 0u);
  for (const char* name : {"checkpoints/recogniser_2.h5", "checkpoints/Action2Motion_1.h5"}) {
    EXPECT_EQ(fewer.count(name), 1u) << name;
  }
  EXPECT_EQ(fewer.count("dataset.h5") + fewer.count("report/index.html"), 0u);

  std::vector<std::string> shorter = TrainingJob(folder, {});
  shorter.insert(shorter.end(), {"--to", "assemble"});
  ASSERT_EQ(TrainingProgram(folder, shorter).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "r/dataset.h5"));
  EXPECT_TRUE(fs::exists(folder / "r/curation_log.jsonl"));
  std::map<std::string, std::string> later = StaleStages(folder / "r");
  const std::pair<const char*, const char*> stages[] = {{"metrics.json", "table"},
                                                        {"tables/table.md", "table"},
                                                        {"tables/table.json", "table"},
                                                        {"checkpoints/recogniser_1.h5", "train"},
                                                        {"report_input.json", "report"},
                                                        {"report/index.html", "report"},
                                                        {"checkpoints/recogniser_2.h5", "train"}};
  for (const auto& [name, stage] : stages) {
    EXPECT_TRUE(fs::exists(folder / "r" / name)) << name;
    EXPECT_EQ(later[name], stage) << name;
  }
  EXPECT_EQ(later.count("dataset.h5") + later.count("curation_log.jsonl"), 0u);
  for (const std::string& name : mine) {
    EXPECT_EQ(ReadText(folder / ("r/" + name)), "mine") << name;
    EXPECT_EQ(later.count(name), 0u) << name;
  }
  fs::remove(folder / "r/checkpoints/recogniser_best.h5");
  const Result eval = RunProgram(folder, {"eval", "--run", (folder / "r").string(), "--protocol", "own", "--generated",
                                          (folder / "r/dataset.h5").string()});
  EXPECT_EQ(eval.exit_code, 3) << "features of a stale recogniser: " << eval.err;
  EXPECT_THAT(eval.err, HasSubstr("recogniser_1.h5"));
}

TEST(TrainingRun, AFailedEvaluationLeavesTheReportWithTheReason) {
  const ScratchFolder folder;
  ASSERT_EQ(TrainingProgram(folder, TrainingJob(folder, {})).exit_code, 0);
  const Result result = TrainingProgram(
      folder,
      TrainingJob(folder, {"assemble.splits=[{name: s, by: fraction, test_share: 0.3, validation_share: 0}, {name: "
                           "no_test, by: fraction, test_share: 0, validation_share: 0}]",
                           "evaluate.split=no_test", "evaluate.real=test"}));
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_TRUE(result.Json()["unevaluated"]["message"].is_string());
  EXPECT_EQ(StaleStages(folder / "r")["metrics.json"], "table") << "the earlier run's";
  EXPECT_EQ(StaleStages(folder / "r")["tables/table.json"], "table");
  EXPECT_THAT(ReadText(folder / "r/report/index.html"), HasSubstr("There is no table: the evaluation failed."));
}

TEST(TrainingRun, RecognisersThatFailLeaveTheGenerator) {
  const ScratchFolder folder;
  const Result result =
      TrainingProgram(folder, TrainingJob(folder, {"train.networks.1.split=all_test", "evaluate.split=s"}));
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("2 of 3 networks were not trained; recogniser/1"));
  EXPECT_TRUE(fs::exists(folder / "r/checkpoints/Action2Motion_1.h5"));
  EXPECT_THAT(ReadText(folder / "r/report/index.html"), HasSubstr("recogniser/2"));
}

TEST(TrainingRun, WithoutAnyNetworkTheExitCodeIsStill1) {
  const ScratchFolder folder;
  const Result result = TrainingProgram(
      folder, TrainingJob(folder, {"train.networks.1.split=all_test", "train.networks.0.split=all_test"}));
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("3 of 3 networks were not trained"));
  EXPECT_TRUE(fs::exists(folder / "r/dataset.h5"));
}

TEST(TrainingRun, BothBranchesOfTheStagesHaveDifferentNames) {
  const ScratchFolder folder;
  std::vector<std::string> arguments = TrainingJob(folder, {"train.networks.1.trained_on=unfitted"});
  arguments.erase(std::find(arguments.begin(), arguments.end(), "--json"));
  arguments.insert(arguments.end(), {"--to", "assemble"});
  const Result result = TrainingProgram(folder, arguments);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* title :
       {"canon (fitted motion)", "canon (raw tracks)", "assemble (fitted motion)", "assemble (raw tracks)"}) {
    EXPECT_THAT(result.err, HasSubstr(title));
    EXPECT_THAT(result.out, Not(HasSubstr(title))) << "a stage is reported once";
  }
}

TEST(TrainingRun, DurationsAndYardsticksAreRowsAndANetworkStartsFromAnother) {
  const ScratchFolder folder;
  const std::string actor = "split: s, frames: 10, latent: 16, layers: 1, heads: 2, feed_forward: 16, iterations: ";
  std::vector<std::string> job =
      TrainingJob(folder, {"train.networks=[{kind: actor, name: A, " + actor +
                               "3, until: 2, samples_at: [1]}, {kind: actor, name: B, " + actor +
                               "2, longest_frames: 12, start_from_network: A}, {kind: gru_recogniser, " +
                               "name: R, split: s, frames: 10, hidden: 4, epochs: 1}]",
                           "evaluate.durations=[8, 14]", "evaluate.yardsticks=true", "canon.facing.anchor=middle"});
  const Result result = TrainingProgram(folder, job);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json table = nlohmann::json::parse(ReadText(folder / "r/tables/table.json"));
  std::vector<std::string> names;
  for (const nlohmann::json& row : table["rows"]) {
    names.push_back(row["name"]);
    const std::string name = names.back();
    const bool made = name[0] == 'A' || name[0] == 'B';
    EXPECT_EQ(row["ours"]["steps"], made ? nlohmann::json(name.find('@') == std::string::npos ? 2 : 1) : nullptr);
    EXPECT_EQ(row.value("given", ""), made || name == "Real" ? "" : "motions") << name;
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"Real", "Retrieval", "Shuffled labels", "Mean pose", "A@1, 8 frames",
                                      "A@1, 14 frames", "A, 8 frames", "A, 14 frames", "B, 8 frames", "B, 14 frames"}));
  const std::string learning = ReadText(folder / "r/tables/learning.svg");
  for (const char* name : {"A, 8 frames", "A, 14 frames", "Retrieval", "Accuracy"})
    EXPECT_THAT(learning, HasSubstr(name));
  EXPECT_THAT(learning, Not(HasSubstr("B, 8 frames"))) << "of two steps, one sample";
  const auto metrics_of = [&](const std::string& row) {
    const nlohmann::json read = nlohmann::json::parse(ReadText(folder / "r/tables/table.json"));
    for (const nlohmann::json& one : read["rows"])
      if (one["name"] == row) return one["metrics"];
    return nlohmann::json();
  };
  const auto void_of = [&] {  // the real row that is named
    const nlohmann::json metrics = nlohmann::json::parse(ReadText(folder / "r/metrics.json"));
    for (const nlohmann::json& warning : metrics["warnings"])
      if (warning["code"] == "void") return warning["row"].get<std::string>();
    return std::string();
  };
  const nlohmann::json retrieval = metrics_of("Retrieval"), made = metrics_of("B, 14 frames");
  ASSERT_TRUE(retrieval.is_object());
  EXPECT_EQ(void_of(), "Real");
  job.insert(job.end(), {"--set", "evaluate.least_real_accuracy=0", "--set", "evaluate.generated_root=as_given"});
  ASSERT_EQ(TrainingProgram(folder, job).exit_code, 0);
  EXPECT_EQ(void_of(), "");
  EXPECT_EQ(metrics_of("Retrieval"), retrieval) << "yardsticks are real clips, which real_root places";
  EXPECT_NE(metrics_of("B, 14 frames"), made) << "what networks made, generated_root";
  EXPECT_EQ(TrainingProgram(folder, TrainingJob(folder, {"evaluate.durations=[8, 8]"})).exit_code, 2);
  EXPECT_EQ(
      TrainingProgram(folder, TrainingJob(folder, {"evaluate.durations=[8]", "evaluate.generators=false"})).exit_code,
      2);
}

TEST(TrainingRun, ActorIsScoredByAnStGcnAndDenoisesTheDataset) {
  const ScratchFolder folder;
  const Result result = TrainingProgram(
      folder,
      TrainingJob(
          folder,
          {"skeleton=smpl24",
           "train.networks=[{kind: actor, name: ACTOR, split: s, frames: 10, latent: 16, layers: 1, heads: 2, "
           "feed_forward: 16, iterations: 60, learning_rate: 3e-3}, {kind: st_gcn, name: ST-GCN, split: s, frames: 10, "
           "epochs: 1}, "
           "{kind: st_gcn, name: Denoised, split: s, frames: 10, epochs: 1, trained_on: denoised, generator: ACTOR}, "
           "{kind: st_gcn, name: Mixed, split: s, frames: 10, epochs: 1, trained_on: generated, generator: ACTOR, "
           "made_share: 0.5}]"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json recognition = nlohmann::json::parse(ReadText(folder / "r/tables/recognition.json"));
  std::vector<std::string> names;
  for (const nlohmann::json& row : recognition["rows"]) {
    names.push_back(row["name"]);
    EXPECT_TRUE(row["metrics"]["accuracy"]["value"].is_number());
    EXPECT_TRUE(row["metrics"]["accuracy_denoised"]["value"].is_number());
  }
  EXPECT_EQ(names, (std::vector<std::string>{"ST-GCN", "Denoised", "Mixed"}));
  EXPECT_THAT(result.out, HasSubstr("recognisers"));
  const nlohmann::json table = nlohmann::json::parse(ReadText(folder / "r/tables/table.json"));
  ASSERT_EQ(table["rows"].size(), 2u);
  EXPECT_EQ(table["rows"][1]["name"], "ACTOR");
  EXPECT_TRUE(table["rows"][1]["metrics"]["FID_train"]["value"].is_number());
  EXPECT_TRUE(table["rows"][1]["metrics"]["accuracy"]["value"].is_number());
  const std::string set = (folder / "r/dataset.h5").string();
  const Result audit = TrainingProgram(folder, {"audit", set, "--json", "-o", (folder / "audit").string()});
  ASSERT_EQ(audit.exit_code, 0) << audit.err;
  for (const char* key : {"findings", "summary"}) EXPECT_TRUE(audit.Json().contains(key)) << key;
  EXPECT_EQ(audit.Json(), nlohmann::json::parse(ReadText(folder / "audit/audit.json")));
  EXPECT_EQ(TrainingProgram(folder, {"audit", set, "-o", (folder / "audit").string()}).exit_code, 2) << "it is there";
  EXPECT_EQ(TrainingProgram(folder, {"audit", (folder / "nowhere.h5").string()}).exit_code, 3);
  EXPECT_EQ(TrainingProgram(folder, {"audit", set, "--set", "labels.widht=2"}).exit_code, 2);
  const Result strict = TrainingProgram(folder, {"audit", set, "--fail-on", "warning", "-q"});
  EXPECT_EQ(strict.exit_code, audit.Json()["findings"].empty() ? 0 : 1);
  const auto in = [&](const char* name) { return (folder / name).string(); };
  EXPECT_EQ(TrainingProgram(folder, {"audit", set, "--fix", in("safe.yaml"), "--with-findings", in("with_findings.h5")})
                .exit_code,
            0);
  EXPECT_EQ(TrainingProgram(folder, {"review", set, "--decisions", in("safe.yaml"), "-o", in("page.html")}).exit_code,
            0);
  EXPECT_EQ(TrainingProgram(folder, {"review", set, "-o", in("page.html")}).exit_code, 2) << "it is there";
  EXPECT_EQ(TrainingProgram(folder, {"review", set, "--audit", in("safe.yaml"), "-o", in("other.html")}).exit_code, 3);
  const std::string first = ReadDataset(folder / "r/dataset.h5")->clips.front().id();
  program::WriteText(folder / "drop.yaml", "decisions: [{clip: '" + first + "', decision: drop}]\n");
  const Result applied = TrainingProgram(
      folder, {"dataset", "apply", set, in("drop.yaml"), "-o", in("clean.h5"), "--excluded", in("gone.h5"), "--json"});
  ASSERT_EQ(applied.exit_code, 0) << applied.err;
  EXPECT_EQ(applied.Json()["dropped"], 1);
  EXPECT_EQ(ReadDataset(folder / "gone.h5")->clips.front().id(), first);
  EXPECT_EQ(TrainingProgram(folder, {"dataset", "apply", set, in("drop.yaml"), "-o", set, "--force"}).exit_code, 2);
  const std::string actor = (folder / "r/checkpoints/ACTOR_1.h5").string();
  const std::string denoised = (folder / "denoised.h5").string(), between = (folder / "between.h5").string();
  ASSERT_TRUE(test::WriteWithOtherFields(*ReadDataset(folder / "r/dataset.h5"), folder / "with_fields.h5"));
  const Result made = TrainingProgram(folder, {"generate", actor, "--denoise", in("with_fields.h5"), "-o", denoised});
  EXPECT_EQ(made.exit_code, 0) << made.err;
  const auto kept = DatasetClips::Open(denoised, DatasetClips::Check::kHashes);
  ASSERT_TRUE(kept) << kept.error().Message();
  EXPECT_EQ(kept->ReadOtherFields().of_frames.count("/frames/mark"), 1u);
  EXPECT_EQ(kept->ReadOtherFields().of_clips.count("/clips/score"), 1u);
  EXPECT_EQ(TrainingProgram(folder, {"generate", actor, "--label", "wave:2", "--interpolate", "3", "--frames", "8:12:4",
                                     "-o", between})
                .exit_code,
            0);
  const char* data = std::getenv("MOCURATE_DATA");
  const auto mesh = [&](const std::string& body) {
    return TrainingProgram(folder, {"generate", actor, "--label", "wave", "--mesh", (folder / "meshes").string(),
                                    "--shapes", "2", "--body", body, "--force", "-o", (folder / "mesh.h5").string()});
  };
  EXPECT_EQ(mesh((folder / "nowhere.h5").string()).exit_code, 3);
  if (data != nullptr) {
    const Result meshes = mesh(std::string(data) + "/body_cc0/body_cc0.h5");
    ASSERT_EQ(meshes.exit_code, 0) << meshes.err;
    const auto npz = ParseNpz(ReadText(folder / "meshes/generated_network_000000_0-10_shape1.npz"), "mesh");
    ASSERT_TRUE(npz) << npz.error().Message();
    EXPECT_EQ(npz->Find("vertices")->shape, (std::vector<std::size_t>{10, 13380, 3}));
    EXPECT_GT(npz->Find("shape")->size(), 3u);
  }
  const Result scored =
      TrainingProgram(folder, {"eval", "--protocol", "own", "--extractor",
                               (folder / "r/checkpoints/ST-GCN_1.h5").string(), "--generated", denoised, "--json"});
  EXPECT_EQ(scored.exit_code, 0) << scored.err;
  EXPECT_EQ(TrainingProgram(folder, {"generate", actor, "--frames", "0", "-o", between, "--force"}).exit_code, 2);
  EXPECT_EQ(
      TrainingProgram(folder, {"generate", actor, "--denoise", between, "--label", "wave", "-o", denoised, "--force"})
          .exit_code,
      2);
}

TEST(TrainingRun, ATableOverTwoSetsHasARowOfEachNetworkAndMarksSubstitutes) {
  const ScratchFolder folder;
  const std::string config = std::string(kSourceFolder) + "/configs/papers/a2m/table1.yaml";
  const std::vector<std::string> arguments = {"run",    config, "--set", "profile=smoke", "-o", (folder / "r").string(),
                                              "--jobs", "1"};
  ASSERT_EQ(TrainingProgram(folder, arguments).exit_code, 0);
  const nlohmann::json table = nlohmann::json::parse(ReadText(folder / "r/tables/table.json"));
  std::set<std::string> checkpoints;
  std::map<std::string, int> methods;
  for (const auto& row : table["rows"]) {
    ++methods[row["method"].get<std::string>()];
    EXPECT_TRUE(row["substitute"].is_string());
    if (row["method"] == "Real" || row["method"] == "Real-test") continue;
    EXPECT_TRUE(checkpoints.insert(row["ours"]["checkpoint"].get<std::string>()).second) << row["method"];
    EXPECT_TRUE(row["ours"]["metrics"]["FID_train"]["value"].is_number());
    EXPECT_GT(row["ours"]["steps"].get<int>(), 0);
    EXPECT_GT(row["ours"]["peak_memory"].get<double>(), 1e6);
    EXPECT_GT(row["ours"]["seconds"].get<double>(), 0.0);
    EXPECT_EQ(row["ours"]["unconverged"].is_string(), row["method"] != "CondGRU zeros") << "2 of many steps";
    const bool held_out = row["dataset"].get<std::string>().find("held_out") != std::string::npos;
    EXPECT_EQ(row["ours"]["metrics"]["FID_test"]["value"].is_number(), held_out) << row["method"];
    if (row["method"] == "Ours" && row["dataset"] == "humanact12") {  // the paper's Table 3
      EXPECT_EQ(row["ours"]["parameters"],
                nlohmann::json({{"prior", 117820}, {"posterior", 117820}, {"decoder", 227110}}));
    }
  }
  for (const char* method : {"Real", "CondGRU", "Two-stage GAN", "Act-MoCoGAN", "Ours w/o Lie", "Ours"}) {
    EXPECT_EQ(methods[method], 4) << method << ", once a set and its held-out persons";
  }
  EXPECT_EQ(methods["Real-test"], 2);
  const std::string page = ReadText(folder / "r/data/humanact12/report/generated.html");
  std::size_t motions = 0;
  const std::string ours = "\"source\":1,";
  for (std::size_t at = page.find(ours); at != std::string::npos; at = page.find(ours, at + 1)) ++motions;
  EXPECT_EQ(motions, 36u) << "three generated motions of each class";
  EXPECT_GT(table["published"].size(), 20u);
  EXPECT_TRUE(fs::exists(folder / "r/data/ntu13/dataset.h5"));
  for (const auto& [set, weight] :
       {std::pair("humanact12", nlohmann::json()), std::pair("ntu13", nlohmann::json(0.01))}) {
    const Result of = TrainingProgram(folder, {"inspect", folder / "r/data" / set / "checkpoints/Ours_1.h5", "--json"});
    ASSERT_EQ(of.exit_code, 0) << of.err;
    EXPECT_EQ(of.Json()["options"]["kl_weight"], weight) << "as released for " << set;
    EXPECT_EQ(of.Json()["options"]["iterations"], 2) << "the profile bounds what a set changes";
  }
  std::vector<std::string> again = arguments;
  again.emplace_back("--json");
  const Result cached = TrainingProgram(folder, again);
  for (const auto& [name, set] : cached.Json()["sets"].items()) EXPECT_EQ(set["executed"], 0) << name;
  std::vector<std::string> wrong = arguments;
  wrong.insert(wrong.end(), {"--set", ""});
  for (const char* option : {"data.1.networks=[Ours.no_such_option=1]", "data.1.evaluate=[no_such_option=1]",
                             "data.2.like=unknown", "data.0.like=ntu13"}) {
    wrong.back() = option;
    EXPECT_EQ(TrainingProgram(folder, wrong).exit_code, 2) << option;
  }
  again.insert(again.end(), {"--data", "humanact=" + (folder / "x").string()});
  EXPECT_EQ(TrainingProgram(folder, again).exit_code, 2);
  again.back() = "humanact12=" + (folder / "x").string();
  EXPECT_EQ(TrainingProgram(folder, again).exit_code, 1) << "a missing set does not affect others";
}

/// Words of one segment after the other in each motion of a MotionSet.
std::vector<std::string> SegmentsIn(const fs::path& file) {
  std::vector<std::string> labels;
  const auto set = ReadDataset(file);
  EXPECT_TRUE(set) << file;
  for (std::size_t i = 0; set && i < set->clips.size(); ++i) {
    for (const Segment& segment : set->clips[i].segments) labels.push_back(segment.label);
  }
  return labels;
}

TEST(TrainingRun, NetworksOfMultiActAreRowsOfTransitionsAndAnswerScripts) {
  const ScratchFolder folder;
  const std::string papers = std::string(kSourceFolder) + "/configs/papers/multiact/";
  const auto run = [&](const std::string& table) {
    return TrainingProgram(folder, {"run", papers + table, "--set", "profile=smoke", "-o", (folder / table).string(),
                                    "--json", "--jobs", "1"});
  };
  ASSERT_EQ(run("table3.yaml").exit_code, 0);
  const nlohmann::json table = nlohmann::json::parse(ReadText(folder / "table3.yaml/tables/table.json"));
  std::set<std::string> methods, published;
  for (const auto& row : table["rows"]) {
    methods.insert(row["method"].get<std::string>());
    EXPECT_TRUE(row["ours"]["metrics"]["FID_test"]["value"].is_number()) << row["method"];
    EXPECT_TRUE(row["ours"]["metrics"].contains("nearest_train"));
  }
  for (const auto& value : table["published"]) published.insert(value["method"].get<std::string>());
  EXPECT_EQ(published.size(), 5u);
  for (const std::string& method : published) EXPECT_EQ(methods.count(method), 1u) << method;

  const std::string checkpoints = (folder / "table3.yaml/data/babel/checkpoints/").string();
  const std::string macvae = checkpoints + "MACVAE (Ours)_1.h5", actor = checkpoints + "ACTOR_1.h5";
  const std::string dataset = (folder / "table3.yaml/data/babel/dataset.h5").string(),
                    made = (folder / "m.h5").string();
  const auto generate = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "generate");
    arguments.insert(arguments.end(), {"-o", made, "--force"});
    return TrainingProgram(folder, arguments).exit_code;
  };
  ASSERT_EQ(generate({macvae, "--first", actor, "--script", "walk,sit down:9,kick"}), 0);
  EXPECT_EQ(SegmentsIn(made), (std::vector<std::string>{"walk", "transition", "sit down", "transition", "kick"}));
  ASSERT_EQ(generate({actor, "--fill", checkpoints + "SSMCT-like_1.h5", "--align", "--script", "walk,kick"}), 0);
  EXPECT_EQ(SegmentsIn(made), (std::vector<std::string>{"walk", "transition", "kick"}));
  ASSERT_EQ(generate({macvae, "--previous", dataset, "--script", "studio_five", "--count", "2"}), 0);
  EXPECT_EQ(SegmentsIn(made).size(), 20u) << "five actions and their transitions, twice";
  const std::vector<std::pair<std::vector<std::string>, int>> wrong = {
      {{macvae, "--script", "walk,kick"}, 2},                                                  // nothing before it
      {{macvae, "--first", actor, "--previous", dataset, "--script", "walk,kick"}, 2},         // two things
      {{macvae, "--first", actor, "--script", "walk,fly"}, 2},                                 // no such class
      {{macvae, "--first", actor, "--script", "walk,kick:0"}, 2},                              // no frames
      {{macvae, "--first", actor, "--script", "walk,kick:3,jump"}, 3},                         // four are read
      {{macvae, "--first", actor, "--script", "walk,kick", "--transition-frames", "119"}, 3},  // the table ends at 118
      {{macvae, "--previous", dataset, "--previous-clip", "none", "--script", "walk"}, 2},
      {{macvae, "--label", "walk"}, 3},
      {{checkpoints + "recogniser_1.h5", "--script", "walk,kick"}, 2}};
  for (const auto& [arguments, code] : wrong) EXPECT_EQ(generate(arguments), code) << arguments.back();

  // A chain's steps are rows, of actions and of transitions.
  const fs::path config = folder / "steps.yaml";
  program::WriteText(config,
                     "include: resource:papers/multiact/figure6.yaml\nevaluate: {rows: [{name: Ours, network: MACVAE "
                     "(Ours), script: chain, "
                     "steps: 2, first: ACTOR}]}\n");
  const Result run_of_steps = TrainingProgram(folder, {"run", config.string(), "--set", "profile=smoke", "-o",
                                                       (folder / "steps").string(), "--json", "--jobs", "1"});
  ASSERT_EQ(run_of_steps.exit_code, 0) << run_of_steps.err;
  const nlohmann::json chains = nlohmann::json::parse(ReadText(folder / "steps/tables/table.json"));
  std::map<std::string, int> rows;
  for (const nlohmann::json& row : chains["rows"]) ++rows[row.at("method")];
  EXPECT_EQ(rows["Ours, step 1"], 1) << "the first action is ACTOR's, and no transition precedes it";
  EXPECT_EQ(rows["Ours, step 2"], 2);
}

TEST(TrainingRun, ABudgetIsAShareOfTheIterations) {
  const ScratchFolder folder;
  std::vector<std::string> arguments =
      TrainingJob(folder, {"train.networks=[{kind: action2motion, name: Action2Motion, split: s, input: resample, "
                           "frames: 10, hidden: 4, iterations: 2}]"});
  arguments.insert(arguments.end(), {"--to", "train", "--budget", "0.5"});
  const Result result = TrainingProgram(folder, arguments);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Result network = TrainingProgram(folder, {"inspect", folder / "r/checkpoints/Action2Motion_1.h5", "--json"});
  ASSERT_EQ(network.exit_code, 0) << network.err;
  EXPECT_EQ(network.Json()["options"]["iterations"], 1);
}

TEST(TrainingRun, TheDurationOfTheJobIsThatOfTheWholeJob) {
  const ScratchFolder folder;
  std::vector<std::string> arguments = TrainingJob(folder, {"takes=an hour"});
  EXPECT_THAT(TrainingProgram(folder, arguments).err, HasSubstr("demo takes an hour\n"));
  arguments.insert(arguments.end(), {"--to", "ingest"});
  EXPECT_THAT(TrainingProgram(folder, arguments).err,
              HasSubstr("demo as a whole takes an hour; this run ends after the stage ingest"));
}

}  // namespace
}  // namespace mocurate
