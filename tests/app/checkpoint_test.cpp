// A checkpoint of another kind of network than requested is refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/base/sha256.h"
#include "core/store/store.h"
#include "tests/app/program.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::WriteText;
using ::testing::HasSubstr;
using ::testing::Not;

/// The small job up to the table, with networks of a few numbers.
std::vector<std::string> TinyTraining(const ScratchFolder& folder) {
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

/// Cache record of item `item` of stage `train`, by the journal of the run.
fs::path RecordOf(const ScratchFolder& folder, const std::string& item) {
  std::ifstream journal(folder / "r/journal.jsonl");
  std::string line;
  while (std::getline(journal, line)) {
    const nlohmann::json entry = nlohmann::json::parse(line);
    if (entry["stage"] != "train" || entry["item"] != item) continue;
    const std::string key = entry["key"];
    return folder / ("cache/objects/" + key.substr(0, 2) + "/" + key.substr(2, 2) + "/" + key.substr(4) + ".json");
  }
  return {};
}

/// Gives a record the artifact of another one, under a name of its own.
void Exchange(const fs::path& record, const fs::path& other) {
  nlohmann::json changed = nlohmann::json::parse(ReadText(record));
  const nlohmann::json wrong = nlohmann::json::parse(ReadText(other));
  const std::string theirs = wrong["artifact"], sha256 = wrong["sha256"];
  const std::string name = record.stem().string() + "-" + sha256.substr(0, 8) + fs::path(theirs).extension().string();
  fs::copy_file(other.parent_path() / theirs, record.parent_path() / name, fs::copy_options::overwrite_existing);
  for (const char* key : {"sha256", "bytes"}) changed[key] = wrong[key];
  changed["artifact"] = name;
  WriteText(record, changed.dump());
}

/// Checks the description of a run's outputs: a checkpoint, the dataset, the run folder.
void ExpectDescriptions(const ScratchFolder& folder) {
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
                           "clips         15 clips, 15 kept, excluded by rule: 0, 0 failed", "dataset.h5: mocurate/1",
                           "tables/table.md"}) {
    EXPECT_THAT(run.out, HasSubstr(part));
  }
  EXPECT_EQ(RunProgram(folder, {"inspect", (folder / "r").string(), "--json"}).Json()["state"], "ended");
}

/// A recogniser's folder scores as its checkpoint does, and is refused where a file is not the manifest's.
void ExpectAnExtractorForOthers(const ScratchFolder& folder) {
  const std::string network = (folder / "r/checkpoints/recogniser_1.h5").string();
  const fs::path shared = folder / "shared";
  const auto score = [&](const std::string& extractor) {
    const std::string set = (folder / "r/dataset.h5").string();
    return RunProgram(folder, {"eval", "--protocol", "own", "--extractor", extractor, "--generated", "a=" + set,
                               "--real", set, "--json"});
  };
  const Result made = RunProgram(folder, {"export", network, "--layout", "extractor", "-o", shared.string()});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Result own = score(network), theirs = score(shared.string());
  ASSERT_EQ(theirs.exit_code, 0) << theirs.err;
  EXPECT_EQ(theirs.Json()["rows"], own.Json()["rows"]);
  EXPECT_EQ(theirs.Json()["extractor"], "shared");
  const nlohmann::json manifest = nlohmann::json::parse(ReadText(shared / "manifest.json"));
  EXPECT_EQ(manifest["files"].size(), 2U);
  EXPECT_EQ(manifest["labels"].size(), 5U);
  for (const char* file : {"extractor.yaml", "weights.safetensors"}) {
    const std::string before = ReadText(shared / file);
    WriteText(shared / file, before + " ");
    EXPECT_EQ(score(shared.string()).exit_code, 3) << "changed " << file;
    fs::remove(shared / file);
    EXPECT_EQ(score(shared.string()).exit_code, 3) << "without " << file;
    WriteText(shared / file, before);
  }
  nlohmann::json other = manifest;
  const std::string description = ReadText(shared / "extractor.yaml");
  std::string renamed = description;
  renamed.replace(renamed.find("kick"), 4, "kock");
  WriteText(shared / "extractor.yaml", renamed);
  other["files"]["extractor.yaml"]["sha256"] = Sha256Hex(renamed);
  WriteText(shared / "manifest.json", other.dump());
  EXPECT_EQ(score(shared.string()).exit_code, 3) << "it describes another network";
  WriteText(shared / "extractor.yaml", description);
  other = manifest;
  other["files"]["weights.safetensors"].erase("sha256");
  WriteText(shared / "manifest.json", other.dump());
  EXPECT_EQ(score(shared.string()).exit_code, 3);
  const std::string generator = (folder / "r/checkpoints/Action2Motion_1.h5").string();
  EXPECT_EQ(
      RunProgram(folder, {"export", generator, "--layout", "extractor", "-o", (folder / "no").string()}).exit_code, 2);
  EXPECT_EQ(RunProgram(folder, {"export", network, "--layout", "extractor", "-o", shared.string()}).exit_code, 2)
      << "it is not empty";
  const std::string run = (folder / "r").string(), before = ReadText(folder / "r/metrics.json");
  EXPECT_EQ(
      RunProgram(folder, {"eval", "--protocol", "own", "--run", run, "--generated", run + "/dataset.h5", "-o", run})
          .exit_code,
      2)
      << "it would replace the run's metrics";
  EXPECT_EQ(ReadText(folder / "r/metrics.json"), before);
}

TEST(Generate, GivesTheSameMotionsAgainAndOtherBonesWithTheSameRotations) {
  const ScratchFolder folder;
  ASSERT_EQ(RunProgram(folder, TinyTraining(folder)).exit_code, 0);
  const std::string network = (folder / "r/checkpoints/Action2Motion_1.h5").string();
  const auto generate = [&](const std::string& output, std::vector<std::string> more) {
    std::vector<std::string> arguments = {"generate", network, "-o",    (folder / output).string(),
                                          "--frames", "12",    "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(folder, arguments);
  };
  const Result made = generate("made.h5", {"--label", "kick:3", "--label", "walk", "--seed", "7"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.Json()["motions"], 4);
  EXPECT_EQ(generate("made.h5", {}).exit_code, 2) << "the file exists";
  ASSERT_EQ(generate("again.h5", {"--label", "kick:3", "--label", "walk", "--seed", "7"}).exit_code, 0);
  EXPECT_EQ(ReadText(folder / "made.h5"), ReadText(folder / "again.h5"));
  ASSERT_EQ(
      generate("long.h5", {"--label", "kick:3", "--label", "walk", "--seed", "7", "--scale", "legs=1.5"}).exit_code, 0);
  const auto made_set = ReadDataset(folder / "made.h5"), long_set = ReadDataset(folder / "long.h5");
  ASSERT_TRUE(made_set && long_set);
  const Skeleton& skeleton = *made_set->skeleton;
  for (std::size_t clip = 0; clip < 4; ++clip) {
    EXPECT_EQ(made_set->clips[clip].label, clip < 3 ? "kick" : "walk");
    const Motion &a = *made_set->clips[clip].motion, &b = *long_set->clips[clip].motion;
    ASSERT_EQ(a.frame_count(), 12);
    for (const char* name : {"left_knee", "left_elbow"}) {
      const int joint = *skeleton.FindJoint(name), parent = skeleton.joints[static_cast<std::size_t>(joint)].parent;
      const Vector3d short_bone = a.joints.at(5, joint) - a.joints.at(5, parent);
      const Vector3d long_bone = b.joints.at(5, joint) - b.joints.at(5, parent);
      const double factor = std::string(name) == "left_knee" ? 1.5 : 1.0;
      EXPECT_NEAR((long_bone - factor * short_bone).norm(), 0.0, 1e-4) << name;
    }
  }
  const std::string weights = (folder / "network.safetensors").string();
  ASSERT_EQ(RunProgram(folder, {"export", network, "-o", weights}).exit_code, 0);
  const Result imported = RunProgram(folder, {"generate", weights, "-o", (folder / "from_weights.h5").string(),
                                              "--frames", "12", "--label", "kick:3", "--label", "walk", "--seed", "7"});
  ASSERT_EQ(imported.exit_code, 0) << imported.err;
  EXPECT_EQ(ReadText(folder / "from_weights.h5"), ReadText(folder / "made.h5"));
  EXPECT_EQ(generate("x.h5", {"--label", "fly:3"}).exit_code, 2);
  EXPECT_EQ(generate("x.h5", {"--scale", "nose=2"}).exit_code, 2);
  const Result recogniser = RunProgram(
      folder, {"generate", (folder / "r/checkpoints/recogniser_1.h5").string(), "-o", (folder / "x.h5").string()});
  EXPECT_EQ(recogniser.exit_code, 3) << recogniser.err;
  EXPECT_EQ(RunProgram(folder,
                       {"export", (folder / "made.h5").string(), "-o", (folder / "arrays").string(), "--as", "joints"})
                .exit_code,
            0);
  ExpectAnExtractorForOthers(folder);
}

TEST(WrongCheckpoint, IsRefusedNamingBothKindsAndTheFile) {
  const ScratchFolder folder;
  const Result good = RunProgram(folder, TinyTraining(folder));
  ASSERT_EQ(good.exit_code, 0) << good.out << good.err;
  ExpectDescriptions(folder);

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
