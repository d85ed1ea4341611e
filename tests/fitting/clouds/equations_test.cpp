#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/motion/skeleton.h"
#include "fitting/clouds/capsule_fit.h"
#include "fitting/clouds/cloud_terms.h"
#include "tests/fitting/term_rows.h"

namespace mocurate {
namespace {

/// A body in three frames; points near its surface in the second frame, some of them far off.
class Cloud : public testing::Test {
 protected:
  Cloud()
      : skeleton_(*LoadSkeleton("smpl24")),
        body_(CapsuleBody::Make(skeleton_, 1.0)),
        state_(*skeleton_, 3, skeleton_->RestBoneLengths(), body_.MovingJoints()) {
    Random random(8, "cloud");
    for (int f = 0; f < 3; ++f) {
      Eigen::Map<Vector3d>(state_.translation(f)) = Vector3d(0.1, 0.9, -0.2 + 0.02 * f);
      for (int j = 0; j < state_.joints(); ++j) {
        if (!state_.active(j)) continue;
        Eigen::Map<Vector3d>(state_.rotation(f, j)) = 0.3 * Vector3d(random.Normal(), random.Normal(), random.Normal());
      }
    }
    Eigen::Map<Vector3d>(state_.rotation(1, 4)) = Vector3d(-0.6, 1.0, 0.1);  // beyond the knee's limits
    state_.Update(0, 3, true);
    cloud_ = {Eigen::Matrix3Xd(3, 600), Eigen::Matrix3Xd(3, 600), 0};
    for (int i = 0; i < 600; ++i) {
      const BodyCapsule& capsule = body_.capsules[static_cast<std::size_t>(i) % body_.capsules.size()];
      const CapsuleEnds ends = EndsOf(capsule, state_, 1);
      const Vector3d out = Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
      cloud_.points.col(i) =
          ends.begin + random.Uniform() * (ends.end - ends.begin) + (capsule.radius + 0.02 * random.Normal()) * out;
      cloud_.normals.col(i) = out;
    }
    matches_ = MatchPoints(body_, state_, 1, cloud_, 0.1);
  }

  PoseTerms Terms(const std::vector<FixedNeighbourFrame>& neighbours, const std::vector<PointTerm>& joints = {},
                  const PoseGaussian* pose = nullptr) {
    FrameFit fit;
    fit.frame = 1;
    fit.held = neighbours;
    fit.joints = joints;
    fit.pose = pose;
    PoseTerms terms = CloudTerms(body_, options_);
    terms.frames = {TermsOfFit(body_, cloud_, fit, matches_, kSigma, options_)};
    return terms;
  }

  void ExpectRows(const PoseTerms& terms) {
    ExpectSameEquations(terms, state_);
    ExpectDerivatives(terms, state_, 1e-6, 1e-4);  // a point may pass the end of its axis
  }

  static constexpr double kSigma = 0.01;
  SkeletonPtr skeleton_;
  CapsuleBody body_;
  PoseState state_;
  FusedCloud cloud_;
  std::vector<CloudMatch> matches_;
  PointCloudOptions options_;
};

TEST_F(Cloud, EquationsOfAFrameMatchCeres) { ExpectRows(Terms({})); }

TEST_F(Cloud, EquationsBesideOneFixedFrameMatchCeres) { ExpectRows(Terms({{-1, 1.0 / 30.0}})); }

TEST_F(Cloud, EquationsBetweenTwoFixedFramesMatchCeres) { ExpectRows(Terms({{-1, 1.0 / 30.0}, {1, 0.1}})); }

TEST_F(Cloud, EquationsWithObservedJointsMatchCeres) {
  std::vector<PointTerm> joints;
  for (int j = 0; j < state_.joints(); ++j) {
    Matrix3d whitening = (40.0 + j) * Matrix3d::Identity();
    whitening.row(j % 3) *= j % 2 == 0 ? 0.1 : 0.0;  // little or no precision along rays
    joints.push_back({j, state_.position(1, j) + Vector3d(0.01 * j, 0.02, -0.01), whitening});
  }
  ExpectRows(Terms({{-1, 1.0 / 30.0}}, joints));
}

/// What the fit of tracks knows: the root and the joints `known`, with correlated errors.
PoseGaussian KnownPose(const PoseState& state, int frame, std::vector<int> known, double rest = 0.1) {
  Random random(9, "known_pose");
  PoseGaussian pose;
  pose.joints = std::move(known);
  pose.translation = state.position(frame, 0) + Vector3d(0.01, -0.02, 0.005);
  for (const int j : pose.joints) {
    const Vector3d off = 0.05 * Vector3d(random.Normal(), random.Normal(), random.Normal());
    pose.rotation.push_back(state.local(frame, j) * ExpQuaternion(off).toRotationMatrix());
    pose.rest.push_back(rest);
  }
  const Eigen::Index size = 3 + 3 * static_cast<Eigen::Index>(pose.joints.size());
  pose.whitening = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index r = 0; r < size; ++r) {
    for (Eigen::Index c = 0; c <= r; ++c) pose.whitening(r, c) = r == c ? 30.0 + r : 3.0 * random.Normal();
  }
  return pose;
}

TEST_F(Cloud, EquationsWithAKnownPoseMatchCeres) {
  const PoseGaussian pose = KnownPose(state_, 1, {0, 1, 4, 6, 16, 18});
  ExpectRows(Terms({{-1, 1.0 / 30.0}}, {}, &pose));
}

/// Without points the pose is as certain as the other evidence says: its rest pose and limits are not counted again.
TEST_F(Cloud, WithoutPointsAKnownPoseKeepsItsCovariance) {
  std::vector<int> moving;
  for (int j = 0; j < state_.joints(); ++j) {
    if (state_.active(j)) moving.push_back(j);
  }
  const PoseGaussian pose = KnownPose(state_, 1, moving, 1e6);  // more than the rest pose of depth fits
  matches_.clear();
  const PoseTerms terms = Terms({}, {}, &pose);
  const auto solution = Solve(terms, state_, {PoseSolver::kBanded, 1e-14, 100});
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(solution->final_cost, 1e-9);
  PoseEquations equations(state_);
  BlockTridiagonal banded(1, equations.columns().size());
  equations.Linearise(terms, state_, banded);
  const Eigen::MatrixXd information = banded.Diagonal(0).selfadjointView<Eigen::Upper>();
  Eigen::MatrixXd expected = pose.whitening.transpose() * pose.whitening;
  for (std::size_t k = 0; k < moving.size(); ++k) {
    const Matrix3d& jacobian = state_.right_jacobian(1, moving[k]);
    const auto at = PoseGaussian::At(k);
    expected.middleRows<3>(at) = (jacobian.transpose() * expected.middleRows<3>(at)).eval();
    expected.middleCols<3>(at) = (expected.middleCols<3>(at) * jacobian).eval();
  }
  EXPECT_LT((information - expected).norm(), 1e-6 * expected.norm());
}

TEST_F(Cloud, SomePointsLieInTheLinearPartOfTheLoss) {
  int linear = 0;
  const SurfaceTerm surface = Terms({}).frames.front().surface;
  for (const CloudMatch& match : matches_) {
    const double whitened = surface.weight * match.distance;
    linear += HuberSlope(whitened * whitened, surface.huber) < 1.0 ? 1 : 0;
  }
  EXPECT_GT(linear, 10);
  EXPECT_LT(linear, 400);
}

/// What is minimised between two matchings is what poses are compared by.
TEST_F(Cloud, TheCostFallsFromMatchingToMatching) {
  options_.solver = PoseSolver::kBanded;
  const PoseGaussian pose = KnownPose(state_, 1, {0, 1, 4, 6, 16, 18});
  for (const PoseGaussian* known : {static_cast<const PoseGaussian*>(nullptr), &pose}) {
    PoseState state = state_;
    for (int j = 0; j < state.joints(); ++j) {
      if (state.active(j)) state.rotation(1, j)[j % 3] += 0.15;
    }
    FrameFit fit = ComparedFit(1, 1);
    fit.held = {{-1, 1.0 / 30.0}};
    fit.pose = known;
    state.Update(0, 3, true);
    double before = PoseCost(body_, cloud_, fit, state, options_);
    const double first = before;
    for (int i = 0; i < 12; ++i) {
      ASSERT_TRUE(FitCloudFrame(body_, cloud_, fit, state, options_));
      const double after = PoseCost(body_, cloud_, fit, state, options_);
      EXPECT_LE(after, 1.005 * before) << "matching " << i;  // normals, which are no cost, select matches too
      before = after;
    }
    EXPECT_LT(before, 0.5 * first);
    // All at once: never above the lowest matching.
    fit.iterations = 40;
    ASSERT_TRUE(FitCloudFrame(body_, cloud_, fit, state, options_));
    EXPECT_LE(PoseCost(body_, cloud_, fit, state, options_), 1.001 * before);
  }
}

TEST_F(Cloud, BothSolversLowerTheCostToTheSameVanishingGradient) {
  const PoseTerms terms = Terms({{-1, 1.0}});
  const std::vector<double> start = state_.FrameParameters(1);
  std::vector<double> costs;
  for (const PoseSolver solver : {PoseSolver::kBanded, PoseSolver::kCeres}) {
    state_.SetFrameParameters(1, start);
    const auto solution = Solve(terms, state_, {solver, 1e-14, 100});
    ASSERT_TRUE(solution.has_value());
    EXPECT_LT(solution->final_cost, 0.9 * solution->initial_cost);
    EXPECT_NEAR(Cost(terms, state_), solution->final_cost, 1e-9 * solution->final_cost);
    PoseEquations equations(state_);
    BlockTridiagonal banded(1, equations.columns().size());
    equations.Linearise(terms, state_, banded);
    const Eigen::VectorXd scale = banded.DiagonalEntries().cwiseSqrt();
    EXPECT_LT(banded.GradientEntries().cwiseQuotient(scale).cwiseAbs().maxCoeff(), 1e-2);
    costs.push_back(solution->final_cost);
  }
  EXPECT_NEAR(costs[0], costs[1], 1e-6 * costs[0]);
}

/// Brute force over every point and capsule, without bounding spheres.
TEST_F(Cloud, EveryPointMatchesTheNearestCapsuleThatFacesItsWay) {
  for (const double farthest : {0.02, 0.1, 0.5}) {
    const std::vector<CloudMatch> matches = MatchPoints(body_, state_, 1, cloud_, farthest);
    std::size_t next = 0;
    for (int i = 0; i < cloud_.size(); ++i) {
      int nearest = -1;
      double least = farthest + 0.08;
      for (std::size_t c = 0; c < body_.capsules.size(); ++c) {
        const CapsuleEnds ends = EndsOf(body_.capsules[c], state_, 1);
        const CapsulePoint on = ClosestOnCapsule(ends.begin, ends.end, body_.capsules[c].radius, cloud_.points.col(i));
        const double score = std::abs(on.distance) + 0.04 * (1.0 - on.normal.dot(cloud_.normals.col(i)));
        if (std::abs(on.distance) > farthest || score >= least) continue;
        least = score;
        nearest = static_cast<int>(c);
      }
      if (nearest < 0) continue;
      ASSERT_LT(next, matches.size());
      EXPECT_EQ(matches[next].point, i);
      EXPECT_EQ(matches[next].capsule, nearest);
      ++next;
    }
    EXPECT_EQ(next, matches.size());
  }
}

}  // namespace
}  // namespace mocurate
