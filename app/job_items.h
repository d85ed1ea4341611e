#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/job_options.h"
#include "core/pipeline/runner.h"

namespace mocurate {

struct JobResult;

/// A network of a run: which of TrainOptions::networks, its row in tables, its checkpoint.
struct TrainedNetwork {
  std::size_t network = 0;
  std::string row;
  StageInput checkpoint;
};

/// What became of one source clip, stage by stage.
struct ClipRecord {
  std::string item;
  std::vector<StageInput> depth;         ///< depth images that the evidence refers to
  ItemResult evidence;                   ///< stage ingest
  ItemResult motion;                     ///< stage fitting (or ingest, when nothing is fitted)
  ItemResult canonical;                  ///< stage canon
  ItemResult assembled;                  ///< stage assemble, of a clip that it leaves out
  ItemResult baseline;                   ///< stage canon on the unfitted tracks
  std::string format;                    ///< of its file, as the source declares it
  bool rotations = false;                ///< its file holds rotations
  std::optional<double> joint_error_mm;  ///< mean distance of the fitted joints from the truth, where there is one

  std::string person() const { return evidence.outcome.summary.value("person", std::string()); }
  /// Item of the stage `proportions` that the clip's body is of.
  std::string body(BodyOf body_of) const;
  /// In the dataset, as far as the stages have come.
  bool kept() const { return !canonical.artifact.empty() && HasArtifact(assembled.outcome.kind); }
  /// What the stage said that ended it: it failed there, or a rule left it out. Null when none did.
  const ItemResult* ended() const;
  /// Name of that stage, or empty.
  std::string ended_at() const;
  bool failed() const { return ended() != nullptr && IsFailure(ended()->outcome.kind); }
  /// No clip: a folder whose files lie where the pattern does not look.
  bool folder() const;
  /// It went on, with a finding of severity error.
  bool doubtful() const;
  /// It went on, and is doubtful or its fit is: far from the evidence, mostly unobserved (fitting/fit_outcome.cpp).
  bool suspect() const;
  /// Rotations that were fitted stand in place of the recorded ones.
  bool replaces_rotations() const;
  bool left_out() const { return ended() != nullptr && !failed(); }
  /// The reason in one word: the rule (code of its finding), or the code that an inspection gives such a
  /// file. Empty when nothing ended it.
  std::string reason() const;
};

/// Codes of what the stages found about a clip, each once; those of severity info are left out.
std::set<std::string> FindingCodes(const ClipRecord& clip);

/// Counts the clips and their findings, and apart from them the folders that were not looked into.
void CountClips(const std::vector<ClipRecord>& clips, JobResult& result);

/// Why the first clip failed; if none did, which rule left the first one out.
/// With `branch` = &ClipRecord::baseline the same of the raw tracks alone.
Error FirstReason(const std::vector<ClipRecord>& clips, ItemResult ClipRecord::*branch);

/// Why the raw tracks are not compared with the fits.
Finding ComparisonDropped(const std::string& why);

/// Tells of files and folders that are no items: one line for all of a kind, with their number. A folder that is passed
/// over is no warning: data are shipped so.
void LogLeftOut(const std::vector<ItemResult>& files);

/// The clips after the stage `ingest`: of each of its items, and of the files that are none.
std::vector<ClipRecord> RecordsOf(const std::vector<ItemSpec>& specs, const std::vector<ItemResult>& ingested,
                                  std::vector<ItemResult> left_out);

/// The metrics with what training, audit and networks that are not there add to them.
nlohmann::json WithNotes(nlohmann::json metrics, const JobOptions& options, const JobResult& result);

/// An artifact as the input of a later stage.
StageInput InputFrom(const char* role, const ItemResult& item);

/// The content of a skeleton file as an input: stages find the file by its name, the key holds what is in it. Empty
/// content hash for a file that does not exist: the stage says so.
StageInput SkeletonInput(const std::string& name_or_path);

/// All evidence, to be searched for clips that show the same; nothing when there are fewer than two clips.
std::optional<ItemSpec> DuplicatesItem(const std::vector<ClipRecord>& clips, const nlohmann::json& options);

/// Brings what that stage found to the clips: findings, and no artifact for those that are to be left out.
void NoteDuplicates(const ItemResult& found, std::vector<ClipRecord>& clips);

/// Brings what the stage `assemble` left out to the clips, and tells of them: one line for all of a reason. Gives the
/// other findings back, which are about the set.
std::vector<Finding> NoteLeftOutOfSet(const ItemResult& assembled, std::vector<ClipRecord>& clips);

/// One item per person, or per recording of a person, with the evidence of at most 30 of their clips, chosen by hash of
/// the clip ids so that other clips do not move the choice.
std::vector<ItemSpec> ProportionItems(const std::vector<ClipRecord>& clips, BodyOf body_of,
                                      const nlohmann::json& options);

/// Items of the stage `fitting`, and the clip of each.
struct FitItems {
  std::vector<ItemSpec> items;
  std::vector<ClipRecord*> clips;
};

/// One item per clip with evidence; a clip whose body has no proportions is refused here, with the reason.
FitItems FittingItems(std::vector<ClipRecord>& clips, BodyOf body_of, const std::map<std::string, ItemResult>& bodies,
                      const nlohmann::json& options);

/// One item per clip with a motion that is handed on.
FitItems GivenMotionItems(std::vector<ClipRecord>& clips, const nlohmann::json& options);

/// Truth that lies beside a capture: the .h5 of a folder, or one file; none where the path is empty. Error kNotFound.
Expected<std::vector<StageInput>> TruthInputs(const std::filesystem::path& truth);

/// All fits and their evidence against the truth; nothing when one of the two is missing.
std::optional<ItemSpec> FitErrorItem(const std::vector<ClipRecord>& clips, const std::vector<StageInput>& truth);

/// Brings the errors that this item found to the clips. Errors of reading its artifact.
Status NoteFitErrors(const ItemResult& scored, std::vector<ClipRecord>& clips);

}  // namespace mocurate
