#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// Problems of one input, reported together: one is returned unchanged, several become one error with a line for each.
/// The first 50 are kept, the others are counted.
class ProblemList {
 public:
  void Add(std::string where, std::string what, std::string hint = {});
  /// With a hint that takes time, such as the nearest name: it is asked for where the problem is kept.
  void Add(std::string where, std::string what, const std::function<std::string()>& hint);
  bool empty() const { return problems_.empty(); }
  /// Done, or one error of code kConfig.
  Status Result() const;

 private:
  std::vector<Error> problems_;
  std::size_t more_ = 0;
};

/// "did you mean 'x'?", or the list of `known` when nothing is near and the list is short.
std::string HintFor(const std::string& word, const std::vector<std::string>& known);

}  // namespace mocurate
