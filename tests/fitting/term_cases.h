#pragma once

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
#include "fitting/terms/terms.h"

namespace mocurate {

inline constexpr int kJointsOfBent = 5;
inline constexpr double kWeight = 3.0;
/// Three times as precise along one direction as along another, with correlation.
inline const Matrix3d kWhitening = (Matrix3d() << 3.0, 0.7, -0.4, 0.0, 1.2, 0.5, 0.0, 0.0, 0.9).finished();

/// A chain of five joints, bent at rest.
inline Skeleton BentChain() {
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

inline constexpr bool kActive[kJointsOfBent] = {true, true, false, true, false};
inline constexpr int kOfFrame = 12;  // unknowns: translation, and three rotation vectors
using Jet = ceres::Jet<double, 2 * kOfFrame>;
using Unknowns = std::array<Jet, 2 * kOfFrame>;

/// World rotation of a joint as a quaternion, and its position.
struct JetPose {
  Jet rotation[4] = {Jet(1.0), Jet(0.0), Jet(0.0), Jet(0.0)};
  Jet position[3];
};

inline JetPose PoseOf(const Skeleton& skeleton, const Unknowns& unknowns, int frame, int joint) {
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
inline const Jet* RotationOf(const Unknowns& unknowns, int frame, int joint) {
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

/// Every term by itself, on a chain of five joints and two frames.
class TermProblem {
 public:
  explicit TermProblem(Regime regime)
      : skeleton_(BentChain()),
        state_(skeleton_, 2, skeleton_.RestBoneLengths(), std::vector<bool>(kActive, kActive + 5)) {
    Random random(7, "jacobians", std::to_string(static_cast<int>(regime)));
    for (int f = 0; f < 2; ++f) {
      for (int i = 0; i < 3; ++i) state_.translation(f)[i] = random.Normal();
      for (int j = 0; j < kJointsOfBent; ++j) Eigen::Map<Vector3d>(state_.rotation(f, j)) = Draw(regime, random);
    }
    state_.Update(0, 2, true);
    body_.skeleton = std::make_shared<Skeleton>(skeleton_);
    body_.capsules = {{1, 2, {0.02, 0.01, -0.01}, {0.0, 0.03, 0.01}, 0.05, 0},
                      {4, 4, Vector3d::Zero(), Vector3d::Zero(), 0.08, 1}};
    const CapsuleEnds axis = EndsOf(body_.capsules[0], state_, 0);
    for (int i = 0; i < 3; ++i)  // before its begin, beside it, beyond its end
      points_.col(i) = axis.begin + (i - 0.5) * (axis.end - axis.begin) + Vector3d(0.1, 0.05, 0.15);
    points_.col(3) = state_.position(0, 4) + Vector3d(0.1, -0.1, 0.15);
    known_.joints = {0, 1, 3};
    known_.translation = state_.position(0, 0) + Vector3d(0.1, 0.2, -0.1);
    for (const int j : known_.joints)
      known_.rotation.push_back(state_.local(0, j) * ExpMatrix(Vector3d(0.3 * j, -0.2, 0.4)));
    known_.whitening = Eigen::MatrixXd::Zero(12, 12);
    for (int r = 0; r < 12; ++r) {
      for (int c = 0; c <= r; ++c) known_.whitening(r, c) = r == c ? 3.0 + r : 0.1 * (r - 2 * c);
    }
  }

  /// Rotation vector of the regime. Inactive joints keep the identity, whatever their memory contains.
  static Vector3d Draw(Regime regime, Random& random) {
    const Vector3d direction = Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
    switch (regime) {
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
  PoseState& state() { return state_; }

 private:
  void AddSteps(std::vector<TermCase>& cases) const;

  Skeleton skeleton_;
  PoseState state_;
  CapsuleBody body_;
  Eigen::Matrix3Xd points_{3, 4};
  JointLimits limits_{{-0.2, -0.4, 0.1}, {0.3, 0.2, 0.5}};  // the third component is outside at the identity
  std::vector<std::optional<Hinge>> hinges_ = HingesOf(**LoadSkeleton("smpl24"));
  PoseGaussian known_;
};

inline std::vector<TermCase> TermProblem::Cases() const {
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
         terms.frames[0].surface = {&points_, {{0, 0, 0.0}, {1, 0, 0.0}, {2, 0, 0.0}, {3, 1, 0.0}}, kWeight, 1.0};
       },
       [this](const Unknowns& at) {
         Residual r;
         for (const auto& [point, of] : {std::pair(0, 0), std::pair(1, 0), std::pair(2, 0), std::pair(3, 1)}) {
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
             along += (points_(i, point) - begin[i]) * (end[i] - begin[i]);
           }
           Jet place(0.0);
           if (square.a > 0.0 && along.a > 0.0) place = along.a > square.a ? Jet(1.0) : along / square;
           Jet distance(0.0);
           for (int i = 0; i < 3; ++i) {
             away[i] = points_(i, point) - begin[i] - place * (end[i] - begin[i]);
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

inline void TermProblem::AddSteps(std::vector<TermCase>& cases) const {
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

}  // namespace mocurate
