// The draws of a repetition: real motions and requests for generators.

#include "eval/protocols/draws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/motion/kinematics.h"
#include "tests/train/toy_dataset.h"

namespace mocurate {
namespace {

constexpr int kFrames = 16;

/// "walk" is ten times as frequent as the two others: 40, 4 and 4 clips.
Dataset UnevenDataset() {
  Dataset dataset = ToyDataset(10);
  std::vector<Clip> kept;
  std::map<std::string, int> members;
  for (Clip& clip : dataset.clips) {
    if (clip.label == "walk" || members[clip.label]++ < 4) kept.push_back(std::move(clip));
  }
  dataset.clips = std::move(kept);
  dataset.splits.clear();
  return dataset;
}

FeaturesOptions OfMotions(std::int64_t motions) {
  FeaturesOptions options;
  options.motions = motions;
  return options;
}

std::vector<int> AllRows(const Dataset& dataset) { return *RowsOfPart(dataset, RealPart::kAll); }

std::vector<MotionRequest> Draw(const Dataset& dataset, const FeaturesOptions& options, int repetition) {
  return DrawRequests(dataset, AllRows(dataset), *TrainingRows(dataset), options, kFrames, repetition);
}

std::vector<double> LabelShares(const std::vector<MotionRequest>& requests) {
  std::vector<double> shares(3, 0.0);
  for (const MotionRequest& request : requests) shares[request.label] += 1.0 / static_cast<double>(requests.size());
  return shares;
}

TEST(Requests, UniformLabelsAreEquallyFrequentWhateverTheRealSet) {
  FeaturesOptions options = OfMotions(3000);
  options.labels = LabelDraw::kUniform;
  const auto shares = LabelShares(Draw(UnevenDataset(), options, 0));
  const double four_sigma = 4.0 * std::sqrt(1.0 / 3.0 * 2.0 / 3.0 / static_cast<double>(options.motions));
  for (const double share : shares) EXPECT_NEAR(share, 1.0 / 3.0, four_sigma);
}

TEST(Requests, NaturalLabelsAreAsFrequentAsInTheDrawnRealMotions) {
  const Dataset dataset = UnevenDataset();
  FeaturesOptions options = OfMotions(3000);
  options.labels = LabelDraw::kNatural;
  const auto requests = Draw(dataset, options, 0);
  const std::vector<int> rows = AllRows(dataset);
  const std::vector<int> drawn = DrawPositions(static_cast<int>(rows.size()), 3000, true, 1, 0, "reference");
  for (std::size_t i = 0; i < requests.size(); ++i) {
    ASSERT_EQ(dataset.labels[requests[i].label], dataset.clips[rows[drawn[i]]].label);
  }
  const auto shares = LabelShares(requests);
  const double four_sigma = 4.0 * std::sqrt(0.25 / static_cast<double>(options.motions));
  EXPECT_NEAR(shares[dataset.LabelIndex("walk")], 40.0 / 48.0, four_sigma);
  EXPECT_NEAR(shares[dataset.LabelIndex("slow")], 4.0 / 48.0, four_sigma);
}

TEST(Requests, CarryTheBoneLengthsOfARealClip) {
  const Dataset dataset = UnevenDataset();
  FeaturesOptions options = OfMotions(3000);
  options.motions = 200;
  std::map<std::string, const Clip*> by_id;
  for (const Clip& clip : dataset.clips) by_id[clip.id()] = &clip;
  std::set<std::string> sources;
  for (const MotionRequest& request : Draw(dataset, options, 0)) {
    ASSERT_EQ(by_id.count(request.source_clip), 1u) << request.source_clip;
    const Motion& motion = *by_id[request.source_clip]->motion;
    ASSERT_EQ(request.bone_length.size(), 5u);
    EXPECT_EQ(request.bone_length[0], 0.0);
    for (int j = 1; j < 5; ++j) {
      const int parent = dataset.skeleton->joints[j].parent;
      const double length = (motion.joints.at(0, j) - motion.joints.at(0, parent)).norm();
      EXPECT_NEAR(request.bone_length[j], length, 1e-12) << request.source_clip;
    }
    EXPECT_EQ(request.frames, kFrames);
    sources.insert(request.source_clip);
  }
  EXPECT_GT(sources.size(), 30u);
}

TEST(Requests, TakeBonesAndFirstPosesFromTrainingClipsAlone) {
  Dataset dataset = UnevenDataset();
  Split split;
  split.name = "held out";
  for (int row = 0; row < static_cast<int>(dataset.clips.size()); ++row) {
    (row % 3 == 0 ? split.train : row % 3 == 1 ? split.validation : split.test).push_back(row);
  }
  dataset.splits = {split};
  std::set<std::string> training;
  std::set<std::vector<double>> poses;
  for (const int row : split.train) {
    const Clip& clip = dataset.clips[static_cast<std::size_t>(row)];
    training.insert(clip.id());
    std::vector<double> pose;
    for (int j = 0; j < 5; ++j) {
      const Vector3d place = clip.motion->joints.at(0, j) - clip.motion->joints.at(0, 0);
      pose.insert(pose.end(), {place.x(), place.y(), place.z()});
    }
    poses.insert(pose);
  }
  const std::vector<int> test = *RowsOfPart(dataset, RealPart::kTest);
  const auto requests = DrawRequests(dataset, test, *TrainingRows(dataset), OfMotions(200), kFrames, 0);
  for (const MotionRequest& request : requests) {
    EXPECT_EQ(training.count(request.source_clip), 1U) << request.source_clip;
    EXPECT_EQ(poses.count(request.first_pose), 1U);
  }
}

TEST(Requests, WithoutReplacementAreAsManyAsTheRealMotions) {
  FeaturesOptions options = OfMotions(3000);
  options.replacement = false;
  options.labels = LabelDraw::kNatural;
  EXPECT_EQ(Draw(UnevenDataset(), options, 0).size(), UnevenDataset().clips.size());
}

TEST(Requests, AreTheSameForTheSameSeedAndRepetitionAndForNoOther) {
  const Dataset dataset = UnevenDataset();
  FeaturesOptions options = OfMotions(3000);
  options.motions = 50;
  const nlohmann::json first = Draw(dataset, options, 3);
  EXPECT_EQ(first, nlohmann::json(Draw(dataset, options, 3)));
  EXPECT_NE(first, nlohmann::json(Draw(dataset, options, 4)));
  options.seed = 2;
  EXPECT_NE(first, nlohmann::json(Draw(dataset, options, 3)));
}

TEST(Requests, EachMotionHasASeedOfItsOwn) {
  FeaturesOptions options = OfMotions(3000);
  std::set<std::uint64_t> seeds;
  for (int repetition = 0; repetition < 3; ++repetition) {
    for (const MotionRequest& request : Draw(UnevenDataset(), options, repetition)) seeds.insert(request.seed);
  }
  EXPECT_EQ(seeds.size(), 9000u);
}

TEST(RealMotions, TheReferenceAndTheRowRealAreDifferentDraws) {
  const auto draw = [](int repetition, const char* purpose) {
    return DrawPositions(48, 100, true, 1, repetition, purpose);
  };
  EXPECT_EQ(draw(0, "reference"), draw(0, "reference"));
  EXPECT_NE(draw(0, "reference"), draw(0, "real"));
  EXPECT_NE(draw(0, "reference"), draw(1, "reference"));
}

TEST(RealMotions, WithoutReplacementNoneIsDrawnTwiceAndNoMoreThanThereAre) {
  const std::vector<int> drawn = DrawPositions(48, 30, false, 1, 0, "reference");
  EXPECT_EQ(std::set<int>(drawn.begin(), drawn.end()).size(), 30u);
  EXPECT_EQ(DrawPositions(48, 100, false, 1, 0, "reference").size(), 48u);
  EXPECT_EQ(DrawPositions(48, 0, true, 1, 0, "reference").size(), 48u) << "0: all, in their order";
}

TEST(RealMotions, AreThoseOfTheChosenPart) {
  const Dataset dataset = ToyDataset(2);
  EXPECT_EQ(RowsOfPart(dataset, RealPart::kAll)->size(), dataset.clips.size());
  EXPECT_EQ(*RowsOfPart(dataset, RealPart::kTrain), dataset.splits.front().train);
  EXPECT_EQ(*RowsOfPart(dataset, RealPart::kTest), dataset.splits.front().test);
  EXPECT_EQ(RowsOfPart(dataset, RealPart::kTest, "nowhere").error().code, ErrorCode::kConfig);
  Dataset untested = dataset;
  untested.splits.front().test.clear();
  EXPECT_EQ(RowsOfPart(untested, RealPart::kTest).error().code, ErrorCode::kInconsistent);
}

}  // namespace
}  // namespace mocurate
