#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "job/run_file.h"
#include "job/verbs/verbs.h"

namespace mocurate {

/// The job of a paper's item by its id ("actor/table3"), in a profile ("": the job's own). Error kUsage with the
/// nearest id for an unknown one; those of LoadJob.
Expected<LoadedJob> LoadPaperItem(const std::string& id, const std::string& profile,
                                  const std::vector<std::string>& assignments);

/// Sets the paths of a job's sets from "NAME=PATH" of --data. Error kUsage for an unknown set.
Status TakeData(const std::vector<std::string>& given, JobOptions& options);

/// Requirements of an item, for lists: {"id", "kind", "shows", "at_hand": [names], "missing": [{"name", "how"}],
/// "profiles": {"smoke": hours, ...}}, hours null where they were not measured.
nlohmann::json DescribePaperItem(const std::string& id, const JobOptions& options);

/// Rows of motions published by the authors, for a set of a job: as of ScoreRow, with "profile": "released". Rows with
/// missing files are skipped, and one that cannot be scored with a warning. Error kInterrupted.
Expected<nlohmann::json> ReleasedRows(const ReproduceOptions& item, const std::string& set,
                                      const std::filesystem::path& folder, const CommonArguments& common);

/// The run that pictures are made from.
struct ReproducedRun {
  std::filesystem::path folder;
  const CommonArguments& common;
  const SetsOfRun& sets;
  const std::vector<StaleOutput>& stale;  ///< outputs of the folder that are not used
};

/// Pictures, and rows or surveys that could not be made.
struct PaperPictures {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> lost;  ///< missing parts, each with a warning
};

/// The pictures of a paper's item from the networks and datasets of its run: motions/NAME_ROW.h5, pictures/NAME.svg,
/// .png and .json, pictures/curves.* of rows that are points of a curve, survey/KIND/ of its studies. Overwrites files
/// of these names. Errors kInterrupted, kCannotWrite.
Expected<PaperPictures> MakePaperPictures(const JobOptions& options, const ReproducedRun& run);

/// A motion of a set that ends bent down, placed by each rule (MultiAct, section 3.2): files of sets with one motion
/// for each panel (label) that shows it.
struct PlacedMotions {
  std::vector<std::pair<std::string, std::filesystem::path>> sets;  ///< by name
  std::vector<std::string> labels;                                  ///< of the panels
  std::map<std::string, std::string> colours;                       ///< of the sets
};

/// The previous motion of the sample whose trunk is bent most, cut at that frame: as in its source, with its last frame
/// facing the front, and with that frame's root rotation undone. Files beside `file`. Error kInconsistent for a set
/// without samples of two actions or rotations.
Expected<PlacedMotions> PlacedByEachRule(const std::filesystem::path& dataset, const std::filesystem::path& file);

/// Reduction of a job's training to a time budget.
struct TimeBudget {
  double factor = 1.0;                 ///< of the iterations of generators
  std::int64_t recogniser_epochs = 0;  ///< of recognisers at most; 0: as the job says
};

/// Makes the datasets in a temporary folder, measures a few steps of each network, and distributes `seconds`:
/// recognisers get at most half of the training time, generators the rest, each for the same share of its iterations,
/// at least one step. The result is saved as time_budget.json in `folder` and read when the same run continues. Error
/// kUsage where one step of each network does not fit; those of the stages.
Expected<TimeBudget> MakeTimeBudget(double seconds, const JobOptions& options, const RunnerOptions& settings,
                                    const std::filesystem::path& folder);

}  // namespace mocurate
