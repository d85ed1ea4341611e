#include "train/stages.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/base/file.h"
#include "tests/support/scratch_folder.h"
#include "tests/train/toy_dataset.h"
#include "train/checkpoint/checkpoint.h"
#include "train/data/training_set.h"
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
