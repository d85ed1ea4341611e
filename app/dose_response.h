#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/evaluation.h"
#include "app/verbs.h"
#include "eval/dose/damages.h"

namespace mocurate {

/// Whether the options of a dose response, and those beside them, go together. Error kUsage.
Status CheckDoseArguments(const EvalArguments& arguments);

/// Why the real motions could not be read, with the way out of a dose response.
Status NoMotionsToDamage(Error error);

/// Makes `evaluation`, whose real motions are read, one of damaged copies of them: a row for the undamaged motions and
/// one for each dose, whose motions are written to `folder`/ROW.h5. Reference are the real motions as the protocol says
/// (test_reference: their training part, of which the damaged ones are copies as well); joints of all rows are counted
/// as those of the reference. Damages that the set or the extractor cannot have are left out with a warning, unless
/// --doses names them. Errors: of ParseDoses; kInconsistent, kUnsupported of CheckDamage; kCannotWrite.
Expected<std::vector<DoseSeries>> AddDoseRows(const EvalArguments& arguments, const std::filesystem::path& folder,
                                              Evaluation& evaluation, std::vector<nlohmann::json>& warnings);

/// Puts "dose_response" (as of DoseJson) into the result of that evaluation. Of what was warned of several rows the
/// first is kept, and nothing of what damaged copies of real motions are by design.
void AddDoseResponse(const std::vector<DoseSeries>& series, nlohmann::json& result);

/// What the terminal shows instead of the table of rows.
std::string DoseResponseText(const std::vector<DoseSeries>& series, const nlohmann::json& result);

/// tables/dose_response.{md,csv,json} and dose_response.svg below `folder`. Error kCannotWrite.
Status WriteDoseResponse(const std::vector<DoseSeries>& series, const nlohmann::json& result,
                         const std::filesystem::path& folder);

}  // namespace mocurate
