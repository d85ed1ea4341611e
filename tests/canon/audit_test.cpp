// Audit findings of a set with known errors: labels, repeated clips, frozen and exchanged limbs.

#include <gtest/gtest.h>

#include <unistd.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "canon/audit/audit.h"
#include "canon/stages.h"
#include "core/base/file.h"
#include "core/base/random.h"
#include "core/quality/checks.h"
#include "tests/canon/moving_clips.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

/// Four persons who wave an arm of three joints slowly, quickly or not at all, five clips each, with a little noise.
Dataset WavingSet() {
  std::vector<Clip> clips;
  for (int person = 0; person < 4; ++person) {
    for (int label = 0; label < 3; ++label) {
      for (int k = 0; k < 5; ++k) {
        Clip clip = ClipMoving("p" + std::to_string(person), std::string(1, static_cast<char>('a' + label)),
                               40 + 3 * k + person, 5, 30, 0.3);
        Random random(3, "waving", clip.id());
        Motion& motion = *clip.motion;
        const double phase = random.Uniform(0.0, 0.08);
        for (int f = 0; f < motion.frame_count(); ++f) {
          const double t = static_cast<double>(f) / motion.frame_count();
          const double lift = label == 2 ? 0.0 : 0.4 * std::sin(6.28 * ((label == 0 ? 1.0 : 3.0) * t + phase));
          for (int j = motion.joint_count() - 3; j < motion.joint_count(); ++j) motion.joints.at(f, j).y() += lift;
          for (int j = 0; j < motion.joint_count(); ++j) {
            motion.joints.at(f, j) += 0.01 * Vector3d(random.Normal(), random.Normal(), random.Normal());
          }
        }
        clips.push_back(std::move(clip));
      }
    }
  }
  Dataset dataset = SetOf(std::move(clips));
  dataset.labels = {"a", "b", "c"};
  return dataset;
}

std::size_t CountOf(const std::vector<AuditFinding>& findings, const std::string& code, const std::string& clip) {
  return static_cast<std::size_t>(std::count_if(findings.begin(), findings.end(), [&](const AuditFinding& one) {
    return one.finding.code == code && (clip.empty() || one.finding.clip == clip);
  }));
}

TEST(AuditOfLabels, ExchangedLabelsAreFoundWithTheirClassAndOthersAreNot) {
  Dataset dataset = WavingSet();
  const LabelAudit sound = AuditLabels(dataset, LabelNoiseOptions());
  ASSERT_EQ(sound.judged.size(), dataset.clips.size());
  EXPECT_TRUE(
      std::none_of(sound.judged.begin(), sound.judged.end(), [](const JudgedLabel& one) { return one.suspect; }));
  std::map<std::size_t, std::string> truth;
  for (const std::size_t row : {std::size_t{2}, std::size_t{31}, std::size_t{50}}) {
    truth[row] = dataset.clips[row].label;
    dataset.clips[row].label = truth[row] == "c" ? "a" : "c";
  }
  const LabelAudit audit = AuditLabels(dataset, LabelNoiseOptions());
  for (std::size_t i = 0; i < audit.judged.size(); ++i) {
    const auto planted = truth.find(static_cast<std::size_t>(audit.rows[i]));
    EXPECT_EQ(audit.judged[i].suspect, planted != truth.end()) << dataset.clips[i].id();
    if (planted == truth.end()) continue;
    EXPECT_EQ(dataset.labels[static_cast<std::size_t>(audit.judged[i].suggested)], planted->second);
    EXPECT_LT(audit.judged[i].margin, -0.3);
  }
}

TEST(AuditOfLabels, FoldsKeepPersonsTogetherAndWhatCannotBeComparedIsNot) {
  const Dataset dataset = WavingSet();
  std::vector<int> rows;
  for (int i = 0; i < static_cast<int>(dataset.clips.size()); ++i) rows.push_back(i);
  std::map<std::string, std::set<int>> folds;
  const std::vector<int> fold = FoldsByPerson(dataset, rows);
  for (const int row : rows) {
    folds[dataset.clips[static_cast<std::size_t>(row)].identity.person].insert(fold[static_cast<std::size_t>(row)]);
  }
  for (const auto& [person, own] : folds) EXPECT_EQ(own.size(), 1u) << person;
  EXPECT_EQ(std::set<int>(fold.begin(), fold.end()).size(), 4u);
  Dataset one_class = dataset;
  for (Clip& clip : one_class.clips) clip.label = "a";
  EXPECT_TRUE(AuditLabels(one_class, LabelNoiseOptions()).rows.empty());
  Dataset alone = dataset;  // of one person the clips themselves are folded
  for (Clip& clip : alone.clips) clip.identity.person = "p";
  const std::vector<int> of_clips = FoldsByPerson(alone, rows);
  EXPECT_EQ(std::set<int>(of_clips.begin(), of_clips.end()).size(), 5u);
  EXPECT_EQ(AuditLabels(alone, LabelNoiseOptions()).rows.size(), alone.clips.size());
  LabelNoiseOptions few;  // learning from drawn clips alone judges all
  few.most_clips = 20;
  const LabelAudit drawn = AuditLabels(dataset, few), all = AuditLabels(dataset, LabelNoiseOptions());
  ASSERT_EQ(drawn.judged.size(), dataset.clips.size());
  EXPECT_NE(drawn.judged[0].margin, all.judged[0].margin);
  Dataset own_class = dataset;  // of one person alone: no other fold has it
  own_class.labels.push_back("d");
  for (Clip& clip : own_class.clips) {
    if (clip.identity.person == "p1" && clip.label == "c") clip.label = "d";
  }
  const LabelAudit unchecked = AuditLabels(own_class, LabelNoiseOptions());
  EXPECT_EQ(unchecked.unchecked, std::vector<std::string>{"d"});
  for (std::size_t i = 0; i < unchecked.judged.size(); ++i) {
    EXPECT_FALSE(unchecked.judged[i].suspect) << own_class.clips[i].id();
    EXPECT_NE(unchecked.judged[i].suggested, 3);
  }
}

TEST(AuditOfLabels, ProbabilitiesOfAnotherClassifierCountByClip) {
  const Dataset dataset = WavingSet();
  FeatureSet features;
  features.classes = {"c", "a", "b"};  // in an order of its own
  for (std::size_t row = 0; row < dataset.clips.size(); ++row) {
    const std::string predicted = row == 7 ? (dataset.clips[row].label == "a" ? "b" : "a") : dataset.clips[row].label;
    for (const std::string& name : features.classes) features.logits.push_back(name == predicted ? 4.0f : 0.0f);
    features.clip.push_back(dataset.clips[row].id());
    features.label.push_back(0);
  }
  const auto audit = AuditLabelsBy(features, dataset, LabelNoiseOptions());
  ASSERT_TRUE(audit) << audit.error().Message();
  for (std::size_t i = 0; i < audit->judged.size(); ++i) EXPECT_EQ(audit->judged[i].suspect, i == 7);
  for (std::string& clip : features.clip) clip = "other/" + clip;
  EXPECT_EQ(AuditLabelsBy(features, dataset, LabelNoiseOptions()).error().code, ErrorCode::kInconsistent);
}

TEST(AuditOfClips, FrozenAndExchangedLimbsAreFoundWhereTheyAre) {
  Dataset dataset = WavingSet();
  EXPECT_TRUE(FindClipErrors(dataset).empty());
  Motion& frozen = *dataset.clips[4].motion;
  for (int f = 12; f < 20; ++f) {
    for (int j = 0; j < frozen.joint_count(); ++j) frozen.joints.at(f, j) = Vector3d(frozen.joints.at(11, j));
  }
  Motion& swapped = *dataset.clips[40].motion;
  std::vector<std::string> names;
  for (const Joint& joint : swapped.skeleton->joints) names.push_back(joint.name);
  for (int f = 15; f < 25; ++f) {
    for (const auto& [left, right] : FindLimbPairs(names).legs) {
      const Vector3d kept = swapped.joints.at(f, left);
      swapped.joints.at(f, left) = Vector3d(swapped.joints.at(f, right));
      swapped.joints.at(f, right) = kept;
    }
  }
  const std::vector<AuditFinding> findings = FindClipErrors(dataset);
  EXPECT_EQ(findings.size(), 2u);
  EXPECT_EQ(CountOf(findings, "frozen_frames", dataset.clips[4].id()), 1u);
  EXPECT_EQ(CountOf(findings, "swapped_sides", dataset.clips[40].id()), 1u);
  for (const AuditFinding& one : findings) {
    EXPECT_LE(std::abs(one.finding.frame_begin - (one.finding.code == "frozen_frames" ? 12 : 15)), 1);
  }
}

TEST(AuditOfClips, AClipUnderAnotherPersonsNameLeaksAcrossTheSplit) {
  Dataset dataset = WavingSet();
  EXPECT_TRUE(FindRepeatedClips(dataset).empty());
  Clip copy = dataset.clips[3];
  copy.identity.person = "p9";
  for (double& value : copy.motion->joints.xyz) value += 1e-4;
  dataset.clips.push_back(copy);
  Split split;
  split.name = "persons";
  for (int row = static_cast<int>(dataset.clips.size()) - 2; row >= 0; --row) split.train.push_back(row);  // any order
  split.test = {static_cast<int>(dataset.clips.size()) - 1};
  std::vector<AuditFinding> findings = FindRepeatedClips(dataset);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].finding.code, "duplicate");
  dataset.splits = {split};
  findings = FindRepeatedClips(dataset);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].finding.code, "leak");
  EXPECT_EQ(findings[0].finding.severity, Severity::kError);
  EXPECT_EQ(findings[0].suggested, copy.id());
}

TEST(AuditOfClips, ClipsOfOneSourceFileLeakThoughTheirMotionsDiffer) {
  Dataset dataset = WavingSet();
  const std::size_t rows[] = {3, 20, 21, 40};  // of three people
  for (const std::size_t row : rows) {
    Clip& clip = dataset.clips[row];
    clip.evidence_sha256 = std::string(64, 'a');
    clip.identity.begin_frame = 0;
    clip.identity.end_frame = 40;
    clip.provenance["file"] = std::to_string(row) + ".txt";
  }
  Split split;
  split.name = "s";
  split.train = {3, 20};
  split.test = {21, 40};
  dataset.splits = {split};
  const std::vector<AuditFinding> findings = FindRepeatedClips(dataset);
  EXPECT_EQ(CountOf(findings, "leak", ""), 3u) << "with the first of each part: 3 and 21, 3 and 40, 20 and 21";
  EXPECT_EQ(CountOf(findings, "duplicate", ""), 1u) << "3 and 20";
  for (const AuditFinding& one : findings) {
    EXPECT_EQ(one.parts.size(), one.finding.code == "leak" ? 1u : 0u);
    for (const SplitParts& in : one.parts) EXPECT_EQ(in.part + in.other, "traintest");
  }
  for (const std::size_t row : rows) dataset.clips[row].provenance["file"] = "0.txt";
  EXPECT_TRUE(FindRepeatedClips(dataset).empty()) << "several people of one file";
}

TEST(AuditOfClips, AClipThatMovesUnlikeItsClassIsTheFirstOutlier) {
  Dataset dataset = WavingSet();
  OutlierOptions options;
  EXPECT_TRUE(FindOutliers(dataset, MeasureClips(dataset), options).empty());
  Motion& shaken = *dataset.clips[7].motion;
  Random random(2, "shaken", "");
  for (double& value : shaken.joints.xyz) value += 0.1 * random.Normal();
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    Motion& motion = *dataset.clips[i].motion;
    motion.state.assign(motion.joints.xyz.size() / 3, i == 20 ? JointState::kInferred : JointState::kObserved);
  }
  const auto findings = FindOutliers(dataset, MeasureClips(dataset), options);
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(CountOf(findings, "outlier", dataset.clips[7].id()), 1u);
  EXPECT_EQ(CountOf(findings, "outlier", dataset.clips[20].id()), 1u);
  EXPECT_EQ(findings[0].finding.severity, Severity::kInfo);
  options.deviations = 1e4;
  EXPECT_TRUE(FindOutliers(dataset, MeasureClips(dataset), options).empty());
}

TEST(AuditOfSets, ClassesThatAreTestedAndNotTrainedAndNamesThatDifferInCaseAreReported) {
  Dataset dataset = WavingSet();
  EXPECT_TRUE(FindSetErrors(dataset).empty());
  Split split;
  split.name = "s";
  split.rule = "by performance";
  for (int row = 0; row < static_cast<int>(dataset.clips.size()); ++row) {
    const bool c = dataset.clips[static_cast<std::size_t>(row)].label == "c";
    (c ? split.test : split.train).push_back(row);
  }
  dataset.splits = {split};
  dataset.clips[0].identity.person = "P0";
  const auto findings = FindSetErrors(dataset);
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[0].finding.code, "class_not_trained");
  EXPECT_EQ(findings[1].finding.code, "names_alike");
  Split& persons = dataset.splits[0];
  persons.rule = "by person; test: p3";
  const auto shared = FindSetErrors(dataset);
  EXPECT_EQ(CountOf(shared, "split_leak", ""), 4u) << "P0 has a clip of one class only";
}

TEST(AuditMap, ClipsOfAClassAreNearAndPlacesAreThoseOfTheExactComponents) {
  Dataset dataset = WavingSet();
  const ClipMap map = MapClips(dataset, 4);
  ASSERT_EQ(map.rows.size(), dataset.clips.size());
  int alike = 0;
  Eigen::MatrixXd columns(LabelDescriptor(*dataset.clips[0].motion).size(), static_cast<Eigen::Index>(map.rows.size()));
  for (std::size_t i = 0; i < map.rows.size(); ++i) {
    ASSERT_EQ(map.nearest[i].size(), 4u);
    for (const int near : map.nearest[i]) {
      EXPECT_NE(near, map.rows[i]);
      alike += dataset.clips[static_cast<std::size_t>(near)].label == dataset.clips[i].label ? 1 : 0;
    }
    columns.col(static_cast<Eigen::Index>(i)) = LabelDescriptor(*dataset.clips[i].motion).cast<double>();
  }
  EXPECT_GT(alike, 0.9 * 4.0 * static_cast<double>(map.rows.size()));
  columns.colwise() -= columns.rowwise().mean().eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> exact(columns.transpose() * columns);
  for (int k = 0; k < 2; ++k) {
    const Eigen::Index last = exact.eigenvalues().size() - 1 - k;
    const Eigen::VectorXd own = exact.eigenvectors().col(last) * std::sqrt(exact.eigenvalues()[last]);
    Eigen::VectorXd found(own.size());
    for (Eigen::Index i = 0; i < own.size(); ++i) found[i] = map.places[static_cast<std::size_t>(i)][k];
    EXPECT_LT(std::min((found - own).norm(), (found + own).norm()), 1e-3 * own.norm()) << k;
  }
  Clip copy = dataset.clips[7];
  copy.identity.person = "p9";
  dataset.clips.push_back(copy);
  EXPECT_EQ(MapClips(dataset, 1).nearest.back(), std::vector<int>{7});
}

TEST(AuditMap, WhatCannotBePlacedIsLeftOut) {
  Dataset dataset = WavingSet();
  dataset.clips.resize(2);
  EXPECT_TRUE(MapClips(dataset, 4).rows.empty());
  dataset.clips.resize(4, dataset.clips.front());  // three are alike
  dataset.clips[1].motion->joints.at(1, 1).x() = std::nan("");
  const ClipMap map = MapClips(dataset, 4);
  EXPECT_EQ(map.rows, (std::vector<int>{0, 2, 3}));
  for (const Eigen::Vector2f& place : map.places) EXPECT_LT(place.norm(), 1e-3F);
  for (const std::vector<int>& nearest : map.nearest) EXPECT_EQ(nearest.size(), 2u);
}

TEST(AuditStage, ErrorsStandFirstAndEveryFindingHasItsFields) {
  Dataset dataset = WavingSet();
  const std::string wrong = dataset.clips[2].id();
  dataset.clips[2].label = "c";
  Clip copy = dataset.clips[3];
  copy.identity.person = "p9";
  dataset.clips.push_back(copy);
  Split split;
  split.name = "persons";
  split.rule = "by person";
  split.leak_check = "ok";
  for (int row = 0; row + 1 < static_cast<int>(dataset.clips.size()); ++row) split.train.push_back(row);
  split.test = {static_cast<int>(dataset.clips.size()) - 1};
  dataset.splits = {split};
  const ScratchFolder folder;
  ASSERT_TRUE(WriteDataset(dataset, folder / "set.h5"));
  StageRequest request;
  request.stage = request.item = "audit";
  request.options = OptionsToJson(AuditOptions());
  request.inputs = {{"dataset", "set.h5", folder / "set.h5", ""}};
  request.output = folder / "audit.json";
  const auto outcome = AuditStage(request);
  ASSERT_TRUE(outcome) << outcome.error().Message();
  const nlohmann::json audit = nlohmann::json::parse(*ReadFile(request.output));
  ASSERT_GE(audit.at("findings").size(), 2u);
  EXPECT_EQ(audit.at("findings")[0].at("code"), "leak");
  EXPECT_EQ(audit.at("findings")[0].at("severity"), "error");
  bool label = false;
  for (const nlohmann::json& finding : audit.at("findings")) {
    for (const char* key : {"suggested", "safe_to_drop", "parts"}) EXPECT_TRUE(finding.contains(key)) << key;
    EXPECT_EQ(finding.get<Finding>().code, finding.at("code")) << "the fields of every finding";
    label = label || (finding.at("code") == "label_suspect" && finding.at("clip") == wrong);
  }
  EXPECT_TRUE(label);
  for (const nlohmann::json& line : audit.at("clips")) {
    EXPECT_TRUE(line.at("map_x").is_number());
    EXPECT_EQ(line.at("nearest").size(), 4u);
  }
  EXPECT_EQ(audit.at("summary").at("labels").at("checked"), dataset.clips.size());
  dataset.axes = *AxisConvention::Parse("+x -z +y");
  ASSERT_TRUE(WriteDataset(dataset, folder / "set.h5"));
  EXPECT_EQ(AuditStage(request).error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace mocurate
