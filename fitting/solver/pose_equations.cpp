#include "fitting/solver/pose_equations.h"

#include <algorithm>
#include <utility>

namespace mocurate {

Twist TwistOf(const PoseState& state, int frame, int joint) {
  Twist twist;
  twist.topRows<3>().noalias() =
      Hat(state.position(frame, joint) - state.position(frame, 0)) * state.lever(frame, joint);
  twist.bottomRows<3>() = state.lever(frame, joint);
  return twist;
}

PoseColumns::PoseColumns(const PoseState& state) {
  for (int j = 0; j < state.joints(); ++j) {
    column_.push_back(state.active(j) ? size_ : -1);
    if (state.active(j)) size_ += 3;
  }
}

Eigen::VectorXd PoseColumns::Read(const PoseTerms& terms, const PoseState& state) const {
  Eigen::VectorXd unknowns(static_cast<Eigen::Index>(terms.frames.size()) * size_);
  for (std::size_t i = 0; i < terms.frames.size(); ++i) {
    const int f = terms.frames[i].frame;
    auto own = unknowns.segment(static_cast<Eigen::Index>(i) * size_, size_);
    own.head<3>() = Eigen::Map<const Vector3d>(state.translation(f));
    for (int j = 0; j < state.joints(); ++j) {
      if (of(j) >= 0) own.segment<3>(of(j)) = Eigen::Map<const Vector3d>(state.rotation(f, j));
    }
  }
  return unknowns;
}

void PoseColumns::Write(const PoseTerms& terms, const Eigen::VectorXd& unknowns, PoseState& state) const {
  for (std::size_t i = 0; i < terms.frames.size(); ++i) {
    const int f = terms.frames[i].frame;
    const auto own = unknowns.segment(static_cast<Eigen::Index>(i) * size_, size_);
    Eigen::Map<Vector3d>(state.translation(f)) = own.head<3>();
    for (int j = 0; j < state.joints(); ++j) {
      if (of(j) >= 0) Eigen::Map<Vector3d>(state.rotation(f, j)) = own.segment<3>(of(j));
    }
    state.Update(f, f + 1, true);
  }
}

/// Sums the rows of a frame, and of its step to the next.
struct PoseEquations::Rows {
  PoseEquations& sums;
  BlockTridiagonal& equations;

  template <int K>
  void operator()(const BodyRows<K>& rows) {
    BodyInformation& sum = sums.here_[static_cast<std::size_t>(rows.carrier)];
    const Eigen::Matrix<double, K, 6> weighted = rows.Slope() * rows.a;
    sum.information.noalias() += weighted.transpose() * rows.a;
    sum.gradient.noalias() += weighted.transpose() * rows.r;
  }
  template <int K>
  void operator()(const JointRows<K>& rows) {
    const int c = sums.columns_.of(rows.joint);
    equations.Diagonal(rows.frame).template block<3, 3>(c, c).noalias() += rows.j.transpose() * rows.j;
    equations.Gradient(rows.frame).template segment<3>(c).noalias() += rows.j.transpose() * rows.r;
  }
  void operator()(const PoseRows& rows) {
    std::vector<int> columns{0};
    for (const int joint : rows.joints) columns.push_back(sums.columns_.of(joint));
    const Eigen::MatrixXd information = rows.j.transpose() * rows.j;
    const Eigen::VectorXd gradient = rows.j.transpose() * rows.r;
    auto diagonal = equations.Diagonal(rows.frame);
    auto right = equations.Gradient(rows.frame);
    for (std::size_t b = 0; b < columns.size(); ++b) {
      for (std::size_t a = 0; a <= b; ++a)
        diagonal.block<3, 3>(columns[a], columns[b]) +=
            information.block<3, 3>(3 * static_cast<Eigen::Index>(a), 3 * static_cast<Eigen::Index>(b));
      right.segment<3>(columns[b]) += gradient.segment<3>(3 * static_cast<Eigen::Index>(b));
    }
  }
  void operator()(const RotationStepRows& rows) {
    const int c = sums.columns_.of(rows.joint), f = rows.frame;
    equations.Diagonal(f).block<3, 3>(c, c).noalias() += rows.before.transpose() * rows.before;
    equations.Gradient(f).segment<3>(c).noalias() += rows.before.transpose() * rows.r;
    equations.Diagonal(f + 1).block<3, 3>(c, c).noalias() += rows.after.transpose() * rows.after;
    equations.Gradient(f + 1).segment<3>(c).noalias() += rows.after.transpose() * rows.r;
    equations.Next(f).block<3, 3>(c, c).noalias() += rows.before.transpose() * rows.after;
  }
  void operator()(const MoveRows& rows) {
    const auto c = static_cast<std::size_t>(rows.carrier);
    sums.here_[c].information.noalias() += rows.before.transpose() * rows.before;
    sums.here_[c].gradient.noalias() += rows.before.transpose() * rows.r;
    sums.next_[c].information.noalias() += rows.after.transpose() * rows.after;
    sums.next_[c].gradient.noalias() += rows.after.transpose() * rows.r;
    sums.across_[c].noalias() += rows.before.transpose() * rows.after;
  }
};

PoseEquations::PoseEquations(const PoseState& state)
    : columns_(state),
      here_(static_cast<std::size_t>(state.joints())),
      next_(here_.size()),
      across_(here_.size()),
      twist_(here_.size()),
      twist_next_(here_.size()) {}

void PoseEquations::AddFrame(const PoseState& state, BlockTridiagonal::Block diagonal,
                             BlockTridiagonal::Column gradient) {
  for (int j = state.joints() - 1; j > 0; --j)
    here_[static_cast<std::size_t>(state.parent(j))] += here_[static_cast<std::size_t>(j)];
  diagonal.topLeftCorner<3, 3>() += here_[0].information.topLeftCorner<3, 3>();
  gradient.head<3>() += here_[0].gradient.head<3>();
  for (int j = 0; j < state.joints(); ++j) {
    const int c = columns_.of(j);
    if (c < 0) continue;
    const BodyInformation& below = here_[static_cast<std::size_t>(j)];
    const Twist& twist = twist_[static_cast<std::size_t>(j)];
    const Twist moved = below.information * twist;
    diagonal.block<3, 3>(0, c) += moved.topRows<3>();
    diagonal.block<3, 3>(c, c).noalias() += twist.transpose() * moved;
    for (const int a : state.path(j))
      diagonal.block<3, 3>(columns_.of(a), c).noalias() += twist_[static_cast<std::size_t>(a)].transpose() * moved;
    gradient.segment<3>(c).noalias() += twist.transpose() * below.gradient;
  }
}

void PoseEquations::AddNext(const PoseState& state, BlockTridiagonal::Block next) {
  for (int j = state.joints() - 1; j > 0; --j)
    across_[static_cast<std::size_t>(state.parent(j))] += across_[static_cast<std::size_t>(j)];
  next.topLeftCorner<3, 3>() += across_[0].topLeftCorner<3, 3>();
  for (int j = 0; j < state.joints(); ++j) {
    const int c = columns_.of(j);
    if (c < 0) continue;
    const auto at = static_cast<std::size_t>(j);
    const Twist moved = across_[at] * twist_next_[at];
    const Twist back = across_[at].transpose() * twist_[at];
    next.block<3, 3>(0, c) += moved.topRows<3>();
    next.block<3, 3>(c, 0) += back.topRows<3>().transpose();
    next.block<3, 3>(c, c).noalias() += twist_[at].transpose() * moved;
    for (const int a : state.path(j)) {
      next.block<3, 3>(columns_.of(a), c).noalias() += twist_[static_cast<std::size_t>(a)].transpose() * moved;
      next.block<3, 3>(c, columns_.of(a)).noalias() += back.transpose() * twist_next_[static_cast<std::size_t>(a)];
    }
  }
}

void PoseEquations::Linearise(const PoseTerms& terms, const PoseState& state, BlockTridiagonal& equations) {
  const auto set_twists = [&](std::size_t i, std::vector<Twist>& twists) {
    for (int j = 0; j < state.joints(); ++j) {
      if (columns_.of(j) >= 0) twists[static_cast<std::size_t>(j)] = TwistOf(state, terms.frames[i].frame, j);
    }
  };
  Rows rows{*this, equations};
  equations.SetZero(0);
  set_twists(0, twist_);
  std::fill(here_.begin(), here_.end(), BodyInformation());
  for (std::size_t i = 0; i < terms.frames.size(); ++i) {
    const int block = static_cast<int>(i);
    VisitFrame<true>(terms, state, block, rows);
    std::fill(next_.begin(), next_.end(), BodyInformation());
    const bool has_next = i + 1 < terms.frames.size();
    if (has_next) {
      equations.SetZero(block + 1);
      set_twists(i + 1, twist_next_);
    }
    if (has_next && !terms.frames[i].next.rotation.empty()) {
      std::fill(across_.begin(), across_.end(), Matrix6d(Matrix6d::Zero()));
      VisitNext<true>(terms, state, block, rows);
      AddNext(state, equations.Next(block));
    }
    AddFrame(state, equations.Diagonal(block), equations.Gradient(block));
    std::swap(here_, next_);
    std::swap(twist_, twist_next_);
  }
}

}  // namespace mocurate
