#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/babel.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Candidate paths of a BABEL sequence's motion in a folder of AMASS, in this order: its `feat_p` without the first
/// element; with the old or new name of the dataset ("BioMotionLab_NTroje", "BMLrub"); as "..._poses.npz", or as
/// "..._stageii.npz" with '_' for blanks.
std::vector<std::string> AmassNames(const std::string& feat_p);

/// A sequence, and its file of annotations.
struct IndexedSequence {
  BabelSequence sequence;
  std::string file;
};

/// The sequences of several annotation files, by the AMASS file they refer to.
class BabelIndex {
 public:
  /// `names` below `folder`; where several files list a sequence, the first one counts. Errors kNotFound, kMalformed.
  static Expected<BabelIndex> Read(const std::filesystem::path& folder, const std::vector<std::string>& names);

  /// The sequence of a file below the source's folder, whose name may have more folders in front; null: not annotated.
  /// A sequence that was found counts as used.
  const IndexedSequence* Find(const std::string& file);

  std::size_t size() const { return sequences_.size(); }
  /// `feat_p` of the sequences that were never found.
  std::vector<std::string> Unused() const;

 private:
  std::vector<IndexedSequence> sequences_;
  std::vector<bool> used_;
  std::map<std::string, std::size_t> by_name_;
};

/// "annotation_duration": `annotated_s` and `duration_s` differ by more than 5 % and 0.25 s.
std::optional<Finding> CheckDuration(double annotated_s, double duration_s);

/// Labels of the frames, or of the whole sequence where there are none, as segments ordered by their begin. The name is
/// `proc_label`, else `raw_label`; categories are joined by ", ". Findings: "segment_times" (impossible: excluded; past
/// the end of the motion by more than `frame_s`: cut), "label_withheld". Of several annotators the first is used.
std::vector<Segment> SegmentsOf(const BabelSequence& sequence, double duration_s, double frame_s,
                                std::vector<Finding>& findings);

}  // namespace mocurate
