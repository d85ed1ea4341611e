// What a repetition draws: real motions and the requests that generators answer.

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

std::vector<MotionRequest> Draw(const Dataset& dataset, const EvaluateOptions& options, int repetition) {
  const auto real = ChooseReal(dataset, RealPart::kAll);
  EXPECT_TRUE(real);
  const auto drawn = DrawReal(*real, static_cast<int>(options.motions), static_cast<std::uint64_t>(options.seed),
                              repetition, "reference");
  return DrawRequests(dataset, *real, drawn, options, kFrames, repetition);
}

std::vector<double> LabelShares(const std::vector<MotionRequest>& requests) {
  std::vector<double> shares(3, 0.0);
  for (const MotionRequest& request : requests) shares[request.label] += 1.0 / static_cast<double>(requests.size());
  return shares;
}

TEST(Requests, UniformLabelsAreEquallyFrequentWhateverTheRealSet) {
  EvaluateOptions options;
  options.labels = LabelDraw::kUniform;
  const auto shares = LabelShares(Draw(UnevenDataset(), options, 0));
  const double four_sigma = 4.0 * std::sqrt(1.0 / 3.0 * 2.0 / 3.0 / static_cast<double>(options.motions));
  for (const double share : shares) EXPECT_NEAR(share, 1.0 / 3.0, four_sigma);
}

TEST(Requests, NaturalLabelsAreAsFrequentAsInTheDrawnRealMotions) {
  const Dataset dataset = UnevenDataset();
  EvaluateOptions options;
  options.labels = LabelDraw::kNatural;
  const auto real = ChooseReal(dataset, RealPart::kAll);
  ASSERT_TRUE(real);
  const auto drawn = DrawReal(*real, static_cast<int>(options.motions), 1, 0, "reference");
  const auto requests = DrawRequests(dataset, *real, drawn, options, kFrames, 0);
  for (std::size_t i = 0; i < requests.size(); ++i) ASSERT_EQ(requests[i].label, real->labels[drawn[i]]);
  const auto shares = LabelShares(requests);
  const double four_sigma = 4.0 * std::sqrt(0.25 / static_cast<double>(options.motions));
  EXPECT_NEAR(shares[dataset.LabelIndex("walk")], 40.0 / 48.0, four_sigma);
  EXPECT_NEAR(shares[dataset.LabelIndex("slow")], 4.0 / 48.0, four_sigma);
}

TEST(Requests, CarryTheBoneLengthsOfARealClip) {
  const Dataset dataset = UnevenDataset();
  EvaluateOptions options;
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

TEST(Requests, AreTheSameForTheSameSeedAndRepetitionAndForNoOther) {
  const Dataset dataset = UnevenDataset();
  EvaluateOptions options;
  options.motions = 50;
  const nlohmann::json first = Draw(dataset, options, 3);
  EXPECT_EQ(first, nlohmann::json(Draw(dataset, options, 3)));
  EXPECT_NE(first, nlohmann::json(Draw(dataset, options, 4)));
  options.seed = 2;
  EXPECT_NE(first, nlohmann::json(Draw(dataset, options, 3)));
}

TEST(Requests, EachMotionHasASeedOfItsOwn) {
  EvaluateOptions options;
  std::set<std::uint64_t> seeds;
  for (int repetition = 0; repetition < 3; ++repetition) {
    for (const MotionRequest& request : Draw(UnevenDataset(), options, repetition)) seeds.insert(request.seed);
  }
  EXPECT_EQ(seeds.size(), 9000u);
}

TEST(RealMotions, TheReferenceAndTheRowRealAreDifferentDraws) {
  const auto real = ChooseReal(UnevenDataset(), RealPart::kAll);
  ASSERT_TRUE(real);
  EXPECT_EQ(DrawReal(*real, 100, 1, 0, "reference"), DrawReal(*real, 100, 1, 0, "reference"));
  EXPECT_NE(DrawReal(*real, 100, 1, 0, "reference"), DrawReal(*real, 100, 1, 0, "real"));
  EXPECT_NE(DrawReal(*real, 100, 1, 0, "reference"), DrawReal(*real, 100, 1, 1, "reference"));
}

TEST(RealMotions, AreThoseOfTheChosenPartAndHaveALabel) {
  Dataset dataset = ToyDataset(2);
  const std::size_t test_clips = dataset.splits.front().test.size();
  EXPECT_EQ(ChooseReal(dataset, RealPart::kAll)->rows.size(), dataset.clips.size());
  EXPECT_EQ(ChooseReal(dataset, RealPart::kTrain)->rows, dataset.splits.front().train);
  EXPECT_EQ(ChooseReal(dataset, RealPart::kTest)->rows, dataset.splits.front().test);
  dataset.clips[dataset.splits.front().test.front()].label.clear();
  const auto labelled = ChooseReal(dataset, RealPart::kTest);
  ASSERT_TRUE(labelled);
  EXPECT_EQ(labelled->rows.size(), test_clips - 1);
  for (std::size_t i = 0; i < labelled->rows.size(); ++i) {
    EXPECT_EQ(dataset.labels[labelled->labels[i]].name, dataset.clips[labelled->rows[i]].label);
  }
}

TEST(RealMotions, AClassWithoutAnyIsAnErrorThatNamesIt) {
  Dataset dataset = ToyDataset(1);
  dataset.labels.push_back({"jump", ""});
  const auto real = ChooseReal(dataset, RealPart::kAll);
  ASSERT_FALSE(real);
  EXPECT_EQ(real.error().code, ErrorCode::kInconsistent);
  EXPECT_NE(real.error().what.find("'jump'"), std::string::npos);
}

}  // namespace
}  // namespace mocurate
