#include "fitting/clouds/cloud_smoothing.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/motion/skeleton.h"

namespace mocurate {
namespace {

constexpr int kFrames = 5;
constexpr double kStep_s = 1.0 / 30.0;

/// A walking body: points on its surface in every frame, but none on the left arm in the middle one.
class Chain : public testing::Test {
 protected:
  Chain()
      : skeleton_(*LoadSkeleton("smpl24")),
        body_(CapsuleBody::Make(skeleton_, 1.0, 1.0)),
        truth_(*skeleton_, kFrames, skeleton_->RestBoneLengths(), body_.MovingJoints()) {
    Random random(11, "chain");
    options_.solver = TrackSolver::kBanded;
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
  std::vector<CloudUncertainty> Smoothed(PoseState& state) {
    EXPECT_TRUE(SmoothChain(body_, clouds_, chain_, time_s_, options_, state));
    auto uncertainty = SmoothChain(body_, clouds_, chain_, time_s_, options_, state);
    EXPECT_TRUE(uncertainty) << uncertainty.error().Message();
    return *uncertainty;
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
  const std::vector<CloudUncertainty> smoothed = Smoothed(state);
  for (int f = 1; f + 1 < kFrames; ++f) {
    FrameFit fit = chain_[static_cast<std::size_t>(f)];
    const double sigma = 0.003;  // that of points on the capsules themselves, the smallest
    const auto alone = UncertaintyOfFrame(body_, clouds_[static_cast<std::size_t>(f)], fit, sigma, state, options_);
    fit.held = {{-1, kStep_s}, {1, kStep_s}};
    const auto beside = UncertaintyOfFrame(body_, clouds_[static_cast<std::size_t>(f)], fit, sigma, state, options_);
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
  const std::vector<CloudUncertainty> smoothed = Smoothed(state);
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

TEST_F(Chain, PartsOfALongChainGiveTheUncertaintyOfTheWhole) {
  std::vector<FusedCloud> clouds;
  std::vector<FrameFit> chain;
  std::vector<double> time_s;
  constexpr int kLong = 320;  // more than a part
  PoseState state(*skeleton_, kLong, skeleton_->RestBoneLengths(), body_.MovingJoints());
  for (int f = 0; f < kLong; ++f) {
    clouds.push_back(clouds_[0]);
    time_s.push_back(f * kStep_s);
    FrameFit fit;
    fit.frame = f;
    chain.push_back(fit);
    state.SetFrameParameters(f, truth_.FrameParameters(0));
  }
  const auto stated = SmoothChain(body_, clouds, chain, time_s, options_, state);
  ASSERT_TRUE(stated) << stated.error().Message();
  ASSERT_EQ(stated->size(), static_cast<std::size_t>(kLong));
  for (std::size_t j = 0; j < (*stated)[0].position.size(); ++j) {
    const double inside = (*stated)[150].position[j].trace();
    EXPECT_NEAR((*stated)[299].position[j].trace(), inside, 0.01 * inside) << j;
    EXPECT_NEAR((*stated)[300].position[j].trace(), inside, 0.01 * inside) << j;
  }
}

}  // namespace
}  // namespace mocurate
