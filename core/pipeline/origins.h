#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"

namespace mocurate {

/// How the artifacts of one runner were made, so that a damaged one can be made again. Options that items of a stage
/// share are stored once.
class Origins {
 public:
  struct Origin {
    StageDeclaration stage;
    ItemSpec spec;
  };
  void Add(const StageDeclaration& stage, const ItemSpec& spec, const std::filesystem::path& artifact);
  /// Empty for an artifact that this runner does not know.
  std::optional<Origin> Of(const std::filesystem::path& artifact) const;

 private:
  struct Known {
    std::size_t stage = 0;  ///< in stages_
    std::string item;
    const std::string* options = nullptr;  ///< canonical text, in options_
    std::vector<StageInput> inputs;
  };
  std::vector<StageDeclaration> stages_;
  std::set<std::string> options_;
  std::map<std::string, Known> known_;  ///< by path
};

}  // namespace mocurate
