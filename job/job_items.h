#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/pipeline/runner.h"
#include "job/job_options.h"

namespace mocurate {

struct JobResult;

/// A network of a run: its index in TrainOptions::networks, its row in tables, its checkpoint.
struct TrainedNetwork {
  std::size_t network = 0;
  std::string row;
  StageInput checkpoint;

  bool IsSample() const { return row.find('@') != std::string::npos; }  ///< of samples_at, on the way to its end
};

/// Results of one source clip, stage by stage.
struct ClipRecord {
  std::string item;
  std::vector<StageInput> depth;         ///< depth images that the evidence refers to
  ItemResult evidence;                   ///< stage ingest
  ItemResult motion;                     ///< stage fitting (or ingest, when nothing is fitted)
  ItemResult canonical;                  ///< stage canon
  ItemResult assembled;                  ///< stage assemble, of a clip that it excludes
  ItemResult baseline;                   ///< stage canon on the unfitted tracks
  std::string format;                    ///< of its file, as the source declares it
  bool rotations = false;                ///< its file holds rotations
  std::optional<double> joint_error_mm;  ///< mean distance of the fitted joints from the truth, where there is one

  std::string person() const { return evidence.summary.value("person", std::string()); }
  /// Item of the stage `proportions` with the clip's body.
  std::string body(BodyOf body_of) const;
  /// Whether it is in the dataset, up to the stages that have run.
  bool kept() const { return !canonical.artifact.empty() && HasArtifact(assembled.outcome.kind); }
  /// Result of the stage that ended it, by failure or by rule. Null for none.
  const ItemResult* ended() const;
  /// Name of that stage, or empty.
  std::string ended_at() const;
  bool failed() const { return ended() != nullptr && IsFailure(ended()->outcome.kind); }
  /// Whether it is not a clip but a folder whose files are outside the pattern.
  bool folder() const;
  /// Of its stages, each once: a motion that is passed through has those of the evidence.
  std::vector<Finding> findings() const;
  /// Whether it was processed with a finding of severity error.
  bool has_error_finding() const;
  /// Whether it was processed with such a finding, or its fit is suspect: large residual, mostly unobserved
  /// (fitting/fit_outcome.cpp).
  bool suspect() const;
  /// Whether fitted rotations replace recorded ones.
  bool replaces_rotations() const;
  bool excluded() const { return ended() != nullptr && !failed(); }
  /// The reason as a code: the rule (code of its finding), or the code that an inspection gives to such a file. Empty
  /// for none.
  std::string reason() const;
};

/// Codes of the stages' findings about a clip, each once, without those of severity info.
std::set<std::string> FindingCodes(const ClipRecord& clip);

/// Counts the clips and their findings, and separately the skipped folders.
void CountClips(const std::vector<ClipRecord>& clips, JobResult& result);

/// Why the first clip failed; without a failure, the rule that excluded the first one. With `branch` =
/// &ClipRecord::baseline the same for the raw tracks.
Error FirstReason(const std::vector<ClipRecord>& clips, ItemResult ClipRecord::*branch);

/// Finding with the reason why the raw tracks are not compared with the fits.
Finding ComparisonDropped(const std::string& why);

/// Logs files and folders that are not items: one line for each reason, with their number. A skipped folder is logged
/// as information, since many data sets contain some.
void LogExcluded(const std::vector<ItemResult>& files);

/// The clips after the stage `ingest`: of its items, and of excluded files.
std::vector<ClipRecord> RecordsOf(const std::vector<ItemSpec>& specs, std::vector<ItemResult> ingested,
                                  std::vector<ItemResult> excluded);

/// The metrics with notes of training, audit and missing networks.
nlohmann::json WithNotes(nlohmann::json metrics, const JobOptions& options, const JobResult& result);

/// An artifact as the input of a later stage.
StageInput InputFrom(const char* role, const ItemResult& item);

/// The configuration's limits of an item, where it sets them, instead of the stages' own.
void LimitItems(const PipelineOptions& limits, RunnerOptions& runner);

inline constexpr const char* kSkeletonRole = "skeleton";

/// The content of a skeleton file as an input without a path: stages find the file by its name, the key contains its
/// content. A missing file counts as an empty one; the stage reports it.
StageInput SkeletonInput(const std::string& name_or_path);

/// All evidence as one item of the search for duplicates; nothing with fewer than two clips.
std::optional<ItemSpec> DuplicatesItem(const std::vector<ClipRecord>& clips, const ItemOptions& options);

/// Adds that stage's findings to the clips, and removes the artifact of clips to exclude.
void NoteDuplicates(const ItemResult& found, std::vector<ClipRecord>& clips);

/// Adds the exclusions of the stage `assemble` to the clips, and logs them, one line for each reason. Returns the other
/// findings, which are about the set.
std::vector<Finding> NoteExcludedFromSet(const ItemResult& assembled, std::vector<ClipRecord>& clips);

/// One item per person, or per recording of a person, with the evidence of at most 30 of their clips, chosen by hash of
/// the clip ids, so that other clips hardly change the choice.
std::vector<ItemSpec> ProportionItems(const std::vector<ClipRecord>& clips, BodyOf body_of, const ItemOptions& options);

/// Items of the stage `fitting`, and the clip of each.
struct FitItems {
  std::vector<ItemSpec> items;
  std::vector<ClipRecord*> clips;
};

/// One item per clip with evidence; a clip whose body has no proportions is refused here, with the reason.
FitItems FittingItems(std::vector<ClipRecord>& clips, BodyOf body_of, const std::map<std::string, ItemResult>& bodies,
                      const ItemOptions& options);

/// One item per clip with a motion that is passed through.
FitItems GivenMotionItems(std::vector<ClipRecord>& clips, const ItemOptions& options);

/// Truth of a capture: the .h5 files of a folder, or one file; none for an empty path. Error kNotFound.
Expected<std::vector<StageInput>> TruthInputs(const std::filesystem::path& truth);

/// All fits and their evidence against the truth; nothing when one of the two is missing.
std::optional<ItemSpec> FitErrorItem(const std::vector<ClipRecord>& clips, const std::vector<StageInput>& truth);

/// Adds the errors of this item to the clips. Errors of reading its artifact.
Status NoteFitErrors(const ItemResult& scored, std::vector<ClipRecord>& clips);

}  // namespace mocurate
