#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/motion/request.h"
#include "core/store/store.h"
#include "eval/options.h"

namespace mocurate {

/// Answers requests without a network, from the training part of a set: by a clip of the label, drawn by the request's
/// seed; by a clip of any label; or by the mean pose of the label for the requested frames. Of samples of two actions
/// the part alone.
class Yardsticks {
 public:
  /// Without the rows `skipped`. Error kInconsistent where a clip lacks the part; errors of TrainingRows.
  static Expected<Yardsticks> Make(Yardstick yardstick, const Dataset& set, const std::set<int>& skipped,
                                   const FeaturesOptions& options);

  struct Answer {
    std::string clip;  ///< id of the training clip; of a mean pose one for each request, as of a generated motion
    Motion motion;
  };
  /// Error kInconsistent where the label has no training clip.
  Expected<Answer> Of(const MotionRequest& request) const;

 private:
  Yardstick yardstick_ = Yardstick::kNone;
  std::vector<std::string> names_;               ///< of the set's labels
  std::vector<int> labels_;                      ///< with training clips
  std::map<int, std::vector<Answer>> of_label_;  ///< the mean pose: one frame
};

}  // namespace mocurate
