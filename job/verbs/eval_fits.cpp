#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "eval/stages.h"
#include "eval/tables/table.h"
#include "job/job_items.h"
#include "job/run_file.h"
#include "job/run_folder.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// The dataset of a run folder, or the path itself. Errors of CheckIsDataset; kInconsistent: of an earlier run.
Expected<fs::path> FileOfFits(const fs::path& path) {
  std::error_code unknown;
  const bool run = fs::is_directory(path, unknown);
  const fs::path file = run ? path / "dataset.h5" : path;
  if (run && IsStale(StaleOutputs(path), "dataset.h5")) {
    return Fail(ErrorCode::kInconsistent, "the dataset is of an earlier run of the folder", DisplayPath(file),
                "run the stage assemble, or give --fits DATASET");
  }
  if (Status sound = CheckIsDataset(file); !sound) return Forward(sound);
  return file;
}

Table::Cell NumberCellOf(const nlohmann::json& measures, const char* key, double factor) {
  Table::Cell cell;
  const auto number = measures.find(key);
  if (number != measures.end() && number->is_number()) cell.value = factor * number->get<double>();
  return cell;
}

/// Measures of a row: positions of each group, then rotations of each group.
Table SigmaTable(const nlohmann::json& row) {
  constexpr std::tuple<const char*, const char*, double, int> kColumns[] = {
      {"samples", "samples", 1.0, 0},
      {"within 1 sigma, %", "within_one_sigma", 100.0, 1},
      {"within 2 sigma, %", "within_two_sigma", 100.0, 1},
      {"ECE", "ece", 1.0, 3},
      {"Spearman", "spearman", 1.0, 2},
      {"AURC, mm", "aurc_mm", 1.0, 1},
      {"ideal AURC, mm", "ideal_aurc_mm", 1.0, 1},
      {"AUC", "auc", 1.0, 2}};
  const nlohmann::json& sigma = row.at("sigma");
  Table table;
  table.title = row.at("name").get<std::string>() + ": joints " + RoundedText(row.at("joint_mm").get<double>(), 3) +
                " mm, rotations " + RoundedText(row.at("rotation_deg").get<double>(), 3) + " degrees off, " +
                Counted(row.at("clips").get<long long>(), "clip") + ", " +
                Counted(row.at("frames").get<long long>(), "frame");
  table.first = "group";
  for (const auto& [title, key, factor, digits] : kColumns) {
    table.columns.emplace_back(title);
    table.digits.push_back(digits);
  }
  for (const char* part : {"positions", "rotations"}) {
    for (const auto& [group, name] : {std::pair("all", "all"),
                                      {"trunk", "trunk"},
                                      {"head", "head"},
                                      {"arms", "arms"},
                                      {"legs", "legs"},
                                      {"not_observed", "not observed"}}) {
      Table::Row line{std::string(part) + ": " + name, {}, "", false};
      const nlohmann::json& measures = sigma.at("groups").at(group).at(part);
      for (const auto& [title, key, factor, digits] : kColumns)
        line.cells.push_back(NumberCellOf(measures, key, factor));
      table.rows.push_back(std::move(line));
    }
  }
  table.notes = {"AUC: area under the ROC curve for errors above " +
                 RoundedText(sigma.at("large_error_mm").get<double>(), 3) +
                 " mm. docs/uncertainty.md explains the columns."};
  return table;
}

/// Adds what the row's figures leave out to `warnings`. Returns the number of clips that could not be compared.
long long AddWarnings(const nlohmann::json& row, nlohmann::json& warnings) {
  const auto warn = [&](const std::string& code, const std::string& message) {
    warnings.push_back({{"code", code}, {"row", row.at("name")}, {"message", message}});
  };
  for (const nlohmann::json& warning : row.at("sigma").at("warnings"))
    warn(warning.at("code").get<std::string>(), warning.at("message").get<std::string>());
  const nlohmann::json& without = row.at("without_truth");
  if (!without.empty()) {
    warn("no_truth", Counted(static_cast<long long>(without.size()), "clip") +
                         " without a truth of the same id, not compared, e.g. '" + without.front().get<std::string>() +
                         "'");
  }
  long long failed = 0;
  for (const auto& [id, clip] : row.at("per_clip").items()) {
    if (!clip.contains("error")) continue;
    warn("not_compared", clip.at("error").get<std::string>());
    ++failed;
  }
  return failed;
}

}  // namespace

Status EvalFitsVerb(CommonArguments& common, const EvalArguments& arguments) {
  if (arguments.truth.empty()) {
    return Fail(ErrorCode::kUsage, "--fits is given without --truth", "command line",
                "add --truth FILE, the motions that the fits should be");
  }
  const auto truth = TruthInputs(arguments.truth);
  if (!truth) return Forward(truth);
  nlohmann::json result = {{"truth", DisplayPath(arguments.truth)},
                           {"rows", nlohmann::json::array()},
                           {"warnings", nlohmann::json::array()},
                           {"failed", nlohmann::json::object()}};
  std::optional<Error> first;
  const auto failed = [&](const NamedPath& set, Error error) {
    result["failed"][set.name] = error.Message();
    if (!first) first = std::move(error);
  };
  std::set<std::string> taken;
  std::vector<NamedPath> sets;  // of the items
  std::vector<ItemSpec> items;
  for (const std::string& text : arguments.fits) {
    NamedPath set = NamedRow(text, taken);
    const auto file = FileOfFits(set.path);
    if (!file) {
      failed(set, file.error());
      continue;
    }
    items.push_back({"fit_error/" + set.name, nlohmann::json::object(), *truth});
    items.back().inputs.push_back({"fit", set.name, *file, ""});
    sets.push_back(std::move(set));
  }
  if (items.empty()) return tl::unexpected<Error>(*first);
  if (!arguments.output.empty()) {
    if (Status plain = CheckRunFiles(arguments.output); !plain) return plain;
    if (Status made = MakeFolder(arguments.output); !made) return made;
  }
  auto stages = VerbStages::Make(common, arguments.jobs, arguments.output);
  if (!stages) return Forward(stages);
  const auto report = (*stages)->runs().Run(FitErrorDeclaration(), std::move(items));
  if (!report) return Forward(report);
  long long clips_failed = 0;
  for (std::size_t i = 0; i < report->items.size(); ++i) {
    const ItemResult& item = report->items[i];
    if (item.artifact.empty()) {
      Error error = item.outcome.error;
      error.where = DisplayPath(sets[i].path) + (error.where.empty() ? "" : ": " + error.where);
      failed(sets[i], std::move(error));
      continue;
    }
    auto row = ReadJson(item.artifact);
    if (!row) return Forward(row);
    (*row)["name"] = sets[i].name;
    (*row)["fits"] = DisplayPath(sets[i].path);
    clips_failed += AddWarnings(*row, result["warnings"]);
    result["rows"].push_back(*std::move(row));
  }
  if (result["rows"].empty()) return tl::unexpected<Error>(*first);
  if (!arguments.output.empty()) {
    if (Status written = WriteFile(arguments.output / "metrics.json", result.dump(1) + "\n"); !written) return written;
  }
  if (AnswersInText(common, result)) {
    for (const nlohmann::json& row : result["rows"]) Print("%s\n", ToMarkdown(SigmaTable(row)).c_str());
    for (const nlohmann::json& warning : result["warnings"])
      LogWarning(warning.at("row").get<std::string>() + ": " + warning.at("message").get<std::string>());
  }
  if (first) {
    first->what = Counted(static_cast<long long>(result["failed"].size()), "set") +
                  " could not be compared; the first: " + first->what;
    first->code = ErrorCode::kTooManyFailures;
    return tl::unexpected<Error>(*first);
  }
  if (clips_failed == 0) return {};
  return Fail(ErrorCode::kTooManyFailures, Counted(clips_failed, "clip") + " could not be compared with the truth",
              DisplayPath(arguments.truth), "see the warnings above; the figures are of the other clips");
}

}  // namespace mocurate
