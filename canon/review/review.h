#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/store/store.h"

namespace mocurate {

/// A reviewer's decision about a clip.
enum class Verdict {
  kUndecided,
  kKeep,     ///< the finding is wrong, or does not matter
  kDrop,     ///< the clip leaves the dataset
  kRelabel,  ///< it is of another class
  kCut,      ///< only some frames stay
};

/// One decision. It applies to a clip whose id and motion are those that were reviewed. A finding about the whole set
/// is kept with an empty clip.
struct Decision {
  std::string clip;     ///< id
  std::string content;  ///< MotionFingerprint; empty: any motion
  std::string finding;  ///< code that it resolves, or empty
  std::string other;    ///< for a pair with the same motion: the other clip; empty: any
  Verdict verdict = Verdict::kUndecided;
  std::string label;       ///< kRelabel: the class
  std::int64_t begin = 0;  ///< kCut: first frame that stays
  std::int64_t end = 0;    ///< kCut: the frame after the last one
  std::string note;
  std::string place;  ///< "decisions.yaml:12:5", for messages

  void Declare(OptionVisitor& v);
};

/// A file of decisions, saved by `mocurate review`.
struct Review {
  std::string dataset;  ///< the file that was reviewed, for the reader
  std::vector<Decision> decisions;

  void Declare(OptionVisitor& v);
};

/// Errors kNotFound; kConfig with all errors, each with its place: unknown fields, and contradicting decisions (dropped
/// and kept for one finding, dropped and relabelled, two labels, two cuts, two motions under one id).
Expected<Review> ReadReview(const std::filesystem::path& path);

/// The same as YAML.
std::string ReviewText(const Review& review);

/// Code of the finding about a clip that a review drops.
inline constexpr const char* kReviewDrop = "review_drop";

/// A row of the reviewed dataset, and the frames of its clip that stay.
struct ReviewedRow {
  std::size_t row = 0;
  int begin = 0;
  int end = 0;
};

/// Result of a review.
struct AppliedReview {
  std::vector<ReviewedRow> origins;  ///< of each clip that stays
  std::vector<Clip> dropped;
  std::map<std::string, std::string> new_ids;  ///< of clips that were cut: old id -> new one
  /// "review_drop", "review_relabel", "review_cut" (info) for each applied decision, "review_stale" (warning) for each
  /// that no longer matches a clip.
  std::vector<Finding> findings;
};

/// Applies the decisions in their order: clips are dropped, change class or are cut; rows of splits follow, findings
/// get new ids. Later decisions refer to a cut clip by its new id. A clip whose anchor was at the origin facing +z is
/// canonicalised again. Error kConfig for a class that the dataset lacks, or a cut outside the clip, with the place in
/// the file; kInconsistent where no decision matches a clip.
Expected<AppliedReview> ApplyReview(const Review& review, Dataset& dataset);

/// Whether a decision rejects a finding of this code about a clip, and of a pair about the other clip. `contents` are
/// the fingerprints of the dataset's clips by id.
bool IsAccepted(const Review& review, const std::map<std::string, std::string>& contents, const std::string& clip,
                const std::string& other, const std::string& code);

}  // namespace mocurate
