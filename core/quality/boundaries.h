#pragma once

#include <utility>
#include <vector>

namespace mocurate {

/// Pairs (index of found, index of truth) of two sorted lists of times, seconds: as many as possible that lie within
/// `tolerance_s` of each other, each time in one pair at most, both indices increasing; of the largest sets of pairs
/// the one with the least sum of distances.
std::vector<std::pair<int, int>> MatchBoundaries(const std::vector<double>& found_s, const std::vector<double>& truth_s,
                                                 double tolerance_s);

/// How well found boundaries agree with true ones. Sums over recordings are those of the counts and errors.
struct BoundaryScore {
  int found = 0;
  int truth = 0;
  std::vector<double> error_s;  ///< distance of each matched pair

  int matched() const { return static_cast<int>(error_s.size()); }
  double precision() const;  ///< 1 where nothing was found
  double recall() const;     ///< 1 where there is nothing to find
  double f1() const;         ///< 1 where both lists are empty
  double median_s() const;   ///< of the matched; 0 of none
  void Add(const BoundaryScore& other);
};

/// Score of MatchBoundaries. Lists in any order.
BoundaryScore ScoreBoundaries(std::vector<double> found_s, std::vector<double> truth_s, double tolerance_s);

}  // namespace mocurate
