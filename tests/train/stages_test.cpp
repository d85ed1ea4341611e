#include "train/stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/base/file.h"
#include "tests/support/scratch_folder.h"
#include "tests/train/toy_dataset.h"
#include "train/checkpoint/checkpoint.h"
#include "train/data/batches.h"
#include "train/items.h"

namespace mocurate {
namespace {

class TrainStages : public testing::Test {
 protected:
  void SetUp() override {
    const Status written = WriteDataset(ToyDataset(3), folder_ / "dataset.h5");
    ASSERT_TRUE(written) << written.error().Message();
  }

  StageRequest Request(NetworkOptions options) const {
    options.data.frames = 8;
    options.learning.iterations = 3;
    options.recogniser.hidden = options.action2motion.hidden = 8;
    options.recogniser.epochs = 3;
    options.action2motion.latent = 2;
    options.seeds = {5};
    StageRequest request;
    request.stage = "train";
    request.item = options.name + "/5";
    request.options = OptionsToJson(options);
    request.inputs = {{"dataset", "dataset", folder_ / "dataset.h5", "0"}};
    request.output = folder_ / "output.h5";
    request.scratch = folder_ / "scratch";
    return request;
  }

  ScratchFolder folder_;
};

TEST_F(TrainStages, ARecogniserIsTrainedFromADatasetFile) {
  const auto outcome = TrainStage(Request(NetworkOptions(NetworkKind::kGruRecogniser)));
  ASSERT_TRUE(outcome) << outcome.error().Message();
  EXPECT_EQ(outcome->summary.at("seed"), 5);
  EXPECT_EQ(outcome->summary.at("classes"), 3);
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(folder_ / "output.h5", kGruRecogniserKind);
  ASSERT_TRUE(checkpoint) << checkpoint.error().Message();
  EXPECT_TRUE(checkpoint->finished);
  EXPECT_EQ(checkpoint->skeleton->joint_count(), 5);
}

TEST_F(TrainStages, AGeneratorIsTrainedFromADatasetFile) {
  const auto outcome = TrainStage(Request(NetworkOptions(NetworkKind::kAction2Motion)));
  ASSERT_TRUE(outcome) << outcome.error().Message();
  EXPECT_EQ(outcome->summary.at("iterations"), 3);
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(folder_ / "output.h5", kAction2MotionKind);
  ASSERT_TRUE(checkpoint) << checkpoint.error().Message();
  EXPECT_EQ(checkpoint->history.at("loss").size(), 3u);
}

TEST_F(TrainStages, TheSetIsReadAsItIsPackedFromMemory) {
  const auto read = ReadTrainingSet(folder_ / "dataset.h5");
  ASSERT_TRUE(read) << read.error().Message();
  const TrainingSet packed = *PackTrainingSet(ToyDataset(3));
  EXPECT_EQ(read->joints, packed.joints);
  EXPECT_EQ(read->labels, packed.labels);
  EXPECT_EQ(read->rate.Text(), packed.rate.Text());
  ASSERT_EQ(read->clips.size(), packed.clips.size());
  EXPECT_EQ(read->clips[7].id, packed.clips[7].id);
  EXPECT_EQ(read->clips[7].label, packed.clips[7].label);
  EXPECT_EQ(read->clips[7].frames, packed.clips[7].frames);
  ASSERT_EQ(read->splits.size(), 1u);
  EXPECT_EQ(read->splits[0].train, packed.splits[0].train);
}

/// A clip without an observation is left out of the set and its splits; of one with a gap the longest stretch stays.
TEST_F(TrainStages, InferredFramesAreLeftOut) {
  Dataset set = ToyDataset(3);
  const auto infer = [&](std::size_t row, int begin, int end) {
    Motion& motion = *set.clips[row].motion;
    motion.state.assign(static_cast<std::size_t>(motion.frame_count()) * 5, JointState::kObserved);
    std::fill(motion.state.begin() + 5 * begin, motion.state.begin() + 5 * end, JointState::kInferred);
  };
  const int all = set.clips[2].motion->frame_count(), frames = set.clips[4].motion->frame_count();
  infer(2, 0, all);
  infer(4, 0, 6);
  const TrainingSet packed = *PackTrainingSet(set);
  ASSERT_EQ(packed.clips.size(), set.clips.size() - 1);
  EXPECT_EQ(packed.clips[2].id, set.clips[3].id());
  EXPECT_EQ(packed.clips[3].frames, frames - 6);
  std::vector<std::string> before, after;
  for (const int row : set.splits[0].train) {
    if (row != 2) before.push_back(set.clips[static_cast<std::size_t>(row)].id());
  }
  for (const int row : packed.splits[0].train) after.push_back(packed.clips[static_cast<std::size_t>(row)].id);
  EXPECT_EQ(after, before);
  TrainingSetNeeds whole;
  whole.whole = true;
  EXPECT_EQ(PackTrainingSet(set, whole)->clips[4].frames, frames);

  ASSERT_TRUE(WriteDataset(set, folder_ / "dataset.h5"));
  const auto outcome = TrainStage(Request(NetworkOptions(NetworkKind::kGruRecogniser)));
  ASSERT_TRUE(outcome) << outcome.error().Message();
  const auto about = std::find_if(outcome->findings.begin(), outcome->findings.end(),
                                  [](const Finding& finding) { return finding.code == "inferred_frames"; });
  ASSERT_NE(about, outcome->findings.end());
  EXPECT_EQ(about->value, all + 6);
  NetworkOptions network(NetworkKind::kActor);
  network.data.frames = 10;
  const auto windows = TrainingWindows(set, network, true);
  ASSERT_TRUE(windows) << windows.error().Message();
  ASSERT_EQ(windows->findings.size(), 1u);
  EXPECT_EQ(windows->findings[0].value, all + 6);
}

TEST_F(TrainStages, AnUnknownOptionAndAMissingDatasetAreErrors) {
  StageRequest request = Request(NetworkOptions(NetworkKind::kGruRecogniser));
  request.options["epoch"] = 3;
  const Expected<StageOutcome> option = TrainStage(request);
  ASSERT_FALSE(option);
  EXPECT_NE(option.error().Message().find("epoch"), std::string::npos);
  std::filesystem::remove(folder_ / "dataset.h5");
  const auto missing = TrainStage(Request(NetworkOptions(NetworkKind::kAction2Motion)));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace mocurate
