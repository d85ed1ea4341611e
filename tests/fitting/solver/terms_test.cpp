// Every term by itself: its rows against numeric differences, against an independent residual by automatic
// differentiation, and in the equations of both solvers.
#include <ceres/jet.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "tests/fitting/term_rows.h"

namespace mocurate {
namespace {

constexpr int kJointsOfBent = 5;
constexpr double kWeight = 3.0;
/// Three times as precise along one direction as along another, with correlation.
const Matrix3d kWhitening = (Matrix3d() << 3.0, 0.7, -0.4, 0.0, 1.2, 0.5, 0.0, 0.0, 0.9).finished();

/// A chain of five joints, bent at rest.
Skeleton BentChain() {
  Skeleton skeleton;
  const Vector3d offsets[kJointsOfBent] = {{0, 0, 0}, {0.1, 0.3, 0}, {0, 0.4, 0.1}, {0.3, 0, 0}, {0.2, 0.1, -0.1}};
  for (int j = 0; j < kJointsOfBent; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.parent = j - 1;
    joint.mirror = j;
    joint.rest_offset = offsets[j];
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

/// Regimes in which rotation formulas are numerically critical.
enum class Regime { kRandom, kIdentity, kTiny, kNearPi };

constexpr bool kActive[kJointsOfBent] = {true, true, false, true, false};
constexpr int kOfFrame = 12;  // unknowns: translation, and three rotation vectors
using Jet = ceres::Jet<double, 2 * kOfFrame>;
using Unknowns = std::array<Jet, 2 * kOfFrame>;

/// World rotation of a joint as a quaternion, and its position.
struct JetPose {
  Jet rotation[4] = {Jet(1.0), Jet(0.0), Jet(0.0), Jet(0.0)};
  Jet position[3];
};

JetPose PoseOf(const Skeleton& skeleton, const Unknowns& unknowns, int frame, int joint) {
  JetPose pose;
  const Jet* next = unknowns.data() + frame * kOfFrame;
  std::copy(next, next + 3, pose.position);
  for (int k = 0; k <= joint; ++k) {
    if (k > 0) {
      const Vector3d rest = skeleton.joints[static_cast<std::size_t>(k)].rest_offset;
      const Jet offset[3] = {Jet(rest[0]), Jet(rest[1]), Jet(rest[2])};
      Jet turned[3];
      ceres::UnitQuaternionRotatePoint(pose.rotation, offset, turned);
      for (int i = 0; i < 3; ++i) pose.position[i] += turned[i];
    }
    if (!kActive[k]) continue;
    Jet own[4], product[4];
    ceres::AngleAxisToQuaternion(next += 3, own);
    ceres::QuaternionProduct(pose.rotation, own, product);
    std::copy(product, product + 4, pose.rotation);
  }
  return pose;
}

/// Rotation vector of a joint: 0 root, 1, 3.
const Jet* RotationOf(const Unknowns& unknowns, int frame, int joint) {
  return unknowns.data() + frame * kOfFrame + 3 + 3 * (joint == 3 ? 2 : joint);
}

using Residual = std::vector<Jet>;
using JetResidual = std::function<Residual(const Unknowns&)>;

/// One term: what it adds to a problem of one or two frames, and its residual written down anew.
struct TermCase {
  std::string name;
  int frames;
  std::function<void(const PoseState&, PoseTerms&)> add;
  JetResidual residual{};  ///< none: differences are the only check
};

class EveryTerm : public testing::TestWithParam<Regime> {
 protected:
  EveryTerm()
      : skeleton_(BentChain()),
        state_(skeleton_, 2, skeleton_.RestBoneLengths(), std::vector<bool>(kActive, kActive + 5)) {
    Random random(7, "jacobians", std::to_string(static_cast<int>(GetParam())));
    for (int f = 0; f < 2; ++f) {
      for (int i = 0; i < 3; ++i) state_.translation(f)[i] = random.Normal();
      for (int j = 0; j < kJointsOfBent; ++j) Eigen::Map<Vector3d>(state_.rotation(f, j)) = Draw(random);
    }
    state_.Update(0, 2, true);
    body_.skeleton = std::make_shared<Skeleton>(skeleton_);
    body_.capsules = {{1, 2, {0.02, 0.01, -0.01}, {0.0, 0.03, 0.01}, 0.05, 0},
                      {4, 4, Vector3d::Zero(), Vector3d::Zero(), 0.08, 1}};
    cloud_ = {Eigen::Matrix3Xd(3, 3), Eigen::Matrix3Xd::Zero(3, 3), 0};
    for (int i = 0; i < 3; ++i)
      cloud_.points.col(i) = state_.position(0, i < 2 ? 1 : 4) + Vector3d(0.1, 0.2 - 0.3 * i, 0.15);
  }

  /// Rotation vector of the regime. Inactive joints keep the identity, whatever their memory contains.
  static Vector3d Draw(Random& random) {
    const Vector3d direction = Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    switch (GetParam()) {
      case Regime::kRandom:
        return random.Uniform(0.1, 2.5) * direction;
      case Regime::kIdentity:
        return Vector3d::Zero();
      case Regime::kTiny:
        return 1e-8 * direction;
      case Regime::kNearPi:
        return (3.14159265358979 - 1e-7) * direction;
    }
    return direction;
  }

  PoseTerms TermsOf(const TermCase& one) const {
    PoseTerms terms;
    terms.body = &body_;
    terms.huber = 2.5;
    terms.limit = 10.0;
    terms.hinge = 5.0;
    for (int f = 0; f < one.frames; ++f) {
      terms.frames.emplace_back();
      terms.frames.back().frame = f;
      terms.frames.back().priors.resize(kJointsOfBent);
    }
    one.add(state_, terms);
    return terms;
  }

  std::vector<TermCase> Cases() const;
  void AddSteps(std::vector<TermCase>& cases) const;

  Skeleton skeleton_;
  PoseState state_;
  CapsuleBody body_;
  FusedCloud cloud_;
  JointLimits limits_{{-0.2, -0.4, 0.1}, {0.3, 0.2, 0.5}};  // the third component is outside at the identity
  std::vector<std::optional<Hinge>> hinges_ = HingesOf(**LoadSkeleton("smpl24"));
  PoseGaussian known_;
};

INSTANTIATE_TEST_SUITE_P(Regimes, EveryTerm,
                         testing::Values(Regime::kRandom, Regime::kIdentity, Regime::kTiny, Regime::kNearPi));

std::vector<TermCase> EveryTerm::Cases() const {
  std::vector<TermCase> cases;
  for (int joint = 0; joint < kJointsOfBent; ++joint) {
    const std::string of = " of joint " + std::to_string(joint);
    for (const Vector3d& seen : {Vector3d(0.3, -0.2, 0.5), state_.position(0, joint)}) {
      cases.push_back({"position" + of, 1,
                       [=](const PoseState&, PoseTerms& terms) {
                         terms.frames[0].points = {{joint, seen, kWhitening}};
                       },
                       [=](const Unknowns& at) {
                         const JetPose pose = PoseOf(skeleton_, at, 0, joint);
                         Residual r(3, Jet(0.0));
                         for (int i = 0; i < 3; ++i) {
                           for (int k = 0; k < 3; ++k)
                             r[static_cast<std::size_t>(i)] += kWhitening(i, k) * (pose.position[k] - seen[k]);
                         }
                         return r;
                       }});
    }
    for (const Vector3d& away : {Vector3d(0.3, -0.2, 0.5), Vector3d(1.5, 0.4, -1.0)}) {
      const Quaterniond seen = Quaterniond(state_.global(0, joint)) * ExpQuaternion(away);
      cases.push_back({"recorded rotation" + of, 1,
                       [=](const PoseState&, PoseTerms& terms) {
                         terms.frames[0].rotations = {{joint, seen.toRotationMatrix(), kWeight}};
                       },
                       [=](const Unknowns& at) {
                         const JetPose pose = PoseOf(skeleton_, at, 0, joint);
                         const Jet back[4] = {Jet(seen.w()), Jet(-seen.x()), Jet(-seen.y()), Jet(-seen.z())};
                         Jet turn[4];
                         Residual r(3);
                         ceres::QuaternionProduct(back, pose.rotation, turn);
                         ceres::QuaternionToAngleAxis(turn, r.data());
                         for (Jet& one : r) one *= kWeight;
                         return r;
                       }});
    }
  }
  cases.push_back(
      {"surface", 1,
       [this](const PoseState&, PoseTerms& terms) {
         terms.frames[0].surface = {&cloud_, {{0, 0, 0.0}, {1, 0, 0.0}, {2, 1, 0.0}}, kWeight, 1.0};
       },
       [this](const Unknowns& at) {
         Residual r;
         for (const auto& [point, of] : {std::pair(0, 0), std::pair(1, 0), std::pair(2, 1)}) {
           const BodyCapsule& capsule = body_.capsules[static_cast<std::size_t>(of)];
           const JetPose frame = PoseOf(skeleton_, at, 0, capsule.frame);
           const JetPose last = PoseOf(skeleton_, at, 0, capsule.end_joint);
           // The rotation of the capsule's frame moves both offsets.
           Jet begin[3], end[3], away[3], square(0.0), along(0.0);
           const Jet from[3] = {Jet(capsule.begin_offset[0]), Jet(capsule.begin_offset[1]),
                                Jet(capsule.begin_offset[2])};
           const Jet to[3] = {Jet(capsule.end_offset[0]), Jet(capsule.end_offset[1]), Jet(capsule.end_offset[2])};
           ceres::UnitQuaternionRotatePoint(frame.rotation, from, begin);
           ceres::UnitQuaternionRotatePoint(frame.rotation, to, end);
           for (int i = 0; i < 3; ++i) {
             begin[i] += frame.position[i];
             end[i] += last.position[i];
             square += (end[i] - begin[i]) * (end[i] - begin[i]);
             along += (cloud_.points(i, point) - begin[i]) * (end[i] - begin[i]);
           }
           Jet place(0.0);
           if (square.a > 0.0 && along.a > 0.0) place = along.a > square.a ? Jet(1.0) : along / square;
           Jet distance(0.0);
           for (int i = 0; i < 3; ++i) {
             away[i] = cloud_.points(i, point) - begin[i] - place * (end[i] - begin[i]);
             distance += away[i] * away[i];
           }
           r.push_back(kWeight * (sqrt(distance) - capsule.radius));
         }
         return r;
       }});
  cases.push_back({"rest", 1, [](const PoseState&, PoseTerms& terms) { terms.frames[0].priors[1].rest = 4.0; },
                   [](const Unknowns& at) {
                     const Jet* w = RotationOf(at, 0, 1);
                     return Residual{2.0 * w[0], 2.0 * w[1], 2.0 * w[2]};
                   }});
  cases.push_back({"limits", 1,
                   [this](const PoseState&, PoseTerms& terms) { terms.frames[0].priors[3].limits = &limits_; },
                   [this](const Unknowns& at) {
                     Residual r(3, Jet(0.0));
                     for (int i = 0; i < 3; ++i) {
                       const Jet w = RotationOf(at, 0, 3)[i];
                       if (w.a > limits_.max[i]) r[static_cast<std::size_t>(i)] = 10.0 * (w - limits_.max[i]);
                       if (w.a < limits_.min[i]) r[static_cast<std::size_t>(i)] = 10.0 * (w - limits_.min[i]);
                     }
                     return r;
                   }});
  for (const std::optional<Hinge>& hinge : hinges_) {
    if (hinge)
      cases.push_back(
          {"hinge", 1, [&hinge](const PoseState&, PoseTerms& terms) { terms.frames[0].priors[1].hinge = &*hinge; }});
  }
  cases.push_back({"known pose", 1, [this](const PoseState&, PoseTerms& terms) { terms.frames[0].pose = &known_; }});
  AddSteps(cases);
  return cases;
}

void EveryTerm::AddSteps(std::vector<TermCase>& cases) const {
  constexpr double kRotation = 9.0, kMove = 4.0;
  StepTerm all{std::vector<double>(kJointsOfBent, kRotation), std::vector<double>(kJointsOfBent, kMove)};
  cases.push_back({"process noise", 2, [=](const PoseState&, PoseTerms& terms) { terms.frames[0].next = all; },
                   [this](const Unknowns& at) {
                     Residual r;
                     for (int j = 0; j < kJointsOfBent; ++j) {
                       if (kActive[j]) {
                         const Jet* first = RotationOf(at, 0, j);
                         const Jet back[3] = {-first[0], -first[1], -first[2]};
                         Jet a[4], b[4], turn[4], vector[3];
                         ceres::AngleAxisToQuaternion(back, a);
                         ceres::AngleAxisToQuaternion(RotationOf(at, 1, j), b);
                         ceres::QuaternionProduct(a, b, turn);
                         ceres::QuaternionToAngleAxis(turn, vector);
                         for (const Jet& one : vector) r.push_back(3.0 * one);
                       }
                       const JetPose here = PoseOf(skeleton_, at, 0, j), there = PoseOf(skeleton_, at, 1, j);
                       for (int i = 0; i < 3; ++i) r.push_back(2.0 * (there.position[i] - here.position[i]));
                     }
                     return r;
                   }});
  StepTerm root = all;
  std::fill(root.move.begin() + 1, root.move.end(), 0.0);
  cases.push_back(
      {"process noise of the root", 2, [=](const PoseState&, PoseTerms& terms) { terms.frames[0].next = root; }});
  cases.push_back({"after a fixed frame", 1, [=](const PoseState&, PoseTerms& terms) {
                     terms.frames[0].frame = 1;
                     terms.frames[0].fixed = {{0, all}};
                   }});
  cases.push_back({"before a fixed frame", 1, [=](const PoseState&, PoseTerms& terms) {
                     terms.frames[0].fixed = {{1, all}};
                   }});
}

TEST_P(EveryTerm, HasTheDerivativesOfItsResidualAndTheSameEquationsInBothSolvers) {
  known_.joints = {0, 1, 3};
  known_.translation = state_.position(0, 0) + Vector3d(0.1, 0.2, -0.1);
  for (const int j : known_.joints)
    known_.rotation.push_back(state_.local(0, j) * ExpMatrix(Vector3d(0.3 * j, -0.2, 0.4)));
  known_.whitening = Eigen::MatrixXd::Zero(12, 12);
  for (int r = 0; r < 12; ++r) {
    for (int c = 0; c <= r; ++c) known_.whitening(r, c) = r == c ? 3.0 + r : 0.1 * (r - 2 * c);
  }
  const std::vector<TermCase> cases = Cases();
  EXPECT_EQ(cases.size(), 32u);
  for (const TermCase& one : cases) {
    SCOPED_TRACE(one.name);
    const PoseTerms terms = TermsOf(one);
    ExpectDerivatives(terms, state_, 1e-4, 1e-7);
    ExpectSameEquations(terms, state_);
    if (!one.residual) continue;
    const DenseRows rows(terms, state_);
    const Eigen::VectorXd here = rows.columns.Read(terms, state_);
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

/// What people do without evidence, by plan: a Kinect's tracks need other limits than depth.
TEST(PriorValues, OfThePlans) {
  const PriorValues tracks = FittingOptions().joint_tracks.priors, clouds = FittingOptions().point_clouds.priors;
  const auto values = [](const PriorValues& of) {
    return std::vector<double>{of.rest,           of.limit,          of.hinge,
                               of.rotation_noise, of.position_noise, of.all_joints ? 1.0 : 0.0};
  };
  EXPECT_EQ(values(tracks), (std::vector<double>{3.3, 0.5, 0.25, 0.55, 0.33, 1.0}));
  EXPECT_EQ(values(clouds), (std::vector<double>{1.0, 0.1, 0.0, 0.55, 0.33, 0.0}));
}

}  // namespace
}  // namespace mocurate
