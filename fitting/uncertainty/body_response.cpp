#include "fitting/uncertainty/body_response.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace mocurate {
namespace {

constexpr double kUnknownPlace = 1.0;  ///< m^2; variance of a place that is not known (numerical)
constexpr int kOfCapsule = 7;          ///< numbers of a capsule: its ends and its radius

/// Couples the rows of a frame with the body.
struct Coupling {
  std::vector<Matrix6d> bodies;                                  ///< (J) information of what a joint carries
  std::vector<Matrix3d> points;                                  ///< (J) of the joint's own observations
  std::vector<Eigen::Matrix<double, 6, kOfCapsule>> capsules{};  ///< of its points between carrier and capsule
  const PoseState& state;
  int frame;

  void operator()(const BodyRows<1>& row) {
    const double slope = row.Slope();
    bodies[static_cast<std::size_t>(row.carrier)].noalias() += slope * row.a.transpose() * row.a;
    const Vector3d pull = state.global(frame, row.carrier).transpose() * row.a.head<3>().transpose();
    Eigen::Matrix<double, 1, kOfCapsule> of_capsule;
    of_capsule << (1.0 - row.place) * pull.transpose(), row.place * pull.transpose(), -pull.norm();
    capsules[static_cast<std::size_t>(row.source)].noalias() += slope * row.a.transpose() * of_capsule;
  }
  void operator()(const BodyRows<3>& rows) {
    bodies[static_cast<std::size_t>(rows.carrier)].noalias() += rows.Slope() * rows.a.transpose() * rows.a;
    if (rows.source < 0) return;
    points[static_cast<std::size_t>(rows.source)].noalias() +=
        rows.Slope() * rows.a.leftCols<3>().transpose() * rows.a.leftCols<3>();
  }
  template <int K>
  void operator()(const JointRows<K>&) {}
  void operator()(const PoseRows&) {}
};

/// What the end of a bone moves by per standard deviation (3 x 3, world).
Matrix3d MoveOfEnd(const PoseState& state, int frame, int joint, const BodyDeviations& deviations) {
  const auto at = static_cast<std::size_t>(joint);
  Matrix3d axes = Matrix3d::Identity();
  if (!deviations.length_measured.empty() && deviations.length_measured[at]) {
    const Vector3d along =
        (state.position(frame, joint) - state.position(frame, state.parent(joint))).stableNormalized();
    axes -= along * along.transpose();
  }
  return deviations.bone[at] * axes;
}

}  // namespace

double SpreadOfBone(const Skeleton& skeleton, int bone) {
  const int start = skeleton.joints[bone].parent;
  return skeleton.joints[start].mirror == start ? kTrunkSigma : kLimbSigma;
}

BodyResponse::BodyResponse(const PoseTerms& terms, const PoseState& state, int index,
                           const BodyDeviations& deviations) {
  const auto joints = static_cast<std::size_t>(state.joints());
  const int frame = terms.frames[static_cast<std::size_t>(index)].frame;
  PoseTerms of_frame{
      {terms.frames[static_cast<std::size_t>(index)]}, terms.body, terms.huber, terms.limit, terms.hinge};
  of_frame.frames.front().next = {};
  PoseEquations equations(state);
  const PoseColumns& columns = equations.columns();
  BlockTridiagonal information(1, columns.size());
  equations.Linearise(of_frame, state, information);
  // No prior of a frame alone knows where the root is: as far as nothing shows it, the body does not move it.
  information.Diagonal(0).diagonal().head<3>().array() += 1.0 / kUnknownPlace;
  if (const int root = columns.of(0); root >= 0)
    information.Diagonal(0).diagonal().segment<3>(root).array() += 1.0 / kUnknownAngle;
  const Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> factor(information.Diagonal(0));
  known_ = factor.info() == Eigen::Success;
  position_.assign(joints, known_ ? Matrix3d::Zero() : Matrix3d(kUnknownPlace * Matrix3d::Identity()));
  rotation_.assign(joints, known_ ? Matrix3d::Zero() : Matrix3d(kUnknownAngle * Matrix3d::Identity()));
  if (!known_) return;

  Coupling sums{std::vector<Matrix6d>(joints, Matrix6d::Zero()),
                std::vector<Matrix3d>(joints, Matrix3d::Zero()),
                {},
                state,
                frame};
  const std::size_t capsules = terms.body != nullptr ? terms.body->capsules.size() : 0;
  sums.capsules.assign(capsules, Eigen::Matrix<double, 6, kOfCapsule>::Zero());
  VisitFrame<true>(of_frame, state, 0, sums);
  for (std::size_t j = joints - 1; j > 0; --j)
    sums.bodies[static_cast<std::size_t>(state.parent(static_cast<int>(j)))] += sums.bodies[j];

  std::vector<Twist> twist(joints);
  for (std::size_t j = 0; j < joints; ++j) {
    if (columns.of(static_cast<int>(j)) >= 0) twist[j] = TwistOf(state, frame, static_cast<int>(j));
  }
  // Columns: three of each bone that is not exact, of points beside their joints and of fixed joints, along the world's
  // axes, then those of the capsules with points.
  std::vector<int> bone(joints, -1), point(joints, -1), fixed(joints, -1);
  int count = 0;
  const auto add = [&](const std::vector<double>& sigma, std::size_t j, int& column) {
    if (sigma.empty() || !(sigma[j] > 0.0)) return;
    column = count;
    count += 3;
  };
  for (std::size_t j = 0; j < joints; ++j) {
    if (j > 0) add(deviations.bone, j, bone[j]);
    if (!sums.points[j].isZero(0.0)) add(deviations.point, j, point[j]);
    if (columns.of(static_cast<int>(j)) < 0) add(deviations.fixed, j, fixed[j]);
  }
  std::vector<int> capsule(capsules, -1);
  for (std::size_t c = 0; c < capsules; ++c) {
    if (sums.capsules[c].isZero(0.0)) continue;
    capsule[c] = count;
    count += kOfCapsule;
  }
  Eigen::MatrixXd coupled = Eigen::MatrixXd::Zero(columns.size(), count);
  // Couples columns with what is above a joint, by what a move along them does to its twist.
  const auto couple_above = [&](int joint, int column, const Eigen::Matrix<double, 6, 3>& moved) {
    coupled.block<3, 3>(0, column) = moved.topRows<3>();
    for (const int a : state.path(joint))
      coupled.block<3, 3>(columns.of(a), column).noalias() = twist[static_cast<std::size_t>(a)].transpose() * moved;
  };
  for (std::size_t j = 0; j < joints; ++j) {
    const int joint = static_cast<int>(j);
    Eigen::Matrix<double, 6, 3> of_point;
    of_point << sums.points[j], Hat(state.position(frame, joint) - state.position(frame, 0)) * sums.points[j];
    // The observed point moves against the joint: as a residual of the opposite sign.
    if (point[j] >= 0) couple_above(joint, point[j], deviations.point[j] * of_point);
    if (bone[j] < 0) continue;
    const Matrix3d end = MoveOfEnd(state, frame, joint, deviations);
    couple_above(joint, bone[j], (sums.bodies[j].leftCols<3>() + of_point) * end);
    for (std::size_t below = j; below < joints; ++below) {
      const int column = columns.of(static_cast<int>(below));
      if (column < 0) continue;
      bool carried = below == j;
      for (const int on : state.bones(static_cast<int>(below))) carried = carried || on == joint;
      if (!carried) continue;
      coupled.block<3, 3>(column, bone[j]).noalias() =
          twist[below].transpose() * sums.bodies[below].leftCols<3>() * end;
    }
  }
  for (std::size_t c = 0; c < capsules; ++c) {
    if (capsule[c] < 0) continue;
    Eigen::Matrix<double, 6, kOfCapsule> moved = sums.capsules[c];
    moved.leftCols<6>() *= deviations.capsule_end;
    moved.rightCols<1>() *= deviations.capsule_radius;
    const int carrier = terms.body->capsules[c].frame;
    coupled.block<3, kOfCapsule>(0, capsule[c]) = moved.topRows<3>();
    const auto couple = [&](int joint) {
      if (columns.of(joint) >= 0)
        coupled.block<3, kOfCapsule>(columns.of(joint), capsule[c]).noalias() =
            twist[static_cast<std::size_t>(joint)].transpose() * moved;
    };
    for (const int a : state.path(carrier)) couple(a);
    couple(carrier);
  }
  const Eigen::MatrixXd response = -factor.solve(coupled);

  // Twists of the bodies, and places of the joints, per standard deviation.
  std::vector<Eigen::Matrix<double, 6, Eigen::Dynamic>> moved(joints);
  for (std::size_t j = 0; j < joints; ++j) {
    const int joint = static_cast<int>(j), parent = state.parent(joint);
    moved[j] =
        parent < 0 ? Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, count) : moved[static_cast<std::size_t>(parent)];
    if (parent < 0) moved[j].topRows<3>() = response.topRows<3>();
    Eigen::Matrix<double, 3, Eigen::Dynamic> place =
        PointMotion(state.position(frame, joint) - state.position(frame, 0)) * moved[j];
    if (bone[j] >= 0) {
      const Matrix3d end = MoveOfEnd(state, frame, joint, deviations);
      place.middleCols<3>(bone[j]) += end;
      moved[j].block<3, 3>(0, bone[j]) += end;
    }
    position_[j].noalias() = place * place.transpose();
    if (const int column = columns.of(joint); column >= 0) {
      const Eigen::Matrix<double, 3, Eigen::Dynamic> turned =
          state.right_jacobian(frame, joint) * response.middleRows<3>(column);
      rotation_[j].noalias() = turned * turned.transpose();
      moved[j].noalias() += twist[j] * response.middleRows<3>(column);
    } else if (fixed[j] >= 0) {
      moved[j].block<3, 3>(0, fixed[j]) +=
          deviations.fixed[j] * Hat(state.position(frame, joint) - state.position(frame, 0));
      moved[j].block<3, 3>(3, fixed[j]) += deviations.fixed[j] * Matrix3d::Identity();
    }
  }
}

}  // namespace mocurate
