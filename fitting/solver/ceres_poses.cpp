#include "fitting/solver/ceres_poses.h"

#include <ceres/cost_function.h>
#include <ceres/iteration_callback.h>
#include <ceres/solver.h>

#include <Eigen/QR>
#include <algorithm>
#include <string>
#include <utility>

#include "core/pipeline/worker.h"
#include "fitting/solver/pose_equations.h"
#include "fitting/stop_request.h"

namespace mocurate {

/// A residual block at the present iterate.
struct CeresPoses::Block {
  std::vector<double*> parameters;  ///< of three numbers each
  Eigen::VectorXd residual;
  std::vector<Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>> jacobians;  ///< one per parameter block
};

/// Copies what CeresPoses evaluated.
class CeresPoses::BlockCost final : public ceres::CostFunction {
 public:
  explicit BlockCost(const Block& block) : block_(block) {
    set_num_residuals(static_cast<int>(block.residual.size()));
    mutable_parameter_block_sizes()->assign(block.parameters.size(), 3);
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    std::copy_n(block_.residual.data(), block_.residual.size(), residuals);
    for (std::size_t k = 0; jacobians != nullptr && k < block_.jacobians.size(); ++k) {
      if (jacobians[k] != nullptr) std::copy_n(block_.jacobians[k].data(), block_.jacobians[k].size(), jacobians[k]);
    }
    return true;
  }

 private:
  const Block& block_;
};

/// Sorts the rows of all frames into blocks.
class CeresPoses::Rows {
 public:
  explicit Rows(CeresPoses& of)
      : of_(of), bodies_(of.terms_.frames.size() * Joints()), joints_(bodies_.size()), twists_(bodies_.size()) {
    for (int j = 0; j < of.state_.joints(); ++j) {
      moving_.push_back(of.state_.path(j));
      if (of.state_.active(j)) moving_.back().push_back(j);
    }
  }

  void Evaluate(bool derivatives) {
    derivatives_ = derivatives;
    next_ = 0;
    for (auto& stack : bodies_) stack.Clear();
    for (auto& stack : joints_) stack.Clear();
    for (std::size_t at = 0; derivatives && at < twists_.size(); ++at) {
      const auto joint = static_cast<int>(at % Joints());
      if (of_.state_.active(joint)) twists_[at] = TwistOf(of_.state_, FrameAt(static_cast<int>(at / Joints())), joint);
    }
    for (int i = 0; i < static_cast<int>(of_.terms_.frames.size()); ++i) {
      derivatives ? VisitFrame<true>(of_.terms_, of_.state_, i, *this)
                  : VisitFrame<false>(of_.terms_, of_.state_, i, *this);
      derivatives ? VisitNext<true>(of_.terms_, of_.state_, i, *this)
                  : VisitNext<false>(of_.terms_, of_.state_, i, *this);
    }
    for (std::size_t at = 0; at < bodies_.size(); ++at) {
      if (!bodies_[at].rows.empty()) Finish(at, bodies_[at]);
      if (!joints_[at].rows.empty()) Finish(at, joints_[at]);
    }
  }

  template <int K>
  void operator()(const BodyRows<K>& rows) {
    auto& stack = bodies_[At(rows.frame, rows.carrier)];
    stack.excess += rows.Loss() - rows.Slope() * rows.r.squaredNorm();
    const double root = std::sqrt(rows.Slope());
    for (int k = 0; k < K; ++k) {
      Eigen::Matrix<double, 1, 7> row = Eigen::Matrix<double, 1, 7>::Zero();
      if (derivatives_) row.head<6>() = root * rows.a.row(k);
      row[6] = root * rows.r[k];
      stack.rows.push_back(row);
    }
  }
  template <int K>
  void operator()(const JointRows<K>& rows) {
    auto& stack = joints_[At(rows.frame, rows.joint)];
    for (int k = 0; k < K; ++k) {
      Eigen::Matrix<double, 1, 4> row = Eigen::Matrix<double, 1, 4>::Zero();
      if (derivatives_) row.head<3>() = rows.j.row(k);
      row[3] = rows.r[k];
      stack.rows.push_back(row);
    }
  }
  void operator()(const PoseRows& rows) {
    Block& block = Next(rows.r.size(), [&] {
      std::vector<double*> parameters{Translation(rows.frame)};
      for (const int j : rows.joints) parameters.push_back(Rotation(rows.frame, j));
      return parameters;
    });
    block.residual = rows.r;
    for (std::size_t k = 0; derivatives_ && k < block.jacobians.size(); ++k)
      block.jacobians[k] = rows.j.middleCols<3>(3 * static_cast<Eigen::Index>(k));
  }
  void operator()(const RotationStepRows& rows) {
    Block& block = Next(3, [&] {
      return std::vector{Rotation(rows.frame, rows.joint), Rotation(rows.frame + 1, rows.joint)};
    });
    block.residual = rows.r;
    if (derivatives_) block.jacobians = {rows.before, rows.after};
  }
  void operator()(const MoveRows& rows) {
    Block& block = Next(3, [&] {
      std::vector<double*> parameters = ParametersOf(rows.frame, rows.carrier);
      const std::vector<double*> next = ParametersOf(rows.frame + 1, rows.carrier);
      parameters.insert(parameters.end(), next.begin(), next.end());
      return parameters;
    });
    block.residual = rows.r;
    if (!derivatives_) return;
    SetJacobians(rows.frame, rows.carrier, rows.before, block, 0);
    SetJacobians(rows.frame + 1, rows.carrier, rows.after, block, block.jacobians.size() / 2);
  }

 private:
  /// Rows [a r] of one body (seven columns) or joint (four).
  template <int C>
  struct Stack {
    std::vector<Eigen::Matrix<double, 1, C>> rows;
    double excess = 0.0;  ///< of the robust losses over the squares of the reweighted rows
    Block* block = nullptr;

    void Clear() { rows.clear(), excess = 0.0; }
  };

  std::size_t Joints() const { return static_cast<std::size_t>(of_.state_.joints()); }
  std::size_t At(int frame, int joint) const {
    return static_cast<std::size_t>(frame) * Joints() + static_cast<std::size_t>(joint);
  }
  int FrameAt(int frame) const { return of_.terms_.frames[static_cast<std::size_t>(frame)].frame; }
  double* Translation(int frame) const { return of_.state_.translation(FrameAt(frame)); }
  double* Rotation(int frame, int joint) const { return of_.state_.rotation(FrameAt(frame), joint); }
  std::vector<double*> ParametersOf(int frame, int carrier) const {
    std::vector<double*> parameters{Translation(frame)};
    for (const int j : moving_[static_cast<std::size_t>(carrier)]) parameters.push_back(Rotation(frame, j));
    return parameters;
  }
  Block& Make(std::vector<double*> parameters, Eigen::Index rows) {
    of_.blocks_.push_back(std::make_unique<Block>());
    Block& block = *of_.blocks_.back();
    block.jacobians.resize(parameters.size());
    block.parameters = std::move(parameters);
    block.residual.resize(rows);
    return block;
  }
  /// Of rows that are a block of their own: they come in the same order at every evaluation.
  template <class Parameters>
  Block& Next(Eigen::Index rows, Parameters&& parameters) {
    if (next_ == own_.size()) own_.push_back(&Make(parameters(), rows));
    return *own_[next_++];
  }
  /// Jacobians of rows with the derivative `a` in a body's twist, from the `first` parameter block on.
  template <class Derivative>
  void SetJacobians(int frame, int carrier, const Derivative& a, Block& block, std::size_t first) const {
    block.jacobians[first] = a.template leftCols<3>();
    for (const int j : moving_[static_cast<std::size_t>(carrier)])
      block.jacobians[++first].noalias() = a * twists_[At(frame, j)];
  }
  template <int C>
  void Finish(std::size_t at, Stack<C>& stack) {
    const auto frame = static_cast<int>(at / Joints()), joint = static_cast<int>(at % Joints());
    if (stack.block == nullptr) {
      stack.block = &Make(C == 7 ? ParametersOf(frame, joint) : std::vector{Rotation(frame, joint)}, C);
    }
    Block& block = *stack.block;
    using Square = Eigen::Matrix<double, C, C>;
    if (!derivatives_) {  // any residual of the same length
      double square = stack.excess;
      for (const auto& row : stack.rows) square += row[C - 1] * row[C - 1];
      block.residual.setZero();
      block.residual[C - 1] = std::sqrt(square);
      return;
    }
    while (stack.rows.size() < static_cast<std::size_t>(C)) stack.rows.push_back(Eigen::Matrix<double, 1, C>::Zero());
    using All = Eigen::Matrix<double, Eigen::Dynamic, C, Eigen::RowMajor>;
    const Eigen::Map<const All> all(stack.rows.front().data(), static_cast<Eigen::Index>(stack.rows.size()), C);
    const Square upper =
        Eigen::HouseholderQR<All>(all).matrixQR().template topRows<C>().template triangularView<Eigen::Upper>();
    block.residual = upper.col(C - 1);
    block.residual[C - 1] = std::sqrt(block.residual[C - 1] * block.residual[C - 1] + std::max(0.0, stack.excess));
    const Eigen::Matrix<double, C, C - 1> a = upper.template leftCols<C - 1>();
    if constexpr (C == 7) {
      SetJacobians(frame, joint, a, block, 0);
    } else {
      block.jacobians.front() = a;
    }
  }

  CeresPoses& of_;
  bool derivatives_ = true;
  std::vector<Stack<7>> bodies_;  ///< (frames * J)
  std::vector<Stack<4>> joints_;
  std::vector<Twist> twists_;             ///< (frames * J)
  std::vector<std::vector<int>> moving_;  ///< (J) joints whose rotations move a body: those at and above its carrier
  std::vector<Block*> own_;
  std::size_t next_ = 0;
};

CeresPoses::CeresPoses(const PoseTerms& terms, PoseState& state) : terms_(terms), state_(state) {
  ceres::Problem::Options options;
  options.disable_all_safety_checks = true;
  options.evaluation_callback = this;
  problem_ = std::make_unique<ceres::Problem>(options);
  rows_ = std::make_unique<Rows>(*this);
  PrepareForEvaluation(true, true);
  for (const auto& block : blocks_) problem_->AddResidualBlock(new BlockCost(*block), nullptr, block->parameters);
}

CeresPoses::~CeresPoses() = default;

void CeresPoses::PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) {
  if (new_evaluation_point) has_derivatives_ = false;
  if (!new_evaluation_point && (has_derivatives_ || !evaluate_jacobians)) return;
  for (const FrameTerms& frame : terms_.frames) state_.Update(frame.frame, frame.frame + 1, evaluate_jacobians);
  rows_->Evaluate(evaluate_jacobians);
  has_derivatives_ = evaluate_jacobians;
}

namespace {

/// Ends the solver when the worker receives a stop request, and after the step that SolveOptions ask for. Ceres itself
/// tests its tolerance before it takes a step, and drops the last one.
class StopAfterStep : public ceres::IterationCallback {
 public:
  explicit StopAfterStep(const SolveOptions& options) : options_(options) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (StopRequested()) return ceres::SOLVER_ABORT;
    if (summary.iteration == 0 || !summary.step_is_successful) return ceres::SOLVER_CONTINUE;
    const double before = summary.cost + summary.cost_change;
    const bool ended = options_.one_step || summary.cost_change <= options_.relative_tolerance * before;
    return ended ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  const SolveOptions& options_;
};

}  // namespace

Expected<Solution> SolveWithCeres(const PoseTerms& terms, PoseState& state, const SolveOptions& options) {
  CeresPoses poses(terms, state);
  ceres::Solver::Options solver;
  solver.linear_solver_type = terms.frames.size() == 1 ? ceres::DENSE_NORMAL_CHOLESKY : ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  solver.num_threads = 1;
  solver.function_tolerance = 1e-3 * options.relative_tolerance;  // rounding at the minimum
  solver.max_num_consecutive_invalid_steps = options.max_iterations;
  solver.gradient_tolerance = 1e-12;
  solver.parameter_tolerance = 1e-12;
  solver.max_num_iterations = options.max_iterations;
  solver.logging_type = ceres::SILENT;
  StopAfterStep stop(options);
  solver.callbacks = {&stop};
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &poses.problem(), &summary);
  for (const FrameTerms& frame : terms.frames) state.Update(frame.frame, frame.frame + 1, true);
  if (Status on = StopIfInterrupted(options.of); !on) return Forward(on);
  if (!summary.IsSolutionUsable()) {
    return Fail(ErrorCode::kInconsistent, "the solver failed: " + summary.message, FramesOf(terms), kCheckFrames);
  }
  Solution solution;
  solution.iterations = static_cast<int>(summary.iterations.size()) - 1;
  solution.initial_cost = summary.initial_cost;
  solution.final_cost = summary.final_cost;
  solution.converged = summary.termination_type != ceres::NO_CONVERGENCE;
  return solution;
}

}  // namespace mocurate
