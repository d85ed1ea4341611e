#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "eval/protocols/score.h"
#include "eval/stages.h"

namespace mocurate {
namespace {

/// The features of the input with that role; nothing when there is none.
Expected<std::optional<FeatureSet>> FeaturesOf(const StageRequest& request, const std::string& role) {
  const auto input = std::find_if(request.inputs.begin(), request.inputs.end(),
                                  [&](const StageInput& candidate) { return candidate.role == role; });
  if (input == request.inputs.end()) return std::optional<FeatureSet>();
  auto set = ReadFeatures(input->path);
  if (!set) return Forward(set);
  return std::optional<FeatureSet>(std::move(*set));
}

const FeatureSet* Pointer(const std::optional<FeatureSet>& set) { return set ? &*set : nullptr; }

Expected<StageOutcome> Written(const nlohmann::json& json, const StageRequest& request) {
  if (Status written = WriteFile(request.output, json.dump(1) + "\n"); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = json;
  return outcome;
}

}  // namespace

Expected<StageOutcome> ScoreStage(const StageRequest& request) {
  const auto options = OptionsFromJson<ScoreOptions>(request.options, "score");
  if (!options) return Forward(options);
  const auto row = FeaturesOf(request, "row");
  if (!row) return Forward(row);
  if (!*row) return Fail(ErrorCode::kInternal, "the stage score needs the role 'row'", request.item);
  const auto train = FeaturesOf(request, "reference_train");
  if (!train) return Forward(train);
  const auto test = FeaturesOf(request, "reference_test");
  if (!test) return Forward(test);
  const auto json = ScoreRow(*options, **row, {Pointer(*train), Pointer(*test)});
  if (!json) return Forward(json);
  return Written(*json, request);
}

Expected<StageOutcome> CompareStage(const StageRequest& request) {
  const auto options = OptionsFromJson<ScoreOptions>(request.options, "compare");
  if (!options) return Forward(options);
  const auto a = FeaturesOf(request, "a");
  if (!a) return Forward(a);
  const auto b = FeaturesOf(request, "b");
  if (!b) return Forward(b);
  const auto reference = FeaturesOf(request, "reference_train");
  if (!reference) return Forward(reference);
  if (!*a || !*b || !*reference) {
    return Fail(ErrorCode::kInternal, "the stage compare needs the roles 'a', 'b' and 'reference_train'", request.item);
  }
  const auto json = CompareRows(*options, **a, **b, **reference);
  if (!json) return Forward(json);
  return Written(*json, request);
}

}  // namespace mocurate
