#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/base/file.h"
#include "tests/train/toy_dataset.h"
#include "train/generators/motion_generator.h"
#include "train/recognisers/recogniser.h"
#include "train/recognisers/recogniser_input.h"
#include "train/trainer/training_control.h"

namespace mocurate {
namespace {

class Training : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("mocurate_train_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string BytesOf(const Checkpoint& checkpoint) {
    const std::filesystem::path path = folder_ / "checkpoint.h5";
    EXPECT_TRUE(WriteCheckpoint(checkpoint, path));
    return *ReadFile(path);
  }

  std::filesystem::path folder_;
};

RecogniserOptions SmallRecogniser() {
  RecogniserOptions options;
  options.frames = 16;
  options.hidden = 16;
  options.epochs = 60;
  options.batch = 8;
  options.learning_rate = 1e-2;
  options.augmentation.yaw_rad = 0.1;
  options.augmentation.noise_m = 0.005;
  return options;
}

GeneratorOptions SmallGenerator() {
  GeneratorOptions options;
  options.frames = 12;
  options.hidden = 16;
  options.latent = 4;
  options.iterations = 12;
  options.batch = 8;
  options.save_every = 1000;
  return options;
}

double TestAccuracy(const Dataset& dataset, const std::filesystem::path& path) {
  const auto recogniser = Recogniser::Load(path);
  EXPECT_TRUE(recogniser) << recogniser.error().Message();
  Random random(0, "unused");
  double right = 0.0;
  for (const int row : dataset.splits[0].test) {
    const Clip& clip = dataset.clips[static_cast<std::size_t>(row)];
    const std::vector<float> input =
        RecogniserInput(*clip.motion, (*recogniser)->input_kind(), (*recogniser)->input_frames(), random);
    const auto output = (*recogniser)->Run(input.data(), 1, (*recogniser)->input_frames(), 15);
    right += output->Predicted(0) == dataset.LabelIndex(clip.label) ? 1.0 : 0.0;
  }
  return right / static_cast<double>(dataset.splits[0].test.size());
}

TEST_F(Training, ARecogniserLearnsMotionsThatDiffer) {
  const Dataset dataset = ToyDataset(6);
  const Expected<Checkpoint> checkpoint = TrainRecogniser(dataset, SmallRecogniser(), {});
  ASSERT_TRUE(checkpoint) << checkpoint.error().Message();
  ASSERT_TRUE(WriteCheckpoint(*checkpoint, folder_ / "recogniser.h5"));
  EXPECT_GE(TestAccuracy(dataset, folder_ / "recogniser.h5"), 0.9)
      << "last accuracy on the training clips " << checkpoint->history.at("train_accuracy").back();
  EXPECT_NE(checkpoint->facts.at("validation_rule").get<std::string>().find("training person"), std::string::npos);
  EXPECT_FALSE(checkpoint->history.at("validation_accuracy").empty());
}

TEST_F(Training, TheSameTrainingGivesTheSameBytes) {
  const Dataset dataset = ToyDataset(3);
  RecogniserOptions options = SmallRecogniser();
  options.epochs = 4;
  const std::string recogniser = BytesOf(*TrainRecogniser(dataset, options, {}));
  EXPECT_EQ(recogniser, BytesOf(*TrainRecogniser(dataset, options, {})));
  options.seed = 1;
  EXPECT_NE(recogniser, BytesOf(*TrainRecogniser(dataset, options, {})));
  const std::string generator = BytesOf(*TrainGenerator(dataset, SmallGenerator(), {}));
  EXPECT_EQ(generator, BytesOf(*TrainGenerator(dataset, SmallGenerator(), {})));
}

TEST_F(Training, AStoppedRecogniserGoesOnBitForBit) {
  const Dataset dataset = ToyDataset(3);
  RecogniserOptions options = SmallRecogniser();
  options.epochs = 6;
  options.check_every = 2;
  const std::string straight = BytesOf(*TrainRecogniser(dataset, options, {}));
  for (const int stop_at : {1, 3, 8}) {
    TrainingControl control;
    control.scratch = folder_ / ("scratch" + std::to_string(stop_at));
    int asked = 0;
    control.stop = [&] { return ++asked == stop_at + 1; };
    const Expected<Checkpoint> stopped = TrainRecogniser(dataset, options, control);
    if (!stopped) {
      EXPECT_EQ(stopped.error().code, ErrorCode::kInterrupted);
    }
    const Expected<Checkpoint> resumed = TrainRecogniser(dataset, options, control);
    ASSERT_TRUE(resumed) << resumed.error().Message();
    EXPECT_EQ(straight, BytesOf(*resumed)) << stop_at;
  }
}

TEST_F(Training, AStoppedGeneratorGoesOnBitForBit) {
  const Dataset dataset = ToyDataset(3);
  for (const bool lie : {true, false}) {
    GeneratorOptions options = SmallGenerator();
    options.lie = lie;
    const std::string straight = BytesOf(*TrainGenerator(dataset, options, {}));
    TrainingControl control;
    control.scratch = folder_ / (lie ? "lie" : "plain");
    int asked = 0;
    control.stop = [&] { return ++asked == 6; };
    const Expected<Checkpoint> stopped = TrainGenerator(dataset, options, control);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().code, ErrorCode::kInterrupted);
    EXPECT_EQ(straight, BytesOf(*TrainGenerator(dataset, options, control)));
  }
}

TEST_F(Training, AStateOfOtherOptionsOrDataIsNotUsed) {
  const Dataset dataset = ToyDataset(3);
  GeneratorOptions options = SmallGenerator();
  TrainingControl control;
  control.scratch = folder_;
  control.dataset_sha256 = "a";
  int asked = 0;
  control.stop = [&] { return ++asked == 6; };
  EXPECT_FALSE(TrainGenerator(dataset, options, control));
  control.stop = [] { return false; };
  control.dataset_sha256 = "b";
  options.seed = 3;
  const Expected<Checkpoint> fresh = TrainGenerator(dataset, options, control);
  TrainingControl clean;
  clean.dataset_sha256 = "b";
  EXPECT_EQ(BytesOf(*fresh), BytesOf(*TrainGenerator(dataset, options, clean)));
}

TEST_F(Training, TheLossOfAGeneratorFalls) {
  const Dataset dataset = ToyDataset(3);
  for (const Protocol protocol : {Protocol::kReleased, Protocol::kPaper}) {
    GeneratorOptions options = SmallGenerator();
    options.protocol = protocol;
    options.iterations = 120;
    options.learning_rate = 3e-3;
    const Expected<Checkpoint> checkpoint = TrainGenerator(dataset, options, {});
    ASSERT_TRUE(checkpoint) << checkpoint.error().Message();
    const std::vector<double>& loss = checkpoint->history.at("reconstruction");
    EXPECT_LT(loss.back(), 0.3 * loss.front());
  }
}

TEST_F(Training, ACheckpointOfAnotherModelIsRefusedNamingBoth) {
  const Dataset dataset = ToyDataset(3);
  ASSERT_TRUE(WriteCheckpoint(*TrainGenerator(dataset, SmallGenerator(), {}), folder_ / "generator.h5"));
  const auto recogniser = Recogniser::Load(folder_ / "generator.h5");
  ASSERT_FALSE(recogniser);
  EXPECT_EQ(recogniser.error().code, ErrorCode::kInconsistent);
  EXPECT_NE(recogniser.error().what.find("'action2motion'"), std::string::npos) << recogniser.error().what;
  EXPECT_NE(recogniser.error().what.find("'gru_recogniser'"), std::string::npos) << recogniser.error().what;
}

TEST_F(Training, ADamagedCheckpointIsRefused) {
  const Dataset dataset = ToyDataset(3);
  const std::filesystem::path path = folder_ / "generator.h5";
  std::string bytes = BytesOf(*TrainGenerator(dataset, SmallGenerator(), {}));
  Random random(1, "damage");
  for (int round = 0; round < 30; ++round) {
    std::string damaged = bytes;
    damaged[damaged.size() / 4 + random.Below(damaged.size() / 2)] ^= 1;
    ASSERT_TRUE(WriteFile(path, damaged));
    const Expected<Checkpoint> checkpoint = ReadCheckpoint(path);
    if (checkpoint) {
      EXPECT_EQ(BytesOf(*checkpoint), bytes);  // the change lay outside of what is stored
    }
  }
  ASSERT_TRUE(WriteFile(path, bytes.substr(0, bytes.size() / 2)));
  EXPECT_FALSE(ReadCheckpoint(path));
  ASSERT_TRUE(WriteFile(path, ""));
  EXPECT_FALSE(ReadCheckpoint(path));
  EXPECT_EQ(ReadCheckpoint(folder_ / "nothing.h5").error().code, ErrorCode::kNotFound);
}

TEST_F(Training, AnUnknownSplitIsNamedWithTheKnownOnes) {
  GeneratorOptions options = SmallGenerator();
  options.split = "style";
  const Expected<Checkpoint> checkpoint = TrainGenerator(ToyDataset(3), options, {});
  ASSERT_FALSE(checkpoint);
  EXPECT_EQ(checkpoint.error().code, ErrorCode::kConfig);
  EXPECT_NE(checkpoint.error().Message().find("person"), std::string::npos);
}

TEST_F(Training, RequestsAreAnsweredOneByOneAndByHundreds) {
  const Dataset dataset = ToyDataset(3);
  ASSERT_TRUE(WriteCheckpoint(*TrainGenerator(dataset, SmallGenerator(), {}), folder_ / "generator.h5"));
  const auto generator = MotionGenerator::Load(folder_ / "generator.h5");
  ASSERT_TRUE(generator) << generator.error().Message();
  std::vector<MotionRequest> requests;
  for (int i = 0; i < 100; ++i) {
    MotionRequest request;
    request.label = i % 3;
    request.frames = 12;
    request.seed = static_cast<std::uint64_t>(i);
    request.bone_length = {0.0, 0.3, 0.25 + 0.001 * i, 0.4, 0.4};
    requests.push_back(request);
  }
  ASSERT_TRUE(WriteRequests(requests, folder_ / "requests.json"));
  const auto read = ReadRequests(folder_ / "requests.json");
  ASSERT_TRUE(read) << read.error().Message();
  const auto all = (*generator)->Joints(*read);
  ASSERT_TRUE(all) << all.error().Message();
  const auto one = (*generator)->Joints({requests[37]});
  for (std::size_t k = 0; k < one->size(); ++k) EXPECT_NEAR((*one)[k], (*all)[37 * one->size() + k], 1e-4);
  const auto set = (*generator)->Generate(requests);
  ASSERT_TRUE(set) << set.error().Message();
  ASSERT_EQ(set->clips.size(), 100u);
  const Motion& motion = *set->clips[37].motion;
  EXPECT_NEAR((motion.joints.at(5, 2) - motion.joints.at(5, 1)).norm(), 0.25 + 0.037, 1e-5);
  EXPECT_EQ(set->clips[37].label, "quick");
  const Status stored = WriteDataset(*set, folder_ / "motions.h5");
  EXPECT_TRUE(stored) << stored.error().Message();
  requests[4].label = 9;
  const auto wrong = (*generator)->Joints(requests);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().where, "request 4");
}

}  // namespace
}  // namespace mocurate
