#pragma once

#include "core/base/error.h"
#include "fitting/options.h"
#include "fitting/terms/terms.h"

namespace mocurate {

class BlockTridiagonal;

struct SolveOptions {
  PoseSolver solver = PoseSolver::kBanded;
  double relative_tolerance = 1e-4;  ///< ends at this relative change of the cost
  int max_iterations = 100;
  const char* of = "fit";              ///< what is interrupted
  BlockTridiagonal* memory = nullptr;  ///< of the banded equations, reused by the next solve; null: their own
  bool one_step = false;               ///< ends after the first step that lowers the cost
};

/// Termination of a solver; the solution is in the state.
struct Solution {
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  bool converged = false;
  bool exhausted = false;  ///< no step reduces the cost, however small
};

/// Minimises the cost of terms over the poses of their frames, from the pose in the state (Levenberg-Marquardt).
/// There is at least one frame; fixed frames beside them must be up to date. kBanded: block-tridiagonal normal
/// equations by subtree sums (PoseEquations), Cholesky by LAPACK. kCeres: the same rows as a Ceres problem, sparse
/// Cholesky (CHOLMOD). Errors kInconsistent where the initial cost is not finite or Ceres fails, kInterrupted.
Expected<Solution> Solve(const PoseTerms& terms, PoseState& state, const SolveOptions& options);

}  // namespace mocurate
