#include "core/pipeline/origins.h"

namespace mocurate {

void Origins::Add(const StageDeclaration& stage, const ItemSpec& spec, const std::filesystem::path& artifact) {
  if (stages_.empty() || stages_.back().name != stage.name) stages_.push_back(stage);
  known_[artifact.native()] = {stages_.size() - 1, spec};
}

std::optional<Origins::Origin> Origins::Of(const std::filesystem::path& artifact) const {
  const auto found = known_.find(artifact.native());
  if (found == known_.end()) return std::nullopt;
  return Origin{stages_[found->second.stage], found->second.spec};
}

}  // namespace mocurate
