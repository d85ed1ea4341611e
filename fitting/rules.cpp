#include "fitting/rules.h"

#include <algorithm>

namespace mocurate {

const std::vector<std::string>& FittingRuleNames() {
  static const std::vector<std::string> names = {
      "body_errors",
      "uncertainty_calibration",
      "variance_factor",
      "least_variance_factor",
      "unmeasured_noise",
      "bone_noise",
      "process_noise_widening",
      "autocorrelated_error",
      "persistent_residuals",
      "gap_inflation",
      "ambiguous_rig_covariance",
      "low_coverage",
      "unknown_shape",
      "body_error_factor",
      "patch_share",
      "surface_weight",
      "variance_inflation",
      "ray_noise",
      "outlier_rejection",
      "body_sides",
      "reversed_body",
      "person_points",
      "restart_after_gap",
      "refit_poor_frames",
      "recover_lost_frames",
      "second_start",
      "shared_places",
      "clock_widening",
      "view_sides",
      "sides_throughout",
      "inconsistent_cameras",
      "person_shape",
      "wrong_depths",
      "common_fault",
      "far_move",
      "inconsistent_views",
  };
  return names;
}

void Rules::Declare(OptionVisitor& v) {
  const std::vector<std::string>& names = FittingRuleNames();
  std::vector<std::string> without;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (off_.test(i)) without.push_back(names[i]);
  }
  v.ChoiceList("without", without, names,
               "rules that are switched off, to measure what each contributes (docs/fitting_ablation.md)");
  off_.reset();
  for (const std::string& name : without) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) off_.set(static_cast<std::size_t>(found - names.begin()));
  }
}

}  // namespace mocurate
