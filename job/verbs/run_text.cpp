#include "job/verbs/run_text.h"

#include "core/base/file.h"
#include "core/base/terminal.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

void PrintFigures(const JobResult& result) {
  if (result.audit.contains("nearest_neighbour") && result.audit["nearest_neighbour"].value("count", 0) > 0) {
    const nlohmann::json& neighbour = result.audit["nearest_neighbour"];
    Print("1-nearest-neighbour accuracy %.3f (%s)\n", neighbour.value("accuracy", 0.0),
          Counted(neighbour.value("count", 0), "test clip").c_str());
  }
  const nlohmann::json none = nlohmann::json::object();
  const nlohmann::json found = result.audit.is_object() ? result.audit.value("findings", none) : none;
  std::string codes;
  for (const auto& [code, count] : found.items()) {
    codes += (codes.empty() ? "" : ", ") + std::to_string(count.get<int>()) + " " + code;
  }
  if (!codes.empty()) {
    Print("audit: %s (mocurate audit %s lists them)\n", codes.c_str(), DisplayPath(result.dataset).c_str());
  }
  const nlohmann::json& recognisers =
      result.metrics.is_object() && result.metrics.contains("recognisers") ? result.metrics["recognisers"] : none;
  for (const auto& [name, recogniser] : recognisers.items()) {
    if (!recogniser.contains("mean") || !recogniser["mean"].is_number()) {
      Print("%-20s not scored: %s\n", name.c_str(), recogniser.value("scored", "").c_str());
      continue;
    }
    const auto seeds = static_cast<long long>(recogniser.value("test_accuracy", std::vector<double>()).size());
    Print("%-20s accuracy %.3f on %s, mean of %s\n", name.c_str(), recogniser.value("mean", 0.0),
          recogniser.value("scored", "").c_str(), Counted(seeds, "seed").c_str());
  }
  if (result.fit_error.is_object()) {
    const double evidence_mm = result.fit_error.value("evidence_mm", 0.0);
    Print("error against the truth: ");
    if (evidence_mm > 0.0) Print("joints %.1f mm in the evidence, ", evidence_mm);
    Print("joints %.1f mm after fitting, rotations %.1f degrees\n", result.fit_error.value("joint_mm", 0.0),
          result.fit_error.value("rotation_deg", 0.0));
    if (result.fit_error.contains("within_one_sigma")) {
      Print(
          "stated uncertainty: %.1f %% of errors within one standard deviation (68.3 is right), %.1f %% within two "
          "(95.4)\n",
          100.0 * result.fit_error.value("within_one_sigma", 0.0),
          100.0 * result.fit_error.value("within_two_sigma", 0.0));
    }
  }
}

}  // namespace

int Executed(const JobResult& result) {
  int count = 0;
  for (const StageCounts& stage : result.stages) count += static_cast<int>(stage.total) - stage.from_cache;
  return count;
}

void PrintResult(const JobResult& result, double seconds) {
  Print("%s, %.1f s\n", ClipsText(result.counts).c_str(), seconds);
  for (const auto& [code, count] : result.findings) {
    Print("%-26s %d of %s (listed in curation_log.jsonl)\n", code.c_str(), count,
          Counted(result.counts.clips, "clip").c_str());
  }
  PrintFigures(result);
  if (!result.table.empty()) Print("\n%s\n", result.table.c_str());
  if (!result.recognition.empty()) Print("\n%s\n", result.recognition.c_str());
  if (!result.dataset.empty()) {
    Print("dataset  %s  (%s)\n", DisplayPath(result.dataset).c_str(),
          Counted(static_cast<long long>(result.dataset_clips), "clip").c_str());
  }
  for (const auto& table : result.tables) Print("table    %s\n", DisplayPath(table).c_str());
  if (!result.report.empty()) Print("report   %s\n", DisplayPath(result.report).c_str());
}

void PrintPlan(const JobResult& result, JobStage last) {
  Print("dry run: nothing is run and nothing is written\n");
  for (const StageCounts& stage : result.stages) {
    if (stage.total == 0) continue;  // of inputs that do not exist yet
    const auto all = static_cast<int>(stage.total);
    Print("%-24s %s from the cache, %d would run\n", stage.title().c_str(), Counted(stage.from_cache, "item").c_str(),
          all - stage.from_cache);
  }
  const int count = Executed(result);
  if (count == 0) {
    Print("dry run: %s would run: every item is in the cache\n",
          last == JobStage::kReport ? "nothing before the report" : "nothing");
    return;
  }
  Print("dry run: %s would run, and the items that depend on %s up to the stage %s\n", Counted(count, "item").c_str(),
        count == 1 ? "it" : "them", Name(last));
}

}  // namespace mocurate
