#include "fitting/repair/track_repairs.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "fitting/fit_outcome.h"
#include "fitting/repair/bone_violations.h"
#include "fitting/repair/exchanges.h"
#include "tests/fitting/takes.h"
#include "tests/fitting/track_problems.h"

namespace mocurate {
namespace {

constexpr double kNoise = 0.01;

PlayedTake TurningTake(int frames, std::uint64_t seed = 5, double turn_speed = 0.4) {
  PlayedTake take = SmoothTake(frames, Quaterniond::Identity(), 30.0, turn_speed);
  AddNoise(take.tracks, kNoise, seed);
  return take;
}

/// The tracker exchanges left and right.
void Exchange(SkeletonTracks& tracks, const std::vector<int>& left_joints, int begin, int end) {
  for (int f = begin; f < end; ++f) {
    for (const int left : left_joints) {
      const int right = tracks.skeleton->joints[left].mirror;
      const Vector3d place = tracks.positions.at(f, left);
      tracks.positions.at(f, left) = Vector3d(tracks.positions.at(f, right));
      tracks.positions.at(f, right) = place;
      std::swap(tracks.confidence[static_cast<std::size_t>(f) * tracks.joints() + left],
                tracks.confidence[static_cast<std::size_t>(f) * tracks.joints() + right]);
    }
  }
}

FitResult FitRepaired(const PlayedTake& take, const RepairOptions& repair = {}) {
  auto fit = RepairAndFit(take.tracks, take.truth.rate, take.truth.bone_length, repair, {});
  EXPECT_TRUE(fit.has_value()) << fit.error().Message();
  return std::move(*fit);
}

std::vector<Finding> OfCode(const FitResult& fit, const std::string& code) {
  std::vector<Finding> found;
  for (const Finding& finding : fit.findings) {
    if (finding.code == code) found.push_back(finding);
  }
  return found;
}

struct Exchanged {
  const char* what;
  std::vector<int> left;  ///< of TestSkeleton
  std::size_t findings;   ///< one for arms, one for legs
};

class ExchangedLimbs : public testing::TestWithParam<Exchanged> {};

INSTANTIATE_TEST_SUITE_P(Repair, ExchangedLimbs,
                         testing::Values(Exchanged{"forearms", {4, 5}, 1}, Exchanged{"arms", {3, 4, 5}, 1},
                                         Exchanged{"legs", {9, 10}, 1}, Exchanged{"body", {3, 4, 5, 9, 10}, 2}),
                         [](const auto& limbs) { return std::string(limbs.param.what); });

TEST_P(ExchangedLimbs, AreExchangedBackAndReported) {
  for (const int frames : {1, 2, 7, 20}) {
    PlayedTake take = TurningTake(90);
    const double undisturbed = RmsError(FitRepaired(take).motion.joints, take.truth.joints);
    Exchange(take.tracks, GetParam().left, 40, 40 + frames);
    const SkeletonTracks given = take.tracks;
    const FitResult fit = FitRepaired(take);
    EXPECT_LT(RmsError(fit.motion.joints, take.truth.joints), 1.02 * undisturbed) << frames << " frames";
    EXPECT_EQ(take.tracks.positions.xyz, given.positions.xyz);  // evidence stays
    const std::vector<Finding> findings = OfCode(fit, "swapped_sides");
    ASSERT_EQ(findings.size(), GetParam().findings) << frames << " frames";
    for (const Finding& finding : findings) {
      EXPECT_EQ(finding.frame_begin, 40);
      EXPECT_EQ(finding.frame_end, 40 + frames);
      EXPECT_GT(finding.value, RepairOptions{}.swap_margin);
      EXPECT_EQ(finding.action, FindingAction::kRepaired);
    }
    for (int f = 0; f < 90; ++f) {
      for (int j = 0; j < take.tracks.joints(); ++j) {
        const int mirror = take.tracks.skeleton->joints[j].mirror;
        const auto& left = GetParam().left;
        const bool listed = std::find(left.begin(), left.end(), std::min(j, mirror)) != left.end();
        const bool listed_frame = f >= 40 && f < 40 + frames && listed;
        EXPECT_EQ(StateAt(fit.motion, f, j), listed_frame ? JointState::kRepaired : JointState::kObserved)
            << f << " " << j;
      }
    }
  }
}

/// Of two labellings that alternate, the rarer one is the exchange, wherever in the clip it lies.
TEST_P(ExchangedLimbs, AreExchangedBackAtBothEndsOfAShortClip) {
  for (const int frames : {20, 40, 75}) {
    for (const auto& [begin, end] : {std::pair{0, 1}, {0, 3}, {frames - 1, frames}, {frames - 3, frames}}) {
      PlayedTake take = TurningTake(frames);
      const SkeletonTracks sound = take.tracks;
      Exchange(take.tracks, GetParam().left, begin, end);
      const RepairedTracks repaired = RepairTracks(take.tracks, take.truth.bone_length, kNoise, {});
      EXPECT_EQ(repaired.tracks.positions.xyz, sound.positions.xyz) << begin << " of " << frames;
    }
  }
}

TEST(Repair, ListsExchangesSoThatTheyCanBeUndone) {
  PlayedTake take = TurningTake(60);
  const SkeletonTracks before = take.tracks;
  Exchange(take.tracks, {4, 5}, 30, 34);
  const nlohmann::json list = nlohmann::json::parse(FitRepaired(take).track_repairs);
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0]["code"], "swapped_sides");
  EXPECT_EQ(list[0]["joints"], (nlohmann::json{"left_elbow", "left_wrist"}));
  // The listed exchanges, applied again to the repaired tracks, restore the evidence.
  RepairedTracks repaired = RepairTracks(take.tracks, take.truth.bone_length, kNoise, {});
  EXPECT_EQ(repaired.tracks.positions.xyz, before.positions.xyz);
  for (const TrackRepair& repair : repaired.repairs)
    Exchange(repaired.tracks, repair.joints, repair.frame_begin, repair.frame_end);
  EXPECT_EQ(repaired.tracks.positions.xyz, take.tracks.positions.xyz);
}

TEST(Repair, ExchangesNothingInCorrectTracks) {
  for (const double turn_speed : {0.4, 6.0, 12.0}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const PlayedTake take = TurningTake(150, seed, turn_speed);
      EXPECT_TRUE(FindExchanges(take.tracks, take.truth.bone_length, kNoise, 10.0).empty())
          << "turn " << turn_speed << " seed " << seed;
    }
  }
}

/// Only one shoulder is observed, before and after the forearms are exchanged; it must not count as the other.
TEST(Repair, KeepsAJointWithAMissingPartnerInItsPlace) {
  for (const int hidden : {3, 6}) {
    PlayedTake take = TurningTake(90);
    for (int f = 34; f < 52; ++f) Hide(take.tracks, f, hidden);
    const SkeletonTracks sound = take.tracks;
    Exchange(take.tracks, {4, 5}, 44, 45);
    EXPECT_EQ(RepairTracks(take.tracks, take.truth.bone_length, kNoise, {}).tracks.positions.xyz, sound.positions.xyz);
  }
}

TEST(Repair, ExchangesAJointWithAMissingPartnerOnTheOtherSide) {
  for (const int hidden : {3, 6}) {
    PlayedTake take = TurningTake(90);
    for (int f = 41; f < 44; ++f) Hide(take.tracks, f, hidden);
    const SkeletonTracks sound = take.tracks;
    Exchange(take.tracks, {3, 4, 5}, 41, 44);
    const SkeletonTracks repaired = RepairTracks(take.tracks, take.truth.bone_length, kNoise, {}).tracks;
    EXPECT_EQ(repaired.positions.xyz, sound.positions.xyz);
    EXPECT_EQ(repaired.confidence, sound.confidence);
  }
}

TEST(Repair, LongErrorsOfATrackerAreNotAnExchange) {
  PlayedTake take = TurningTake(120);
  for (int f = 0; f < 120; ++f) {  // as knees of a sitting person: each nearer to the other side's hip
    take.tracks.positions.at(f, 10) = Vector3d(take.tracks.positions.at(f, 11)) + Vector3d(0.05, -0.8, 0.0);
    take.tracks.positions.at(f, 12) = Vector3d(take.tracks.positions.at(f, 9)) + Vector3d(-0.05, -0.8, 0.0);
  }
  EXPECT_TRUE(FindExchanges(take.tracks, take.truth.bone_length, kNoise, 10.0).empty());
}

TEST(Repair, KeepsUnclearExchanges) {
  PlayedTake take = TurningTake(60);
  Exchange(take.tracks, {4, 5}, 30, 34);
  const auto clear = FindExchanges(take.tracks, take.truth.bone_length, kNoise, 10.0);
  ASSERT_EQ(clear.size(), 1u);
  EXPECT_TRUE(FindExchanges(take.tracks, take.truth.bone_length, kNoise, clear[0].margin + 1.0).empty());
  RepairOptions off;
  off.swaps = off.bone_violations = false;
  EXPECT_TRUE(FitRepaired(take, off).track_repairs.empty());
}

TEST(Repair, MarksRepeatedValuesAsMissing) {
  PlayedTake take = TurningTake(90);
  const int wrist = 5;
  for (int f = 41; f < 56; ++f) take.tracks.positions.at(f, wrist) = Vector3d(take.tracks.positions.at(40, wrist));
  const FitResult fit = FitRepaired(take);
  const auto findings = OfCode(fit, "repeated_value");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].joint, "left_wrist");
  EXPECT_EQ(StateAt(fit.motion, 40, wrist), JointState::kObserved);
  EXPECT_EQ(StateAt(fit.motion, 48, wrist), JointState::kInterpolated);
  RepairOptions off;
  off.repeated_values = false;
  const auto error = [&](const FitResult& result) {
    return (result.motion.joints.at(50, wrist) - take.truth.joints.at(50, wrist)).norm();
  };
  EXPECT_LT(error(fit), 0.6 * error(FitRepaired(take, off)));
}

TEST(Repair, MarksAPositionJumpAsMissing) {
  PlayedTake take = TurningTake(90);
  for (int f = 40; f < 50; ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) take.tracks.positions.at(f, j) += Vector3d(3.0, 0.0, -2.0);
  }
  const FitResult fit = FitRepaired(take);
  ASSERT_EQ(OfCode(fit, "position_jump").size(), 1u);
  EXPECT_EQ(OfCode(fit, "position_jump")[0].frame_begin, 40);
  EXPECT_EQ(OfCode(fit, "position_jump")[0].frame_end, 50);
  EXPECT_EQ(StateAt(fit.motion, 45, 0), JointState::kInterpolated);
  EXPECT_LT((fit.motion.joints.at(45, 0) - take.truth.joints.at(45, 0)).norm(), 0.05);
}

/// 0.5 m in 1/30 s. If the person returns, it is a position jump; if not, it is reported, as either side may be right.
TEST(Repair, ReportsAJumpOfTheBodyThatIsNotRecovered) {
  PlayedTake take = TurningTake(90);
  const auto move = [&](int begin, int end) {
    for (int f = begin; f < end; ++f) {
      for (int j = 0; j < take.tracks.joints(); ++j) take.tracks.positions.at(f, j) += Vector3d(0.4, 0.0, -0.3);
    }
  };
  move(40, 44);
  const FitResult back = FitRepaired(take);
  ASSERT_EQ(OfCode(back, "position_jump").size(), 1u);
  EXPECT_EQ(StateAt(back.motion, 42, 0), JointState::kInterpolated);
  move(44, 90);
  const FitResult stays = FitRepaired(take);
  EXPECT_TRUE(OfCode(stays, "position_jump").empty());
  ASSERT_EQ(OfCode(stays, "unrecovered_jump").size(), 1u);
  EXPECT_EQ(OfCode(stays, "unrecovered_jump")[0].frame_begin, 39);
  EXPECT_EQ(OfCode(stays, "unrecovered_jump")[0].action, FindingAction::kFlagged);
  EXPECT_EQ(StateAt(stays.motion, 42, 0), JointState::kObserved);
}

/// A hand 0.58 m off for a third of a second: forearms have constant length, and hands do not jump.
TEST(Repair, MarksAMisplacedHandAsMissing) {
  const int wrist = *TestSkeleton()->FindJoint("left_wrist");
  const double undisturbed = RmsError(FitRepaired(TurningTake(90)).motion.joints, TurningTake(90).truth.joints);
  for (const Vector3d& direction : {Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, -1, 0),
                                    Vector3d(0, 0, 1), Vector3d(0, 0, -1)}) {
    PlayedTake take = TurningTake(90);
    for (int f = 40; f < 50; ++f) take.tracks.positions.at(f, wrist) += 0.58 * direction;
    const FitResult fit = FitRepaired(take);
    EXPECT_LT(RmsError(fit.motion.joints, take.truth.joints), 1.3 * undisturbed) << direction.transpose();
    const std::vector<Finding> findings = OfCode(fit, "bone_length_violation");
    ASSERT_EQ(findings.size(), 1u) << direction.transpose();
    EXPECT_EQ(findings[0].joint, "left_wrist");
    EXPECT_EQ(findings[0].frame_begin, 40);
    EXPECT_EQ(findings[0].frame_end, 50);
    EXPECT_EQ(findings[0].action, FindingAction::kMissing);
    for (int f = 0; f < 90; ++f)
      EXPECT_EQ(StateAt(fit.motion, f, wrist) == JointState::kObserved, f < 40 || f >= 50) << f;
  }
  EXPECT_TRUE(OfCode(FitRepaired(TurningTake(90)), "bone_length_violation").empty());
}

/// The set omits frames before its last six: the person continues elsewhere.
TEST(Repair, FindsNoViolationInAPersonWhoMovesAtTheEndOfTheClip) {
  PlayedTake take = TurningTake(90);
  for (int f = 84; f < 90; ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) take.tracks.positions.at(f, j) += Vector3d(0.6, 0.0, 0.1);
  }
  EXPECT_TRUE(DetectBoneViolations(take.tracks, take.truth.bone_length, kNoise, 1.0).empty());
}

/// At an end of the clip only one side of the violation exists.
TEST(Repair, MarksAMisplacedHandAtAnEndOfTheClipAsMissing) {
  const int wrist = *TestSkeleton()->FindJoint("left_wrist");
  for (const Vector3d& direction : {Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(0, 0, 1)}) {
    for (const int begin : {0, 82}) {
      PlayedTake take = TurningTake(90);
      for (int f = begin; f < begin + 8; ++f) take.tracks.positions.at(f, wrist) += 0.45 * direction;
      const std::vector<Finding> findings = OfCode(FitRepaired(take), "bone_length_violation");
      ASSERT_EQ(findings.size(), 1u) << direction.transpose() << " from " << begin;
      EXPECT_EQ(findings[0].joint, "left_wrist");
      EXPECT_EQ(findings[0].frame_begin, begin);
      EXPECT_EQ(findings[0].frame_end, begin + 8);
    }
  }
}

/// A wrist beside the forearm keeps nearly its distance from the elbow, but is far from its hand.
TEST(Repair, AttributesAViolationToTheJointNotToItsChildren) {
  auto body = std::make_shared<Skeleton>(*TestSkeleton());
  for (const int wrist : {5, 8}) {
    Joint hand = body->joints[static_cast<std::size_t>(wrist)];
    hand.name = wrist == 5 ? "left_hand" : "right_hand";
    hand.parent = wrist;
    hand.rest_offset = Vector3d(wrist == 5 ? 0.1 : -0.1, 0.0, 0.0);
    hand.mirror = wrist == 5 ? 15 : 14;
    body->joints.push_back(hand);
  }
  PlayedTake take = SmoothTake(90, Quaterniond::Identity(), 30.0, 0.4, body);
  AddNoise(take.tracks, kNoise, 5);
  for (int f = 40; f < 50; ++f) {
    const Vector3d forearm = take.truth.joints.at(f, 5) - take.truth.joints.at(f, 4);
    take.tracks.positions.at(f, 5) += 0.28 * forearm.unitOrthogonal();
  }
  const std::vector<Finding> findings = OfCode(FitRepaired(take), "bone_length_violation");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].joint, "left_wrist");
  EXPECT_NEAR(findings[0].frame_begin, 40, 1);
  EXPECT_NEAR(findings[0].frame_end, 50, 1);
}

/// A violated bone has two joints; the misplaced one violates the lengths of its other bones too.
TEST(Repair, AttributesAViolationToTheJointNotToItsNeighbours) {
  PlayedTake take = TurningTake(90);
  const int elbow = *TestSkeleton()->FindJoint("left_elbow");
  for (int f = 40; f < 50; ++f) take.tracks.positions.at(f, elbow) += Vector3d(0.3, 0.5, 0.6);
  const std::vector<Finding> findings = OfCode(FitRepaired(take), "bone_length_violation");
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].joint, "left_elbow");
}

TEST(Repair, KeepsLongStillness) {
  PlayedTake take = TurningTake(90);
  for (int f = 1; f < 70; ++f) take.tracks.positions.at(f, 5) = Vector3d(take.tracks.positions.at(0, 5));
  EXPECT_TRUE(OfCode(FitRepaired(take), "repeated_value").empty());  // most of the joint's samples
}

TEST(Repair, StatesDependOnTheLengthOfTheGap) {
  PlayedTake take = TurningTake(120);
  for (int f = 20; f < 100; ++f) Hide(take.tracks, f, 5);
  for (int f = 20; f < 30; ++f) Hide(take.tracks, f, 6);
  const FitResult fit = FitRepaired(take);
  EXPECT_EQ(StateAt(fit.motion, 19, 5), JointState::kObserved);
  for (const int f : {20, 60, 99}) EXPECT_EQ(StateAt(fit.motion, f, 5), JointState::kInferred) << f;  // 2.7 s
  EXPECT_EQ(StateAt(fit.motion, 25, 6), JointState::kInterpolated);
}

}  // namespace
}  // namespace mocurate
