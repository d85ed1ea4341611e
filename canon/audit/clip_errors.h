#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/quality/duplicates.h"
#include "core/quality/shared_stretches.h"
#include "core/store/store.h"

namespace mocurate {

/// What an audit found, and what it proposes: another label, or the clip that shows the same; or nothing.
struct AuditFinding {
  Finding finding;
  std::string suggested;
  /// A clip that can go without loss: it repeats another of the same person, labels, segments and part of every split,
  /// joints to 0.01 mm and rotations too.
  std::string safe_to_drop;
};

/// Clips of which a motion says that they are wrong: "mirrored" (the anatomy of a left-handed frame,
/// MeasureHandedness), "swapped_sides" (FindSwaps), "frozen_frames" (FindRepeats), the last two with their frames.
std::vector<AuditFinding> FindClipErrors(const Dataset& dataset);

/// What FindRepeatedClips compares of a motion.
MotionSignature SignatureOfMotion(const Motion& motion);

/// Pairs of clips that show the same (FindSharedStretches, FindDuplicates), also mirrored or in part: "leak" (error)
/// where a split has them in two parts, else "duplicate". `suggested` is the other clip.
std::vector<AuditFinding> FindRepeatedClips(const Dataset& dataset, const StretchLimits& limits = {});

}  // namespace mocurate
