#include "core/pipeline/origins.h"

#include "core/pipeline/wire.h"

namespace mocurate {

void Origins::Add(const StageDeclaration& stage, const ItemSpec& spec, const std::filesystem::path& artifact) {
  if (stages_.empty() || stages_.back().name != stage.name) stages_.push_back(stage);
  known_[artifact.filename().native()] = {stages_.size() - 1, spec.item, spec.options, Packed(ToJson(spec.inputs))};
}

std::optional<Origins::Origin> Origins::Of(const std::filesystem::path& artifact) const {
  const auto found = known_.find(artifact.filename().native());
  if (found == known_.end()) return std::nullopt;
  const Known& known = found->second;
  Expected<std::vector<StageInput>> inputs = InputsFromJson(nlohmann::json::from_cbor(known.inputs));
  if (!inputs) return std::nullopt;
  return Origin{stages_[known.stage], {known.item, known.options, *std::move(inputs)}};
}

}  // namespace mocurate
