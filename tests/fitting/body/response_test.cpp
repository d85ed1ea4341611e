#include "fitting/uncertainty/body_response.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/base/random.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/solver/solve.h"

namespace mocurate {
namespace {

constexpr double kSigma = 1e-4;  ///< m, small enough for the first order

/// A bent body in one frame, seen by joints (all but a hand) or by points on its surface, and by faint rotations.
class Response : public testing::Test {
 protected:
  Response() : skeleton_(*LoadSkeleton("smpl24")), body_(CapsuleBody::Make(skeleton_, 1.0)), pose_(StateOf(skeleton_)) {
    Random random(5, "response");
    for (int j = 0; j < pose_.joints(); ++j) {
      if (pose_.active(j))
        Eigen::Map<Vector3d>(pose_.rotation(0, j)) = 0.3 * Vector3d(random.Normal(), random.Normal(), random.Normal());
    }
    pose_.Update(0, 1, true);
    terms_.body = &body_;
    terms_.frames.resize(1);
    terms_.frames[0].priors.assign(static_cast<std::size_t>(pose_.joints()), JointPrior{});
    // Nothing is in conflict, so that Gauss-Newton's equations are exact.
    for (int j = 0; j < pose_.joints(); ++j) terms_.frames[0].rotations.push_back({j, pose_.global(0, j), 1.0});
  }

  /// Of the skeleton in the rest pose.
  PoseState StateOf(const SkeletonPtr& skeleton) const {
    return {*skeleton, 1, skeleton->RestBoneLengths(), body_.MovingJoints()};
  }

  void SeeJoints() {
    for (int j = 0; j < pose_.joints(); ++j)
      terms_.frames[0].points.push_back({j, pose_.position(0, j), 100.0 * Matrix3d::Identity()});
  }

  void SeePoints() {
    Random random(6, "points");
    points_ = Eigen::Matrix3Xd(3, 2000);
    std::vector<CloudMatch> matches;
    for (int i = 0; i < points_.cols(); ++i) {
      const int c = i % static_cast<int>(body_.capsules.size());
      const CapsuleEnds ends = EndsOf(body_.capsules[static_cast<std::size_t>(c)], pose_, 0);
      const Vector3d any = Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
      const Vector3d axis = (ends.end - ends.begin).normalized();
      const Vector3d out = (any - any.dot(axis) * axis).normalized();
      points_.col(i) = ends.begin + (0.1 + 0.8 * random.Uniform()) * (ends.end - ends.begin) +
                       body_.capsules[static_cast<std::size_t>(c)].radius * out;
      matches.push_back({i, c, 0.0});
    }
    terms_.frames[0].surface = {&points_, matches, 100.0, 0.0};
  }

  /// The pose that explains the evidence with this body.
  PoseState Solved(const SkeletonPtr& skeleton) {
    PoseState state = StateOf(skeleton);
    state.SetFrameParameters(0, pose_.FrameParameters(0));
    const auto solution = Solve(terms_, state, {PoseSolver::kBanded, 1e-14, 100, "test", nullptr});
    EXPECT_TRUE(solution) << solution.error().Message();
    return state;
  }

  /// Sums squared moves of joints and turns of rotations for a change of the body.
  struct Squares {
    std::vector<Matrix3d> position, rotation;
  };
  void AddMoves(const PoseState& before, const PoseState& after, Squares& squares) const {
    squares.position.resize(static_cast<std::size_t>(before.joints()), Matrix3d::Zero());
    squares.rotation.resize(squares.position.size(), Matrix3d::Zero());
    for (int j = 0; j < before.joints(); ++j) {
      const Vector3d move = after.position(0, j) - before.position(0, j);
      const Vector3d turn = LogMatrix(before.local(0, j).transpose() * after.local(0, j));
      squares.position[static_cast<std::size_t>(j)] += move * move.transpose();
      squares.rotation[static_cast<std::size_t>(j)] += turn * turn.transpose();
    }
  }

  void ExpectEqual(const Squares& solved, const BodyResponse& response) const {
    ASSERT_TRUE(response.known());
    for (std::size_t j = 0; j < solved.position.size(); ++j) {
      const double least = 1e-4 * kSigma * kSigma;
      EXPECT_NEAR(solved.position[j].trace(), response.position()[j].trace(), 0.05 * solved.position[j].trace() + least)
          << j;
      EXPECT_NEAR(solved.rotation[j].trace(), response.rotation()[j].trace(),
                  0.05 * solved.rotation[j].trace() + 100.0 * least)
          << j;
    }
  }

  SkeletonPtr skeleton_;
  CapsuleBody body_;
  PoseState pose_;
  PoseTerms terms_;
  Eigen::Matrix3Xd points_;
};

TEST_F(Response, ToABoneIsHowTheSolvedPoseMoves) {
  SeeJoints();
  const PoseState fitted = Solved(skeleton_);
  for (const char* name : {"left_knee", "spine2", "right_elbow", "left_hip"}) {
    const int bone = *skeleton_->FindJoint(name);
    BodyDeviations deviations{std::vector<double>(24, 0.0)};
    deviations.bone[static_cast<std::size_t>(bone)] = kSigma;
    Squares squares;
    for (int axis = 0; axis < 3; ++axis) {
      auto changed = std::make_shared<Skeleton>(*skeleton_);
      changed->joints[static_cast<std::size_t>(bone)].rest_offset +=
          fitted.global(0, fitted.parent(bone)).transpose() * (kSigma * Vector3d::Unit(axis));
      AddMoves(fitted, Solved(changed), squares);
    }
    ExpectEqual(squares, BodyResponse(terms_, fitted, 0, deviations));
  }
}

TEST_F(Response, ToCapsulesIsHowTheSolvedPoseMoves) {
  SeePoints();
  const PoseState fitted = Solved(skeleton_);
  const CapsuleBody given = body_;
  Squares ends, radii;
  for (std::size_t c = 0; c < given.capsules.size(); ++c) {
    for (int i = 0; i < 7; ++i) {
      body_ = given;
      BodyCapsule& capsule = body_.capsules[c];
      if (i < 3)
        capsule.begin_offset[i] += kSigma;
      else if (i < 6)
        capsule.end_offset[i - 3] += kSigma;
      else
        capsule.radius += kSigma;
      AddMoves(fitted, Solved(skeleton_), i < 6 ? ends : radii);
    }
  }
  body_ = given;
  ExpectEqual(ends, BodyResponse(terms_, fitted, 0, {std::vector<double>(24, 0.0), kSigma, 0.0}));
  ExpectEqual(radii, BodyResponse(terms_, fitted, 0, {std::vector<double>(24, 0.0), 0.0, kSigma}));
}

}  // namespace
}  // namespace mocurate
