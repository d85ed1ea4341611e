#include "core/pipeline/origins.h"

#include "core/pipeline/wire.h"

namespace mocurate {

void Origins::Add(const StageDeclaration& stage, const ItemSpec& spec, const std::filesystem::path& artifact) {
  if (stages_.empty() || stages_.back().name != stage.name) stages_.push_back(stage);
  Known& known = known_[artifact.filename().native()];
  known = {stages_.size() - 1, spec.item, spec.options, {}};
  known.inputs.reserve(spec.inputs.size());
  for (const StageInput& input : spec.inputs) known.inputs.push_back(Packed(ToJson(std::vector<StageInput>{input})));
}

std::optional<Origins::Origin> Origins::Of(const std::filesystem::path& artifact) const {
  const auto found = known_.find(artifact.filename().native());
  if (found == known_.end()) return std::nullopt;
  const Known& known = found->second;
  Origin origin{stages_[known.stage], {known.item, known.options, {}}};
  for (const std::vector<std::uint8_t>& packed : known.inputs) {
    Expected<std::vector<StageInput>> input = InputsFromJson(nlohmann::json::from_cbor(packed));
    if (!input) return std::nullopt;
    origin.spec.inputs.push_back(std::move(input->front()));
  }
  return origin;
}

}  // namespace mocurate
