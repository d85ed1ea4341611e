// Sets that a network makes of its training clips, to train recognisers on (a2m_actor.md D.9).

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/train/toy_dataset.h"
#include "train/data/batches.h"
#include "train/data/training_windows.h"
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
    const auto rows = SelectTrainingRows(PackTrainingSet(set), network.data, false, 1, 0.1);
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
  const auto whole = TrainingWindows(set, network, true);
  ASSERT_TRUE(whole);
  EXPECT_GE(whole->clips[0].motion->frame_count(), 20) << "a shorter clip stays whole";
}

TEST(MadeSets, EachRuleKeepsLabelsAndLengthsAndDrawsByClip) {
  const fs::path file = fs::path(testing::TempDir()) / "made_sets_generator.h5";
  const Dataset set = TurningDataset(2);
  const auto trained = TrainNetwork(PackTrainingSet(set, true), Generator(10), {});
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

  Dataset alone = set;  // one clip of a class is interpolated with itself: a motion like any other
  alone.clips.resize(1);
  alone.splits.clear();
  RemakeOptions between;
  between.rule = RemakeRule::kInterpolate;
  EXPECT_TRUE((*network)->Remake(alone, between));
  fs::remove(file);
}

TEST(MadeSets, EachBatchHasItsShareOfMadeClips) {
  TrainingSet set = PackTrainingSet(ToyDataset(5), false);
  const auto recorded = static_cast<int>(set.clips.size());
  Dataset windows = *TrainingWindows(ToyDataset(5), Generator(10), true);
  ASSERT_TRUE(AddMade(PackTrainingSet(windows), set));
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
    const MixedOrder order(set, {}, rows->train, 8, true, share, 1);
    std::set<int> seen;
    for (std::int64_t step = 0; step < 40; ++step) {
      const std::vector<int> batch = order.RowsOf(step);
      ASSERT_EQ(batch.size(), 8u);
      EXPECT_EQ(std::count_if(batch.begin(), batch.end(), [&](int row) { return row >= recorded; }), count);
      seen.insert(batch.begin(), batch.end());
    }
    EXPECT_GT(static_cast<int>(seen.size()), recorded / 4);
  }
  windows.labels.push_back("dance");
  TrainingSet plain = PackTrainingSet(ToyDataset(1));
  EXPECT_EQ(AddMade(PackTrainingSet(windows), plain).error().code, ErrorCode::kInconsistent);
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
  options.networks[0].enabled = false;
  EXPECT_EQ(code(), ErrorCode::kConfig);
  options.networks[0].enabled = true;
  recogniser.trained_on = TrainingSetChoice::kDataset;
  EXPECT_EQ(code(), ErrorCode::kConfig) << "a generator that is not asked";
}

}  // namespace
}  // namespace mocurate
