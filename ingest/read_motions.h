#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/pipeline/stage.h"
#include "core/store/store.h"
#include "ingest/options.h"

namespace mocurate {

/// One clip of a source in memory, and what was found about it. The clip counts where the outcome has an artifact; one
/// that a finding refuses or leaves out is there to be looked at.
struct ReadItem {
  Clip clip;
  StageOutcome outcome;
};

/// What the stage `ingest` reads of one item, without writing it.
Expected<ReadItem> ReadSourceItem(const StageRequest& request);

/// A clip that could not be taken, and why.
struct RefusedClip {
  std::string item;
  Error error;
};

/// Motions that end in padding, or are longer than their stated lengths.
struct PaddedMotions {
  std::int64_t motions = 0;
  std::int64_t frames = 0;  ///< in all of them
  std::string first;        ///< clip
};

/// All clips of a source as one set of motions.
struct ReadMotions {
  Dataset set;  ///< sorted by id; recorded rotations kept, joint tracks as joints-only motions, else as they come
  PaddedMotions padded;
  std::vector<RefusedClip> refused;
  std::vector<Finding> excluded;  ///< about files and entries that the declaration leaves out
};

/// Labels that stand beside motions: one a motion in their order, or by the name of each.
struct MotionLabels {
  std::vector<std::string> ordered;
  std::map<std::string, std::string> by_name;  ///< file name, without ending or with, recording or clip id
  std::string file;                            ///< where they stand

  bool empty() const { return ordered.empty() && by_name.empty(); }
};

/// An .npy of whole numbers or texts; a .csv of "name,label" lines, with or without a header; any other text file: a
/// label a line. Error kMalformed "name:line", kUnsupported.
Expected<MotionLabels> ReadMotionLabels(const std::filesystem::path& file);

/// Numbers of frames that stand beside motions, one a motion in their order.
struct MotionLengths {
  std::vector<std::int64_t> frames;
  std::vector<std::string> places;  ///< of each: "lengths.txt:3", "lengths.npy[2]"
  std::string file;                 ///< where they stand
};

/// An .npy of whole numbers; any other text file: a whole number from 1 on a line. Error kMalformed with the place.
Expected<MotionLengths> ReadMotionLengths(const std::filesystem::path& file);

/// Reads every clip that `options` declare, by the readers of the stage `ingest`. A set of one skeleton: clips of
/// another tree than the first one's, or joints only among rotations, are refused one by one; segments, findings and
/// labels are kept. Motions are cut to `lengths`, where given, and padding is treated as `options.padding` asks
/// (core/quality/padding.h); motions without a frame that is not zero are refused then. Errors of Discover;
/// kInconsistent where no clip can be taken, or where there are other than one label or length a motion. Lengths count
/// frames of the files; a motion that is shorter than its length is refused.
Expected<ReadMotions> ReadAllMotions(const MotionsOptions& options, const MotionLabels& labels = {},
                                     const MotionLengths& lengths = {});

/// The stage `motions`: inputs of role "source" (name: path below the folder) and perhaps one each of the roles
/// "labels" and "lengths" -> a MotionSet; refused clips are findings of severity error, padding is in the summary.
Expected<StageOutcome> MotionsStage(const StageRequest& request);

}  // namespace mocurate
