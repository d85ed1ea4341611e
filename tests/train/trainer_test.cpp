// Every network trains, stops and resumes bit for bit with any number of threads, and its checkpoint generates motions.

#include "train/trainer/trainer.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include "core/base/file.h"
#include "tests/support/scratch_folder.h"
#include "tests/train/recogniser_runs.h"
#include "tests/train/toy_dataset.h"
#include "train/data/batches.h"
#include "train/generators/motion_generator.h"
#include "train/recognisers/recogniser_input.h"

namespace mocurate {
namespace {

constexpr NetworkKind kAllModalities[] = {
    NetworkKind::kGruRecogniser, NetworkKind::kStGcn,      NetworkKind::kAction2Motion,
    NetworkKind::kCondGru,       NetworkKind::kActMoCoGan, NetworkKind::kTwoStageGan,
    NetworkKind::kActor,         NetworkKind::kMacvae,     NetworkKind::kSsmct};

class Trainer : public testing::Test {
 protected:
  std::string BytesOf(const Expected<Checkpoint>& checkpoint) {
    EXPECT_TRUE(checkpoint) << checkpoint.error().Message();
    if (!checkpoint) return "";
    const std::filesystem::path path = folder_ / "checkpoint.h5";
    EXPECT_TRUE(WriteCheckpoint(*checkpoint, path));
    return *ReadFile(path);
  }

  ScratchFolder folder_;
};

NetworkOptions Small(NetworkKind kind) {
  NetworkOptions options(kind);
  options.data.frames = 12;
  options.learning.batch = 8;
  options.learning.shards = 2;
  options.learning.iterations = 12;
  options.learning.save_every = 1000;
  options.recogniser.hidden = 16;
  options.recogniser.epochs = kind == NetworkKind::kStGcn ? 4 : 3;  // as many steps as tests stop within
  options.recogniser.check_every = 2;
  options.action2motion.hidden = options.cond_gru.hidden = options.act_mocogan.hidden = 16;
  options.action2motion.latent = options.act_mocogan.latent = options.two_stage_gan.latent = 4;
  options.two_stage_gan.pose_hidden = options.two_stage_gan.motion_hidden = 16;
  options.two_stage_gan.critic_steps = 2;
  options.actor.latent = 16;
  options.actor.layers = 2;
  options.actor.feed_forward = 24;
  options.data.longest_frames = kind == NetworkKind::kActor ? 16 : 0;
  options.macvae.width = options.ssmct.width = 16;
  options.macvae.layers = options.ssmct.layers = 2;
  options.macvae.feed_forward = options.ssmct.feed_forward = 24;
  if (options.NeedsParts()) options.data.frames = 32;
  return options;
}

const TrainingSet& Toy(NetworkKind kind = NetworkKind::kAction2Motion) {
  static const TrainingSet set = *PackTrainingSet(ToyDataset(3));
  static const TrainingSet turning = *PackTrainingSet(TurningDataset(3), {true});
  static const TrainingSet samples = *PackTrainingSet(SampleDataset(3), {true, true});
  if (NetworkOptions(kind).NeedsParts()) return samples;
  return NetworkOptions(kind).NeedsRotations() ? turning : set;
}

class EveryNetwork : public Trainer, public testing::WithParamInterface<NetworkKind> {};

TEST_P(EveryNetwork, GivesTheSameBytesAgainAndWithMoreThreads) {
  const NetworkOptions options = Small(GetParam());
  const std::string once = BytesOf(TrainNetwork(Toy(GetParam()), options, {}));
  TrainingControl threads;
  threads.threads = 3;
  EXPECT_TRUE(once == BytesOf(TrainNetwork(Toy(GetParam()), options, threads)));
  NetworkOptions other = options;
  other.seeds = {5};
  EXPECT_FALSE(once == BytesOf(TrainNetwork(Toy(GetParam()), other, {})));
}

TEST_P(EveryNetwork, StoppedAnywhereGoesOnBitForBit) {
  NetworkOptions options = Small(GetParam());
  options.learning.save_every = 4;
  const std::string straight = BytesOf(TrainNetwork(Toy(GetParam()), options, {}));
  for (const int stop_at : {1, 5, 9}) {
    TrainingControl control;
    control.scratch = folder_ / ("scratch" + std::to_string(stop_at));
    int asked = 0;
    control.stop = [&] { return ++asked == stop_at + 1; };
    const Expected<Checkpoint> stopped = TrainNetwork(Toy(GetParam()), options, control);
    ASSERT_FALSE(stopped);
    EXPECT_EQ(stopped.error().code, ErrorCode::kInterrupted);
    EXPECT_TRUE(straight == BytesOf(TrainNetwork(Toy(GetParam()), options, control))) << "stopped after " << stop_at;
  }
}

TEST_P(EveryNetwork, AnswersRequestsOneByOneAsByHundreds) {
  const NetworkOptions options = Small(GetParam());
  if (!GeneratesMotions(GetParam()) || options.NeedsParts()) return;  // those answer scripts (long_motion_test.cpp)
  const Expected<Checkpoint> trained = TrainNetwork(Toy(GetParam()), options, {});
  ASSERT_TRUE(trained) << trained.error().Message();
  ASSERT_TRUE(WriteCheckpoint(*trained, folder_ / "generator.h5"));
  const auto generator = MotionGenerator::Load(folder_ / "generator.h5");
  ASSERT_TRUE(generator) << generator.error().Message();
  std::vector<MotionRequest> requests;
  for (int i = 0; i < 100; ++i) {
    MotionRequest request;
    request.label = i % 3;
    request.frames = 12;
    request.seed = static_cast<std::uint64_t>(i);
    request.bone_length = {0.0, 0.3, 0.25 + 0.001 * i, 0.4, 0.4};
    request.first_pose.assign(15, 0.01 * i);
    requests.push_back(request);
  }
  ASSERT_TRUE(WriteRequests(requests, folder_ / "requests.json"));
  const auto read = ReadRequests(folder_ / "requests.json");
  ASSERT_TRUE(read) << read.error().Message();
  const auto all = (*generator)->Joints(*read, 2);
  ASSERT_TRUE(all) << all.error().Message();
  const auto one = (*generator)->Joints({requests[37]});
  for (std::size_t k = 0; k < one->size(); ++k) ASSERT_NEAR((*one)[k], (*all)[37 * one->size() + k], 1e-4);
  const auto set = (*generator)->Generate(requests);
  ASSERT_TRUE(set) << set.error().Message();
  EXPECT_EQ(set->clips[37].label, "quick");
  EXPECT_TRUE(WriteDataset(*set, folder_ / "motions.h5"));
  EXPECT_EQ(set->joints_only, GetParam() != NetworkKind::kActor);
  EXPECT_TRUE(set->joints_only || set->clips[37].motion->Check());
  if (GetParam() == NetworkKind::kAction2Motion || GetParam() == NetworkKind::kActor) {
    const Motion& motion = *set->clips[37].motion;
    EXPECT_NEAR((motion.joints.at(5, 2) - motion.joints.at(5, 1)).norm(), 0.25 + 0.037, 1e-5);
  }
  requests[4].label = 9;
  const auto wrong = (*generator)->Joints(requests);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().where, "request 4");
}

INSTANTIATE_TEST_SUITE_P(Networks, EveryNetwork, testing::ValuesIn(kAllModalities));

TEST_F(Trainer, ANetworkKeptAfterSomeStepsGoesOnToTheSameWeights) {
  NetworkOptions options = Small(NetworkKind::kAction2Motion);
  const Expected<Checkpoint> straight = TrainNetwork(Toy(), options, {});
  options.learning.until = 5;
  const Expected<Checkpoint> early = TrainNetwork(Toy(), options, {});
  ASSERT_TRUE(straight && early);
  EXPECT_EQ(early->step, 5);
  ASSERT_TRUE(WriteCheckpoint(*early, folder_ / "early.h5"));
  TrainingControl control;
  control.start = folder_ / "early.h5";
  options.learning.until = 0;
  int steps = 0;
  control.stop = [&] { return ++steps > 7; };
  const Expected<Checkpoint> later = TrainNetwork(Toy(), options, control);
  ASSERT_TRUE(later) << later.error().Message();
  for (std::size_t i = 0; i < straight->parameters.size(); ++i) {
    EXPECT_EQ(straight->parameters[i].value, later->parameters[i].value) << straight->parameters[i].name;
  }
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
    const auto output = RunOn(**recogniser, input, 1, (*recogniser)->input_frames(), 15);
    right += Predicted(*output, 0) == dataset.LabelIndex(clip.label) ? 1.0 : 0.0;
  }
  return right / static_cast<double>(dataset.splits[0].test.size());
}

TEST_F(Trainer, ARecogniserLearnsMotionsThatDiffer) {
  const Dataset dataset = ToyDataset(6);
  NetworkOptions options = Small(NetworkKind::kGruRecogniser);
  options.data.frames = 16;
  options.data.augmentation.yaw_rad = 0.1;
  options.data.augmentation.noise_m = 0.005;
  options.recogniser.epochs = 60;
  options.learning.learning_rate = 1e-2;
  const Expected<Checkpoint> checkpoint = TrainNetwork(*PackTrainingSet(dataset), options, {});
  ASSERT_TRUE(checkpoint) << checkpoint.error().Message();
  ASSERT_TRUE(WriteCheckpoint(*checkpoint, folder_ / "recogniser.h5"));
  EXPECT_GE(TestAccuracy(dataset, folder_ / "recogniser.h5"), 0.9)
      << "last accuracy on the training clips " << checkpoint->history.at("accuracy").back();
  EXPECT_FALSE(checkpoint->history.at("validation_accuracy").empty());
  EXPECT_EQ(checkpoint->facts.at("rate"), "30");
}

TEST_F(Trainer, AReleasedRecogniserHoldsNothingOutAndKeepsItsLastEpoch) {
  for (const NetworkKind kind : {NetworkKind::kGruRecogniser, NetworkKind::kStGcn}) {
    NetworkOptions options = Small(kind);
    options.recogniser.released = true;
    const Expected<Checkpoint> checkpoint = TrainNetwork(Toy(kind), options, {});
    ASSERT_TRUE(checkpoint) << checkpoint.error().Message();
    EXPECT_EQ(checkpoint->facts.at("clips"), Toy(kind).splits.front().train.size());
    EXPECT_EQ(checkpoint->facts.at("best_epoch"), options.recogniser.epochs);
    EXPECT_EQ(checkpoint->history.count("validation_accuracy"), 0U);
    NetworkOptions selecting = options;
    selecting.recogniser.released = selecting.recogniser.refit = false;
    EXPECT_LT(TrainNetwork(Toy(kind), selecting, {})->facts.at("clips"), checkpoint->facts.at("clips"));
  }
}

TEST_F(Trainer, BodiesAndPosesOfTestClipsAreNotKept) {
  for (const NetworkKind kind : {NetworkKind::kCondGru, NetworkKind::kActor}) {
    const NetworkOptions options = Small(kind);
    const TrainingSet& set = Toy(kind);
    TrainingSet other = set;  // test clips of giants
    for (const int row : set.splits.front().test) {
      TrainingSet::Clip& clip = other.clips[static_cast<std::size_t>(row)];
      const std::size_t width = 3 * static_cast<std::size_t>(set.skeleton->joint_count());
      for (std::size_t i = 0; i < width * static_cast<std::size_t>(clip.frames); ++i) {
        other.joints[clip.first * width + i] *= 3.0F;
      }
      for (Vector3d& offset : clip.rest_offset) offset *= 3.0;
    }
    EXPECT_TRUE(BytesOf(TrainNetwork(set, options, {})) == BytesOf(TrainNetwork(other, options, {})));
  }
}

TEST_F(Trainer, AGradientPenaltyTakesThePlaceOfClippedWeights) {
  NetworkOptions options = Small(NetworkKind::kTwoStageGan);
  options.two_stage_gan.gradient_penalty = 10.0;
  options.learning.iterations = 40;
  const Expected<Checkpoint> checkpoint = TrainNetwork(Toy(), options, {});
  ASSERT_TRUE(checkpoint) << checkpoint.error().Message();
  double largest = 0.0;
  for (const Parameter& parameter : checkpoint->parameters) {
    if (parameter.name.rfind("motion_critic", 0) != 0) continue;
    for (const float value : parameter.value) largest = std::max(largest, std::abs(static_cast<double>(value)));
  }
  EXPECT_GT(largest, options.two_stage_gan.weight_clip);
  EXPECT_GT(checkpoint->history.at("penalty").back(), 0.0);
  TrainingControl threads;
  threads.threads = 2;
  EXPECT_TRUE(BytesOf(checkpoint) == BytesOf(TrainNetwork(Toy(), options, threads)));
}

TEST_F(Trainer, AMotionBatchIsJudgedByTheMotionDiscriminatorAlone) {
  NetworkOptions options = Small(NetworkKind::kActMoCoGan);
  options.act_mocogan.motion_batch = 3;  // of eight in two shards
  const Expected<Checkpoint> checkpoint = TrainNetwork(Toy(), options, {});
  ASSERT_TRUE(checkpoint) << checkpoint.error().Message();
  // Of log 2 + log 2 at the start, whatever the number of motions.
  EXPECT_NEAR(checkpoint->history.at("motion_discriminator").front(), 1.39, 0.3);
  options.act_mocogan.motion_batch = 8;
  NetworkOptions all = options;
  all.act_mocogan.motion_batch = 0;
  EXPECT_EQ(TrainNetwork(Toy(), options, {})->history, TrainNetwork(Toy(), all, {})->history);
}

TEST_F(Trainer, SmallerFractionsAreParts) {
  const TrainingSet set = *PackTrainingSet(ToyDataset(10));
  TrainingDataOptions options;
  std::vector<int> larger;
  for (const double fraction : {1.0, 0.5, 0.2, 0.05}) {
    options.fraction = fraction;
    const auto rows = SelectTrainingRows(set, options, false, 1, 0.1);
    ASSERT_TRUE(rows) << rows.error().Message();
    EXPECT_TRUE(larger.empty() || std::includes(larger.begin(), larger.end(), rows->train.begin(), rows->train.end()));
    const double of_class = std::ceil(fraction * 30);  // three persons, ten clips each
    EXPECT_EQ(rows->train.size(), 3 * static_cast<std::size_t>(of_class)) << "of three classes";
    larger = rows->train;
  }
  // A recogniser that is refitted takes its held-out clips back: those are of the fraction too.
  options.fraction = 0.2;
  const auto whole = SelectTrainingRows(set, options, false, 1, 0.1);
  const auto parts = SelectTrainingRows(set, options, true, 1, 0.1);
  ASSERT_TRUE(whole && parts);
  EXPECT_FALSE(parts->validation.empty());
  EXPECT_EQ(parts->train.size() + parts->validation.size(), whole->train.size());
  for (const int row : parts->validation) {
    EXPECT_TRUE(std::binary_search(whole->train.begin(), whole->train.end(), row)) << row;
  }
}

TEST_F(Trainer, BalancedBatchesHoldEveryClassAlike) {
  TrainingSet set = *PackTrainingSet(ToyDataset(10));
  std::vector<int> rows;  // 24 of one class, 3 of another
  for (int i = 0; i < static_cast<int>(set.clips.size()); ++i) {
    const int label = set.clips[static_cast<std::size_t>(i)].label;
    const auto have = std::count_if(rows.begin(), rows.end(),
                                    [&](int row) { return set.clips[static_cast<std::size_t>(row)].label == label; });
    if ((label == 0 && have < 24) || (label == 1 && have < 3)) rows.push_back(i);
  }
  TrainingDataOptions options;
  options.balance = true;
  const BatchOrder order(set, options, rows, 9, false, 1);
  std::map<int, int> seen;
  for (std::int64_t step = 0; step < 4 * order.batches_per_pass(); ++step) {
    for (const int row : order.RowsOf(step)) ++seen[set.clips[static_cast<std::size_t>(row)].label];
  }
  EXPECT_NEAR(seen[0], seen[1], 4);
}

TEST_F(Trainer, BadInputEndsWithItsCode) {
  NetworkOptions options = Small(NetworkKind::kAction2Motion);
  options.data.split = "style";
  const auto split = TrainNetwork(Toy(), options, {});
  ASSERT_FALSE(split);
  EXPECT_EQ(split.error().code, ErrorCode::kConfig);
  options = Small(NetworkKind::kAction2Motion);
  options.learning.device = TrainDevice::kCuda;
  const auto device = TrainNetwork(Toy(), options, {});
  ASSERT_FALSE(device);
  EXPECT_EQ(device.error().code, ErrorCode::kMissingOnHost);
  TrainingSet unlabelled = Toy();
  unlabelled.clips[static_cast<std::size_t>(unlabelled.splits[0].train[2])].label = -1;
  const auto label = TrainNetwork(unlabelled, Small(NetworkKind::kCondGru), {});
  ASSERT_FALSE(label);
  EXPECT_EQ(label.error().where, unlabelled.clips[static_cast<std::size_t>(unlabelled.splits[0].train[2])].id);
  TrainingSet few = Toy();
  few.splits[0].train.resize(1);
  EXPECT_FALSE(TrainNetwork(few, Small(NetworkKind::kAction2Motion), {}));
}

TEST_F(Trainer, AfterAFailureOfTheDeviceOrAFullDiskItGoesOnBitForBit) {
  NetworkOptions options = Small(NetworkKind::kAction2Motion);
  options.learning.save_every = 3;
  const std::string straight = BytesOf(TrainNetwork(Toy(), options, {}));
  TrainingControl control;
  control.scratch = folder_ / "scratch";
  std::string what = "shapes differ";
  control.progress = [&](double share, const std::string&) {
    if (share > 0.5) throw c10::Error(what, "", nullptr);
  };
  EXPECT_THROW((void)TrainNetwork(Toy(), options, control), c10::Error) << "ends this network alone";
  what = "CUDA error: device lost\nmore";
  const auto lost = TrainNetwork(Toy(), options, control);
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, ErrorCode::kMissingOnHost);
  control.progress = [](double, const std::string&) {};
  // No room for the next state: a folder has the name of the file that is written first.
  const std::string state = *ReadFile(control.scratch / "training_state.h5");
  std::filesystem::remove(control.scratch / "training_state.h5");
  std::filesystem::create_directories(control.scratch / "training_state.h5" / "full");
  const auto full = TrainNetwork(Toy(), options, control);
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kCannotWrite);
  std::filesystem::remove_all(control.scratch / "training_state.h5");
  ASSERT_TRUE(WriteFile(control.scratch / "training_state.h5", state));
  EXPECT_TRUE(straight == BytesOf(TrainNetwork(Toy(), options, control)));
}

TEST_F(Trainer, ACheckpointOfAnotherVersionIsRefusedAndATrainingOfOneStartsAnew) {
  NetworkOptions options = Small(NetworkKind::kAction2Motion);
  options.learning.save_every = 5;
  const std::string straight = BytesOf(TrainNetwork(Toy(), options, {}));
  ASSERT_TRUE(WriteFile(folder_ / "other.h5", straight));
  const hid_t file = H5Fopen((folder_ / "other.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t schema = H5Aopen(file, "schema", H5P_DEFAULT), type = H5Aget_type(schema);
  const char* name = "mocurate-checkpoint/9";
  ASSERT_GE(H5Awrite(schema, type, H5Tis_variable_str(type) > 0 ? static_cast<const void*>(&name) : name), 0);
  H5Tclose(type);
  H5Aclose(schema);
  H5Fclose(file);
  const auto read = ReadCheckpoint(folder_ / "other.h5");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kInconsistent);
  TrainingControl control;
  control.scratch = folder_ / "scratch";
  ASSERT_TRUE(MakeFolder(control.scratch));
  std::filesystem::copy_file(folder_ / "other.h5", control.scratch / "training_state.h5");
  std::vector<std::string> found;
  control.report = [&](const Finding& finding) { found.push_back(finding.code); };
  EXPECT_TRUE(straight == BytesOf(TrainNetwork(Toy(), options, control)));
  EXPECT_EQ(found, std::vector<std::string>{"training_restarted"});
}

TEST_F(Trainer, ClipsOfOneFrameAndMotionsThatStandStillTrain) {
  Dataset dataset = ToyDataset(3);
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    Motion& motion = *dataset.clips[i].motion;
    const int frames = i % 2 == 0 ? 1 : motion.joints.frames;
    JointPositions still(frames, 5);
    for (int f = 0; f < frames; ++f) {
      for (int j = 0; j < 5; ++j) still.at(f, j) = motion.joints.at(0, j);
    }
    motion.joints = still;
  }
  const TrainingSet set = *PackTrainingSet(dataset);
  TrainingSet turning = Toy(NetworkKind::kActor);
  for (std::size_t i = 0; i < turning.clips.size(); i += 2) turning.clips[i].frames = 1;
  for (const NetworkKind kind : kAllModalities) {
    const auto trained = TrainNetwork(NetworkOptions(kind).NeedsRotations() ? turning : set, Small(kind), {});
    EXPECT_EQ(trained.has_value(), !NetworkOptions(kind).NeedsParts()) << "clips without parts are no samples";
    EXPECT_TRUE(trained || trained.error().code == ErrorCode::kInconsistent) << trained.error().Message();
  }
}

TEST_F(Trainer, ALossThatIsNotFiniteEndsTheTrainingAndItsBatchIsKept) {
  NetworkOptions options = Small(NetworkKind::kAction2Motion);
  options.action2motion.lie = false;
  TrainingSet set = Toy();
  for (float& value : set.joints) value *= 1e20f;
  TrainingControl control;
  control.scratch = folder_ / "scratch";
  const auto diverged = TrainNetwork(set, options, control);
  ASSERT_FALSE(diverged);
  EXPECT_EQ(diverged.error().code, ErrorCode::kInconsistent);
  const auto kept = ReadCheckpoint(folder_ / "scratch/diverged.h5");
  ASSERT_TRUE(kept) << kept.error().Message();
  EXPECT_GE(FindParameter(kept->parameters, "batch.motion"), 0);
}

TEST_F(Trainer, AStateBeyondTheEndIsNotGoneOnFrom) {
  NetworkOptions options = Small(NetworkKind::kAction2Motion);
  options.learning.until = 2;
  const auto early = TrainNetwork(Toy(), options, {});
  options.learning.until = 3;
  TrainingControl control;
  control.start = folder_ / "later.h5";
  ASSERT_TRUE(WriteCheckpoint(*TrainNetwork(Toy(), options, {}), control.start));
  options.learning.until = 2;
  const auto again = TrainNetwork(Toy(), options, control);
  ASSERT_TRUE(early && again);
  EXPECT_EQ(again->step, 2);
  EXPECT_EQ(again->parameters[0].value, early->parameters[0].value);
}

TEST_F(Trainer, AFactOfAnotherTypeIsAMalformedCheckpoint) {
  const Checkpoint sound = *TrainNetwork(Toy(), Small(NetworkKind::kAction2Motion), {});
  const std::pair<const char*, nlohmann::json> changes[] = {
      {"rate", 30}, {"bone_length", "long"}, {"first_pose", {1, 2}}, {"round", "one"}};
  for (const auto& [name, value] : changes) {
    Checkpoint changed = sound;
    changed.facts[name] = value;
    ASSERT_TRUE(WriteCheckpoint(changed, folder_ / "changed.h5"));
    const auto read = ReadCheckpoint(folder_ / "changed.h5");
    ASSERT_FALSE(read) << name;
    EXPECT_EQ(read.error().code, ErrorCode::kMalformed);
  }
}

TEST_F(Trainer, EveryPoseOfActorTrainsOnDrawnLengthsWithABody) {
  Skin skin;
  const Skeleton& skeleton = *Toy(NetworkKind::kActor).skeleton;
  skin.name = "toy";
  for (const Joint& joint : skeleton.joints) {
    skin.joints.push_back(joint.parent < 0
                              ? Vector3d::Zero()
                              : Vector3d(skin.joints[static_cast<std::size_t>(joint.parent)] + joint.rest_offset));
    skin.vertices.push_back(skin.joints.back() + Vector3d(0.1, 0.0, 0.1));
    for (std::size_t j = 0; j < skeleton.joints.size(); ++j)
      skin.weights.push_back(j + 1 == skin.joints.size() ? 1.0 : 0.0);
  }
  TrainingControl control;
  control.skin = std::make_shared<const Skin>(skin);
  for (const PoseChoice pose :
       {PoseChoice::kRotation6D, PoseChoice::kMatrix, PoseChoice::kQuaternion, PoseChoice::kAxisAngle}) {
    NetworkOptions options = Small(NetworkKind::kActor);
    options.actor.pose = pose;
    options.actor.vertex_weight = 1.0;
    const auto trained = TrainNetwork(Toy(NetworkKind::kActor), options, control);
    ASSERT_TRUE(trained) << trained.error().Message();
    EXPECT_EQ(trained->facts.at("body"), "toy");
    EXPECT_GT(trained->history.at("vertex").front(), 0.0);
    EXPECT_EQ(TrainNetwork(Toy(NetworkKind::kActor), options, {}).error().code, ErrorCode::kInconsistent);
  }
}

TEST_F(Trainer, ACheckpointWithoutSoundRestOffsetsIsMalformed) {
  const Checkpoint sound = *TrainNetwork(Toy(NetworkKind::kActor), Small(NetworkKind::kActor), {});
  for (const char* offsets : {"null", "[]", "[[0, 1]]", "[[0, 0, 0], [0, 1, 0]]"}) {
    Checkpoint changed = sound;
    changed.facts["rest_offset"] = nlohmann::json::parse(offsets);
    if (changed.facts["rest_offset"].is_null()) changed.facts.erase("rest_offset");
    ASSERT_TRUE(WriteCheckpoint(changed, folder_ / "changed.h5"));
    const auto generator = MotionGenerator::Load(folder_ / "changed.h5");
    ASSERT_FALSE(generator) << offsets;
    EXPECT_EQ(generator.error().code, ErrorCode::kMalformed) << offsets;
  }
  Checkpoint heads = sound;
  heads.options["heads"] = 3;
  ASSERT_TRUE(WriteCheckpoint(heads, folder_ / "heads.h5"));
  EXPECT_EQ(MotionGenerator::Load(folder_ / "heads.h5").error().code, ErrorCode::kMalformed);
}

TEST_F(Trainer, ATrainingBeginsWithTheWeightsItIsGiven) {
  ASSERT_TRUE(
      WriteCheckpoint(*TrainNetwork(Toy(NetworkKind::kActor), Small(NetworkKind::kActor), {}), folder_ / "a.h5"));
  TrainingControl control;
  control.start_from = folder_ / "a.h5";
  NetworkOptions longer = Small(NetworkKind::kActor);
  longer.data.longest_frames = 20;
  const auto fine_tuned = TrainNetwork(Toy(NetworkKind::kActor), longer, control);
  const auto anew = TrainNetwork(Toy(NetworkKind::kActor), longer, {});
  ASSERT_TRUE(fine_tuned && anew);
  EXPECT_EQ(fine_tuned->step, 12);
  EXPECT_LT(fine_tuned->history.at("loss").front(), anew->history.at("loss").front());
}

TEST_F(Trainer, ActorInterpolatesVariesLengthsAndDenoises) {
  ASSERT_TRUE(
      WriteCheckpoint(*TrainNetwork(Toy(NetworkKind::kActor), Small(NetworkKind::kActor), {}), folder_ / "a.h5"));
  const auto generator = MotionGenerator::Load(folder_ / "a.h5");
  ASSERT_TRUE(generator) << generator.error().Message();
  std::vector<MotionRequest> requests(3);
  for (MotionRequest& request : requests) request.frames = 12;
  requests[0].seed = requests[1].seed = 7;
  requests[1].to_seed = requests[2].seed = 8;
  requests[1].fraction = 1.0;
  ASSERT_TRUE(WriteRequests(requests, folder_ / "requests.json"));
  const auto read = ReadRequests(folder_ / "requests.json");
  ASSERT_TRUE(read) << read.error().Message();
  const auto joints = (*generator)->Joints(*read);
  ASSERT_TRUE(joints) << joints.error().Message();
  const std::size_t size = joints->size() / 3;
  double apart = 0.0, same = 0.0;
  for (std::size_t k = 0; k < size; ++k) {
    apart = std::max(apart, std::fabs(static_cast<double>((*joints)[k]) - (*joints)[2 * size + k]));
    same = std::max(same, std::fabs(static_cast<double>((*joints)[size + k]) - (*joints)[2 * size + k]));
  }
  EXPECT_GT(apart, 1e-3);
  EXPECT_LT(same, 1e-5) << "all of the way is the other latent";
  for (const int frames : {1, 40, 5001}) {
    requests[0].frames = frames;
    EXPECT_EQ((*generator)->Joints({requests[0]}).has_value(), frames <= 5000);
  }

  const Dataset noisy = TurningDataset(1);
  const auto denoised = (*generator)->Remake(noisy, {3}, 2);
  ASSERT_TRUE(denoised) << denoised.error().Message();
  ASSERT_EQ(denoised->clips.size(), noisy.clips.size());
  for (std::size_t i = 0; i < noisy.clips.size(); ++i) {
    EXPECT_EQ(denoised->clips[i].id(), noisy.clips[i].id());
    EXPECT_EQ(denoised->clips[i].motion->frame_count(), noisy.clips[i].motion->frame_count());
    EXPECT_TRUE(denoised->clips[i].motion->Check());
  }
  EXPECT_TRUE(WriteDataset(*denoised, folder_ / "denoised.h5"));
  Dataset other = noisy;
  other.clips[0].label = "dance";
  EXPECT_EQ((*generator)->Remake(other, {3}).error().code, ErrorCode::kInconsistent);
  EXPECT_EQ((*generator)->Remake(ToyDataset(1), {3}).error().code, ErrorCode::kInconsistent) << "joints alone";
  ASSERT_TRUE(WriteCheckpoint(*TrainNetwork(Toy(), Small(NetworkKind::kAction2Motion), {}), folder_ / "b.h5"));
  const auto frame_by_frame = MotionGenerator::Load(folder_ / "b.h5");
  ASSERT_TRUE(frame_by_frame);
  EXPECT_EQ((*frame_by_frame)->Remake(noisy, {3}).error().code, ErrorCode::kInconsistent);
  EXPECT_EQ((*frame_by_frame)->Joints({requests[1]}).error().code, ErrorCode::kInconsistent);
}

TEST_F(Trainer, JointsAloneAreRefusedWhereRotationsAreNeeded) {
  ASSERT_TRUE(WriteDataset(ToyDataset(1), folder_ / "joints.h5"));
  EXPECT_TRUE(ReadTrainingSet(folder_ / "joints.h5"));
  EXPECT_EQ(ReadTrainingSet(folder_ / "joints.h5", {true}).error().code, ErrorCode::kInconsistent);
}

TEST_F(Trainer, ACheckpointOfAnotherNetworkIsRefusedNamingBoth) {
  ASSERT_TRUE(WriteCheckpoint(*TrainNetwork(Toy(), Small(NetworkKind::kAction2Motion), {}), folder_ / "generator.h5"));
  const auto recogniser = Recogniser::Load(folder_ / "generator.h5");
  ASSERT_FALSE(recogniser);
  EXPECT_EQ(recogniser.error().code, ErrorCode::kInconsistent);
  ASSERT_TRUE(WriteCheckpoint(*TrainNetwork(Toy(), Small(NetworkKind::kGruRecogniser), {}), folder_ / "recogniser.h5"));
  const auto generator = MotionGenerator::Load(folder_ / "recogniser.h5");
  ASSERT_FALSE(generator);
  EXPECT_EQ(generator.error().code, ErrorCode::kInconsistent);
}

TEST_F(Trainer, ADamagedCheckpointIsRefused) {
  const std::filesystem::path path = folder_ / "generator.h5";
  const std::string bytes = BytesOf(TrainNetwork(Toy(), Small(NetworkKind::kAction2Motion), {}));
  Random random(1, "damage");
  for (int round = 0; round < 30; ++round) {
    std::string damaged = bytes;
    damaged[damaged.size() / 4 + random.Below(damaged.size() / 2)] ^= 1;
    ASSERT_TRUE(WriteFile(path, damaged));
    const Expected<Checkpoint> checkpoint = ReadCheckpoint(path);
    if (checkpoint) {
      EXPECT_EQ(BytesOf(checkpoint), bytes);  // the change lay outside of what is stored
    }
  }
  ASSERT_TRUE(WriteFile(path, bytes.substr(0, bytes.size() / 2)));
  EXPECT_FALSE(ReadCheckpoint(path));
  ASSERT_TRUE(WriteFile(path, ""));
  EXPECT_FALSE(ReadCheckpoint(path));
  EXPECT_EQ(ReadCheckpoint(folder_ / "nothing.h5").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace mocurate
