#include <nlohmann/json.hpp>

#include "canon/diff/dataset_diff.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "job/verbs/dataset_answers.h"

namespace mocurate {
namespace {

/// A difference as a line: "name: 12".
void PrintCount(const char* name, const nlohmann::json& list) { Print("%-12s %zu\n", name, list.size()); }

std::string ShownValue(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void PrintDiff(const nlohmann::json& diff) {
  constexpr std::size_t kMostLines = 20;
  Print("%-12s %d\n", "equal", diff.at("equal").get<int>());
  for (const char* kind : {"added", "removed", "relabelled", "refitted", "moved", "changed"}) {
    PrintCount(kind, diff.at(kind));
  }
  for (const nlohmann::json& one : diff.at("dataset")) {
    Print("dataset      %s: %s -> %s\n", one.at("field").get<std::string>().c_str(),
          ShownValue(one.at("before")).c_str(), ShownValue(one.at("after")).c_str());
  }
  for (const char* kind : {"splits_added", "splits_removed"}) {
    if (!diff.at(kind).empty()) PrintCount(kind, diff.at(kind));
  }
  std::size_t shown = 0;
  const auto show = [&](const std::string& line) {
    if (shown++ < kMostLines) Print("%s\n", line.c_str());
  };
  for (const nlohmann::json& clip : diff.at("added")) show("added       " + clip.get<std::string>());
  for (const nlohmann::json& clip : diff.at("removed")) show("removed     " + clip.get<std::string>());
  for (const nlohmann::json& one : diff.at("relabelled")) {
    show("relabelled  " + one.at("clip").get<std::string>() + ": " + one.at("before").get<std::string>() + " -> " +
         one.at("after").get<std::string>());
  }
  for (const nlohmann::json& one : diff.at("moved")) {
    show("moved       " + one.at("clip").get<std::string>() + ": " + one.at("before").get<std::string>() + " -> " +
         one.at("after").get<std::string>() + " of split " + one.at("split").get<std::string>());
  }
  for (const nlohmann::json& one : diff.at("changed")) {
    show("changed     " + one.at("clip").get<std::string>() + ": " + one.at("field").get<std::string>() + " " +
         one.at("before").get<std::string>() + " -> " + one.at("after").get<std::string>());
  }
  for (const nlohmann::json& one : diff.at("refitted")) {
    const int before = one.at("frames_before").get<int>(), after = one.at("frames_after").get<int>();
    std::string how =
        before == after ? "to another skeleton" : std::to_string(before) + " -> " + std::to_string(after) + " frames";
    if (one.at("joint_mm").is_number()) how = RoundedText(one.at("joint_mm").get<double>(), 3) + " mm";
    if (one.at("rotation_deg").is_number()) how += ", " + RoundedText(one.at("rotation_deg").get<double>(), 3) + " deg";
    show("refitted    " + one.at("clip").get<std::string>() + ": " + how);
  }
  if (shown > kMostLines) Print("and %zu more: --json lists all\n", shown - kMostLines);
}

}  // namespace

Status DatasetDiffVerb(CommonArguments& common, const DatasetArguments& arguments) {
  const auto diff = DiffDatasets(arguments.path, arguments.other);
  if (!diff) return Forward(diff);
  if (common.json) {
    common.answered = true;
    PrintJson(*diff);
  } else {
    PrintDiff(*diff);
  }
  return {};
}

}  // namespace mocurate
