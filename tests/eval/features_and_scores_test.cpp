// Features and scores of rows: repetitions, scores of good and bad generators, and errors.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "eval/features/yardsticks.h"
#include "tests/eval/toy_evaluation.h"

namespace mocurate {
namespace {

using testing::HasSubstr;

AnswerRequests Real(const Dataset& dataset) {
  return [&dataset](const std::vector<MotionRequest>& requests) { return RealMotions(dataset, requests); };
}

AnswerRequests Frozen(const Dataset& dataset) {
  return [&dataset](const std::vector<MotionRequest>& requests) { return FrozenMotions(dataset, requests); };
}

double ValueOf(const nlohmann::json& row, const char* metric) {
  return row.at("metrics").at(metric).at("value").get<double>();
}

TEST_F(ToyEvaluation, EveryRowHasOneValueOfEachMetricPerRepetition) {
  const nlohmann::json real = ScoreOfReal(Draws(3, 90));
  const nlohmann::json generated = ScoreOfGenerator(OpenTrained, Draws(3, 90));
  for (const nlohmann::json& row : {real, generated}) {
    for (const char* metric : {"FID_train", "accuracy", "diversity", "multimodality"}) {
      EXPECT_EQ(row.at("metrics").at(metric).at("repetitions").size(), 3u) << metric;
    }
    EXPECT_EQ(row.at("motions"), 90);
  }
  EXPECT_GT(ValueOf(real, "accuracy"), 0.9);
  EXPECT_EQ(real["metrics"]["nearest_train"]["why"], "real_motions");
  EXPECT_GT(ValueOf(generated, "FID_train"), ValueOf(real, "FID_train"));
  EXPECT_NE(real["metrics"]["FID_train"]["repetitions"][0], real["metrics"]["FID_train"]["repetitions"][1]);
}

TEST_F(ToyEvaluation, TheWholeRepeatsByteForByteAndAnotherSeedDrawsAnew) {
  const nlohmann::json first = ScoreOfGenerator(OpenTrained, Draws(2, 60));
  EXPECT_EQ(first, ScoreOfGenerator(OpenTrained, Draws(2, 60)));
  EXPECT_NE(first, ScoreOfGenerator(OpenTrained, Draws(2, 60), 2));
}

TEST_F(ToyEvaluation, ARandomHiddenStateRepeatsByteForByteToo) {
  DrawOptions draws = Draws(2, 60);
  draws.hidden = HiddenDraw::kNormal;
  const nlohmann::json drawn = ScoreOfGenerator(Answering(Real(dataset_)), draws);
  EXPECT_EQ(drawn, ScoreOfGenerator(Answering(Real(dataset_)), draws));
  EXPECT_NE(drawn, ScoreOfGenerator(Answering(Real(dataset_)), Draws(2, 60)));
}

TEST_F(ToyEvaluation, MoreThreadsGiveTheSameBytes) {
  const FeaturesOptions options = FeaturesOf(Draws(2, 700), "generated", true);
  const std::string one = FeaturesFile(Answering(Real(dataset_)), options, 1);
  const std::string three = FeaturesFile(Answering(Real(dataset_)), options, 3);
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(one, three);
}

TEST_F(ToyEvaluation, RealMotionsAnsweredByAGeneratorScoreAsReal) {
  const nlohmann::json real = ScoreOfReal(Draws(2, 2000));
  const nlohmann::json answered = ScoreOfGenerator(Answering(Real(dataset_)), Draws(2, 2000));
  EXPECT_LT(ValueOf(answered, "FID_train"), 0.1);
  EXPECT_NEAR(ValueOf(answered, "accuracy"), ValueOf(real, "accuracy"), 0.02);
  EXPECT_NEAR(ValueOf(answered, "diversity"), ValueOf(real, "diversity"), 0.15 * ValueOf(real, "diversity"));
  EXPECT_NEAR(ValueOf(answered, "nearest_train"), 0.0, 1e-3) << "copies of the training set";
  EXPECT_GT(ValueOf(answered, "coverage"), 0.9);
  EXPECT_EQ(ValueOf(answered, "memorised"), 1.0);
  EXPECT_EQ(answered["warnings"].back()["code"], "memorised");
  const nlohmann::json& equal = answered["metrics"]["FID_equal"];
  EXPECT_EQ(equal["real"], real["metrics"]["FID_equal"]["value"]) << "the same halves";
  EXPECT_EQ(equal["motions"], dataset_.clips.size() / 2);
  EXPECT_NEAR(equal["value"].get<double>(), equal["real"].get<double>(), equal["real_sd"].get<double>());
  EXPECT_TRUE(real["metrics"]["FID_equal"]["p"].is_null());
  EXPECT_TRUE(equal["p"].is_null());
  EXPECT_EQ(equal["why_no_p"], "few_or_unknown_persons");
}

TEST_F(ToyEvaluation, AFrozenPoseScoresMuchWorseThanRealMotions) {
  const nlohmann::json frozen = ScoreOfGenerator(Answering(Frozen(dataset_)), Draws(2, 600));
  EXPECT_GT(ValueOf(frozen, "FID_train"), 10.0);
  EXPECT_LT(ValueOf(frozen, "accuracy"), 0.5);
  EXPECT_LT(ValueOf(frozen, "diversity"), 1e-5);
  EXPECT_LT(ValueOf(frozen, "multimodality"), 1e-5);
  EXPECT_EQ(ValueOf(frozen, "frozen_share"), 1.0);
  EXPECT_EQ(ValueOf(frozen, "jerk"), 0.0);
  EXPECT_EQ(ValueOf(frozen, "movement_of_real"), 0.0);
  const nlohmann::json& warnings = frozen["warnings"];
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(),
                          [](const nlohmann::json& warning) { return warning["code"] == "hardly_moves"; }));
}

TEST_F(ToyEvaluation, YardsticksAreMadeOfTrainingClips) {
  const std::vector<int>& train = dataset_.splits[0].train;
  std::vector<MotionRequest> requests(30);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    requests[i].label = static_cast<int>(i % 3);
    requests[i].frames = 9;
    requests[i].seed = i;
  }
  for (const Yardstick yardstick : {Yardstick::kRetrieval, Yardstick::kShuffledLabels}) {
    const auto answers = Yardsticks::Make(yardstick, dataset_, {train[0]}, {});
    ASSERT_TRUE(answers) << answers.error().Message();
    int of_label = 0;
    for (const MotionRequest& request : requests) {
      const auto answer = answers->Of(request);
      ASSERT_TRUE(answer) << answer.error().Message();
      const auto row = std::find_if(train.begin() + 1, train.end(), [&](int candidate) {
        return dataset_.clips[static_cast<std::size_t>(candidate)].id() == answer->clip;
      });
      ASSERT_NE(row, train.end()) << "not a training clip, or the skipped one";
      const Clip& clip = dataset_.clips[static_cast<std::size_t>(*row)];
      EXPECT_EQ(answer->motion.joints.xyz, clip.motion->joints.xyz);
      of_label += dataset_.LabelIndex(clip.label) == request.label ? 1 : 0;
    }
    EXPECT_NEAR(of_label, yardstick == Yardstick::kRetrieval ? 30 : 10, yardstick == Yardstick::kRetrieval ? 0 : 8);
  }
  for (const Dataset& set : {dataset_, TurningDataset(2)}) {
    const Yardsticks answers = *Yardsticks::Make(Yardstick::kMeanPose, set, {}, {});
    const Motion slow = answers.Of(requests[0])->motion, quick = answers.Of(requests[1])->motion;
    EXPECT_EQ(slow.frame_count(), 9);
    EXPECT_EQ(slow.joints_only(), set.joints_only);
    EXPECT_TRUE(slow.Check());
    EXPECT_EQ(slow.joints.at(0, 2), slow.joints.at(8, 2)) << "it stands still";
    EXPECT_NE(slow.joints.xyz, quick.joints.xyz) << "each class has its own";
    EXPECT_EQ(slow.joints.xyz, answers.Of(requests[3])->motion.joints.xyz);
    EXPECT_NEAR(slow.joints.at(0, 0).y(), 1.0, 1e-9);
  }
  Dataset missing = dataset_;
  for (Clip& clip : missing.clips) clip.label = clip.label == "walk" ? "slow" : clip.label;
  const Yardsticks without = *Yardsticks::Make(Yardstick::kRetrieval, missing, {}, {});
  EXPECT_EQ(without.Of(requests[2]).error().code, ErrorCode::kInconsistent);

  FeaturesOptions options = FeaturesOf(Draws(2, 300), "generated", true);
  options.yardstick = Yardstick::kMeanPose;
  const FeatureSet features = FeatureSetOf("dataset.h5", options);
  EXPECT_EQ(features.count(), 600);
  EXPECT_EQ(std::set<std::string>(features.clip.begin(), features.clip.end()).size(), 600u);
  options.yardstick = Yardstick::kRetrieval;
  const FeatureSet copies = FeatureSetOf("dataset.h5", options);
  EXPECT_LE(std::set<std::string>(copies.clip.begin(), copies.clip.end()).size(), train.size()) << "copies count once";
  EXPECT_EQ(features.quality.at("frozen_share").front(), 1.0);
}

TEST_F(ToyEvaluation, MBenchsMeasuresAndThoseOfTransitionsStandInTheirRowsAlone) {
  FeaturesOptions options;
  EXPECT_EQ(FeatureSetOf("dataset.h5", options).quality.count("mbench_jitter"), 0U);
  options.measures = MeasureSet::kMBench;
  const FeatureSet set = FeatureSetOf("dataset.h5", options);
  EXPECT_EQ(set.quality.at("mbench_jitter").size(), dataset_.clips.size());
  EXPECT_EQ(set.quality.count("peak_jerk"), 0U);
}

TEST_F(ToyEvaluation, TwoMotionsAreScoredAndSayWhatTheyAreTooFewFor) {
  Dataset few = dataset_;
  few.clips.resize(2);
  few.splits.clear();
  Save(few, "two.h5");
  const FeatureSet set = FeatureSetOf("two.h5", FeaturesOptions());
  ScoreOptions options;
  options.name = "Real";
  options.real = RealRow::kTrain;
  const auto row = ScoreRow(options, set, {&set, nullptr});
  ASSERT_TRUE(row) << row.error().Message();
  for (const char* metric : {"FID_train", "FID_equal", "FID_inf", "KID", "coverage"}) {
    EXPECT_EQ((*row)["metrics"][metric]["why"], "too_few_motions") << metric;
    EXPECT_TRUE((*row)["metrics"][metric]["value"].is_null()) << metric;
  }
}

TEST_F(ToyEvaluation, OneMotionOfAClassHasNoMultimodalityAndSaysWhy) {
  Dataset few = dataset_;
  few.clips.clear();
  for (const Clip& clip : dataset_.clips) {
    const bool there =
        std::any_of(few.clips.begin(), few.clips.end(), [&](const Clip& other) { return other.label == clip.label; });
    if (!there) few.clips.push_back(clip);
  }
  few.splits.clear();
  Save(few, "one.h5");
  const nlohmann::json metrics = ScoreOfSet("one.h5")["metrics"];
  for (const char* metric : {"multimodality", "ACPD"}) {
    EXPECT_TRUE(metrics[metric]["value"].is_null()) << metric;
    EXPECT_EQ(metrics[metric]["why"], "one_motion_of_a_class") << metric;
  }
}

TEST_F(ToyEvaluation, WhereNothingIsDrawnRealIsScoredInTwoHalves) {
  const nlohmann::json real = ScoreOfReal(DrawOptions());
  EXPECT_EQ(real.at("assumed"), nlohmann::json({"real_in_two_halves"}));
  const nlohmann::json& fid = real["metrics"]["FID_train"];
  EXPECT_EQ(fid["interval_kind"], "spread") << "four persons";
  EXPECT_LE(fid["interval"][0].get<double>(), fid["value"].get<double>());
  EXPECT_GE(fid["interval"][1].get<double>(), fid["value"].get<double>());
  EXPECT_EQ(real["motions"], dataset_.clips.size());
}

TEST_F(ToyEvaluation, RealClipsOfTheTestPartAreScoredAgainstThemselvesInHalvesAndAgainstOtherClipsAsTheyAre) {
  const auto with_label = [](const std::string& label) {
    Dataset part = dataset_;
    part.clips.erase(std::remove_if(part.clips.begin(), part.clips.end(),
                                    [&](const Clip& clip) { return (clip.label == "walk") != (label == "walk"); }),
                     part.clips.end());
    part.splits.clear();
    Save(part, "part.h5");
    return FeatureSetOf("part.h5", FeaturesOptions());
  };
  const FeatureSet train = with_label("wave"), test = with_label("walk");
  ScoreOptions options;
  options.name = "Real-test";
  options.real = RealRow::kTest;
  const auto row = ScoreRow(options, test, {&train, &test});
  ASSERT_TRUE(row) << row.error().Message();
  EXPECT_GT(ValueOf(*row, "FID_train"), 20.0 * ValueOf(*row, "FID_test"));
  EXPECT_GT(ValueOf(*row, "FID_test"), 0.0) << "not the same clips on both sides";
}

TEST_F(ToyEvaluation, WithoutLabelsADrawPerLabelIsAnError) {
  Dataset unlabelled = dataset_;
  for (Clip& clip : unlabelled.clips) clip.label.clear();
  Save(unlabelled, "unlabelled.h5");
  ScoreOptions options;
  options.draw.per_label = 20;
  const FeatureSet row = FeatureSetOf("unlabelled.h5", FeaturesOptions());
  const auto scored = ScoreRow(options, row, {nullptr, nullptr});
  ASSERT_FALSE(scored);
  EXPECT_EQ(scored.error().code, ErrorCode::kInconsistent);
}

TEST_F(ToyEvaluation, AClassWithoutMotionsIsAWarningAndItsMetricNull) {
  Dataset lacking = dataset_;
  lacking.clips.erase(
      std::remove_if(lacking.clips.begin(), lacking.clips.end(), [](const Clip& clip) { return clip.label == "walk"; }),
      lacking.clips.end());
  lacking.splits.clear();
  Save(lacking, "lacking.h5");
  const nlohmann::json row = ScoreOfSet("lacking.h5");
  EXPECT_TRUE(row["metrics"]["multimodality"]["value"].is_null());
  EXPECT_TRUE(row["metrics"]["accuracy"]["value"].is_number());
  EXPECT_EQ(row["metrics"]["multimodality"]["why"], "class_without_motions");
  EXPECT_EQ(row["warnings"][0]["code"], "class_without_motions");
}

TEST_F(ToyEvaluation, MotionsThatNobodyObservedAreNotScoredAndCutOnesKeepTheirNames) {
  Dataset set = dataset_;
  Motion &unseen = *set.clips[0].motion, &padded = *set.clips[1].motion;
  unseen.state.assign(unseen.joints.xyz.size() / 3, JointState::kInferred);
  std::fill(padded.joints.xyz.end() - 15 * 4, padded.joints.xyz.end(), 0.0);
  Save(set, "unseen.h5");
  FeaturesOptions options;
  options.padding = PaddingAction::kCut;
  const auto outcome = MakeFeaturesStage(OpenTrained)(FeaturesRequest("unseen.h5", options));
  ASSERT_TRUE(outcome) << outcome.error().Message();
  EXPECT_EQ(outcome->summary.at("with_inferred"), 1);
  EXPECT_EQ(outcome->summary.at("all_inferred"), 1);
  EXPECT_EQ(outcome->summary.at("inferred_frames"), unseen.frame_count());
  EXPECT_EQ(outcome->summary.at("padding_frames"), 4);
  const FeatureSet features = Read(outcome);
  ASSERT_EQ(features.clip.size(), set.clips.size() - 1);
  EXPECT_EQ(features.clip[0], set.clips[1].id());
}

TEST_F(ToyEvaluation, MotionsWithoutLabelsHaveNoAccuracyAndTheRestAllTheSame) {
  Dataset unlabelled = dataset_;
  for (Clip& clip : unlabelled.clips) clip.label.clear();
  Save(unlabelled, "unlabelled.h5");
  const nlohmann::json row = ScoreOfSet("unlabelled.h5");
  EXPECT_TRUE(row["metrics"]["accuracy"]["value"].is_null());
  EXPECT_TRUE(row["metrics"]["FID_train"]["value"].is_number());
  EXPECT_EQ(row["warnings"][0]["code"], "no_labels");
}

TEST_F(ToyEvaluation, FewerMotionsThanFeaturesAreAWarningBesideTheFigure) {
  Dataset few = dataset_;
  few.clips.resize(12);
  few.splits.clear();
  Save(few, "few.h5");
  const nlohmann::json row = ScoreOfSet("few.h5");
  EXPECT_TRUE(row["metrics"]["FID_train"]["value"].is_number());
  EXPECT_EQ(row["metrics"]["FID_inf"]["why"], "too_few_motions");
  EXPECT_TRUE(row["metrics"]["FID_inf"]["value"].is_null());
  EXPECT_TRUE(std::any_of(row["warnings"].begin(), row["warnings"].end(),
                          [](const nlohmann::json& warning) { return warning["code"] == "too_few_for_fid"; }));
}

TEST_F(ToyEvaluation, ALabelThatTheExtractorLacksIsAnErrorThatNamesClipAndClasses) {
  Dataset foreign = dataset_;
  foreign.clips[3].label = "quik";
  foreign.labels.push_back("quik");
  Save(foreign, "foreign.h5");
  const auto outcome = MakeFeaturesStage(OpenTrained)(FeaturesRequest("foreign.h5", FeaturesOptions()));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::kInconsistent);
  EXPECT_EQ(outcome.error().where, foreign.clips[3].id());
  EXPECT_THAT(outcome.error().hint, HasSubstr("'quick'"));
}

TEST_F(ToyEvaluation, TheSetThatTrainedTheRecogniserIsKnown) {
  StageRequest request = FeaturesRequest("dataset.h5", FeaturesOptions());
  request.inputs[1].sha256 = "0";  // as the recognisers were trained on
  const auto outcome = MakeFeaturesStage(OpenTrained)(request);
  ASSERT_TRUE(outcome) << outcome.error().Message();
  EXPECT_EQ(outcome->summary.at("is_training_set"), true);
}

TEST_F(ToyEvaluation, FeaturesOfAnotherDimensionAreRefused) {
  FeatureSet narrow;
  narrow.feature_size = 2;
  narrow.classes = {"a"};
  narrow.features = {0.0f, 1.0f, 1.0f, 0.0f};
  narrow.logits = {1.0f, 1.0f};
  narrow.label = {0, 0};
  narrow.clip = {"x", "y"};
  narrow.pass_begin = {0};
  FeatureSet wide = narrow;
  wide.feature_size = 1;
  wide.features = {0.0f, 1.0f};
  const auto scored = ScoreRow({}, narrow, {&wide, nullptr});
  ASSERT_FALSE(scored);
  EXPECT_EQ(scored.error().code, ErrorCode::kInconsistent);
}

TEST_F(ToyEvaluation, AGeneratorThatAnswersTooFewMotionsIsAnError) {
  const AnswerRequests answer = [](const std::vector<MotionRequest>& requests) {
    auto motions = RealMotions(dataset_, requests);
    motions.resize(2);
    return motions;
  };
  const auto outcome = OutcomeOfGenerator(Answering(answer), Draws(1, 90));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::kInconsistent);
}

TEST_F(ToyEvaluation, AMotionOfAnotherSkeletonIsAnErrorThatNamesTheJointsItLacks) {
  auto other = std::make_shared<Skeleton>(*dataset_.skeleton);
  other->joints[2].name = "tail";
  const AnswerRequests answer = [&](const std::vector<MotionRequest>& requests) {
    auto motions = RealMotions(dataset_, requests);
    for (Motion& motion : motions) motion.skeleton = other;
    return motions;
  };
  const auto outcome = OutcomeOfGenerator(Answering(answer), Draws(1, 90));
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().what, HasSubstr(dataset_.skeleton->joints[2].name));
}

TEST_F(ToyEvaluation, PositionsThatAreNotFiniteAreAnErrorThatNamesTheMotion) {
  const AnswerRequests answer = [](const std::vector<MotionRequest>& requests) {
    auto motions = RealMotions(dataset_, requests);
    motions[4].joints.at(3, 2).x() = std::nan("");
    return motions;
  };
  const auto outcome = OutcomeOfGenerator(Answering(answer), Draws(1, 90));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().where, "generated/0/4");
}

TEST_F(ToyEvaluation, RowsThatDifferAreDistinguishedAndEqualOnesAreNot) {
  const FeatureSet real = FeatureSetOf("dataset.h5", FeaturesOptions());
  FeatureSet shifted = real;
  for (float& value : shifted.features) value += 0.2f;
  ScoreOptions options;
  const auto different = CompareRows(options, shifted, real, real);
  ASSERT_TRUE(different);
  EXPECT_LT(different->at("FID_train").at("p").get<double>(), 0.02);
  const auto same = CompareRows(options, real, real, real);
  EXPECT_EQ(same->at("FID_train").at("p"), 1.0);
}

TEST_F(ToyEvaluation, WhatAGeneratorSaysWhenItFailsIsPassedOn) {
  const OpenGenerator closed = [](const GeneratorFiles&, int) -> Expected<AnswerRequests> {
    return Fail(ErrorCode::kNotFound, "no such generator", "shelf");
  };
  const auto outcome = OutcomeOfGenerator(closed, Draws(1, 90));
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace mocurate
