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

Expected<IndexPairs> DrawMultimodalityPairs(const std::vector<int>& labels, const std::vector<std::string>& classes,
                                            int quota, Random& random) {
  std::vector<std::vector<int>> members(classes.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] < 0 || labels[i] >= static_cast<int>(classes.size())) {
      return Fail(ErrorCode::kInconsistent,
                  "label " + std::to_string(labels[i]) + " of motion " + std::to_string(i) + "; there are " +
                      std::to_string(classes.size()) + " classes",
                  "multimodality");
    }
    members[labels[i]].push_back(static_cast<int>(i));
  }
  IndexPairs drawn;
  drawn.reserve(classes.size() * quota);
  for (std::size_t c = 0; c < classes.size(); ++c) {
    if (members[c].empty()) {
      return Fail(ErrorCode::kInconsistent,
                  "class '" + classes[c] + "' has none of the " + std::to_string(labels.size()) + " motions drawn",
                  "multimodality", "every class needs at least one: raise evaluate.motions");
    }
    for (int i = 0; i < quota; ++i) {
      const int first = members[c][random.Below(members[c].size())];
      const int second = members[c][random.Below(members[c].size())];
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
