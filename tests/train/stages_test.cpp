#include "train/stages.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/base/file.h"
#include "tests/train/toy_dataset.h"
#include "train/checkpoint/checkpoint.h"
#include "train/items.h"

namespace mocurate {
namespace {

class TrainStages : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / "mocurate_train_stages";
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    const Dataset dataset = ToyDataset(3);
    const Status written = WriteDataset(dataset, folder_ / "dataset.h5");
    ASSERT_TRUE(written) << written.error().Message();
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  StageRequest Request(const std::string& item, const NetworkOptions& options) const {
    StageRequest request;
    request.stage = "train";
    request.item = item;
    request.options = OptionsToJson(options);
    request.inputs = {{"dataset", "dataset", folder_ / "dataset.h5", "0"}};
    request.output = folder_ / "output.h5";
    request.scratch = folder_ / "scratch";
    return request;
  }

  std::filesystem::path folder_;
};

TEST_F(TrainStages, ARecogniserIsTrainedFromADatasetFile) {
  RecogniserOptions options;
  options.frames = 12;
  options.hidden = 8;
  options.epochs = 3;
  options.seed = 5;
  const Expected<StageOutcome> outcome = TrainStage(Request("recogniser/7", {NetworkKind::kRecogniser, options, {}}));
  ASSERT_TRUE(outcome) << outcome.error().Message();
  EXPECT_EQ(outcome->summary.at("seed"), 5);
  EXPECT_EQ(outcome->summary.at("classes"), 3);
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(folder_ / "output.h5", kGruRecogniserKind);
  ASSERT_TRUE(checkpoint) << checkpoint.error().Message();
  EXPECT_EQ(checkpoint->options.at("seed"), 5);
  EXPECT_TRUE(checkpoint->finished);
  EXPECT_EQ(checkpoint->skeleton->joint_count(), 5);
}

TEST_F(TrainStages, AGeneratorIsTrainedFromADatasetFile) {
  GeneratorOptions options;
  options.frames = 8;
  options.hidden = 8;
  options.latent = 2;
  options.iterations = 3;
  const Expected<StageOutcome> outcome =
      TrainStage(Request("Action2Motion", {NetworkKind::kAction2Motion, {}, options}));
  ASSERT_TRUE(outcome) << outcome.error().Message();
  EXPECT_EQ(outcome->summary.at("iterations"), 3);
  const Expected<Checkpoint> checkpoint = ReadCheckpoint(folder_ / "output.h5", kAction2MotionKind);
  ASSERT_TRUE(checkpoint) << checkpoint.error().Message();
  EXPECT_EQ(checkpoint->history.at("loss").size(), 3u);
}

TEST_F(TrainStages, AnUnknownOptionAndAMissingDatasetAreErrors) {
  StageRequest request = Request("recogniser/1", {});
  request.options["recogniser"]["epoch"] = 3;
  const Expected<StageOutcome> option = TrainStage(request);
  ASSERT_FALSE(option);
  EXPECT_NE(option.error().Message().find("epoch"), std::string::npos);
  std::filesystem::remove(folder_ / "dataset.h5");
  const Expected<StageOutcome> missing = TrainStage(Request("Action2Motion", {NetworkKind::kAction2Motion, {}, {}}));
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace mocurate
