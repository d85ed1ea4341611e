#pragma once

#include <string>

namespace mocurate {

/// What became of source clips: files that became clips or should have.
struct ClipCounts {
  int clips = 0;
  int kept = 0;                ///< with at least one clip in the dataset
  int doubtful = 0;            ///< of those that did not end, with a finding of severity error
  int left_out = 0;            ///< by a rule of the configuration: no failure
  int failed = 0;              ///< refused or crashed anywhere before the dataset
  int undecided = 0;           ///< the run ended before the dataset
  int folders = 0;             ///< no clips: folders that were not looked into
  int replaces_rotations = 0;  ///< fitted, though their files hold rotations
};

/// "15 clips, 13 kept, left out by rule: 1, 1 failed"; the doubtful (", 2 doubtful"), the undecided, the folders and
/// the replaced rotations only where there are some.
std::string ClipsText(const ClipCounts& counts);

}  // namespace mocurate
