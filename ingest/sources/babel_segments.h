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

/// Where a BABEL sequence's motion may lie in a folder of AMASS: its `feat_p` without the first element; with the old
/// or the new name of the dataset ("BioMotionLab_NTroje", "BMLrub"); as "..._poses.npz", or as "..._stageii.npz" with
/// '_' for blanks. In this order.
std::vector<std::string> AmassNames(const std::string& feat_p);

/// A sequence, and the file of annotations that it stands in.
struct IndexedSequence {
  BabelSequence sequence;
  std::string file;
};

/// The sequences of several annotation files by the AMASS file they speak of.
class BabelIndex {
 public:
  /// `names` below `folder`; a sequence that stands in several files counts where it stands first. Errors kNotFound,
  /// kMalformed.
  static Expected<BabelIndex> Read(const std::filesystem::path& folder, const std::vector<std::string>& names);

  /// Of a file below the source's folder, whose name may have more folders in front; null: not annotated. What was
  /// found counts as used.
  const IndexedSequence* Find(const std::string& file);

  std::size_t size() const { return sequences_.size(); }
  /// `feat_p` of the sequences that were never found.
  std::vector<std::string> Unused() const;

 private:
  std::vector<IndexedSequence> sequences_;
  std::vector<bool> used_;
  std::map<std::string, std::size_t> by_name_;
};

/// "annotation_duration": an annotation of `annotated_s` seconds for a motion that lasts `duration_s`, by more than 5 %
/// and 0.25 s.
std::optional<Finding> DoubtDuration(double annotated_s, double duration_s);

/// Labels of the frames, or of the whole sequence where there are none, as segments in the order of their begin; the
/// name is `proc_label`, else `raw_label`; categories are joined by ", ". Findings: "segment_times" (impossible, left
/// out; past the end of the motion by more than `frame_s`, cut), "label_withheld", "annotators" (the first is taken).
std::vector<Segment> SegmentsOf(const BabelSequence& sequence, double duration_s, double frame_s,
                                std::vector<Finding>& findings);

}  // namespace mocurate
