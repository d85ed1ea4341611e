#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"

namespace mocurate {

/// How the artifacts of one runner were made, so that a damaged one can be made again.
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
    ItemOptions options;
    std::vector<std::vector<std::uint8_t>> inputs;  ///< each packed: a run holds 100,000 items of each stage
  };
  std::vector<StageDeclaration> stages_;
  std::map<std::string, Known> known_;  ///< by name of the artifact's file, which holds most of its key
};

}  // namespace mocurate
