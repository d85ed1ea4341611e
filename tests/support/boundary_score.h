// Scores found boundaries of segments against true ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/median.h"

namespace mocurate {

/// Pairs and sum of distances of the first i found and j true times.
struct MatchState {
  int pairs = 0;
  double distance = 0.0;

  bool BetterThan(const MatchState& other) const {
    return pairs != other.pairs ? pairs > other.pairs : distance < other.distance;
  }
};

/// Pairs (index of found, index of truth) of two sorted lists of times, seconds: as many as possible that lie within
/// `tolerance_s` of each other, each time in one pair at most, both indices increasing; of the largest sets of pairs
/// the one with the least sum of distances.
inline std::vector<std::pair<int, int>> MatchBoundaries(const std::vector<double>& found_s,
                                                        const std::vector<double>& truth_s, double tolerance_s) {
  // Pairs of sorted lists need not cross, so that an alignment by dynamic programming is optimal.
  const std::size_t rows = found_s.size(), columns = truth_s.size();
  std::vector<MatchState> best((rows + 1) * (columns + 1));
  const auto at = [&](std::size_t i, std::size_t j) -> MatchState& { return best[i * (columns + 1) + j]; };
  const auto distance = [&](std::size_t i, std::size_t j) { return std::abs(found_s[i - 1] - truth_s[j - 1]); };
  const auto paired = [&](std::size_t i, std::size_t j) {
    const MatchState& before = at(i - 1, j - 1);
    return MatchState{before.pairs + 1, before.distance + distance(i, j)};
  };
  for (std::size_t i = 1; i <= rows; ++i) {
    for (std::size_t j = 1; j <= columns; ++j) {
      MatchState state = at(i - 1, j).BetterThan(at(i, j - 1)) ? at(i - 1, j) : at(i, j - 1);
      if (distance(i, j) <= tolerance_s && paired(i, j).BetterThan(state)) state = paired(i, j);
      at(i, j) = state;
    }
  }
  std::vector<std::pair<int, int>> pairs;
  std::size_t i = rows, j = columns;
  while (i > 0 && j > 0) {
    if (!at(i, j).BetterThan(at(i - 1, j))) {
      --i;
    } else if (!at(i, j).BetterThan(at(i, j - 1))) {
      --j;
    } else {
      pairs.emplace_back(static_cast<int>(--i), static_cast<int>(--j));
    }
  }
  std::reverse(pairs.begin(), pairs.end());
  return pairs;
}

/// How well found boundaries agree with true ones. Sums over recordings are those of the counts and errors.
struct BoundaryScore {
  int found = 0;
  int truth = 0;
  std::vector<double> error_s;  ///< distance of each matched pair

  int matched() const { return static_cast<int>(error_s.size()); }
  /// 1 where nothing was found.
  double precision() const { return found == 0 ? 1.0 : static_cast<double>(matched()) / found; }
  /// 1 where there is nothing to find.
  double recall() const { return truth == 0 ? 1.0 : static_cast<double>(matched()) / truth; }
  /// 1 where both lists are empty.
  double f1() const { return found + truth == 0 ? 1.0 : 2.0 * matched() / (found + truth); }
  /// Of the matched; 0 of none.
  double median_s() const { return Median(error_s); }
  void Add(const BoundaryScore& other) {
    found += other.found;
    truth += other.truth;
    error_s.insert(error_s.end(), other.error_s.begin(), other.error_s.end());
  }
};

/// Score of MatchBoundaries. Lists in any order.
inline BoundaryScore ScoreBoundaries(std::vector<double> found_s, std::vector<double> truth_s, double tolerance_s) {
  std::sort(found_s.begin(), found_s.end());
  std::sort(truth_s.begin(), truth_s.end());
  BoundaryScore score;
  score.found = static_cast<int>(found_s.size());
  score.truth = static_cast<int>(truth_s.size());
  for (const auto& [i, j] : MatchBoundaries(found_s, truth_s, tolerance_s)) {
    score.error_s.push_back(std::abs(found_s[static_cast<std::size_t>(i)] - truth_s[static_cast<std::size_t>(j)]));
  }
  return score;
}

}  // namespace mocurate
