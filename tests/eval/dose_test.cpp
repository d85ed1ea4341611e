// Damages: each applies exactly its dose, and the table lists the doses that a metric responds to.

#include "eval/dose/damages.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/base/file.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "core/store/store.h"
#include "eval/dose/dose_table.h"
#include "tests/support/scratch_folder.h"
#include "tests/train/toy_dataset.h"

namespace mocurate {
namespace {

constexpr DamagedValues kOfJoints = DamagedValues::kJoints, kOfRotations = DamagedValues::kRotations;

std::vector<int> RowsToDamage(const Dataset& dataset) {
  std::vector<int> rows(dataset.clips.size());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

Dataset DamagedToy(const Dataset& dataset, Damage damage, double dose, DamagedValues values = kOfJoints,
                   std::uint64_t seed = 1) {
  const Status can = CheckDamage(dataset.clips, damage, values);
  EXPECT_TRUE(can) << can.error().Message();
  return DamagedDataset(dataset, RowsToDamage(dataset), damage, dose, values, seed);
}

bool SameMotion(const Motion& a, const Motion& b) {
  return a.joints.xyz == b.joints.xyz && a.root_translation == b.root_translation &&
         std::equal(a.rotation.begin(), a.rotation.end(), b.rotation.begin(), b.rotation.end(),
                    [](const Quaterniond& p, const Quaterniond& q) { return p.coeffs() == q.coeffs(); });
}

/// How many clips differ in their motions.
int MotionsChanged(const Dataset& a, const Dataset& b) {
  int changed = 0;
  for (std::size_t i = 0; i < a.clips.size(); ++i) changed += !SameMotion(*a.clips[i].motion, *b.clips[i].motion);
  return changed;
}

/// Root mean square over all axes, joints, frames and clips, metres.
double RmsPerAxis(const Dataset& a, const Dataset& b) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.clips.size(); ++i) {
    const std::vector<double>&x = a.clips[i].motion->joints.xyz, &y = b.clips[i].motion->joints.xyz;
    for (std::size_t k = 0; k < x.size(); ++k) sum += (x[k] - y[k]) * (x[k] - y[k]);
    count += x.size();
  }
  return std::sqrt(sum / static_cast<double>(count));
}

std::string BytesOf(const Dataset& dataset) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "dose.h5";
  const Status written = WriteDataset(dataset, file);
  EXPECT_TRUE(written) << written.error().Message();
  return ReadFile(file).value_or("");
}

double LengthOfBone(const Motion& motion, int frame, int joint) {
  const int parent = motion.skeleton->joints[static_cast<std::size_t>(joint)].parent;
  return (motion.joints.at(frame, joint) - motion.joints.at(frame, parent)).norm();
}

TEST(Dose, NoneChangesNoByteAndTheSameSeedGivesTheSameBytesForEveryDamage) {
  for (const bool turning : {false, true}) {
    Dataset dataset = turning ? TurningDataset(2) : ToyDataset(2);
    dataset.splits.clear();
    const DamagedValues values = turning ? kOfRotations : kOfJoints;
    const std::string before = BytesOf(dataset);
    for (const DamageInfo& info : Damages()) {
      if (turning && info.damage == Damage::kBoneDrift) continue;
      EXPECT_EQ(BytesOf(DamagedToy(dataset, info.damage, info.none, values)), before) << info.name;
      const double dose = info.doses.back();
      const std::string damaged = BytesOf(DamagedToy(dataset, info.damage, dose, values));
      EXPECT_NE(damaged, before) << info.name;
      EXPECT_EQ(BytesOf(DamagedToy(dataset, info.damage, dose, values)), damaged) << info.name;
    }
    EXPECT_NE(BytesOf(DamagedToy(dataset, Damage::kJitter, 5.0, values, 2)),
              BytesOf(DamagedToy(dataset, Damage::kJitter, 5.0, values, 1)));
  }
}

TEST(Dose, JitterMovesJointsByItsMillimetresWhetherJointsOrRotationsAreRead) {
  const Dataset joints = ToyDataset(4), turning = TurningDataset(4);
  for (const double dose : {1.0, 5.0, 20.0}) {
    EXPECT_NEAR(RmsPerAxis(joints, DamagedToy(joints, Damage::kJitter, dose)), 1e-3 * dose, 0.02e-3 * dose);
    const Dataset noisy = DamagedToy(turning, Damage::kJitter, dose, kOfRotations);
    EXPECT_NEAR(RmsPerAxis(turning, noisy), 1e-3 * dose, 0.02e-3 * dose);
    for (const Clip& clip : noisy.clips) EXPECT_TRUE(clip.motion->Check());
    EXPECT_TRUE(DamagedToy(turning, Damage::kJitter, dose, kOfJoints).joints_only);
  }
  const Motion& one = *joints.clips[0].motion;
  const Motion small = AddJitter(one, 1.0, kOfJoints, 1, "clip"), large = AddJitter(one, 20.0, kOfJoints, 1, "clip");
  for (std::size_t k = 0; k < one.joints.xyz.size(); ++k) {
    EXPECT_NEAR(large.joints.xyz[k] - one.joints.xyz[k], 20.0 * (small.joints.xyz[k] - one.joints.xyz[k]), 1e-9)
        << "a larger dose is more of the same noise";
  }
}

TEST(Dose, MotionsOfPeopleWithBonesOfTheirOwnAreWrittenAsJointsOfTheSharedSkeleton) {
  Dataset dataset = TurningDataset(1);
  dataset.splits.clear();
  for (Clip& clip : dataset.clips) {
    Skeleton own = *dataset.skeleton;
    own.joints[4].rest_offset = Vector3d(0.1, -0.4, 0.0);
    clip.motion->rotation_reference = dataset.skeleton;
    clip.motion->skeleton = std::make_shared<Skeleton>(own);
    ComputeJoints(*clip.motion);
  }
  for (const Damage damage : {Damage::kJitter, Damage::kBoneDrift, Damage::kScale, Damage::kMirrored}) {
    EXPECT_FALSE(BytesOf(DamagedToy(dataset, damage, InfoOf(damage).doses.front())).empty()) << InfoOf(damage).name;
  }
}

TEST(Dose, SlidingIsAConstantHorizontalSpeedOfTheWholeBody) {
  const Dataset dataset = TurningDataset(2), sliding = DamagedToy(dataset, Damage::kSliding, 100.0);
  std::vector<double> directions;
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const Motion &before = *dataset.clips[i].motion, &after = *sliding.clips[i].motion;
    const int last = before.frame_count() - 1;
    for (int j = 0; j < before.joint_count(); ++j) {
      const Vector3d way = after.joints.at(last, j) - before.joints.at(last, j);
      EXPECT_NEAR(way.norm() / before.rate.FrameTime(last), 0.1, 1e-9);
      EXPECT_NEAR(way.y(), 0.0, 1e-12);
      if (j == 0) directions.push_back(std::atan2(way.z(), way.x()));
    }
    EXPECT_TRUE(after.Check());
  }
  std::sort(directions.begin(), directions.end());
  EXPECT_GT(directions.back() - directions.front(), 1.0) << "each motion has a direction of its own";
}

TEST(Dose, SharesAreOfExactlySoManyMotionsAndLargerOnesHoldTheSmaller) {
  const Dataset dataset = TurningDataset(5);  // 60 clips
  for (const Damage damage : {Damage::kFrozen, Damage::kMirrored}) {
    EXPECT_EQ(MotionsChanged(dataset, DamagedToy(dataset, damage, 0.1)), 6);
    EXPECT_EQ(MotionsChanged(dataset, DamagedToy(dataset, damage, 1.0)), 60);
  }
  const Dataset frozen = DamagedToy(dataset, Damage::kFrozen, 1.0);
  for (std::size_t i = 0; i < frozen.clips.size(); ++i) {
    const Motion& motion = *frozen.clips[i].motion;
    for (int f = 0; f < motion.frame_count(); ++f) {
      EXPECT_EQ(motion.joints.at(f, 2), dataset.clips[i].motion->joints.at(0, 2));
    }
    EXPECT_TRUE(motion.Check());
  }
  const Dataset mirrored = DamagedToy(dataset, Damage::kMirrored, 1.0);
  EXPECT_LT(RmsPerAxis(dataset, DamagedToy(mirrored, Damage::kMirrored, 1.0)), 1e-12) << "twice is the identity";
  std::vector<std::string> items;
  for (const Clip& clip : dataset.clips) items.push_back(clip.id());
  const std::vector<bool> few = DamagedShare(items, 0.1, Damage::kFrozen, 1),
                          many = DamagedShare(items, 0.5, Damage::kFrozen, 1);
  for (std::size_t i = 0; i < items.size(); ++i) EXPECT_TRUE(!few[i] || many[i]);
  EXPECT_NE(few, DamagedShare(items, 0.1, Damage::kMirrored, 1));
}

TEST(Dose, SwappedLabelsAreOfAnotherClassAndMotionsStay) {
  Dataset dataset = ToyDataset(5);
  const Dataset swapped = DamagedToy(dataset, Damage::kSwappedLabels, 0.25);
  int changed = 0;
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    changed += dataset.clips[i].label != swapped.clips[i].label;
    EXPECT_GE(dataset.LabelIndex(swapped.clips[i].label), 0);
  }
  EXPECT_EQ(changed, 15);
  EXPECT_EQ(MotionsChanged(dataset, swapped), 0);
  for (Clip& clip : dataset.clips) clip.label.clear();
  const Status unlabelled = CheckDamage(dataset.clips, Damage::kSwappedLabels, kOfJoints);
  ASSERT_FALSE(unlabelled);
  EXPECT_EQ(unlabelled.error().code, ErrorCode::kInconsistent);
}

TEST(Dose, TruncatedAndFasterMotionsAreShorterAndTheirSegmentsFit) {
  const Dataset dataset = SampleDataset(2);
  const Dataset cut = DamagedToy(dataset, Damage::kTruncated, 0.5), fast = DamagedToy(dataset, Damage::kRate, 2.0),
                slow = DamagedToy(dataset, Damage::kRate, 0.5);
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const Motion& before = *dataset.clips[i].motion;
    const int frames = before.frame_count();
    const Motion &half = *cut.clips[i].motion, &twice = *fast.clips[i].motion, &long_one = *slow.clips[i].motion;
    EXPECT_EQ(half.frame_count(), frames - std::lround(0.5 * frames));
    EXPECT_EQ(half.joints.at(half.frame_count() - 1, 2), before.joints.at(half.frame_count() - 1, 2));
    ASSERT_EQ(twice.frame_count(), (frames - 1) / 2 + 1);
    ASSERT_EQ(long_one.frame_count(), 2 * frames - 1);
    for (int f = 0; f < twice.frame_count(); ++f) {
      EXPECT_LT((twice.joints.at(f, 2) - before.joints.at(2 * f, 2)).norm(), 1e-9);
    }
    EXPECT_TRUE(twice.rate == before.rate && fast.clips[i].rate == dataset.clips[i].rate);
    EXPECT_EQ(cut.clips[i].id(), dataset.clips[i].id());
    for (const Dataset* damaged : {&cut, &fast}) {
      for (const Segment& segment : damaged->clips[i].segments) {
        EXPECT_LE(segment.end_s, damaged->clips[i].motion->duration() + 1e-9);
      }
    }
    EXPECT_NEAR(fast.clips[i].segments[0].end_s, 0.5 * dataset.clips[i].segments[0].end_s, 1e-12);
  }
}

TEST(Dose, BodiesGrowByTheirPercentEachSecondOrByTheirFactor) {
  const Dataset dataset = TurningDataset(1);
  const Motion& before = *dataset.clips[0].motion;
  const Motion drifting = DriftBones(before, 5.0), larger = Scaled(before, 1.25);
  const int last = before.frame_count() - 1;
  for (int j = 1; j < before.joint_count(); ++j) {
    const double length = LengthOfBone(before, last, j);
    EXPECT_NEAR(LengthOfBone(drifting, 0, j), length, 1e-9);
    EXPECT_NEAR(LengthOfBone(drifting, last, j), length * (1.0 + 0.05 * before.rate.FrameTime(last)), 1e-9);
    EXPECT_NEAR(LengthOfBone(larger, last, j), 1.25 * length, 1e-9);
  }
  EXPECT_TRUE(drifting.joints_only());
  EXPECT_TRUE(larger.Check());
  EXPECT_EQ(larger.joints.at(0, 0), before.joints.at(0, 0));
  const Status refused = CheckDamage(dataset.clips, Damage::kBoneDrift, kOfRotations);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
}

TEST(Dose, YawTurnsTheWholeMotionToEitherSideAboutWhereItBegins) {
  const Dataset dataset = TurningDataset(4), turned = DamagedToy(dataset, Damage::kYaw, 45.0);
  int left = 0;
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const Motion &before = *dataset.clips[i].motion, &after = *turned.clips[i].motion;
    EXPECT_LT((after.joints.at(0, 0) - before.joints.at(0, 0)).norm(), 1e-12);
    const Quaterniond turn = after.rotation_at(3, 0) * before.rotation_at(3, 0).conjugate();
    EXPECT_NEAR(2.0 * std::acos(std::min(1.0, std::abs(turn.w()))), 0.25 * 3.14159265358979, 1e-6);
    EXPECT_NEAR(turn.vec().normalized().cwiseAbs().y(), 1.0, 1e-9);
    left += turn.y() * turn.w() > 0.0;
    EXPECT_TRUE(after.Check());
  }
  EXPECT_GT(left, 10);
  EXPECT_LT(left, 38) << "of 48";
}

TEST(Dose, DosesAreReadOrRefused) {
  const auto all = ParseDoses({});
  ASSERT_TRUE(all);
  EXPECT_EQ(all->size(), static_cast<std::size_t>(kDamageCount));
  const auto read = ParseDoses({"jitter_mm=20,1,0,5", "rate_factor"});
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_EQ((*read)[0].doses, (std::vector<double>{1, 5, 20})) << "0 is scored in any case";
  EXPECT_EQ((*read)[1].doses, InfoOf(Damage::kRate).doses);
  for (const char* bad : {"jiter_mm=5", "frozen_share=1.5", "jitter_mm=-1", "jitter_mm=", "jitter_mm=5mm",
                          "rate_factor=0", "jitter_mm=nan"}) {
    const auto refused = ParseDoses({bad});
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().code, ErrorCode::kUsage) << bad;
  }
  EXPECT_FALSE(ParseDoses({"yaw_deg=5", "yaw_deg=15"}));
}

nlohmann::json RowOf(const std::string& name, double accuracy, double low, double high, double diversity) {
  return {{"name", name},
          {"metrics",
           {{"accuracy", {{"value", accuracy}, {"interval", {low, high}}}},
            {"diversity", {{"value", diversity}, {"interval", nullptr}}},
            {"FID_test", {{"value", nullptr}, {"interval", nullptr}}}}}};
}

TEST(Dose, AMetricAnswersWhereIntervalsAreDisjointElseBeyondATenthAndTheNoiseOfRealMotions) {
  const nlohmann::json rows = {RowOf("Real", 0.9, 0.85, 0.95, 12.0), RowOf(kUndamaged, 0.9, 0.85, 0.95, 10.0),
                               RowOf("rate_factor=0.5", 0.7, 0.65, 0.75, 11.5),
                               RowOf("rate_factor=2", 0.84, 0.8, 0.86, 13.0)};
  const nlohmann::json table = DoseTable(rows, {{Damage::kRate, {0.5, 2.0, 4.0}}});  // the row of 4 failed
  const nlohmann::json expected = {{"accuracy", {0.5}}, {"diversity", {2.0}}};
  EXPECT_EQ(table["answers_from"]["rate_factor"], expected);
  ASSERT_EQ(table["values"].size(), 6u);
  const nlohmann::json& slow = table["values"][2];
  EXPECT_EQ(slow["dose"], 0.5);
  EXPECT_EQ(slow["metric"], "accuracy");
  EXPECT_NEAR(slow["ratio"], 0.7 / 0.9, 1e-12);
  EXPECT_NEAR(slow["shift"], -4.0, 1e-9);
  const std::string csv = DoseCsv(table), markdown = DoseMarkdown(table, "t");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7) << "a header, three rows of two metrics";
  EXPECT_NE(csv.find("\nrate_factor,times,1,diversity,10,,,,,0\n"), std::string::npos);
  EXPECT_NE(markdown.find("\n| rate_factor | 0.5 | 2 |\n"), std::string::npos);
  EXPECT_NE(markdown.find("\n| 2 | 0.84 | 13 * |\n"), std::string::npos);
}

}  // namespace
}  // namespace mocurate
