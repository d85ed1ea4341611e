#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "job/job_items.h"

namespace mocurate {

/// Counts of source clips: files that became clips or should have.
struct ClipCounts {
  int clips = 0;
  int kept = 0;                ///< with at least one clip in the dataset
  int suspect = 0;             ///< of clips that were not ended, with a finding of severity error
  int excluded = 0;            ///< by a rule of the configuration; not a failure
  int failed = 0;              ///< refused or crashed anywhere before the dataset
  int undecided = 0;           ///< the run ended before the dataset
  int folders = 0;             ///< skipped folders, which are not clips
  int replaces_rotations = 0;  ///< fitted, though their files hold rotations
};

/// "15 clips, 13 kept, excluded by rule: 1, 1 failed"; suspect (", 2 suspect"), undecided, skipped folders and replaced
/// rotations only where there are some.
std::string ClipsText(const ClipCounts& counts);

/// One JSON line per source clip, sorted: kept, excluded (by a rule of the configuration), dropped (it failed) or
/// undecided (the run ended before), with stage, rule, findings and hashes.
Status WriteCurationLog(const std::vector<ClipRecord>& clips, const std::filesystem::path& path);

}  // namespace mocurate
