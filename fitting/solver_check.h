#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "fitting/fit_result.h"

namespace mocurate {

/// Whether both solvers had the same matches of evidence to the body, or each matched anew as it went.
enum class SolverMatches { kFixed, kOwn };

/// Compares a fit with that of the other solver, named `solver`. They differ where joints are more than 0.1 mm or costs
/// more than 1e-6 (relative) apart; with own matches 1 mm in the median joint, 5 mm in the worst and 1e-3; where one of
/// them alone converges; and where the other fails.
/// {"solver", "differ", "joint_median_mm", "joint_worst_mm", "cost_difference": relative, or "failed"}; adds a finding
/// solvers_differ, its value the worst joint's mm.
nlohmann::json CheckOfSolvers(const FitResult& fit, const std::string& solver, const Expected<FitResult>& other,
                              SolverMatches matches, std::vector<Finding>& findings);

}  // namespace mocurate
