#include "core/quality/handedness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace mocurate {
namespace {

const std::vector<std::string>& Names() {
  static const std::vector<std::string> names = {
      "head",     "left_hip",  "right_hip",     "left_knee",      "right_knee", "left_ankle", "right_ankle",
      "left_toe", "right_toe", "left_shoulder", "right_shoulder", "left_wrist", "right_wrist"};
  return names;
}

BodyLandmarks Points() {
  return FindHandednessPoints([](std::string_view name) -> std::optional<int> {
    for (std::size_t i = 0; i < Names().size(); ++i) {
      if (Names()[i] == name) return static_cast<int>(i);
    }
    return std::nullopt;
  });
}

/// A person in the canonical world: y up, facing +z, the left side at +x. `knee` and `wrist` point forward by this
/// much.
JointPositions Person(double knee, double wrist, double toe = 0.15) {
  const std::vector<Vector3d> joints = {{0, 1.6, 0},       {0.1, 0.9, 0}, {-0.1, 0.9, 0}, {0.1, 0.5, knee},
                                        {-0.1, 0.5, knee}, {0.1, 0.1, 0}, {-0.1, 0.1, 0}, {0.1, 0.02, toe},
                                        {-0.1, 0.02, toe}, {0.2, 1.4, 0}, {-0.2, 1.4, 0}, {0.3, 1.1, wrist},
                                        {-0.3, 1.1, wrist}};
  JointPositions positions(10, static_cast<int>(joints.size()));
  for (int f = 0; f < positions.frames; ++f) {
    for (int j = 0; j < positions.joints; ++j) positions.at(f, j) = joints[j];
  }
  return positions;
}

JointPositions Applied(const Matrix3d& matrix, JointPositions positions) {
  for (int f = 0; f < positions.frames; ++f) {
    for (int j = 0; j < positions.joints; ++j) positions.at(f, j) = (matrix * positions.at(f, j)).eval();
  }
  return positions;
}

/// As a depth tracker sees it: lengths change from frame to frame.
JointPositions DepthTracked(JointPositions positions) {
  for (int f = 1; f < positions.frames; f += 2) {
    for (int j = 0; j < positions.joints; ++j) positions.at(f, j) *= 1.02;
  }
  return positions;
}

JointPositions Longer(const JointPositions& positions, int times) {
  JointPositions longer(positions.frames * times, positions.joints);
  for (int f = 0; f < longer.frames; ++f) {
    for (int j = 0; j < positions.joints; ++j) longer.at(f, j) = positions.at(f % positions.frames, j);
  }
  return longer;
}

/// The score of a part of the body; 0 where it does not vote. Negative: as in a right-handed frame.
double ScoreOf(const HandednessMeasure& measure, const std::string& part) {
  for (const HandednessCue& cue : measure.cues) {
    if (cue.name == part) return cue.score;
  }
  return 0.0;
}

TEST(Handedness, APersonInTheCanonicalWorldIsRightHanded) {
  const HandednessMeasure measure = MeasureHandedness(Person(0.3, 0.4), Points());
  EXPECT_EQ(measure.handedness, Handedness::kRight);
  EXPECT_EQ(measure.confidence, 1.0);
  EXPECT_EQ(ScoreOf(measure, "knees"), -1.0);
}

TEST(Handedness, AMirroredPersonBendsTheKneesBackwardsInAnyRotatedWorld) {
  for (const Vector3d& turn : {Vector3d(0, 0, 0), Vector3d(0, 2, 0), Vector3d(1.5, 0.3, -2)}) {
    for (const Vector3d& flip : {Vector3d(-1, 1, 1), Vector3d(1, -1, 1), Vector3d(1, 1, -1)}) {
      const Matrix3d matrix = ExpMatrix(turn) * Matrix3d(flip.asDiagonal());
      const HandednessMeasure measure = MeasureHandedness(Applied(matrix, Person(0.3, 0.4)), Points());
      EXPECT_EQ(measure.handedness, Handedness::kLeft);
      for (const char* part : {"knees", "feet", "hands"}) EXPECT_EQ(ScoreOf(measure, part), 1.0) << part;
    }
  }
}

TEST(Handedness, ExchangedNamesOfLeftAndRightLookTheSameAsAMirrorImage) {
  BodyLandmarks points = Points();
  for (int* pair : {points.hip, points.knee, points.ankle, points.toe, points.shoulder, points.wrist}) {
    std::swap(pair[0], pair[1]);
  }
  EXPECT_EQ(MeasureHandedness(Person(0.3, 0.4), points).handedness, Handedness::kLeft);
}

TEST(Handedness, AStiffPersonWithoutToesIsUndetermined) {
  BodyLandmarks points = Points();
  points.toe[0] = points.toe[1] = -1;
  const HandednessMeasure measure = MeasureHandedness(Person(0.02, 0.0), points);
  EXPECT_FALSE(measure.handedness.has_value());
  EXPECT_LT(measure.confidence, 0.4);
  EXPECT_FALSE(MeasureHandedness(Person(0.3, 0.4), BodyLandmarks()).handedness.has_value());
}

TEST(Handedness, StraightLegsBentBackwardsByATrackerAreIgnored) {
  BodyLandmarks points = Points();
  points.toe[0] = points.toe[1] = -1;
  const JointPositions backwards = Person(-0.4 * std::tan(0.45), 0.0);  // knees of 0.9 rad
  EXPECT_EQ(MeasureHandedness(DepthTracked(backwards), points).cues[1].frames, 0);
  EXPECT_EQ(MeasureHandedness(backwards, points).handedness, Handedness::kLeft) << "fixed bones do not bend that way";
}

TEST(Handedness, ContradictingPartsAreUndetermined) {
  BodyLandmarks points = Points();
  points.toe[0] = points.toe[1] = -1;
  const HandednessMeasure measure = MeasureHandedness(Person(0.3, -0.4), points);
  EXPECT_FALSE(measure.handedness.has_value());
  EXPECT_EQ(measure.confidence, 0.0);
  EXPECT_LT(ScoreOf(measure, "knees"), 0.0);
  EXPECT_GT(ScoreOf(measure, "hands"), 0.0);
  EXPECT_FALSE(MeasureHandedness(Person(0.3, 0.4, -0.15), Points()).handedness.has_value());
}

TEST(Handedness, FeetAndKneesThatAgreeOverruleHandsBehindTheBack) {
  EXPECT_EQ(MeasureHandedness(Person(0.3, -0.4), Points()).handedness, Handedness::kRight);
  EXPECT_FALSE(MeasureHandedness(DepthTracked(Person(0.4, -0.4)), Points()).handedness.has_value())
      << "10 tracked frames";
  EXPECT_EQ(MeasureHandedness(Longer(DepthTracked(Person(0.4, -0.4)), 2), Points()).handedness, Handedness::kRight);
}

TEST(Handedness, OnePartAloneDecidesOnlyWhenItIsOverwhelming) {
  BodyLandmarks points = Points();
  points.toe[0] = points.toe[1] = -1;
  const JointPositions sitting = DepthTracked(Person(0.4, 0.0));
  EXPECT_FALSE(MeasureHandedness(sitting, points).handedness.has_value()) << "20 votes of knees";
  JointPositions longer = Longer(sitting, 4);
  EXPECT_EQ(MeasureHandedness(longer, points).handedness, Handedness::kRight);
  const JointPositions upright = DepthTracked(Person(0.0, 0.0));
  for (int f = 20; f < longer.frames; ++f) {
    for (int j = 0; j < longer.joints; ++j) longer.at(f, j) = upright.at(f % upright.frames, j);
  }
  EXPECT_EQ(MeasureHandedness(longer, points).handedness, Handedness::kRight) << "bent in half of the frames";
  for (int f = 10; f < longer.frames; ++f) {
    for (int j = 0; j < longer.joints; ++j) longer.at(f, j) = upright.at(f % upright.frames, j);
  }
  EXPECT_FALSE(MeasureHandedness(longer, points).handedness.has_value()) << "bent in a quarter of the frames";
}

TEST(Handedness, AKneeBentSidewaysIsIgnored) {
  BodyLandmarks points = Points();
  points.toe[0] = points.toe[1] = -1;
  JointPositions aside = Person(0.0, 0.0);
  for (int f = 0; f < aside.frames; ++f) {
    for (int side = 0; side < 2; ++side) aside.at(f, points.knee[side]).x() += 0.5;
  }
  EXPECT_EQ(MeasureHandedness(aside, points).cues[1].frames, 0);
}

TEST(Handedness, MissingJointsAreNotRead) {
  JointPositions mirrored = Applied(Vector3d(-1, 1, 1).asDiagonal(), Person(0.3, 0.4));
  std::vector<double> confidence(static_cast<std::size_t>(mirrored.frames) * mirrored.joints, 0.0);
  EXPECT_FALSE(MeasureHandedness(mirrored, Points(), &confidence).handedness.has_value());
}

}  // namespace
}  // namespace mocurate
