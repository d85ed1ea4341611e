#include "eval/metrics/spread.h"

namespace mocurate {

IndexPairs DrawDiversityPairs(int motions, int pairs, Random& random) {
  IndexPairs drawn;
  drawn.reserve(pairs);
  for (int i = 0; i < pairs; ++i) {
    const int first = static_cast<int>(random.Below(motions));
    const int second = static_cast<int>(random.Below(motions));
    drawn.emplace_back(first, second);
  }
  return drawn;
}

IndexPairs DrawMultimodalityPairs(const std::vector<int>& labels, int classes, int quota, Random& random) {
  std::vector<std::vector<int>> members(static_cast<std::size_t>(classes));
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] >= 0 && labels[i] < classes)
      members[static_cast<std::size_t>(labels[i])].push_back(static_cast<int>(i));
  }
  IndexPairs drawn;
  for (const std::vector<int>& of_class : members) {
    for (int i = 0; !of_class.empty() && i < quota; ++i) {
      const int first = of_class[random.Below(of_class.size())];
      const int second = of_class[random.Below(of_class.size())];
      drawn.emplace_back(first, second);
    }
  }
  return drawn;
}

double MeanDistance(const Features& features, const IndexPairs& pairs) {
  if (pairs.empty()) return 0.0;
  double sum = 0.0;
  for (const auto& [first, second] : pairs) sum += (features.row(first) - features.row(second)).norm();
  return sum / static_cast<double>(pairs.size());
}

}  // namespace mocurate
