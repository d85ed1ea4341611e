#include "fitting/clouds/cloud_smoothing.h"

#include <gtest/gtest.h>

#include <utility>

#include "core/base/random.h"
#include "core/motion/skeleton.h"
#include "fitting/clouds/cloud_terms.h"
#include "fitting/solver/pose_equations.h"
#include "fitting/solver/rest_sigmas.h"

namespace mocurate {
namespace {

constexpr int kFrames = 5;
constexpr double kStep_s = 1.0 / 30.0;

/// A walking body: points on its surface in every frame, but none on the left arm in the middle one.
class Chain : public testing::Test {
 protected:
  Chain()
      : skeleton_(*LoadSkeleton("smpl24")),
        body_(CapsuleBody::Make(skeleton_, 1.0)),
        truth_(*skeleton_, kFrames, skeleton_->RestBoneLengths(), body_.MovingJoints()) {
    Random random(11, "chain");
    options_.solver = PoseSolver::kBanded;
    options_.rules.SwitchOff(FittingRule::kBodyErrors);  // the body is exact
    const int shoulder = *skeleton_->FindJoint("left_shoulder");
    for (int f = 0; f < kFrames; ++f) {
      Eigen::Map<Vector3d>(truth_.translation(f)) = Vector3d(0.1, 0.9, 0.03 * f);
      truth_.rotation(f, shoulder)[2] = -0.8 + 0.02 * f;
    }
    truth_.Update(0, kFrames, true);
    for (int f = 0; f < kFrames; ++f) {
      FusedCloud cloud{Eigen::Matrix3Xd(3, 1200), Eigen::Matrix3Xd(3, 1200), 0};
      Eigen::Index count = 0;
      for (int i = 0; i < 1200; ++i) {
        const BodyCapsule& capsule = body_.capsules[static_cast<std::size_t>(i) % body_.capsules.size()];
        const bool hidden = f == kFrames / 2 && IsBelow(capsule.frame, shoulder);
        const CapsuleEnds ends = EndsOf(capsule, truth_, f);
        const Vector3d any = Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
        const Vector3d axis = (ends.end - ends.begin).normalized();
        const Vector3d out = (any - any.dot(axis) * axis).normalized();
        if (hidden) continue;
        cloud.points.col(count) = ends.begin + random.Uniform() * (ends.end - ends.begin) + capsule.radius * out;
        cloud.normals.col(count++) = out;
      }
      cloud.points.conservativeResize(3, count);
      cloud.normals.conservativeResize(3, count);
      clouds_.push_back(cloud);
      time_s_.push_back(f * kStep_s);
      FrameFit fit;
      fit.frame = f;
      chain_.push_back(fit);
    }
  }

  bool IsBelow(int joint, int top) const {
    for (; joint >= 0; joint = skeleton_->joints[static_cast<std::size_t>(joint)].parent) {
      if (joint == top) return true;
    }
    return false;
  }

  PoseState Start() const {
    PoseState state = truth_;
    Random random(12, "start");
    for (int f = 0; f < kFrames; ++f) {
      for (int j = 0; j < state.joints(); ++j) {
        if (state.active(j))
          Eigen::Map<Vector3d>(state.rotation(f, j)) +=
              0.03 * Vector3d(random.Normal(), random.Normal(), random.Normal());
      }
    }
    state.Update(0, kFrames, true);
    return state;
  }

  /// Twice: points are weighed by how far they are from the first poses.
  std::vector<PosePosterior> Smoothed(PoseState& state) {
    EXPECT_TRUE(SmoothChain(body_, clouds_, chain_, time_s_, options_, state));
    auto smoothed = SmoothChain(body_, clouds_, chain_, time_s_, options_, state);
    EXPECT_TRUE(smoothed) << smoothed.error().Message();
    EXPECT_TRUE(smoothed->settled);
    return smoothed->uncertainty;
  }

  SkeletonPtr skeleton_;
  CapsuleBody body_;
  PoseState truth_;
  std::vector<FusedCloud> clouds_;
  std::vector<double> time_s_;
  std::vector<FrameFit> chain_;
  PointCloudOptions options_;
};

/// A neighbour that is known exactly says most, a neighbour that is estimated less, none least.
TEST_F(Chain, StatesMoreThanAFrameAloneAndLessThanBesideKnownNeighbours) {
  PoseState state = Start();
  const std::vector<PosePosterior> smoothed = Smoothed(state);
  for (int f = 1; f + 1 < kFrames; ++f) {
    FrameFit fit = chain_[static_cast<std::size_t>(f)];
    const double sigma = 0.003;  // that of points on the capsules themselves, the smallest
    const auto alone = UncertaintyOfFrame(body_, clouds_[static_cast<std::size_t>(f)], fit, sigma, {}, state, options_);
    fit.held = {{-1, kStep_s}, {1, kStep_s}};
    const auto beside =
        UncertaintyOfFrame(body_, clouds_[static_cast<std::size_t>(f)], fit, sigma, {}, state, options_);
    ASSERT_TRUE(alone && beside);
    for (std::size_t j = 0; j < alone->position.size(); ++j) {
      const double stated = smoothed[static_cast<std::size_t>(f)].position[j].trace();
      EXPECT_LT(stated, 1.02 * alone->position[j].trace()) << f << " " << j;
      EXPECT_GT(stated, 0.98 * beside->position[j].trace()) << f << " " << j;
    }
  }
}

TEST_F(Chain, NeighboursSayWhereAHiddenArmIs) {
  const auto wrist = static_cast<std::size_t>(*skeleton_->FindJoint("left_wrist"));
  const std::size_t middle = kFrames / 2;
  PoseState state = Start();
  const std::vector<PosePosterior> smoothed = Smoothed(state);
  const double off =
      (state.position(middle, static_cast<int>(wrist)) - truth_.position(middle, static_cast<int>(wrist))).norm();
  EXPECT_LT(off, 0.03);
  const double stated = std::sqrt(smoothed[middle].position[wrist].trace());
  EXPECT_GT(stated, 2.0 * std::sqrt(smoothed[middle - 1].position[wrist].trace()));
  EXPECT_LT(stated, 0.2);
  // Half a second apart nothing couples the frames: the arm may be anywhere.
  for (std::size_t f = 0; f < time_s_.size(); ++f) time_s_[f] = 0.5 * static_cast<double>(f);
  PoseState apart = Start();
  EXPECT_GT(std::sqrt(Smoothed(apart)[middle].position[wrist].trace()), 3.0 * stated);
}

/// An arm without a point in any frame may be anywhere: the rest pose counts once, not once per frame.
TEST_F(Chain, AnArmThatIsNeverSeenIsAsUncertainAsThePrior) {
  const int shoulder = *skeleton_->FindJoint("left_shoulder"), elbow = *skeleton_->FindJoint("left_elbow");
  chain_.clear();
  time_s_.clear();
  const FusedCloud hidden = clouds_[kFrames / 2];
  clouds_.clear();
  PoseState state(*skeleton_, 60, skeleton_->RestBoneLengths(), body_.MovingJoints());
  for (int f = 0; f < state.frames(); ++f) {
    clouds_.push_back(hidden);
    time_s_.push_back(f * kStep_s);
    chain_.emplace_back();
    chain_.back().frame = f;
    state.SetFrameParameters(f, truth_.FrameParameters(kFrames / 2));
  }
  state.Update(0, state.frames(), true);
  const std::vector<PosePosterior> stated = Smoothed(state);
  for (const int f : {0, 30, 59}) {
    for (const int joint : {shoulder, elbow}) {
      const auto j = static_cast<std::size_t>(joint);
      EXPECT_GT(stated[static_cast<std::size_t>(f)].rotation[j].minCoeff(), 0.95 * stated[0].prior[j].x()) << f;
    }
  }
}

/// Process noise between two frames, 1/2 |r|^2, written down anew.
double StepCost(const PoseState& state, int frame, double seconds, const PointCloudOptions& options) {
  double square = (state.position(frame + 1, 0) - state.position(frame, 0)).squaredNorm() /
                  (options.priors.position_noise * options.priors.position_noise);
  for (int j = 0; j < state.joints(); ++j) {
    if (!state.active(j)) continue;
    const Eigen::AngleAxisd between(state.local(frame, j).transpose() * state.local(frame + 1, j));
    square += between.angle() * between.angle() / (options.priors.rotation_noise * options.priors.rotation_noise);
  }
  return 0.5 * square / seconds;
}

/// Two frames: gradient and information of process noise by differences, those of the frames by PoseEquations.
TEST_F(Chain, OfTwoFramesIsTheMinimumAndTheInverseOfDenseEquations) {
  chain_.resize(2);
  options_.priors.rotation_noise = 0.1;
  PoseState state = Start();
  for (int i = 0; i < 3; ++i) (void)SmoothChain(body_, clouds_, chain_, time_s_, options_, state);
  std::vector<double> sigma;
  for (int f = 0; f < 2; ++f) {
    std::vector<double> distances;
    for (const CloudMatch& match : MatchPoints(body_, state, f, clouds_[f], options_.max_distance))
      distances.push_back(match.distance);
    sigma.push_back(RobustSigma(distances));
  }
  const std::vector<PosePosterior> stated = Smoothed(state);

  PoseEquations equations(state);
  std::vector<PoseTerms> terms;
  for (int f = 0; f < 2; ++f) {
    terms.push_back(CloudTerms(body_, options_));
    terms.back().frames = {TermsOfFit(body_, clouds_[f], chain_[f],
                                      MatchPoints(body_, state, f, clouds_[f], options_.max_distance), sigma[f],
                                      options_)};
    for (JointPrior& prior : terms.back().frames[0].priors)  // the rest pose counts once
      prior.rest *=
          kRestAtAnEnd + RestShareOfStep(prior.rest, 1.0 / (Square(options_.priors.rotation_noise) * kStep_s));
  }
  const PoseColumns& columns = equations.columns();
  const Eigen::Index n = columns.size();
  Eigen::VectorXd here(2 * n);
  here << columns.Read(terms[0], state), columns.Read(terms[1], state);
  const auto cost = [&](const Eigen::VectorXd& at) {
    columns.Write(terms[0], at.head(n), state);
    columns.Write(terms[1], at.tail(n), state);
    return StepCost(state, 0, kStep_s, options_);
  };
  constexpr double kDifference = 1e-4;
  Eigen::VectorXd gradient(2 * n);
  Eigen::MatrixXd information(2 * n, 2 * n);
  for (Eigen::Index a = 0; a < 2 * n; ++a) {
    const Eigen::VectorXd da = kDifference * Eigen::VectorXd::Unit(2 * n, a);
    gradient[a] = (cost(here + da) - cost(here - da)) / (2.0 * kDifference);
    for (Eigen::Index b = 0; b <= a; ++b) {
      const Eigen::VectorXd db = kDifference * Eigen::VectorXd::Unit(2 * n, b);
      information(a, b) = information(b, a) =
          (cost(here + da + db) - cost(here + da - db) - cost(here - da + db) + cost(here - da - db)) /
          (4.0 * kDifference * kDifference);
    }
  }
  cost(here);
  for (int f = 0; f < 2; ++f) {
    BlockTridiagonal banded(1, static_cast<int>(n));
    equations.Linearise(terms[f], state, banded);
    gradient.segment(f * n, n) += banded.Gradient(0);
    information.block(f * n, f * n, n, n) += Eigen::MatrixXd(banded.Diagonal(0).selfadjointView<Eigen::Upper>());
  }
  const Eigen::MatrixXd covariance = information.inverse();
  // What is left of a step is far below the standard deviation.
  const Eigen::VectorXd step = (covariance * gradient).cwiseQuotient(covariance.diagonal().cwiseSqrt());
  EXPECT_LT(step.cwiseAbs().maxCoeff(), 0.5);
  for (int f = 0; f < 2; ++f) {
    const PosePosterior dense = PosteriorOf(columns, state, f, Eigen::MatrixXd(covariance.block(f * n, f * n, n, n)),
                                            PriorInClouds(*skeleton_, options_));
    for (std::size_t j = 0; j < dense.position.size(); ++j)
      EXPECT_NEAR(stated[f].position[j].trace(), dense.position[j].trace(), 0.1 * dense.position[j].trace()) << j;
  }
}

/// An arm is hidden where two parts meet: its poses and their uncertainty are those of one part.
TEST_F(Chain, PartsMeetWithoutATrace) {
  constexpr int kLong = 330;  // more than a part
  constexpr int kMeet = 300;
  const auto fit = [&](int begin, int end) {
    std::vector<FusedCloud> clouds;
    std::vector<FrameFit> chain;
    std::vector<double> time_s;
    PoseState state(*skeleton_, end - begin, skeleton_->RestBoneLengths(), body_.MovingJoints());
    for (int f = begin; f < end; ++f) {
      const bool hidden = std::abs(f - kMeet) < 6;
      const std::size_t of = hidden ? kFrames / 2 : 1;
      clouds.push_back(clouds_[of]);
      time_s.push_back(f * kStep_s);
      chain.emplace_back();
      chain.back().frame = f - begin;
      state.SetFrameParameters(f - begin, truth_.FrameParameters(static_cast<int>(of)));
    }
    state.Update(0, end - begin, true);
    auto smoothed = SmoothChain(body_, clouds, chain, time_s, options_, state);
    EXPECT_TRUE(smoothed) << smoothed.error().Message();
    return std::make_pair(state, smoothed->uncertainty);
  };
  const auto [parts, of_parts] = fit(0, kLong);
  const int begin = kMeet - 100;
  const auto [one, of_one] = fit(begin, kLong);
  for (int f = kMeet - 20; f < kMeet + 20; ++f) {
    for (int j = 0; j < parts.joints(); ++j) {
      EXPECT_LT((parts.position(f, j) - one.position(f - begin, j)).norm(), 0.002) << f << " " << j;
      const double trace = of_one[f - begin].position[j].trace();
      EXPECT_NEAR(of_parts[f].position[j].trace(), trace, 0.05 * trace) << f << " " << j;
    }
  }
}

}  // namespace
}  // namespace mocurate
