// The table of a run: rows, repetitions, what good and bad generators score, and what makes it an error.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/eval/toy_evaluation.h"

namespace mocurate {
namespace {

using testing::HasSubstr;

double MeanOf(const nlohmann::json& values) {
  const auto numbers = values.get<std::vector<double>>();
  return std::accumulate(numbers.begin(), numbers.end(), 0.0) / static_cast<double>(numbers.size());
}

AnswerRequests Real(const Dataset& dataset) {
  return [&dataset](const std::vector<MotionRequest>& requests) { return RealMotions(dataset, requests); };
}

AnswerRequests Frozen(const Dataset& dataset) {
  return [&dataset](const std::vector<MotionRequest>& requests) { return FrozenMotions(dataset, requests); };
}

TEST_F(ToyEvaluation, EveryRowHasOneValueOfEachMetricPerRepetition) {
  const nlohmann::json result = Evaluated(OpenTrained, Request({"Action2Motion"}));
  ASSERT_EQ(result.at("rows").size(), 2u);
  for (const char* row : {"Real", "Action2Motion"}) {
    for (const char* metric : {"fid", "accuracy", "diversity", "multimodality"}) {
      EXPECT_EQ(result.at("rows").at(row).at(metric).size(), 3u) << row << " " << metric;
    }
  }
  EXPECT_GT(MeanOf(result.at("rows").at("Real").at("accuracy")), 0.9);
  EXPECT_GT(MeanOf(result.at("rows").at("Action2Motion").at("fid")), MeanOf(result.at("rows").at("Real").at("fid")));
}

TEST_F(ToyEvaluation, RepetitionsAreDrawnAnewAndTheWholeRepeatsByteForByte) {
  const StageRequest request = Request({"Action2Motion"});
  const nlohmann::json result = Evaluated(OpenTrained, request);
  const auto first = ReadFile(request.output);
  ASSERT_TRUE(first);
  Evaluated(OpenTrained, request);
  EXPECT_EQ(*first, ReadFile(request.output).value_or(""));
  for (const char* row : {"Real", "Action2Motion"}) {
    EXPECT_NE(result.at("rows").at(row).at("fid")[0], result.at("rows").at(row).at("fid")[1]) << row;
  }
  StageRequest reseeded = request;
  reseeded.options["seed"] = 2;
  EXPECT_NE(Evaluated(OpenTrained, reseeded).at("rows"), result.at("rows"));
}

TEST_F(ToyEvaluation, ARandomHiddenStateRepeatsByteForByteToo) {
  StageRequest request = Request({"Real motions"});
  request.options["random_hidden"] = true;
  const nlohmann::json drawn = Evaluated(Answering(Real(dataset_)), request);
  EXPECT_EQ(drawn, Evaluated(Answering(Real(dataset_)), request));
  request.options["random_hidden"] = false;
  EXPECT_NE(drawn.at("rows"), Evaluated(Answering(Real(dataset_)), request).at("rows"));
}

/// Enough motions that the distance of two draws of one set is small.
StageRequest LargeRequest(StageRequest request) {
  request.options["motions"] = 2000;
  request.options["diversity_pairs"] = 2000;
  return request;
}

TEST_F(ToyEvaluation, RealMotionsAnsweredByAGeneratorScoreAsReal) {
  const StageRequest request = LargeRequest(Request({"Real motions"}));
  const nlohmann::json rows = Evaluated(Answering(Real(dataset_)), request).at("rows");
  const nlohmann::json& real = rows.at("Real");
  const nlohmann::json& answered = rows.at("Real motions");
  EXPECT_LT(MeanOf(answered.at("fid")), 0.1);
  EXPECT_NEAR(MeanOf(answered.at("accuracy")), MeanOf(real.at("accuracy")), 0.02);
  EXPECT_NEAR(MeanOf(answered.at("diversity")), MeanOf(real.at("diversity")), 0.1 * MeanOf(real.at("diversity")));
}

TEST_F(ToyEvaluation, AFrozenPoseScoresMuchWorseThanRealMotions) {
  const StageRequest request = LargeRequest(Request({"Frozen"}));
  const nlohmann::json rows = Evaluated(Answering(Frozen(dataset_)), request).at("rows");
  const nlohmann::json& real = rows.at("Real");
  const nlohmann::json& frozen = rows.at("Frozen");
  EXPECT_LT(MeanOf(real.at("fid")), 0.1);
  EXPECT_GT(MeanOf(frozen.at("fid")), 10.0);
  EXPECT_LT(MeanOf(frozen.at("accuracy")), 0.5);
  EXPECT_LT(MeanOf(frozen.at("diversity")), 1e-5);
  EXPECT_LT(MeanOf(frozen.at("multimodality")), 1e-5);
}

TEST_F(ToyEvaluation, EveryRecogniserIsScoredOnTheTestClips) {
  const nlohmann::json scores = Evaluated(OpenTrained, Request({})).at("recogniser");
  EXPECT_EQ(scores.at("test_accuracy").size(), 2u);
  EXPECT_EQ(scores.at("test_clips"), dataset_.splits.front().test.size());
  EXPECT_DOUBLE_EQ(scores.at("mean"), MeanOf(scores.at("test_accuracy")));
  int counted = 0;
  for (const auto& row : scores.at("confusion")) {
    for (const int count : row.get<std::vector<int>>()) counted += count;
  }
  EXPECT_EQ(counted, 2 * static_cast<int>(dataset_.splits.front().test.size()));
  EXPECT_EQ(scores.at("labels"), (nlohmann::json{"slow", "quick", "walk"}));
}

TEST_F(ToyEvaluation, TheNotesSayWhatStandsBehindTheNumbers) {
  StageRequest request = Request({});
  request.options["labels"] = "natural";
  request.options["real"] = "train";
  const nlohmann::json notes = Evaluated(OpenTrained, request).at("notes");
  EXPECT_EQ(
      notes[0],
      "Real motions: training clips. Generated labels: as frequent as in the real set. 3 repetitions of 90 motions.");
  EXPECT_EQ(notes[1], "The recogniser sees whole clips resampled to 16 frames, initial hidden state zero.");
}

TEST_F(ToyEvaluation, AClassWithoutRealMotionsIsAnErrorThatNamesIt) {
  Dataset lacking = dataset_;
  lacking.labels.push_back({"jump", ""});
  Save(lacking, "lacking.h5");
  StageRequest request = Request({});
  request.inputs.front().path = folder_ / "lacking.h5";
  const auto outcome = MakeEvaluateStage(OpenTrained)(request);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::kInconsistent);
  EXPECT_THAT(outcome.error().Message(), HasSubstr("class 'jump' has no real motion"));
}

TEST_F(ToyEvaluation, AClassMissingInTheChosenPartIsAnErrorThatNamesIt) {
  Dataset lacking = dataset_;
  std::vector<int>& test = lacking.splits.front().test;
  test.erase(std::remove_if(test.begin(), test.end(), [&](int row) { return lacking.clips[row].label == "walk"; }),
             test.end());
  Save(lacking, "lacking.h5");
  StageRequest request = Request({});
  request.inputs.front().path = folder_ / "lacking.h5";
  request.options["real"] = "test";
  const auto outcome = MakeEvaluateStage(OpenTrained)(request);
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().Message(), HasSubstr("class 'walk'"));
  EXPECT_THAT(outcome.error().Message(), HasSubstr("evaluate.real"));
}

TEST_F(ToyEvaluation, AGeneratorThatAnswersTooFewMotionsIsAnError) {
  const AnswerRequests answer = [](const std::vector<MotionRequest>& requests) {
    auto motions = RealMotions(dataset_, requests);
    motions.resize(2);
    return motions;
  };
  const auto outcome = MakeEvaluateStage(Answering(answer))(Request({"Lazy"}));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::kInconsistent);
  EXPECT_EQ(outcome.error().what, "2 motions answer 90 requests");
}

TEST_F(ToyEvaluation, AMotionOfAnotherSkeletonIsAnErrorWithBothNumbersOfJoints) {
  const AnswerRequests answer = [](const std::vector<MotionRequest>& requests) {
    auto motions = RealMotions(dataset_, requests);
    for (Motion& motion : motions) motion.joints = JointPositions(16, 7);
    return motions;
  };
  const auto outcome = MakeEvaluateStage(Answering(answer))(Request({"Foreign"}));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().what, "motions have 7 joints, the recogniser reads 5");
}

TEST_F(ToyEvaluation, PositionsThatAreNotFiniteAreAnErrorNotANumberInTheTable) {
  const AnswerRequests answer = [](const std::vector<MotionRequest>& requests) {
    auto motions = RealMotions(dataset_, requests);
    motions.front().joints.at(3, 2).x() = std::nan("");
    return motions;
  };
  const auto outcome = MakeEvaluateStage(Answering(answer))(Request({"Broken"}));
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().Message(), HasSubstr("finite"));
}

TEST_F(ToyEvaluation, WhatAGeneratorSaysWhenItFailsIsPassedOn) {
  const OpenGenerator closed = [](const std::filesystem::path&) -> Expected<AnswerRequests> {
    return Fail(ErrorCode::kNotFound, "no such generator", "shelf");
  };
  const auto outcome = MakeEvaluateStage(closed)(Request({"Absent"}));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().Message(), Error({ErrorCode::kNotFound, "no such generator", "shelf", ""}).Message());
}

TEST_F(ToyEvaluation, WithoutARecogniserThereIsNothingToScoreWith) {
  StageRequest request = Request({});
  request.inputs.resize(1);
  const auto outcome = MakeEvaluateStage(OpenTrained)(request);
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().what, HasSubstr("recogniser"));
}

}  // namespace
}  // namespace mocurate
