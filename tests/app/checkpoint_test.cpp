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

/// The small job up to the table, with networks of a few numbers.
std::vector<std::string> TinyTraining(const Folder& folder) {
  std::vector<std::string> arguments = program::SmallJob(folder, "r");
  std::replace(arguments.begin(), arguments.end(), std::string("assemble"), std::string("evaluate"));
  for (const char* option : {"train.recogniser.split=''", "train.recogniser.epochs=1", "train.recogniser.hidden=8",
                             "train.recogniser.frames=10", "train.generator.split=''", "train.generator.hidden=8",
                             "train.generator.latent=2", "train.generator.frames=10", "train.generator.iterations=1",
                             "train.generator.batch=4", "evaluate.repetitions=1", "evaluate.motions=20",
                             "evaluate.diversity_pairs=5", "evaluate.multimodality_quota=2"}) {
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
  fs::copy_file(other.parent_path() / name, record.parent_path() / name, fs::copy_options::overwrite_existing);
  for (const char* key : {"artifact", "sha256", "bytes"}) changed[key] = wrong[key];
  WriteText(record, changed.dump());
}

TEST(WrongCheckpoint, IsRefusedNamingBothKindsAndTheFile) {
  const Folder folder;
  const Result good = RunProgram(folder, TinyTraining(folder));
  ASSERT_EQ(good.exit_code, 0) << good.out << good.err;
  const Result as_dataset =
      RunProgram(folder, {"inspect", (folder / "r/checkpoints/Action2Motion.h5").string(), "--json"});
  EXPECT_EQ(as_dataset.exit_code, 3);
  EXPECT_THAT(as_dataset.err, HasSubstr("Action2Motion.h5:/@schema: is 'mocurate-checkpoint/1'; known are mocurate/1"));

  const fs::path generator = RecordOf(folder, "Action2Motion");
  const fs::path recogniser = RecordOf(folder, "recogniser/1");
  const std::string right_generator = ReadText(generator);

  Exchange(generator, recogniser);
  const Result no_generator = RunProgram(folder, TinyTraining(folder));
  EXPECT_EQ(no_generator.exit_code, 3) << no_generator.out;
  EXPECT_THAT(no_generator.err, HasSubstr("holds a network of kind 'gru_recogniser', 'action2motion' is needed"));
  EXPECT_THAT(no_generator.err, HasSubstr(generator.parent_path().native()));
  EXPECT_THAT(no_generator.err, HasSubstr("give the checkpoint of the other network"));
  EXPECT_EQ(no_generator.Json()["unevaluated"]["code"], "inconsistent");

  WriteText(generator, right_generator);
  Exchange(recogniser, generator);
  const Result no_recogniser = RunProgram(folder, TinyTraining(folder));
  EXPECT_EQ(no_recogniser.exit_code, 3) << no_recogniser.out;
  EXPECT_THAT(no_recogniser.err, HasSubstr("holds a network of kind 'action2motion', 'gru_recogniser' is needed"));
}

}  // namespace
}  // namespace mocurate
