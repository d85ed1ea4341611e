// A checkpoint that holds another model than the one wanted: refused by kind, never read as if it were right.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::Folder;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::WriteText;
using ::testing::HasSubstr;
using ::testing::Not;

/// The small job up to the table, with networks of a few numbers.
std::vector<std::string> TinyTraining(const Folder& folder) {
  std::vector<std::string> arguments = program::SmallJob(folder, "r");
  std::replace(arguments.begin(), arguments.end(), std::string("assemble"), std::string("table"));
  for (const char* option :
       {"train.networks=[{kind: action2motion, name: Action2Motion, hidden: 8, latent: 2, frames: 10, iterations: 1, "
        "batch: 4}, {kind: gru_recogniser, name: recogniser, epochs: 1, hidden: 8, frames: 10}]",
        "evaluate.repetitions=1", "evaluate.motions=20", "evaluate.diversity_pairs=5",
        "evaluate.multimodality_quota=2"}) {
    arguments.insert(arguments.end(), {"--set", option});
  }
  arguments.emplace_back("--json");
  return arguments;
}

/// Where the cache keeps what item `item` of stage `train` made, as the journal of the run tells.
fs::path RecordOf(const Folder& folder, const std::string& item) {
  std::ifstream journal(folder / "r/journal.jsonl");
  std::string line;
  while (std::getline(journal, line)) {
    const nlohmann::json entry = nlohmann::json::parse(line);
    if (entry["stage"] != "train" || entry["item"] != item) continue;
    const std::string key = entry["key"];
    return folder / ("cache/objects/" + key.substr(0, 2) + "/" + key.substr(2) + ".json");
  }
  return {};
}

/// Puts the artifact of one record in the place of another's.
void Exchange(const fs::path& record, const fs::path& other) {
  nlohmann::json changed = nlohmann::json::parse(ReadText(record));
  const nlohmann::json wrong = nlohmann::json::parse(ReadText(other));
  const std::string name = wrong["artifact"];
  if (other.parent_path() != record.parent_path())  // folders are named by two letters of keys
    fs::copy_file(other.parent_path() / name, record.parent_path() / name, fs::copy_options::overwrite_existing);
  for (const char* key : {"artifact", "sha256", "bytes"}) changed[key] = wrong[key];
  WriteText(record, changed.dump());
}

/// What a person is told about what a run has made: a checkpoint, the dataset, the run folder.
void ExpectInspectToTell(const Folder& folder) {
  const Result generator = RunProgram(folder, {"inspect", (folder / "r/checkpoints/Action2Motion_1.h5").string()});
  EXPECT_EQ(generator.exit_code, 0) << generator.err;
  for (const char* part :
       {"a trained network", "action2motion, ", "1 iteration\n", "kinect20, 20 joints", "5: clap, kick"}) {
    EXPECT_THAT(generator.out, HasSubstr(part));
  }
  const Result recogniser =
      RunProgram(folder, {"inspect", (folder / "r/checkpoints/recogniser_1.h5").string(), "--json"});
  EXPECT_EQ(recogniser.Json()["network"], "gru_recogniser");
  EXPECT_EQ(recogniser.Json()["labels"].size(), 5u);

  const Result dataset = RunProgram(folder, {"inspect", (folder / "r/dataset.h5").string()});
  EXPECT_EQ(dataset.exit_code, 0) << dataset.err;
  EXPECT_THAT(dataset.out, Not(HasSubstr("{"))) << "text, no JSON";
  for (const char* part : {"mocurate/1", "15 clips", "kinect20, 20 joints", "3: p01 (5), p02 (5), p03 (5)"}) {
    EXPECT_THAT(dataset.out, HasSubstr(part));
  }

  const Result run = RunProgram(folder, {"inspect", (folder / "r").string()});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  for (const char* part : {"a run of demo", "with exit code 0", "up to stage   table", "15 items: 15 done",
                           "clips         15 clips, 15 kept, left out by rule: 0, 0 failed", "dataset.h5: mocurate/1",
                           "tables/table.md"}) {
    EXPECT_THAT(run.out, HasSubstr(part));
  }
  EXPECT_EQ(RunProgram(folder, {"inspect", (folder / "r").string(), "--json"}).Json()["state"], "ended");
}

TEST(WrongCheckpoint, IsRefusedNamingBothKindsAndTheFile) {
  const Folder folder;
  const Result good = RunProgram(folder, TinyTraining(folder));
  ASSERT_EQ(good.exit_code, 0) << good.out << good.err;
  ExpectInspectToTell(folder);

  const fs::path generator = RecordOf(folder, "Action2Motion/1");
  const fs::path recogniser = RecordOf(folder, "recogniser/1");
  const std::string right_generator = ReadText(generator);

  Exchange(generator, recogniser);
  const Result no_generator = RunProgram(folder, TinyTraining(folder));
  EXPECT_EQ(no_generator.exit_code, 3) << no_generator.out;
  EXPECT_THAT(no_generator.err, HasSubstr("holds a network of kind 'gru_recogniser'"));
  EXPECT_THAT(no_generator.err, HasSubstr(generator.parent_path().native()));
  EXPECT_THAT(no_generator.err, HasSubstr("give the checkpoint of a generator"));
  EXPECT_EQ(no_generator.Json()["unevaluated"]["code"], "inconsistent");

  WriteText(generator, right_generator);
  Exchange(recogniser, generator);
  const Result no_recogniser = RunProgram(folder, TinyTraining(folder));
  EXPECT_EQ(no_recogniser.exit_code, 3) << no_recogniser.out;
  EXPECT_THAT(no_recogniser.err, HasSubstr("holds a network of kind 'action2motion', 'gru_recogniser' is needed"));
}

}  // namespace
}  // namespace mocurate
