#include "job/verbs/dose_response.h"

#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/motion/operations.h"
#include "core/quality/padding.h"
#include "core/store/store.h"
#include "eval/dose/dose_table.h"
#include "eval/protocols/draws.h"
#include "report/charts.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

Status AddSeries(const DoseSeries& series, const Dataset& real, const std::vector<int>& rows, DamagedValues values,
                 std::uint64_t seed, const fs::path& folder, std::vector<ScoredSet>& sets) {
  for (const double dose : series.doses) {
    const std::string name = DoseRowName(series.damage, dose);
    const Dataset damaged = DamagedDataset(real, rows, series.damage, dose, values, seed);
    const fs::path file = folder / (name + ".h5");
    if (Status written = WriteDataset(damaged, file); !written) return written;
    sets.push_back({name, {"motions", name, file, ""}, std::nullopt});
  }
  return {};
}

std::string TitleOf(const nlohmann::json& result) {
  return "Dose response of metrics: " + result.at("protocol").get<std::string>() + ", variant " +
         result.at("variant").get<std::string>() + ", extractor " + result.at("extractor").get<std::string>();
}

}  // namespace

Status CheckDoseArguments(const EvalArguments& arguments) {
  if (!arguments.dose_response) {
    if (!arguments.doses.empty()) {
      return Fail(ErrorCode::kUsage, "--doses is given without --dose-response", "command line",
                  "add --dose-response DATASET");
    }
    if (!arguments.generated.empty()) return {};
    return Fail(ErrorCode::kUsage, "no motions to score", "command line",
                "give --generated PATH, or --dose-response DATASET to score damaged real motions");
  }
  const std::pair<bool, const char*> others[] = {{!arguments.generated.empty(), "--generated"},
                                                 {!arguments.labels.empty(), "--labels"},
                                                 {!arguments.source.empty(), "--source"},
                                                 {!arguments.values.empty(), "--values"},
                                                 {!arguments.bone_lengths.empty(), "--bone-lengths"},
                                                 {!arguments.real.empty(), "--real"}};
  for (const auto& [given, option] : others) {
    if (!given) continue;
    return Fail(ErrorCode::kUsage,
                std::string(option) + " is given with --dose-response, which scores damaged real motions",
                "command line", "remove it; --real-source and --real-labels apply to the motions of --dose-response");
  }
  if (arguments.damaged_real.empty() && arguments.run.empty()) {
    return Fail(ErrorCode::kUsage, "--dose-response names no motions", "command line",
                "give --dose-response DATASET, or --run RUN to use its dataset");
  }
  const auto doses = ParseDoses(arguments.doses);
  return doses ? Status() : Forward(doses);
}

Status NoMotionsToDamage(Error error) {
  if (error.code == ErrorCode::kNotFound) {
    error.hint = "run the stage assemble first, or name motions with --dose-response DATASET";
  }
  return tl::unexpected<Error>(error);
}

Expected<std::vector<DoseSeries>> AddDoseRows(const EvalArguments& arguments, const fs::path& folder,
                                              Evaluation& evaluation, std::vector<nlohmann::json>& warnings) {
  auto asked = ParseDoses(arguments.doses);
  if (!asked) return Forward(asked);
  auto real = ReadDataset(evaluation.real->motions.path);
  if (!real) return Forward(real);
  if (evaluation.real->padding == PaddingAction::kCut) {  // damaged zeros are no longer zeros
    for (Clip& clip : real->clips) {
      const int frames = FramesWithoutPadding(*clip.motion, false);
      if (frames == 0 || frames == clip.motion->frame_count()) continue;
      Expected<Clip> cut = Cut(clip, 0, frames);
      if (!cut) return Forward(cut);
      clip = std::move(*cut);
    }
  }
  const RealPart part = evaluation.test_reference ? RealPart::kTrain : evaluation.real_part;
  const auto rows = RowsOfPart(*real, part, evaluation.split);
  if (!rows) return Forward(rows);
  const bool rotations = evaluation.extractor.values == ExtractorValues::kRotation6DRows;
  const DamagedValues values = rotations ? DamagedValues::kRotations : DamagedValues::kJoints;
  if (Status made = MakeFolder(folder); !made) return Forward(made);
  if (Status added = AddSeries({asked->front().damage, {InfoOf(asked->front().damage).none}}, *real, *rows, values,
                               arguments.seed, folder, evaluation.rows);
      !added) {
    return Forward(added);
  }
  std::vector<Clip> damaged;
  for (const int row : *rows) damaged.push_back(real->clips[static_cast<std::size_t>(row)]);
  std::vector<DoseSeries> series;
  for (const DoseSeries& one : *asked) {
    if (const Status can = CheckDamage(damaged, one.damage, values); !can) {
      if (!arguments.doses.empty()) return Forward(can);
      warnings.push_back({{"code", "damage_skipped"}, {"row", ""}, {"message", can.error().Message()}});
      continue;
    }
    Status added = AddSeries(one, *real, *rows, values, arguments.seed, folder, evaluation.rows);
    if (!added) return Forward(added);
    series.push_back(one);
  }
  evaluation.extractor.generated_root = evaluation.extractor.real_root;
  evaluation.compare_rows = false;  // the square of the number of doses
  return series;
}

void AddDoseResponse(const std::vector<DoseSeries>& series, nlohmann::json& result) {
  result["dose_response"] = DoseTable(result.at("rows"), series);
  nlohmann::json kept = nlohmann::json::array();
  std::set<std::string> codes;
  for (const nlohmann::json& warning : result.at("warnings")) {
    const std::string code = warning.at("code").get<std::string>(), row = warning.at("row").get<std::string>();
    const bool of_dose = !row.empty() && row != "Real" && row != "Real-test";
    const bool known = code == "motions_are_the_real_ones" || code == "fewer_than_protocol" || code == "memorised";
    const bool first = codes.insert(code).second;
    if (known || (of_dose && !first)) continue;
    kept.push_back(warning);
  }
  result["warnings"] = std::move(kept);
}

std::string DoseResponseText(const std::vector<DoseSeries>& series, const nlohmann::json& result) {
  return DoseMarkdown(DoseTable(result.at("rows"), series), TitleOf(result));
}

Status WriteDoseResponse(const std::vector<DoseSeries>& series, const nlohmann::json& result, const fs::path& folder) {
  const nlohmann::json table = DoseTable(result.at("rows"), series);
  if (Status made = MakeFolder(folder / "tables"); !made) return made;
  const std::pair<fs::path, std::string> files[] = {
      {folder / "tables/dose_response.md", DoseMarkdown(table, TitleOf(result))},
      {folder / "tables/dose_response.csv", DoseCsv(table)},
      {folder / "tables/dose_response.json", table.dump(1) + "\n"},
      {folder / "dose_response.svg", ToSvg(DoseSheet(table, TitleOf(result)).Draw())}};
  for (const auto& [path, text] : files) {
    if (Status written = WriteFile(path, text); !written) return written;
  }
  return {};
}

}  // namespace mocurate
