#pragma once

#include <Eigen/Core>
#include <vector>

namespace mocurate {

/// Counts (C, C): rows are true classes, columns predicted ones.
Eigen::MatrixXi ConfusionMatrix(const std::vector<int>& truth, const std::vector<int>& predicted, int classes);

/// Share of the trace; 0 for an empty matrix. [a2m_actor.md D.4]
double Accuracy(const Eigen::MatrixXi& confusion);

}  // namespace mocurate
