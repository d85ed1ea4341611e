#include "eval/metrics/accuracy.h"

#include <algorithm>
#include <numeric>

#include "core/base/text.h"

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

EquivalentClasses EquivalentOf(const std::map<std::string, std::string>& table, const std::vector<std::string>& classes,
                               std::set<std::string>& unknown) {
  EquivalentClasses equivalent;
  if (table.empty()) return equivalent;
  equivalent.resize(classes.size());
  const auto at = [&](const std::string& name) {
    const auto found = std::find(classes.begin(), classes.end(), name);
    return found == classes.end() ? -1 : static_cast<int>(found - classes.begin());
  };
  for (const auto& [truth, accepted] : table) {
    if (at(truth) < 0) {
      unknown.insert(truth);
      continue;
    }
    for (const std::string_view part : SplitText(accepted, ',')) {
      const std::string name(Trim(part));
      if (at(name) >= 0) {
        equivalent[static_cast<std::size_t>(at(truth))].push_back(at(name));
      } else {
        unknown.insert(name);
      }
    }
  }
  return equivalent;
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
