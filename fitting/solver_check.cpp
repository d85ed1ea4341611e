#include "fitting/solver_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/median.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// How far both solvers may end apart.
struct Apart {
  double median;  ///< m, of joints
  double worst;   ///< m, of one joint in one frame
  double cost;    ///< share of the cost
};

}  // namespace

nlohmann::json CheckOfSolvers(const FitResult& fit, const std::string& solver, const Expected<FitResult>& other,
                              SolverMatches matches, std::vector<Finding>& findings) {
  nlohmann::json json = {{"solver", solver}, {"differ", true}};
  const auto report = [&](double value, const std::string& what) {
    findings.push_back(MakeFinding("solvers_differ", Severity::kWarning, value, "the solver " + solver + " " + what,
                                   FindingAction::kKept));
  };
  if (!other) {
    json["failed"] = other.error().Message();
    report(0.0, "fails: " + other.error().Message());
    return json;
  }
  std::vector<double> apart;
  for (int f = 0; f < fit.motion.frame_count(); ++f) {
    for (int j = 0; j < fit.motion.joint_count(); ++j) {
      const double distance = (fit.motion.joints.at(f, j) - other->motion.joints.at(f, j)).norm();
      apart.push_back(std::isnan(distance) ? std::numeric_limits<double>::infinity() : distance);
    }
  }
  const double worst = apart.empty() ? 0.0 : *std::max_element(apart.begin(), apart.end());
  const double median = MeanMedian(apart);
  const double cost = std::abs(other->final_cost - fit.final_cost) / std::max(std::abs(fit.final_cost), 1e-9);
  const Apart most = matches == SolverMatches::kFixed ? Apart{1e-4, 1e-4, 1e-6} : Apart{1e-3, 5e-3, 1e-3};
  const bool differ =
      !(median <= most.median && worst <= most.worst && cost <= most.cost) || other->converged != fit.converged;
  json["differ"] = differ;
  json["joint_median_mm"] = std::round(1e9 * median) / 1e6;
  json["joint_worst_mm"] = std::round(1e9 * worst) / 1e6;
  json["cost_difference"] = cost;
  if (differ)
    report(1e3 * worst, "ends " + RoundedText(1e3 * median, 3) + " mm away in the median joint, " +
                            RoundedText(1e3 * worst, 3) + " mm in the worst, with a cost " + RoundedText(cost, 3) +
                            " apart: " + other->termination + "; " + fit.termination + " here");
  return json;
}

}  // namespace mocurate
