#include "job/published_recogniser.h"

#include <nlohmann/json.hpp>

#include "job/protocols.h"

namespace mocurate {

Status AddPublishedRecogniser(const std::string& protocol_name, const ConfigRules& rules, Evaluation evaluation,
                              StageRuns& runs, nlohmann::json& metrics) {
  if (protocol_name.empty()) return {};
  const auto protocol = LoadProtocol(protocol_name, {}, rules);
  if (!protocol) return Forward(protocol);
  const auto extractor = LoadExtractor(protocol->extractor, {}, rules);
  if (!extractor) return Forward(extractor);
  const auto note = [&](const std::string& why) {
    metrics["own_notes"].push_back("No column by the published recogniser " + extractor->name + ": " + why + ".");
  };
  const auto weights = FindWeights(*extractor);
  if (!weights) {
    note(weights.error().what);
    return {};
  }
  evaluation.extractor = *extractor;
  evaluation.extractor.weights.clear();  // a path; the key contains the file's content
  evaluation.weights = {"weights", weights->filename().string(), *weights, ""};
  evaluation.branch = "published/";
  evaluation.compare_rows = false;
  const auto evaluated = Evaluate(evaluation, runs);
  if (!evaluated) return Forward(evaluated);
  if (!evaluated->failed.empty()) note(evaluated->failed.begin()->second.what);
  for (nlohmann::json& row : metrics["rows"]) {
    for (const nlohmann::json& other : evaluated->rows) {
      if (other.at("name") != row.at("name")) continue;
      for (const char* metric : {"FID_train", "FID_test", "FID_equal", "accuracy", "diversity", "multimodality"}) {
        row["metrics"][std::string(metric) + "_published"] = other.at("metrics").at(metric);
      }
    }
  }
  return {};
}

}  // namespace mocurate
