#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "core/geometry/rotation.h"
#include "fitting/terms/hinge.h"
#include "fitting/terms/huber.h"
#include "fitting/terms/pose_gaussian.h"
#include "fitting/terms/surface.h"

namespace mocurate {

/// Everything that a pose is fitted to, as rows of least squares: 1/2 sum of rho(|r|^2). A term gives its residual,
/// unitless and white, and its derivative in what moves it directly: the twist of one body, or the rotation vector of
/// one joint. The walk from there to the root, the robust loss and the normal equations are written once, by what
/// visits the rows (PoseEquations, the Ceres adapter).
///
/// A body is what a joint, its `carrier`, rotates. Its twist is (v, w) in the world, v at the root's position: a point
/// at p, relative to the root, moves by X(p) (v, w), X(p) = [I, -Hat(p)].

using Matrix36d = Eigen::Matrix<double, 3, 6>;

inline Matrix36d PointMotion(const Vector3d& p) {
  Matrix36d motion;
  motion.leftCols<3>().setIdentity();
  motion.rightCols<3>() = -Hat(p);
  return motion;
}

/// K residuals of one body in a frame.
template <int K>
struct BodyRows {
  int frame = 0;  ///< index in PoseTerms::frames
  int carrier = 0;
  Eigen::Matrix<double, K, 1> r;
  Eigen::Matrix<double, K, 6> a;  ///< dr / d(v, w)
  double huber = 0.0;             ///< |r| from which the loss is linear; 0: squared everywhere
  int source = -1;     ///< of a point on a surface its capsule, of an observed position its joint; -1: of others
  double place = 0.0;  ///< of a point on a surface, along the capsule's axis: 0 at its begin, 1 at its end

  /// rho(|r|^2) of Huber's loss, and its slope there.
  double Loss() const { return huber > 0.0 ? HuberValue(r.squaredNorm(), huber) : r.squaredNorm(); }
  double Slope() const { return huber > 0.0 ? HuberSlope(r.squaredNorm(), huber) : 1.0; }
};

/// K residuals of one joint's rotation vector in a frame.
template <int K>
struct JointRows {
  int frame = 0;
  int joint = 0;
  Eigen::Matrix<double, K, 1> r;
  Eigen::Matrix<double, K, 3> j;  ///< dr / dw
};

/// Residuals between a frame and the next one: of one joint's rotation vectors, and of one body's twists.
struct RotationStepRows {
  int frame = 0;
  int joint = 0;
  Vector3d r = Vector3d::Zero();
  Matrix3d before = Matrix3d::Zero(), after = Matrix3d::Zero();
};
struct MoveRows {
  int frame = 0;
  int carrier = 0;
  Vector3d r = Vector3d::Zero();
  Matrix36d before = Matrix36d::Zero(), after = Matrix36d::Zero();
};

/// Residuals of a frame's translation and of the rotation vectors of some joints, three columns each.
struct PoseRows {
  int frame = 0;
  const std::vector<int>& joints;
  Eigen::VectorXd r;
  Eigen::MatrixXd j;
};

/// Observed position of a joint: r = W (p - seen), W'W its information in 1/m^2 (zero along a ray). Huber's loss.
/// Degenerate: the twist of a straight chain moves no joint.
struct PointTerm {
  int joint = 0;
  Vector3d seen = Vector3d::Zero();       ///< world, m
  Matrix3d whitening = Matrix3d::Zero();  ///< W
};

/// Recorded world rotation of a joint: r = weight Log(seen^T G). Huber's loss.
/// Degenerate: at 180 degrees from the target the branch changes; the robust loss gives that a low weight.
/// Source: Sola, Deray, Atchuthan 2018, A micro Lie theory, sections II and IV.
struct RotationTerm {
  int joint = 0;
  Matrix3d seen = Matrix3d::Identity();
  double weight = 0.0;  ///< 1/rad
};

/// Measured points on the surfaces of their capsules: r = weight (|point - q| - radius), q the nearest point of the
/// axis. The place of q on the axis contributes nothing: it is a minimum or stays at an end.
/// Degenerate: a point on the axis itself has no direction: zero derivative.
struct SurfaceTerm {
  const Eigen::Matrix3Xd* points = nullptr;  ///< (3,N) world, m; null: none
  std::vector<CloudMatch> matches{};
  double weight = 0.0;  ///< 1/m
  double huber = 0.0;
};

/// Priors of a joint's rotation vector w against its parent; not of the root.
struct JointPrior {
  double rest = 0.0;                    ///< information of the rest pose, 1/rad^2: r = sqrt(rest) w
  const JointLimits* limits = nullptr;  ///< r = limit (w - nearest of the limits), component by component
  const Hinge* hinge = nullptr;         ///< r = hinge OffHinge: out of its plane, and hyperextension
};

/// Process noise from a frame to another: r = sqrt(rotation) Log(R_before^T R_after) of each active joint, and
/// r = sqrt(move) (p_after - p_before) of each joint.
/// Degenerate: a rotation of exactly pi between the frames, where Log changes its branch; the cost is largest there.
/// Source: random walks; Sola et al. 2018, eqs. 143-147.
struct StepTerm {
  std::vector<double> rotation{};  ///< (J) 1/rad^2; empty: the frames are not coupled
  std::vector<double> move{};      ///< (J) 1/m^2; 0: that joint's position is free
};

/// A frame of the state that stays as it is, coupled with one that is fitted.
struct FixedFrame {
  int frame = 0;  ///< of the state
  StepTerm step{};
};

/// Terms of one frame.
struct FrameTerms {
  int frame = 0;  ///< of the state
  std::vector<PointTerm> points{};
  std::vector<RotationTerm> rotations{};
  SurfaceTerm surface{};
  const PoseGaussian* pose = nullptr;  ///< what other evidence knows: r = W d; null: nothing
  std::vector<JointPrior> priors{};    ///< (J)
  StepTerm next{};                     ///< to the next of PoseTerms::frames
  std::vector<FixedFrame> fixed{};
};

/// Terms of the frames that are fitted together.
struct PoseTerms {
  std::vector<FrameTerms> frames{};   ///< ascending
  const CapsuleBody* body = nullptr;  ///< of the surfaces
  double huber = 0.0;                 ///< of points and rotations
  double limit = 0.0;                 ///< 1/rad
  double hinge = 0.0;                 ///< 1 over the standard deviation of the sine
};

namespace internal {

template <bool kDerivatives, class Visitor>
void VisitSurface(const PoseTerms& terms, const PoseState& state, int index, Visitor&& visit) {
  const FrameTerms& frame = terms.frames[static_cast<std::size_t>(index)];
  const SurfaceTerm& surface = frame.surface;
  if (surface.points == nullptr) return;
  std::vector<CapsuleEnds> ends;
  for (const BodyCapsule& capsule : terms.body->capsules) ends.push_back(EndsOf(capsule, state, frame.frame));
  const Vector3d& root = state.position(frame.frame, 0);
  BodyRows<1> rows;
  rows.frame = index;
  rows.huber = surface.huber;
  for (const CloudMatch& match : surface.matches) {
    const BodyCapsule& capsule = terms.body->capsules[static_cast<std::size_t>(match.capsule)];
    const CapsuleEnds& axis = ends[static_cast<std::size_t>(match.capsule)];
    const Vector3d point = surface.points->col(match.point);
    rows.source = match.capsule;
    rows.place = PlaceOnAxis(axis.begin, axis.end, point);
    const Vector3d nearest = axis.begin + rows.place * (axis.end - axis.begin);
    const Vector3d away = point - nearest;
    const double distance = away.norm();
    rows.r[0] = surface.weight * (distance - capsule.radius);
    rows.carrier = capsule.frame;
    if constexpr (kDerivatives) {
      const Vector3d pull = distance > 0.0 ? Vector3d(-surface.weight / distance * away) : Vector3d(Vector3d::Zero());
      rows.a.noalias() = pull.transpose() * PointMotion(nearest - root);
    }
    visit(rows);
  }
}

template <bool kDerivatives, class Visitor>
void VisitObservations(const PoseTerms& terms, const PoseState& state, int index, Visitor&& visit) {
  const FrameTerms& frame = terms.frames[static_cast<std::size_t>(index)];
  const int f = frame.frame;
  BodyRows<3> rows;
  rows.frame = index;
  rows.huber = terms.huber;
  for (const PointTerm& term : frame.points) {
    const Vector3d& position = state.position(f, term.joint);
    rows.r.noalias() = term.whitening * (position - term.seen);
    rows.carrier = std::max(0, state.parent(term.joint));
    rows.source = term.joint;
    if constexpr (kDerivatives) {
      rows.a.noalias() = term.whitening * PointMotion(position - state.position(f, 0));
    }
    visit(rows);
  }
  rows.source = -1;
  for (const RotationTerm& term : frame.rotations) {
    const Matrix3d& global = state.global(f, term.joint);
    const Vector3d away = LogMatrix(term.seen.transpose() * global);
    rows.r = term.weight * away;
    rows.carrier = term.joint;
    if constexpr (kDerivatives) {
      rows.a.template leftCols<3>().setZero();
      rows.a.template rightCols<3>().noalias() = term.weight * RightJacobianInverse(away) * global.transpose();
    }
    visit(rows);
  }
}

template <bool kDerivatives, class Visitor>
void VisitPriors(const PoseTerms& terms, const PoseState& state, int index, Visitor&& visit) {
  const FrameTerms& frame = terms.frames[static_cast<std::size_t>(index)];
  for (int j = 1; j < state.joints(); ++j) {
    if (!state.active(j)) continue;
    const JointPrior& prior = frame.priors[static_cast<std::size_t>(j)];
    const Vector3d w = Eigen::Map<const Vector3d>(state.rotation(frame.frame, j));
    if (prior.rest > 0.0) {
      const double weight = std::sqrt(prior.rest);
      visit(JointRows<3>{index, j, weight * w, weight * Matrix3d::Identity()});
    }
    if (prior.limits != nullptr) {
      JointRows<3> rows{index, j, Vector3d::Zero(), Matrix3d::Zero()};
      for (int i = 0; i < 3; ++i) {
        rows.r[i] = terms.limit * BeyondLimit(w[i], prior.limits->min[i], prior.limits->max[i]);
        if (rows.r[i] != 0.0) rows.j(i, i) = terms.limit;
      }
      visit(rows);
    }
    if (prior.hinge != nullptr) {
      const Matrix3d& local = state.local(frame.frame, j);
      JointRows<2> rows{index, j, terms.hinge * OffHinge(*prior.hinge, local), Eigen::Matrix<double, 2, 3>::Zero()};
      if constexpr (kDerivatives) rows.j = terms.hinge * OffHingeSlopes(*prior.hinge, local, w);
      visit(rows);
    }
  }
}

/// Process noise between the frames `before` and `after` of a state.
template <bool kDerivatives, class Visitor>
void VisitSteps(const StepTerm& step, const PoseState& state, int before, int after, Visitor&& visit) {
  RotationStepRows turn;
  MoveRows move;
  for (int j = 0; j < state.joints() && !step.rotation.empty(); ++j) {
    if (state.active(j)) {
      const double weight = std::sqrt(step.rotation[static_cast<std::size_t>(j)]);
      turn.joint = j;
      const Vector3d difference = LogMatrix(state.local(before, j).transpose() * state.local(after, j));
      turn.r = weight * difference;
      if constexpr (kDerivatives) {
        const Matrix3d inverse = weight * RightJacobianInverse(difference);
        turn.before.noalias() = -inverse.transpose() * state.right_jacobian(before, j);
        turn.after.noalias() = inverse * state.right_jacobian(after, j);
      }
      visit(turn);
    }
    if (step.move[static_cast<std::size_t>(j)] == 0.0) continue;
    const double weight = std::sqrt(step.move[static_cast<std::size_t>(j)]);
    const Vector3d &here = state.position(before, j), &there = state.position(after, j);
    move.r = weight * (there - here);
    move.carrier = std::max(0, state.parent(j));
    if constexpr (kDerivatives) {
      move.before = -weight * PointMotion(here - state.position(before, 0));
      move.after = weight * PointMotion(there - state.position(after, 0));
    }
    visit(move);
  }
}

/// Rows of a frame beside a fixed one.
template <class Visitor>
struct BesideFixed {
  Visitor& visit;
  int frame;
  bool is_after;  ///< the frame is after the fixed one

  void operator()(const RotationStepRows& turn) {
    visit(JointRows<3>{frame, turn.joint, turn.r, is_after ? turn.after : turn.before});
  }
  void operator()(const MoveRows& move) {
    visit(BodyRows<3>{frame, move.carrier, move.r, is_after ? move.after : move.before});
  }
};

}  // namespace internal

/// All rows of one frame, those beside fixed frames included: calls `visit` with BodyRows<1>, BodyRows<3>,
/// JointRows<2>, JointRows<3> and PoseRows. The state's kinematics must be up to date, its derivatives too
/// where `kDerivatives`; without, a, j, before and after mean nothing.
template <bool kDerivatives, class Visitor>
void VisitFrame(const PoseTerms& terms, const PoseState& state, int index, Visitor&& visit) {
  internal::VisitSurface<kDerivatives>(terms, state, index, visit);
  internal::VisitObservations<kDerivatives>(terms, state, index, visit);
  internal::VisitPriors<kDerivatives>(terms, state, index, visit);
  const FrameTerms& frame = terms.frames[static_cast<std::size_t>(index)];
  if (frame.pose != nullptr) {
    const PoseGaussian& pose = *frame.pose;
    const Eigen::VectorXd errors = pose.Errors(state, frame.frame);
    const auto whitening = pose.whitening.triangularView<Eigen::Lower>();
    PoseRows rows{index, pose.joints, whitening * errors, {}};
    if constexpr (kDerivatives) {
      rows.j = whitening;
      for (std::size_t k = 0; k < pose.joints.size(); ++k) {
        auto columns = rows.j.middleCols<3>(PoseGaussian::At(k));
        columns = (columns * pose.Derivative(errors, state, frame.frame, k)).eval();
      }
    }
    visit(rows);
  }
  for (const FixedFrame& fixed : frame.fixed) {
    const bool is_after = fixed.frame < frame.frame;
    internal::BesideFixed<std::remove_reference_t<Visitor>> beside{visit, index, is_after};
    internal::VisitSteps<kDerivatives>(fixed.step, state, is_after ? fixed.frame : frame.frame,
                                       is_after ? frame.frame : fixed.frame, beside);
  }
}

/// The rows between a frame and the next: RotationStepRows and MoveRows.
template <bool kDerivatives, class Visitor>
void VisitNext(const PoseTerms& terms, const PoseState& state, int index, Visitor&& visit) {
  const std::size_t i = static_cast<std::size_t>(index);
  if (i + 1 >= terms.frames.size()) return;
  internal::VisitSteps<kDerivatives>(terms.frames[i].next, state, terms.frames[i].frame, terms.frames[i + 1].frame,
                                     [&](auto& rows) {
                                       rows.frame = index;
                                       visit(rows);
                                     });
}

/// 1/2 sum of rho(|r|^2). The state's kinematics must be up to date.
double Cost(const PoseTerms& terms, const PoseState& state);

}  // namespace mocurate
