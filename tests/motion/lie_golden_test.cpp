// Parity with the released Action2Motion kinematics (goldens/lie_kinematics.h5).

#include "tests/motion/builders.h"
#include "tests/motion/lie_inverse.h"
#include "tests/support/golden.h"

namespace mocurate {
namespace {

struct Case {
  const char* group;
  const char* skeleton;
};

class LieGolden : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("MOCURATE_GOLDENS");
    if (folder == nullptr) GTEST_SKIP() << "MOCURATE_GOLDENS is not set";
    file_ = std::make_unique<golden::File>(std::string(folder) + "/lie_kinematics.h5");
    skeleton_ = test::Built(GetParam().skeleton);
    group_ = GetParam().group;
  }

  int count() const { return skeleton_->joint_count(); }
  golden::Array<double> Get(const std::string& name) const { return file_->Doubles(group_ + "/" + name); }

  /// Bone length per joint from raw offsets times lengths, (rows, J, 3).
  std::vector<double> Bones(const golden::Array<double>& offsets, std::size_t row) const {
    std::vector<double> bones;
    for (int j = 0; j < count(); ++j) bones.push_back(Eigen::Map<const Vector3d>(offsets.row(row) + 3 * j).norm());
    return bones;
  }

  double ForwardError(const std::string& type, const std::string& lie, const std::string& result, bool root_rotation,
                      bool scaled) const {
    const auto w = Get(type + "/" + lie), root = Get(type + "/root"), offsets = Get(type + "/offsets_from_joints");
    const auto expected = Get(type + "/" + result);
    double worst = 0.0;
    for (std::size_t row = 0; row < w.rows(); ++row) {
      std::vector<double> parameters(w.row(row), w.row(row) + 3 * count());
      const Vector3d turn(parameters[0], parameters[1], parameters[2]);
      std::copy_n(root.row(row), 3, parameters.begin());
      std::vector<double> bones = Bones(offsets, row);
      if (scaled) {
        for (const int j : skeleton_->lie->chains[0]) bones[j] *= 1.25;
      }
      std::vector<Vector3d> joints(count());
      LieForward(*skeleton_, parameters.data(), bones, LieExp::kReleased, joints.data(),
                 root_rotation ? &turn : nullptr);
      worst = std::max(worst, Worst(joints, expected.row(row)));
    }
    return worst;
  }

  static double Worst(const std::vector<Vector3d>& joints, const double* expected) {
    double worst = 0.0;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      worst = std::max(worst, (joints[j] - Eigen::Map<const Vector3d>(expected + 3 * j)).norm());
    }
    return worst;
  }

  std::unique_ptr<golden::File> file_;
  SkeletonPtr skeleton_;
  std::string group_;
};

TEST_P(LieGolden, ChainsParentsAndRawOffsetsAreTheReleasedOnes) {
  const auto flat = file_->Integers(group_ + "/chains_flat"), lengths = file_->Integers(group_ + "/chains_len");
  std::vector<std::vector<int>> chains;
  std::size_t at = 0;
  for (const std::int64_t length : lengths.values) {
    chains.emplace_back(flat.values.begin() + at, flat.values.begin() + at + length);
    at += static_cast<std::size_t>(length);
  }
  EXPECT_EQ(skeleton_->lie->chains, chains);
  const auto parents = file_->Integers(group_ + "/parents");
  EXPECT_EQ(skeleton_->LieParents(), std::vector<int>(parents.values.begin(), parents.values.end()));
  const auto raw = Get("raw_offsets");
  EXPECT_EQ(Worst(skeleton_->lie->raw_offsets, raw.values.data()), 0.0);
}

TEST_P(LieGolden, ForwardKinematicsAgreesInDouble) {
  EXPECT_LT(ForwardError("f64", "lie_random", "fk_root_rotation0", false, false), 1e-12);
  EXPECT_LT(ForwardError("f64", "lie_random", "fk_root_rotation1", true, false), 1e-12);
  EXPECT_LT(ForwardError("f64", "lie_random", "fk_scaled_chain0", false, true), 1e-12);
  EXPECT_LT(ForwardError("f64", "small_lie", "fk_small", false, false), 1e-12);
}

TEST_P(LieGolden, ForwardKinematicsAgreesWithSinglePrecisionToItsRounding) {
  EXPECT_LT(ForwardError("f32", "lie_random", "fk_root_rotation0", false, false), 5e-6);
  EXPECT_LT(ForwardError("f32", "lie_random", "fk_root_rotation1", true, false), 5e-6);
  EXPECT_LT(ForwardError("f32", "lie_random", "fk_scaled_chain0", false, true), 5e-6);
}

/// Largest difference of IK parameters, without the root slot (the golden stores the root elsewhere).
double InverseError(const Skeleton& skeleton, const golden::Array<double>& joints,
                    const golden::Array<double>& expected) {
  double worst = 0.0;
  const int count = skeleton.joint_count();
  for (std::size_t row = 0; row < joints.rows(); ++row) {
    std::vector<Vector3d> points;
    for (int j = 0; j < count; ++j) points.push_back(Eigen::Map<const Vector3d>(joints.row(row) + 3 * j));
    std::vector<double> parameters(3 * count);
    LieInverse(skeleton, points.data(), parameters.data());
    for (int k = 3; k < 3 * count; ++k) worst = std::max(worst, std::abs(parameters[k] - expected.row(row)[k]));
  }
  return worst;
}

TEST_P(LieGolden, InverseKinematicsAgrees) {
  EXPECT_LT(InverseError(*skeleton_, Get("f64/real_joints"), Get("f64/ik_real")), 1e-12);
  EXPECT_LT(InverseError(*skeleton_, Get("f64/fk_small"), Get("f64/ik_of_fk_small")), 1e-12);
}

TEST_P(LieGolden, ForwardOfInverseGivesTheJointsBack) {
  const auto joints = Get("f64/real_joints");
  for (std::size_t row = 0; row < joints.rows(); ++row) {
    std::vector<Vector3d> points, again(count());
    for (int j = 0; j < count(); ++j) points.push_back(Eigen::Map<const Vector3d>(joints.row(row) + 3 * j));
    std::vector<double> parameters(3 * count());
    LieInverse(*skeleton_, points.data(), parameters.data());
    LieForward(*skeleton_, parameters.data(), BoneLengths(*skeleton_, points.data()), LieExp::kReleased, again.data());
    EXPECT_LT(Worst(again, joints.row(row)), 1e-7) << "the floor of the released exp costs up to 1.5e-8 per bone";
    LieForward(*skeleton_, parameters.data(), BoneLengths(*skeleton_, points.data()), LieExp::kExact, again.data());
    EXPECT_LT(Worst(again, joints.row(row)), 1e-12);
  }
}

TEST_P(LieGolden, WhereTheReleasedInverseIsNotANumberOursIsZero) {
  const auto rest = Get("f64/rest_pose"), released = Get("f64/ik_rest_pose");
  EXPECT_TRUE(std::any_of(released.values.begin(), released.values.end(), [](double v) { return std::isnan(v); }));
  for (std::size_t row = 0; row < rest.rows(); ++row) {
    std::vector<Vector3d> points;
    for (int j = 0; j < count(); ++j) points.push_back(Eigen::Map<const Vector3d>(rest.row(row) + 3 * j));
    std::vector<double> parameters(3 * count());
    LieInverse(*skeleton_, points.data(), parameters.data());
    for (int k = 3; k < 3 * count(); ++k) EXPECT_NEAR(parameters[k], 0.0, 1e-7);
  }
}

INSTANTIATE_TEST_SUITE_P(Released, LieGolden,
                         testing::Values(Case{"humanact12", "humanact12"}, Case{"ntu", "ntu18"},
                                         Case{"mocap", "cmu20"}),
                         [](const auto& case_info) { return std::string(case_info.param.group); });

}  // namespace
}  // namespace mocurate
