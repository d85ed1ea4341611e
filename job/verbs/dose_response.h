#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "eval/dose/damages.h"
#include "job/evaluation.h"
#include "job/verbs/verbs.h"

namespace mocurate {

/// Checks that the options of a dose response fit each other and the other options. Error kUsage.
Status CheckDoseArguments(const EvalArguments& arguments);

/// The error of unreadable real motions, with a hint for a dose response.
Status NoMotionsToDamage(Error error);

/// Turns `evaluation`, whose real motions are read, into one of damaged copies of them: a row for the undamaged motions
/// and one for each dose, whose motions are written to `folder`/ROW.h5. Reference are the real motions of the protocol
/// (test_reference: their training part, whose copies are damaged as well). All rows use the reference's joints.
/// Damages that do not apply to the set or the extractor are skipped with a warning, unless --doses names them. Errors:
/// of ParseDoses; kInconsistent, kUnsupported of CheckDamage; kCannotWrite.
Expected<std::vector<DoseSeries>> AddDoseRows(const EvalArguments& arguments, const std::filesystem::path& folder,
                                              Evaluation& evaluation, std::vector<nlohmann::json>& warnings);

/// Adds "dose_response" (as of DoseTable) to the result of that evaluation. Of equal warnings of several rows the first
/// is kept; warnings that damaged copies cause by design are removed.
void AddDoseResponse(const std::vector<DoseSeries>& series, nlohmann::json& result);

/// Text for the terminal, instead of the table of rows.
std::string DoseResponseText(const std::vector<DoseSeries>& series, const nlohmann::json& result);

/// tables/dose_response.{md,csv,json} and dose_response.svg below `folder`. Error kCannotWrite.
Status WriteDoseResponse(const std::vector<DoseSeries>& series, const nlohmann::json& result,
                         const std::filesystem::path& folder);

}  // namespace mocurate
