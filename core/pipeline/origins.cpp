#include "core/pipeline/origins.h"

#include "core/pipeline/wire.h"

namespace mocurate {

void Origins::Add(const StageDeclaration& stage, const ItemSpec& spec, const std::filesystem::path& artifact) {
  if (stages_.empty() || stages_.back().name != stage.name) stages_.push_back(stage);
  const std::string& options = *options_.insert(CanonicalText(spec.options)).first;
  known_[artifact.native()] = {stages_.size() - 1, spec.item, &options, spec.inputs};
}

std::optional<Origins::Origin> Origins::Of(const std::filesystem::path& artifact) const {
  const auto found = known_.find(artifact.native());
  if (found == known_.end()) return std::nullopt;
  const Known& known = found->second;
  const Expected<nlohmann::json> options = FromCanonicalText(*known.options);
  if (!options) return std::nullopt;
  return Origin{stages_[known.stage], {known.item, *options, known.inputs}};
}

}  // namespace mocurate
