// Every term by itself: its rows against numeric differences, against an independent residual by automatic
// differentiation, and in the equations of both solvers.
#include <nlohmann/json.hpp>

#include "fitting/options.h"
#include "tests/fitting/term_cases.h"
#include "tests/fitting/term_rows.h"

namespace mocurate {
namespace {

class EveryTerm : public testing::TestWithParam<Regime> {};

INSTANTIATE_TEST_SUITE_P(Regimes, EveryTerm,
                         testing::Values(Regime::kRandom, Regime::kIdentity, Regime::kTiny, Regime::kNearPi));

TEST_P(EveryTerm, HasTheDerivativesOfItsResidualAndTheSameEquationsInBothSolvers) {
  TermProblem problem(GetParam());
  PoseState& state = problem.state();
  const std::vector<TermCase> cases = problem.Cases();
  EXPECT_EQ(cases.size(), 32u);
  for (const TermCase& one : cases) {
    SCOPED_TRACE(one.name);
    const PoseTerms terms = problem.TermsOf(one);
    ExpectDerivatives(terms, state, 1e-4, 1e-7);
    ExpectSameEquations(terms, state);
    if (!one.residual) continue;
    const DenseRows rows(terms, state);
    const Eigen::VectorXd here = rows.columns.Read(terms, state);
    ASSERT_EQ(rows.columns.size(), kOfFrame);
    Unknowns unknowns;
    for (int i = 0; i < here.size(); ++i) unknowns[static_cast<std::size_t>(i)] = Jet(here[i], i);
    const Residual residual = one.residual(unknowns);
    ASSERT_EQ(residual.size(), rows.r.size());
    const double scale = std::max(1.0, rows.Jacobian().cwiseAbs().maxCoeff());
    for (std::size_t k = 0; k < residual.size(); ++k) {
      EXPECT_NEAR(rows.r[k], residual[k].a, 1e-7) << "row " << k;
      EXPECT_LT((rows.j[k] - residual[k].v.head(here.size()).transpose()).cwiseAbs().maxCoeff(), 1e-7 * scale)
          << "row " << k;
    }
  }
}

TEST(Hinges, AllowOneBendingDirectionAndTwist) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const std::vector<std::optional<Hinge>> hinges = HingesOf(*skeleton);
  const auto off = [&](const char* joint, const Vector3d& bend, double twist) {
    const Hinge& hinge = *hinges[static_cast<std::size_t>(*skeleton->FindJoint(joint))];
    return OffHinge(hinge, ExpMatrix(bend) * ExpMatrix(twist * hinge.bone));
  };
  for (const double twist : {-1.5, 0.0, 1.0}) {
    for (const double bend : {0.0, 0.7, 1.5, 2.5}) {
      EXPECT_NEAR(off("left_elbow", {0.0, -bend, 0.0}, twist).norm(), 0.0, 1e-9) << bend;
      EXPECT_NEAR(off("right_elbow", {0.0, bend, 0.0}, twist).norm(), 0.0, 1e-9) << bend;
      EXPECT_LT(off("left_knee", {bend, 0.0, 0.0}, twist).norm(), 0.05) << bend;
      EXPECT_LT(off("right_knee", {bend, 0.0, 0.0}, twist).norm(), 0.05) << bend;
    }
    EXPECT_NEAR(off("left_elbow", {0.0, 0.8, 0.0}, twist)[1], 0.2 - std::sin(0.8), 1e-9) << "bent backwards";
    EXPECT_NEAR(std::abs(off("left_elbow", {0.0, 0.0, 0.6}, twist)[0]), std::sin(0.6), 1e-9) << "to the side";
    EXPECT_LT(off("right_knee", {-0.8, 0.0, 0.0}, twist)[1], -0.4);
  }
}

/// A step without a residual, and nearly half a turn.
TEST_P(EveryTerm, StepsHaveDerivativesWhereTheyAreNothingAndNearHalfATurn) {
  TermProblem problem(GetParam());
  PoseState& state = problem.state();
  for (const TermCase& one : problem.Cases()) {
    if (one.frames < 2) continue;
    for (const Vector3d& turn : {Vector3d(0.0, 0.0, 0.0), Vector3d(3.0, 0.5, -0.3)}) {
      for (int j = 0; j < kJointsOfBent; ++j) {
        if (!kActive[j]) continue;
        Eigen::Map<Vector3d>(state.rotation(1, j)) =
            LogQuaternion(ExpQuaternion(Eigen::Map<const Vector3d>(state.rotation(0, j))) * ExpQuaternion(turn));
      }
      const PoseTerms terms = problem.TermsOf(one);
      ExpectDerivatives(terms, state, 1e-4, 1e-6);
      ExpectSameEquations(terms, state);
    }
  }
}

TEST(RotationSteps, AreIndependentOfTheBranchOfTheLogarithm) {
  const Skeleton skeleton = BentChain();
  PoseState state(skeleton, 2, skeleton.RestBoneLengths(), std::vector<bool>(kJointsOfBent, true));
  const Vector3d axis = Vector3d(1.0, 2.0, -1.0).normalized();
  Eigen::Map<Vector3d>(state.rotation(0, 1)).noalias() = 0.5 * axis;
  Eigen::Map<Vector3d>(state.rotation(1, 1)).noalias() = (0.6 - 2.0 * EIGEN_PI) * axis;
  state.Update(0, 2, true);
  PoseTerms terms;
  terms.frames.resize(2);
  for (int f = 0; f < 2; ++f) {
    terms.frames[static_cast<std::size_t>(f)].frame = f;
    terms.frames[static_cast<std::size_t>(f)].priors.resize(kJointsOfBent);
  }
  terms.frames[0].next = {std::vector<double>(kJointsOfBent, 1.0), std::vector<double>(kJointsOfBent, 0.0)};
  EXPECT_NEAR(Cost(terms, state), 0.5 * 0.1 * 0.1, 1e-12);
}

TEST(FittingOptions, RefuseTheOldPlaceOfTheSolverWithTheNewOne) {
  for (const char* group : {"joint_tracks", "point_clouds"}) {
    const auto refused = OptionsFromJson<FittingOptions>({{group, {{"solver", "banded"}}}}, "fitting");
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().Message().find("fitting.solver"), std::string::npos);
  }
  const auto read = OptionsFromJson<FittingOptions>({{"solver", "banded"}}, "fitting");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->joint_tracks.solver, PoseSolver::kBanded);
  EXPECT_EQ(read->point_clouds.solver, PoseSolver::kBanded);
}

/// What people do without evidence, by plan: a Kinect's tracks need other limits than depth.
TEST(PriorValues, OfThePlans) {
  const PriorValues tracks = FittingOptions().joint_tracks.priors, clouds = FittingOptions().point_clouds.priors;
  const auto values = [](const PriorValues& of) {
    return std::vector<double>{of.rest,           of.limit,          of.hinge,
                               of.rotation_noise, of.position_noise, of.all_joints ? 1.0 : 0.0};
  };
  EXPECT_EQ(values(tracks), (std::vector<double>{1.0, 0.5, 0.25, 0.55, 0.33, 1.0}));
  EXPECT_EQ(values(clouds), (std::vector<double>{1.0, 0.1, 0.0, 0.55, 0.33, 0.0}));
}

}  // namespace
}  // namespace mocurate
