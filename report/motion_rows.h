#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/skin/skin.h"
#include "core/store/store.h"
#include "report/drawing.h"
#include "report/options.h"

namespace mocurate {

/// A motion of a picture: what made it, and what it shows.
struct MotionRow {
  std::string method;
  std::string label;
  Clip clip;
  std::optional<Skin> skin;  ///< drawn in the place of bones
};

/// A set of motions with the name of what made them.
struct NamedMotions {
  std::string method;
  Dataset motions;
};

/// Which motions are shown: of each label of the options and each set the first `samples` clips, or the clips that are
/// named; without either one of each class, or of sets of long motions (clips with segments) the first ones. Error
/// kNotFound for a label that no set has and for a clip that is not there, kInconsistent for clips without a motion,
/// kUsage for more than `most_rows`.
Expected<std::vector<MotionRow>> ChooseMotionRows(const std::vector<NamedMotions>& sets,
                                                  const MotionPictureOptions& options);

/// Rows of equally spaced frames at one scale, each figure below its own root: name and label to the left, seconds
/// below, brackets over the segments of long motions (transitions dashed), the root's path from above to the right.
Drawing DrawMotionRows(const std::vector<MotionRow>& rows, const MotionPictureOptions& options);

/// All rows in their frame of one moment, side by side; a motion that has ended holds its last frame.
class MotionGrid {
 public:
  MotionGrid(const std::vector<MotionRow>& rows, const MotionPictureOptions& options);
  double seconds() const { return seconds_; }
  Drawing At(double seconds) const;

 private:
  const std::vector<MotionRow>& rows_;
  const MotionPictureOptions& options_;
  double seconds_ = 0.0;
};

}  // namespace mocurate
