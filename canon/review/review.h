#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/store/store.h"

namespace mocurate {

/// What a person decided about a clip.
enum class Verdict {
  kUndecided,
  kKeep,     ///< the finding is wrong, or does not matter
  kDrop,     ///< the clip leaves the dataset
  kRelabel,  ///< it is of another class
  kCut,      ///< only some frames stay
};

/// One decision. It fits a clip whose id and motion are still those that were looked at. A finding about the set as a
/// whole is kept with an empty clip.
struct Decision {
  std::string clip;     ///< id
  std::string content;  ///< MotionFingerprint; empty: any motion
  std::string finding;  ///< code that it answers, or empty
  std::string other;    ///< of a pair that shows the same: the other clip; empty: any
  Verdict verdict = Verdict::kUndecided;
  std::string label;       ///< kRelabel: the class
  std::int64_t begin = 0;  ///< kCut: first frame that stays
  std::int64_t end = 0;    ///< kCut: the frame after the last one
  std::string note;
  std::string place;  ///< "decisions.yaml:12:5", for messages

  void Declare(OptionVisitor& v);
};

/// A file of decisions, as `mocurate review` saves it.
struct Review {
  std::string dataset;  ///< the file that was looked at, for the reader
  std::vector<Decision> decisions;

  void Declare(OptionVisitor& v);
};

/// Errors kNotFound; kConfig with all that is wrong, each with its place: fields that are no decision's, and decisions
/// that contradict each other (dropped and kept for one finding, dropped and relabelled, two labels, two cuts, two
/// motions under one id).
Expected<Review> ReadReview(const std::filesystem::path& path);

/// The same as YAML.
std::string ReviewText(const Review& review);

/// Code of the finding about a clip that a review drops.
inline constexpr const char* kReviewDrop = "review_drop";

/// What became of a dataset.
struct AppliedReview {
  std::vector<Clip> dropped;
  std::vector<Finding> of_dropped;             ///< what the dataset held about them
  std::map<std::string, std::string> new_ids;  ///< of clips that were cut: old id -> new one
  /// "review_drop", "review_relabel", "review_cut" (info) for each that was carried out, "review_stale" (warning) for
  /// each that fits no clip any more.
  std::vector<Finding> findings;
};

/// Carries the decisions out, in their order: clips leave, change class or are cut; rows of splits follow, findings
/// take new ids. A clip that was cut is known by its new id to the decisions that follow; if it stood at the origin and
/// faced +z it does so again.
/// Error kConfig for a class that the dataset has not, or a cut outside the clip, with the place in the file;
/// kInconsistent where no decision fits a clip.
Expected<AppliedReview> ApplyReview(const Review& review, Dataset& dataset);

/// Whether a decision says that a finding of this code about a clip, and of a pair about the other clip, is wrong or
/// does not matter. `contents` are the fingerprints of the dataset's clips by id.
bool IsAccepted(const Review& review, const std::map<std::string, std::string>& contents, const std::string& clip,
                const std::string& other, const std::string& code);

}  // namespace mocurate
