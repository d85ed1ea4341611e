#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// Problems of one input, reported together: one is returned unchanged, several become one error with a line for each.
class ProblemList {
 public:
  void Add(std::string where, std::string what, std::string hint = {});
  bool empty() const { return problems_.empty(); }
  /// Done, or one error of code kConfig.
  Status Result() const;

 private:
  std::vector<Error> problems_;
};

/// "did you mean 'x'?", or the list of `known` when nothing is near and the list is short.
std::string HintFor(const std::string& word, const std::vector<std::string>& known);

}  // namespace mocurate
