#include "fitting/uncertainty/given_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/motion/operations.h"

namespace mocurate {

void AddGivenUncertainty(const Motion& given, Motion& fitted) {
  const std::vector<int> match = MatchJoints(*given.skeleton, *fitted.skeleton);
  std::vector<int> nearest = match;
  for (int j = 1; j < fitted.joint_count(); ++j) {
    if (nearest[j] < 0) nearest[j] = nearest[fitted.skeleton->joints[j].parent];
  }
  for (int f = 0; f < fitted.frame_count(); ++f) {
    for (int j = 0; j < fitted.joint_count(); ++j) {
      if (nearest[j] < 0) continue;
      const std::size_t from = static_cast<std::size_t>(f) * given.joint_count() + nearest[j];
      const std::size_t to = static_cast<std::size_t>(f) * fitted.joint_count() + j;
      if (!given.position_cov.empty() && !fitted.position_cov.empty()) {
        for (std::size_t i = 0; i < 6; ++i) fitted.position_cov[6 * to + i] += given.position_cov[6 * from + i];
      }
      if (match[j] < 0) continue;
      if (!given.rotation_sigma.empty() && !fitted.rotation_sigma.empty()) {
        for (std::size_t i = 0; i < 3; ++i) {
          float& sigma = fitted.rotation_sigma[3 * to + i];
          sigma = std::hypot(sigma, given.rotation_sigma[3 * from + i]);
        }
      }
      if (!given.state.empty() && !fitted.state.empty()) {
        fitted.state[to] = std::max(fitted.state[to], given.state[from]);
      }
    }
  }
}

}  // namespace mocurate
