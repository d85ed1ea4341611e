#include "ingest/item_facts.h"

#include <nlohmann/json.hpp>

namespace mocurate {
namespace {

constexpr const char* kItem = "item";

}  // namespace

void ItemFacts::Declare(OptionVisitor& v) {
  v.Integer("body", body, {}, "which of several people");
  v.Integer("entry", entry, {}, "index in the container");
  v.Text("entry_name", entry_name, "name in the container");
  v.Integer("most_frames", most_frames, {}, "maximum number of frames");
  v.Text("array", array, "clip in a file of arrays");
  v.Bool("labelled", labelled, "whether the label is not what the name tells");
  v.Text("label", label, "label of the clip");
  v.Text("label_text", label_text, "what the table of labels says");
  v.Text("annotation", annotation, "JSON of a BABEL sequence");
  v.Text("role", role, "role of the file of annotations");
  v.Text("known_issue", known_issue, "what a list says of the recording");
}

std::string ItemFacts::Place() const {
  if (!array.empty()) return array;
  const std::int64_t index = entry >= 0 ? entry : body - 1;
  return index >= 0 ? "[" + std::to_string(index) + "]" : "";
}

ItemFacts FactsOf(const ItemSpec& item) {
  if (!item.options.contains(kItem)) return {};
  return OptionsFromJson<ItemFacts>(item.options.at(kItem), kItem).value_or(ItemFacts());
}

void SetFacts(const ItemFacts& facts, ItemSpec& item) {
  static const nlohmann::json unset = OptionsToJson(ItemFacts());
  nlohmann::json said = OptionsToJson(facts);
  for (const auto& [name, value] : unset.items()) {
    if (said.at(name) == value) said.erase(name);
  }
  if (!said.empty()) item.options.Set(kItem, std::move(said));
}

Expected<ItemFacts> TakeFacts(nlohmann::json& options) {
  const auto said = options.find(kItem);
  if (said == options.end()) return ItemFacts();
  Expected<ItemFacts> facts = OptionsFromJson<ItemFacts>(*said, kItem);
  options.erase(kItem);
  return facts;
}

}  // namespace mocurate
