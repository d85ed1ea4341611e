#include "eval/metrics/accuracy.h"

namespace mocurate {

Eigen::MatrixXi ConfusionMatrix(const std::vector<int>& truth, const std::vector<int>& predicted, int classes) {
  Eigen::MatrixXi confusion = Eigen::MatrixXi::Zero(classes, classes);
  for (std::size_t i = 0; i < truth.size() && i < predicted.size(); ++i) ++confusion(truth[i], predicted[i]);
  return confusion;
}

double Accuracy(const Eigen::MatrixXi& confusion) {
  const int total = confusion.sum();
  return total == 0 ? 0.0 : static_cast<double>(confusion.trace()) / total;
}

}  // namespace mocurate
