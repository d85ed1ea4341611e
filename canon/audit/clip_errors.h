#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/store/store.h"

namespace mocurate {

/// Two clips in two parts of a split: "train", "validation", "test".
struct SplitParts {
  std::string split, part, other;
};

/// A finding of an audit and its suggestion: another label, the other clip of a pair, or nothing.
struct AuditFinding {
  Finding finding;
  std::string suggested;
  /// A redundant clip: it repeats another of the same person, labels, segments and part of every split, with rotations
  /// and joints equal to 0.01 mm.
  std::string safe_to_drop;
  std::vector<SplitParts> parts;  ///< of a leak: where the clip and the suggested one are
};

/// Clips whose motion is wrong: "mirrored" (the anatomy of a left-handed frame, MeasureHandedness), "swapped_sides"
/// (FindSwaps), "frozen_frames" (FindRepeats), the last two with their frames.
std::vector<AuditFinding> FindClipErrors(const Dataset& dataset);

/// Pairs of clips with the same motion (FindDuplicates), also mirrored or in part, or of the same
/// source data (ContentsOf): "leak" (error) where a split has them in two parts, else "duplicate". `suggested` is the
/// other clip. Of more than two clips with the same source data, each is a pair with the first one and with the first
/// one in each other part.
std::vector<AuditFinding> FindRepeatedClips(const Dataset& dataset, double distance = 0.004);

}  // namespace mocurate
