#include "eval/metrics/accuracy.h"

#include <algorithm>
#include <numeric>

namespace mocurate {

Eigen::MatrixXi ConfusionMatrix(const std::vector<int>& truth, const std::vector<int>& predicted, int classes) {
  Eigen::MatrixXi confusion = Eigen::MatrixXi::Zero(classes, classes);
  for (std::size_t i = 0; i < truth.size() && i < predicted.size(); ++i) {
    if (truth[i] >= 0) ++confusion(truth[i], predicted[i]);
  }
  return confusion;
}

int LargestLogit(const float* logits, int classes) {
  return static_cast<int>(std::max_element(logits, logits + classes) - logits);
}

double AcceptedShare(const std::vector<int>& truth, const float* logits, int classes, int top,
                     const EquivalentClasses& equivalent) {
  std::vector<int> order(static_cast<std::size_t>(classes));
  const auto asked = order.begin() + std::min(top, classes);
  long long accepted = 0, all = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i] < 0) continue;
    ++all;
    const float* row = logits + i * static_cast<std::size_t>(classes);
    std::iota(order.begin(), order.end(), 0);
    std::partial_sort(order.begin(), asked, order.end(),
                      [&](int a, int b) { return row[a] != row[b] ? row[a] > row[b] : a < b; });
    const auto right = [&](int predicted) {
      const std::vector<int>* list = equivalent.empty() ? nullptr : &equivalent[static_cast<std::size_t>(truth[i])];
      if (list == nullptr || list->empty()) return predicted == truth[i];
      return std::find(list->begin(), list->end(), predicted) != list->end();
    };
    accepted += std::any_of(order.begin(), asked, right) ? 1 : 0;
  }
  return all == 0 ? 0.0 : static_cast<double>(accepted) / static_cast<double>(all);
}

}  // namespace mocurate
