// Sets generated from a network's training clips, to train recognisers on (a2m_actor.md D.9).

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>

#include "tests/support/scratch_folder.h"
#include "tests/train/toy_dataset.h"
#include "train/data/batches.h"
#include "train/generators/motion_generator.h"
#include "train/items.h"
#include "train/trainer/trainer.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

NetworkOptions Generator(std::int64_t frames) {
  NetworkOptions options(NetworkKind::kActor);
  options.name = "ACTOR";
  options.data.split = "person";
  options.data.frames = frames;
  options.actor.latent = 8;
  options.actor.heads = 2;
  options.actor.layers = 1;
  options.actor.feed_forward = 8;
  options.learning.iterations = 2;
  return options;
}

TEST(MadeSets, WindowsAreThoseOfTheClipsThatTheNetworkLearnedFrom) {
  const Dataset set = TurningDataset(4);
  NetworkOptions network = Generator(10);
  for (const double fraction : {1.0, 0.5}) {
    network.data.fraction = fraction;
    const auto rows = SelectTrainingRows(*PackTrainingSet(set), network.data, false, 1, 0.1);
    const auto windows = TrainingWindows(set, network, true);
    ASSERT_TRUE(rows && windows) << windows.error().Message();
    std::multiset<std::string> expected, seen;
    for (const int row : rows->train) {
      const Clip& clip = set.clips[static_cast<std::size_t>(row)];
      for (int k = 0; k < clip.motion->frame_count() / 10; ++k) expected.insert(clip.identity.person + clip.label);
    }
    ASSERT_EQ(windows->splits.size(), 1u);
    const Split& split = windows->splits[0];
    for (const int row : split.train) {
      const Clip& window = windows->clips[static_cast<std::size_t>(row)];
      EXPECT_EQ(window.motion->frame_count(), 10);
      EXPECT_EQ(window.identity.end_frame - window.identity.begin_frame, 10);
      EXPECT_NE(window.identity.person, "p3");
      seen.insert(window.identity.person + window.label);
    }
    EXPECT_EQ(seen, expected);
    EXPECT_FALSE(split.test.empty());
    EXPECT_EQ(split.train.size() + split.test.size(), windows->clips.size());
    EXPECT_TRUE(std::is_sorted(windows->clips.begin(), windows->clips.end(),
                               [](const Clip& a, const Clip& b) { return a.id() < b.id(); }));
    for (const int row : split.test) {
      EXPECT_EQ(windows->clips[static_cast<std::size_t>(row)].identity.person, "p3");
    }
    EXPECT_TRUE(TrainingWindows(set, network, false)->splits[0].test.empty());
  }
  network.data.frames = 1000;
  network.data.fraction = 1.0;
  const auto whole = TrainingWindows(set, network, true);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->clips.size(), set.clips.size()) << "a shorter clip stays whole";
  network.actor.coders = ActorCoders::kFullyConnected;
  EXPECT_TRUE(TrainingWindows(set, network, true)->clips.empty()) << "which a network of one length cannot take";

  Dataset selects = set;  // the validation part stays one, and an unlabelled test clip costs itself
  Split& parts = selects.splits[0];
  parts.validation.assign(parts.train.begin(), parts.train.begin() + 3);
  parts.train.erase(parts.train.begin(), parts.train.begin() + 3);
  selects.clips[static_cast<std::size_t>(parts.test[0])].label = "dance";
  const auto split = TrainingWindows(selects, Generator(10), true);
  ASSERT_TRUE(split) << split.error().Message();
  EXPECT_GE(split->splits[0].validation.size(), 3u);
  std::set<std::string> recordings;
  for (const int row : split->splits[0].test) {
    const Clip& clip = split->clips[static_cast<std::size_t>(row)];
    recordings.insert(clip.identity.person + clip.identity.recording);
    EXPECT_NE(clip.label, "dance");
  }
  EXPECT_EQ(recordings.size(), parts.test.size() - 1);
}

TEST(MadeSets, EachRuleKeepsLabelsAndLengthsAndDrawsByClip) {
  const ScratchFolder folder;
  const fs::path file = folder / "generator.h5";
  const Dataset set = TurningDataset(2);
  const auto trained = TrainNetwork(*PackTrainingSet(set, {true}), Generator(10), {});
  ASSERT_TRUE(trained) << trained.error().Message();
  ASSERT_TRUE(WriteCheckpoint(*trained, file));
  const auto network = MotionGenerator::Load(file);
  ASSERT_TRUE(network) << network.error().Message();
  std::vector<Dataset> made;
  for (const RemakeRule rule : {RemakeRule::kDenoise, RemakeRule::kInterpolate, RemakeRule::kGenerate}) {
    RemakeOptions options;
    options.rule = rule;
    auto one = (*network)->Remake(set, options, 2);
    const auto again = (*network)->Remake(set, options, 1);
    ASSERT_TRUE(one && again) << one.error().Message();
    ASSERT_EQ(one->clips.size(), set.clips.size());
    for (std::size_t i = 0; i < set.clips.size(); ++i) {
      const Clip &clip = one->clips[i], &recorded = set.clips[i];
      EXPECT_EQ(clip.label, recorded.label);
      EXPECT_EQ(clip.motion->frame_count(), recorded.motion->frame_count());
      EXPECT_EQ(clip.motion->joints.xyz, again->clips[i].motion->joints.xyz) << "with any number of threads";
      if (rule != RemakeRule::kInterpolate) continue;
      const std::string& other = clip.provenance.at("interpolated_with");
      const auto partner = std::find_if(set.clips.begin(), set.clips.end(),
                                        [&](const Clip& candidate) { return candidate.id() == other; });
      ASSERT_NE(partner, set.clips.end());
      EXPECT_EQ(partner->label, recorded.label);
      EXPECT_NE(other, recorded.id());
    }
    made.push_back(std::move(*one));
  }
  EXPECT_NE(made[0].clips[0].motion->joints.xyz, made[1].clips[0].motion->joints.xyz);
  EXPECT_NE(made[0].clips[0].motion->joints.xyz, made[2].clips[0].motion->joints.xyz);

  Dataset gaps = set;  // a gap stays one, in a motion of the same length
  std::vector<JointState>& state = gaps.clips[0].motion->state;
  state.assign(gaps.clips[0].motion->joints.xyz.size() / 3, JointState::kObserved);
  std::fill(state.begin() + 25, state.begin() + 60, JointState::kInferred);
  const auto filled = (*network)->Remake(gaps, RemakeOptions());
  ASSERT_TRUE(filled) << filled.error().Message();
  EXPECT_EQ(filled->clips[0].motion->frame_count(), gaps.clips[0].motion->frame_count());
  EXPECT_EQ(filled->clips[0].motion->state, state);

  Dataset alone = set;  // one clip of a class is interpolated with itself: a motion like any other
  alone.clips.resize(1);
  alone.splits.clear();
  RemakeOptions between;
  between.rule = RemakeRule::kInterpolate;
  EXPECT_TRUE((*network)->Remake(alone, between));
  fs::remove(file);
}

TEST(MadeSets, EachBatchHasItsShareOfMadeClips) {
  TrainingSet set = *PackTrainingSet(ToyDataset(5));
  const auto recorded = static_cast<int>(set.clips.size());
  Dataset windows = *TrainingWindows(ToyDataset(5), Generator(10), true);
  ASSERT_TRUE(AddMade(*PackTrainingSet(windows), set));
  ASSERT_EQ(set.made.size(), windows.splits[0].train.size()) << "its test part does not train";
  const JointPositions joints = set.Joints(static_cast<std::size_t>(set.made[3]));
  const auto third = static_cast<std::size_t>(windows.splits[0].train[3]);
  EXPECT_NEAR(joints.xyz[20], windows.clips[third].motion->joints.xyz[20], 1e-6);
  TrainingDataOptions all;
  all.all_clips = true;
  EXPECT_EQ(SelectTrainingRows(set, all, false, 1, 0.1)->train.size(), static_cast<std::size_t>(recorded));
  const auto rows = SelectTrainingRows(set, {}, false, 1, 0.1);
  ASSERT_TRUE(rows);
  for (const auto& [share, count] : {std::pair(0.5, 4), std::pair(0.25, 2), std::pair(0.01, 1), std::pair(0.99, 7)}) {
    const MixedOrder order(set, {}, rows->train, set.made, 8, true, share, 1);
    std::set<int> seen;
    for (std::int64_t step = 0; step < 400; ++step) {
      const std::vector<int> batch = order.RowsOf(step);
      ASSERT_EQ(batch.size(), 8u);
      EXPECT_EQ(std::count_if(batch.begin(), batch.end(), [&](int row) { return row >= recorded; }), count);
      seen.insert(batch.begin(), batch.end());
    }
    EXPECT_EQ(seen.size(), rows->train.size() + set.made.size()) << "all are used";
  }
  // Of few recorded clips the batch is smaller, the share is kept.
  const MixedOrder few(set, {}, {rows->train.begin(), rows->train.begin() + 2}, set.made, 8, true, 0.5, 1);
  EXPECT_EQ(few.RowsOf(0).size(), 4u);
  // The two kinds are shuffled apart, also where they are of equal number.
  const std::vector<int> same(set.made.begin(), set.made.begin() + 20);
  const MixedOrder order(set, {}, {rows->train.begin(), rows->train.begin() + 20}, same, 40, true, 0.5, 1);
  const std::vector<int> batch = order.RowsOf(0);
  int alike = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    const auto at = std::find(rows->train.begin(), rows->train.end(), batch[i]) - rows->train.begin();
    alike += same[static_cast<std::size_t>(at)] == batch[20 + i] ? 1 : 0;
  }
  EXPECT_LT(alike, 10);
  // What is made of a held-out person's clips does not train while it is held out.
  std::vector<int> of_person;
  for (int row = 0; row < recorded; ++row) {
    if (set.clips[static_cast<std::size_t>(row)].person == "p1") of_person.push_back(row);
  }
  const std::vector<int> left = MadeWithout(set, of_person);
  EXPECT_LT(left.size(), set.made.size());
  EXPECT_FALSE(left.empty());
  for (const int row : left) EXPECT_NE(set.clips[static_cast<std::size_t>(row)].person, "p1");
  windows.labels.push_back("dance");
  TrainingSet plain = *PackTrainingSet(ToyDataset(1));
  EXPECT_EQ(AddMade(*PackTrainingSet(windows), plain).error().code, ErrorCode::kInconsistent);
}

TEST(MadeSets, TheGeneratorIsNamedAndLearnsFromTheSameClips) {
  TrainOptions options;
  options.networks = {Generator(10), NetworkOptions(NetworkKind::kStGcn)};
  options.networks[0].seeds = {1, 2};
  NetworkOptions& recogniser = options.networks[1];
  recogniser.name = "R";
  recogniser.seeds = {2, 3};
  recogniser.data.split = "person";
  recogniser.data.fraction = 0.5;
  options.networks[0].data.fraction = 0.5;
  recogniser.trained_on = TrainingSetChoice::kInterpolated;
  recogniser.generator = "ACTOR";
  ASSERT_TRUE(CheckNetworks(options)) << CheckNetworks(options).error().Message();
  std::vector<std::string> made;
  for (const TrainItem& item : TrainItems(options, {})) {
    if (!item.made) continue;
    made.push_back(item.made->item());
    EXPECT_FALSE(item.mixed);
    EXPECT_EQ(item.spec.options.at("fraction"), 1.0) << "the set is made of that part already";
  }
  EXPECT_EQ(made, (std::vector<std::string>{"ACTOR/2 interpolated", "ACTOR/1 interpolated"}));
  EXPECT_EQ((MadeSet{"ACTOR", "ACTOR/2", RemakeRule::kDenoise}.seed()), 2u);
  recogniser.made_share = 0.5;
  for (const TrainItem& item : TrainItems(options, {})) {
    EXPECT_TRUE(!item.made || (item.mixed && item.spec.options.at("fraction") == 0.5));
  }
  const auto code = [&] { return CheckNetworks(options).error().code; };
  recogniser.generator = "R";
  EXPECT_EQ(code(), ErrorCode::kConfig);
  recogniser.generator = "ACTOR";
  recogniser.data.all_clips = true;
  EXPECT_EQ(code(), ErrorCode::kConfig) << "test clips would train";
  recogniser.data.all_clips = false;
  recogniser.data.fraction = 1.0;
  EXPECT_EQ(code(), ErrorCode::kConfig) << "made of half of its clips";
  recogniser.data.fraction = 0.5;
  options.networks[0].trained_on = TrainingSetChoice::kUnfitted;
  EXPECT_EQ(code(), ErrorCode::kConfig) << "it was not trained on the fitted clips";
  options.networks[0].trained_on = TrainingSetChoice::kDataset;
  options.networks[0].enabled = false;
  EXPECT_EQ(code(), ErrorCode::kConfig);
  options.networks[0].enabled = true;
  recogniser.trained_on = TrainingSetChoice::kDataset;
  EXPECT_EQ(code(), ErrorCode::kConfig) << "an unused generator";
}

TEST(MadeSets, ANetworkBeginsWithOneAboveItOfItsSizeAndClips) {
  TrainOptions options;
  options.networks = {Generator(10), Generator(10)};
  NetworkOptions &first = options.networks[0], &second = options.networks[1];
  second.name = "longer";
  second.seeds = {4};
  second.data.longest_frames = 20;
  second.learning.start_from_network = "ACTOR";
  ASSERT_TRUE(CheckNetworks(options)) << CheckNetworks(options).error().Message();
  const std::vector<TrainItem> items = TrainItems(options, {});
  ASSERT_EQ(items.size(), 2u);
  EXPECT_EQ(items[0].from, "");
  EXPECT_EQ(items[1].from, "ACTOR/1");
  EXPECT_EQ(items[1].spec.options.at("start_from_network"), "") << "its weights are an input";
  const auto refused = [&](const std::function<void()>& change) {
    const TrainOptions before = options;
    change();
    const bool is = !CheckNetworks(options) && CheckNetworks(options).error().code == ErrorCode::kConfig;
    options = before;
    return is;
  };
  EXPECT_TRUE(refused([&] { second.learning.start_from_network = "longer"; })) << "itself";
  EXPECT_TRUE(refused([&] { first.learning.start_from_network = "longer"; })) << "one below it";
  EXPECT_TRUE(refused([&] { first.enabled = false; }));
  EXPECT_TRUE(refused([&] { second.actor.latent = 16; }));
  EXPECT_TRUE(refused([&] { first.data.all_clips = true; })) << "test clips would be learnt";
  EXPECT_TRUE(refused([&] { second.learning.start_from = "a.h5"; }));
  EXPECT_TRUE(refused([&] { second.learning.weights = "a.h5"; }));
}

}  // namespace
}  // namespace mocurate
