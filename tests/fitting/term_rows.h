#pragma once

#include <ceres/crs_matrix.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "fitting/solver/ceres_poses.h"
#include "fitting/solver/pose_equations.h"
#include "fitting/terms/terms.h"

namespace mocurate {

/// All rows of terms below each other, with their dense Jacobian. Unknowns as in PoseColumns, frame after frame.
struct DenseRows {
  const PoseTerms& terms;
  const PoseState& state;
  PoseColumns columns;
  std::vector<double> r{};
  std::vector<Eigen::RowVectorXd> j{};
  std::vector<double> root{};  ///< of the slope of each row's loss
  double cost = 0.0;

  DenseRows(const PoseTerms& of, const PoseState& pose) : terms(of), state(pose), columns(pose) {
    for (int i = 0; i < static_cast<int>(terms.frames.size()); ++i) {
      VisitFrame<true>(terms, state, i, *this);
      VisitNext<true>(terms, state, i, *this);
    }
  }

  Eigen::VectorXd Residuals() const {
    return Eigen::Map<const Eigen::VectorXd>(r.data(), static_cast<Eigen::Index>(r.size()));
  }
  Eigen::MatrixXd Jacobian() const {
    Eigen::MatrixXd all(static_cast<Eigen::Index>(j.size()), Unknowns());
    for (std::size_t i = 0; i < j.size(); ++i) all.row(static_cast<Eigen::Index>(i)) = j[i];
    return all;
  }
  Eigen::VectorXd Roots() const {
    return Eigen::Map<const Eigen::VectorXd>(root.data(), static_cast<Eigen::Index>(root.size()));
  }

  template <int K>
  void operator()(const BodyRows<K>& rows) {
    cost += 0.5 * rows.Loss();
    const double slope = std::sqrt(rows.Slope());
    for (int k = 0; k < K; ++k) Add(rows.r[k], OfTwist(rows.frame, rows.carrier, rows.a.row(k)), slope);
  }
  template <int K>
  void operator()(const JointRows<K>& rows) {
    cost += 0.5 * rows.r.squaredNorm();
    for (int k = 0; k < K; ++k) Add(rows.r[k], OfJoint(rows.frame, rows.joint, rows.j.row(k)), 1.0);
  }
  void operator()(const PoseRows& rows) {
    cost += 0.5 * rows.r.squaredNorm();
    for (Eigen::Index k = 0; k < rows.r.size(); ++k) {
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(Unknowns());
      row.segment<3>(At(rows.frame)) = rows.j.row(k).head<3>();
      for (std::size_t i = 0; i < rows.joints.size(); ++i)
        row += OfJoint(rows.frame, rows.joints[i], rows.j.row(k).segment<3>(3 + 3 * static_cast<Eigen::Index>(i)));
      Add(rows.r[k], row, 1.0);
    }
  }
  void operator()(const RotationStepRows& rows) {
    cost += 0.5 * rows.r.squaredNorm();
    for (int k = 0; k < 3; ++k)
      Add(rows.r[k],
          OfJoint(rows.frame, rows.joint, rows.before.row(k)) + OfJoint(rows.frame + 1, rows.joint, rows.after.row(k)),
          1.0);
  }
  void operator()(const MoveRows& rows) {
    cost += 0.5 * rows.r.squaredNorm();
    for (int k = 0; k < 3; ++k)
      Add(rows.r[k],
          OfTwist(rows.frame, rows.carrier, rows.before.row(k)) +
              OfTwist(rows.frame + 1, rows.carrier, rows.after.row(k)),
          1.0);
  }

 private:
  Eigen::Index Unknowns() const { return static_cast<Eigen::Index>(terms.frames.size()) * columns.size(); }
  Eigen::Index At(int frame) const { return static_cast<Eigen::Index>(frame) * columns.size(); }
  void Add(double residual, const Eigen::RowVectorXd& row, double slope) {
    r.push_back(residual);
    j.push_back(row);
    root.push_back(slope);
  }
  Eigen::RowVectorXd OfJoint(int frame, int joint, const Eigen::RowVector3d& by) const {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(Unknowns());
    row.segment<3>(At(frame) + columns.of(joint)) = by;
    return row;
  }
  Eigen::RowVectorXd OfTwist(int frame, int carrier, const Eigen::Matrix<double, 1, 6>& by) const {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(Unknowns());
    row.segment<3>(At(frame)) = by.head<3>();
    for (int joint = carrier; joint >= 0; joint = state.parent(joint)) {
      if (columns.of(joint) < 0) continue;
      row.segment<3>(At(frame) + columns.of(joint)) =
          by * TwistOf(state, terms.frames[static_cast<std::size_t>(frame)].frame, joint);
    }
    return row;
  }
};

/// Rows against central differences of fourth order.
inline void ExpectDerivatives(const PoseTerms& terms, PoseState& state, double step, double tolerance) {
  for (const FrameTerms& frame : terms.frames) state.Update(frame.frame, frame.frame + 1, true);
  const DenseRows rows(terms, state);
  const Eigen::MatrixXd own = rows.Jacobian();
  const Eigen::VectorXd here = rows.columns.Read(terms, state);
  const double scale = std::max(1.0, own.cwiseAbs().maxCoeff());
  for (Eigen::Index i = 0; i < here.size(); ++i) {
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(own.rows());
    for (const auto& [distance, weight] : {std::pair{-2.0, 1.0}, {-1.0, -8.0}, {1.0, 8.0}, {2.0, -1.0}}) {
      rows.columns.Write(terms, here + distance * step * Eigen::VectorXd::Unit(here.size(), i), state);
      slope += weight / (12.0 * step) * DenseRows(terms, state).Residuals();
    }
    EXPECT_LT((own.col(i) - slope).cwiseAbs().maxCoeff(), tolerance * scale) << "unknown " << i;
  }
  rows.columns.Write(terms, here, state);
}

/// The gradient of the rows, losses included, against central differences of the cost.
inline void ExpectGradient(const PoseTerms& terms, PoseState& state, const PoseColumns& columns,
                           const Eigen::VectorXd& gradient) {
  constexpr double kStep = 1e-6;  // small: a point may pass the end of its axis, or the bend of the loss
  const Eigen::VectorXd here = columns.Read(terms, state);
  Eigen::VectorXd slope(here.size());
  for (Eigen::Index i = 0; i < here.size(); ++i) {
    double ends[2];
    for (const int way : {0, 1}) {
      columns.Write(terms, here + (way == 0 ? -kStep : kStep) * Eigen::VectorXd::Unit(here.size(), i), state);
      ends[way] = Cost(terms, state);
    }
    slope[i] = (ends[1] - ends[0]) / (2.0 * kStep);
  }
  columns.Write(terms, here, state);
  EXPECT_LT((slope - gradient).norm(), 1e-4 * gradient.norm() + 1e-5);
}

/// Cost, gradient and Gauss-Newton matrix of both solvers against the rows.
inline void ExpectSameEquations(const PoseTerms& terms, PoseState& state) {
  for (const FrameTerms& frame : terms.frames) state.Update(frame.frame, frame.frame + 1, true);
  const DenseRows rows(terms, state);
  const Eigen::MatrixXd j = rows.Roots().asDiagonal() * rows.Jacobian();
  const Eigen::VectorXd r = rows.Roots().cwiseProduct(rows.Residuals());
  const Eigen::MatrixXd square = j.transpose() * j;
  const Eigen::VectorXd gradient = j.transpose() * r;
  EXPECT_NEAR(Cost(terms, state), rows.cost, 1e-12 * rows.cost + 1e-15);
  ExpectGradient(terms, state, rows.columns, gradient);

  PoseEquations pose(state);
  const int n = pose.columns().size(), frames = static_cast<int>(terms.frames.size());
  BlockTridiagonal equations(frames, n);
  pose.Linearise(terms, state, equations);
  EXPECT_LT((equations.GradientEntries() - gradient).norm(), 1e-9 * gradient.norm() + 1e-12);
  for (int f = 0; f < frames; ++f) {
    const Eigen::MatrixXd diagonal = equations.Diagonal(f).triangularView<Eigen::Upper>();
    const Eigen::MatrixXd own = square.block(f * n, f * n, n, n).triangularView<Eigen::Upper>();
    EXPECT_LT((diagonal - own).norm(), 1e-9 * square.norm()) << "frame " << f;
    if (f + 1 == frames) break;
    EXPECT_LT((equations.Next(f) - square.block(f * n, (f + 1) * n, n, n)).norm(), 1e-9 * square.norm())
        << "step " << f;
  }

  CeresPoses poses(terms, state);
  ceres::Problem::EvaluateOptions evaluate;
  std::vector<Eigen::Index> places;
  for (int f = 0; f < frames; ++f) {
    const int at = terms.frames[static_cast<std::size_t>(f)].frame;
    const auto add = [&](double* block, Eigen::Index place) {
      if (!poses.problem().HasParameterBlock(block)) return;
      evaluate.parameter_blocks.push_back(block);
      for (Eigen::Index i = 0; i < 3; ++i) places.push_back(static_cast<Eigen::Index>(f) * n + place + i);
    };
    add(state.translation(at), 0);
    for (int k = 0; k < state.joints(); ++k) {
      if (state.active(k)) add(state.rotation(at, k), pose.columns().of(k));
    }
  }
  double cost = 0.0;
  std::vector<double> slopes;
  ceres::CRSMatrix jacobian;
  ASSERT_TRUE(poses.problem().Evaluate(evaluate, &cost, nullptr, &slopes, &jacobian));
  EXPECT_NEAR(cost, rows.cost, 1e-9 * rows.cost + 1e-15);
  Eigen::MatrixXd of_ceres = Eigen::MatrixXd::Zero(jacobian.num_rows, square.cols());
  for (int row = 0; row < jacobian.num_rows; ++row) {
    for (int i = jacobian.rows[row]; i < jacobian.rows[row + 1]; ++i)
      of_ceres(row, places[static_cast<std::size_t>(jacobian.cols[i])]) = jacobian.values[i];
  }
  EXPECT_LT((of_ceres.transpose() * of_ceres - square).norm(), 1e-9 * square.norm());
  Eigen::VectorXd by_ceres = Eigen::VectorXd::Zero(gradient.size());
  for (std::size_t i = 0; i < places.size(); ++i) by_ceres[places[i]] = slopes[i];
  EXPECT_LT((by_ceres - gradient).norm(), 1e-9 * gradient.norm() + 1e-12);
  ASSERT_TRUE(poses.problem().Evaluate(evaluate, &cost, nullptr, nullptr, nullptr));
  EXPECT_NEAR(cost, rows.cost, 1e-9 * rows.cost + 1e-15) << "without derivatives";
}

}  // namespace mocurate
