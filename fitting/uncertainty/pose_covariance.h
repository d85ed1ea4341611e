#pragma once

#include <Eigen/Core>
#include <vector>

namespace mocurate {

/// Covariances of the poses of a fit, one per frame: of the root's translation (m, world), then of each active joint's
/// rotation (rad, in the joint's frame: Log(R^T R')). As solved: neither scaled nor calibrated (PoseUncertainty).
struct PoseCovariances {
  std::vector<int> column;             ///< (J) first number of a joint's rotation; -1: none
  std::vector<Eigen::MatrixXd> frame;  ///< (F) n x n
  std::vector<double> rest_sigma;      ///< (J) rad, of the rest pose that they count as known

  bool empty() const { return frame.empty(); }
};

}  // namespace mocurate
