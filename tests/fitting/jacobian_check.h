#pragma once

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace mocurate {

/// A cost at a point. Its blocks are memory that `update` passes to the cost.
struct CostAt {
  const ceres::CostFunction* cost;
  std::vector<double*> blocks;
  std::function<void()> update = [] {};
};

using Jacobians = std::vector<std::vector<double>>;

inline std::vector<double> ResidualsOf(const CostAt& at, Jacobians* jacobians = nullptr) {
  at.update();
  std::vector<double> residuals(static_cast<std::size_t>(at.cost->num_residuals()));
  std::vector<double*> rows;
  if (jacobians != nullptr) {
    jacobians->clear();
    for (const int size : at.cost->parameter_block_sizes()) {
      jacobians->emplace_back(residuals.size() * static_cast<std::size_t>(size), 0.0);
    }
    for (std::vector<double>& block : *jacobians) rows.push_back(block.data());
  }
  EXPECT_TRUE(at.cost->Evaluate(at.blocks.data(), residuals.data(), jacobians != nullptr ? rows.data() : nullptr));
  return residuals;
}

/// Central differences of fourth order.
inline Jacobians NumericJacobians(const CostAt& at, double step) {
  Jacobians jacobians;
  const auto rows = static_cast<std::size_t>(at.cost->num_residuals());
  for (std::size_t b = 0; b < at.blocks.size(); ++b) {
    const auto size = static_cast<std::size_t>(at.cost->parameter_block_sizes()[b]);
    std::vector<double> block(rows * size, 0.0);
    for (std::size_t c = 0; c < size; ++c) {
      const double here = at.blocks[b][c];
      for (const auto& [distance, weight] : {std::pair{-2.0, 1.0}, {-1.0, -8.0}, {1.0, 8.0}, {2.0, -1.0}}) {
        at.blocks[b][c] = here + distance * step;
        const std::vector<double> residuals = ResidualsOf(at);
        for (std::size_t r = 0; r < rows; ++r) block[r * size + c] += weight * residuals[r] / (12.0 * step);
      }
      at.blocks[b][c] = here;
    }
    jacobians.push_back(std::move(block));
  }
  at.update();
  return jacobians;
}

/// Names block and entry of the largest difference relative to the largest entry.
inline testing::AssertionResult SameJacobians(const Jacobians& analytic, const Jacobians& reference, double tolerance,
                                              const std::string& name) {
  double scale = 1.0;
  for (const std::vector<double>& block : reference) {
    for (const double value : block) scale = std::max(scale, std::abs(value));
  }
  for (std::size_t b = 0; b < reference.size(); ++b) {
    for (std::size_t i = 0; i < reference[b].size(); ++i) {
      if (std::abs(analytic[b][i] - reference[b][i]) <= tolerance * scale) continue;  // also false for NaN
      return testing::AssertionFailure() << "block " << b << " entry " << i << ": analytic " << analytic[b][i] << ", "
                                         << name << " " << reference[b][i] << " (scale " << scale << ")";
    }
  }
  return testing::AssertionSuccess();
}

/// Compares with numeric differences and with an autodiff cost of the same blocks, which must agree in value too.
#define EXPECT_JACOBIAN(at, autodiff, numeric_tolerance)                                                             \
  do {                                                                                                               \
    ::mocurate::Jacobians analytic_;                                                                                 \
    ::mocurate::Jacobians automatic_;                                                                                \
    const std::vector<double> value_ = ::mocurate::ResidualsOf(at, &analytic_);                                      \
    const ::mocurate::CostAt reference_{&(autodiff), (at).blocks};                                                   \
    const std::vector<double> same_ = ::mocurate::ResidualsOf(reference_, &automatic_);                              \
    for (std::size_t i_ = 0; i_ < value_.size(); ++i_) {                                                             \
      EXPECT_NEAR(value_[i_], same_[i_], 1e-9 * std::max(1.0, std::abs(same_[i_])));                                 \
    }                                                                                                                \
    EXPECT_TRUE(::mocurate::SameJacobians(analytic_, automatic_, 1e-7, "autodiff"));                                 \
    EXPECT_TRUE(                                                                                                     \
        ::mocurate::SameJacobians(analytic_, ::mocurate::NumericJacobians(at, 1e-4), numeric_tolerance, "numeric")); \
  } while (false)

}  // namespace mocurate
