#include "job/clip_counts.h"

#include "core/base/text.h"

namespace mocurate {

std::string ClipsText(const ClipCounts& counts) {
  std::string text = Counted(counts.clips, "clip") + ", " + std::to_string(counts.kept) +
                     " kept, excluded by rule: " + std::to_string(counts.excluded) + ", " +
                     std::to_string(counts.failed) + " failed";
  if (counts.suspect > 0) text += ", " + std::to_string(counts.suspect) + " suspect";
  if (counts.undecided > 0) text += ", " + std::to_string(counts.undecided) + " undecided (the run ended before)";
  if (counts.folders > 0) text += "; " + Counted(counts.folders, "folder") + " skipped";
  if (counts.replaces_rotations > 0) {
    text += "; recorded rotations of " + Counted(counts.replaces_rotations, "clip") +
            " replaced by fitted ones (fitting.method: none keeps them)";
  }
  return text;
}

}  // namespace mocurate
