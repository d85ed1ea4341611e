// Weights of a file of torch.save replace a training.

#include "train/checkpoint/checkpoint.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/base/file.h"
#include "tests/support/scratch_folder.h"
#include "tests/train/toy_dataset.h"
#include "train/data/training_set.h"
#include "train/trainer/trainer.h"

namespace mocurate {
namespace {

NetworkOptions SmallNetwork() {
  NetworkOptions options(NetworkKind::kAction2Motion);
  options.data.frames = 8;
  options.learning.iterations = 2;
  options.learning.batch = 8;
  options.action2motion.hidden = 8;
  options.action2motion.latent = 2;
  return options;
}

/// A file of torch.save of before PyTorch 1.6, of nested dictionaries with tensors of floats.
class TorchFile {
 public:
  void Begin(const std::string& key) { object_ += Text(key) + "}"; }
  void End() { object_ += "s"; }
  void Integer(const std::string& key, int value) { object_ += Text(key) + "J" + Bytes(value) + "s"; }
  void Floats(const std::string& key, const Parameter& parameter) {
    const std::string number = std::to_string(count_++);
    const auto size = static_cast<std::int32_t>(parameter.value.size());
    std::string shape = "(", strides = "(";
    for (std::size_t i = 0; i < parameter.shape.size(); ++i) {
      std::int32_t stride = 1;
      for (std::size_t k = i + 1; k < parameter.shape.size(); ++k) stride *= static_cast<int>(parameter.shape[k]);
      shape += "J" + Bytes(static_cast<std::int32_t>(parameter.shape[i]));
      strides += "J" + Bytes(stride);
    }
    object_ += Text(key) + "ctorch._utils\n_rebuild_tensor_v2\n((" + Text("storage") + "ctorch\nFloatStorage\n" +
               Text(number) + Text("cpu") + "J" + Bytes(size) + "NtQK" + std::string(1, '\0') + shape + "t" + strides +
               "t\x89NtRs";
    keys_ += Text(number);
    storages_ += Bytes(static_cast<std::int64_t>(size)) +
                 std::string(reinterpret_cast<const char*>(parameter.value.data()), 4 * parameter.value.size());
  }
  std::string Whole() const {
    return std::string("\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19\x2e", 15) +
           Pickle(std::string("M\xe9\x03", 3)) + Pickle("}" + Text("little_endian") + "\x88s") + Pickle("}" + object_) +
           Pickle("](" + keys_ + "e") + storages_;
  }

 private:
  static std::string Pickle(const std::string& body) { return std::string("\x80\x02", 2) + body + "."; }
  template <class T>
  static std::string Bytes(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof(T)};
  }
  static std::string Text(const std::string& text) {
    return "X" + Bytes(static_cast<std::int32_t>(text.size())) + text;
  }

  int count_ = 0;
  std::string object_, keys_, storages_;
};

/// {"prior_net": {...}, "posterior_net": {...}, "decoder": {...}, "opt_prior_net": {...}, "iterations": n}, as the
/// released trainer saves it.
void Save(const Checkpoint& checkpoint, int iterations, const std::filesystem::path& path) {
  TorchFile file;
  for (const auto& [part, name] :
       {std::pair("prior.", "prior_net"), std::pair("posterior.", "posterior_net"), std::pair("decoder.", "decoder")}) {
    file.Begin(name);
    for (const Parameter& parameter : checkpoint.parameters) {
      if (parameter.name.rfind(part, 0) == 0) file.Floats(parameter.name.substr(std::string(part).size()), parameter);
    }
    file.End();
  }
  file.Begin("opt_prior_net");
  file.Floats("exp_avg", {"", {3}, {1, 1, 1}});
  file.End();
  file.Integer("iterations", iterations);
  ASSERT_TRUE(WriteFile(path, file.Whole()));
}

class ReleasedFiles : public testing::Test {
 protected:
  void SetUp() override {
    set_ = *PackTrainingSet(ToyDataset(2));
    trained_ = *TrainNetwork(set_, SmallNetwork(), {});
  }

  Expected<Checkpoint> From(const std::string& file, const NetworkOptions& options = SmallNetwork()) {
    TrainingControl control;
    control.weights = folder_ / file;
    return TrainNetwork(set_, options, control);
  }

  ScratchFolder folder_;
  TrainingSet set_;
  Checkpoint trained_;
};

TEST_F(ReleasedFiles, WeightsOfATorchFileAndOfACheckpointAreTheNetwork) {
  Save(trained_, 50000, folder_ / "latest.tar");
  ASSERT_TRUE(WriteCheckpoint(trained_, folder_ / "own.h5"));
  ASSERT_TRUE(ExportSafetensors(trained_, folder_ / "own.safetensors"));
  for (const char* file : {"latest.tar", "own.h5", "own.safetensors"}) {
    const auto taken = From(file);
    ASSERT_TRUE(taken) << taken.error().Message();
    EXPECT_TRUE(taken->finished);
    EXPECT_EQ(taken->step, file == std::string("latest.tar") ? 50000 : 2);
    ASSERT_EQ(taken->parameters.size(), trained_.parameters.size());
    for (std::size_t i = 0; i < trained_.parameters.size(); ++i) {
      EXPECT_EQ(taken->parameters[i].name, trained_.parameters[i].name);
      EXPECT_EQ(taken->parameters[i].value, trained_.parameters[i].value);
    }
  }
}

TEST_F(ReleasedFiles, WeightsOfAnotherSizeKindOrFormatAreRefused) {
  Save(trained_, 1, folder_ / "latest.tar");
  NetworkOptions larger = SmallNetwork();
  larger.action2motion.hidden = 16;
  EXPECT_EQ(From("latest.tar", larger).error().code, ErrorCode::kInconsistent);
  NetworkOptions joints = SmallNetwork();
  joints.action2motion.protocol = Protocol::kPaper;
  joints.action2motion.time_counter = TimeChoice::kNone;
  EXPECT_EQ(From("latest.tar", joints).error().code, ErrorCode::kInconsistent);
  EXPECT_EQ(From("latest.tar", NetworkOptions(NetworkKind::kCondGru)).error().code, ErrorCode::kInconsistent);
  EXPECT_EQ(From("none.tar").error().code, ErrorCode::kNotFound);
  ASSERT_TRUE(WriteFile(folder_ / "text.tar", "no weights"));
  EXPECT_EQ(From("text.tar").error().code, ErrorCode::kMalformed);
  // A pickle that would run a command.
  ASSERT_TRUE(WriteFile(folder_ / "system.tar",
                        "\x80\x02"
                        "cposix\nsystem\nX\x04"
                        "\0\0\0true\x85R."));
  EXPECT_FALSE(From("system.tar"));
}

}  // namespace
}  // namespace mocurate
