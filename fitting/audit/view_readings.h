#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "fitting/association/body_shape.h"

namespace mocurate {

/// Views whose keypoints are to be read in another way than given.
struct ViewReading {
  std::vector<std::size_t> views;
  bool mirrored = false;   ///< x is counted from the right
  bool sides = false;      ///< and left is called right, as a detector does in a mirrored image
  double factor = 1.0;     ///< pixels are so many times too small
  double agreement = 0.0;  ///< share of the entries that belong to a body, as given
  double read = 0.0;       ///< and read so
  double confidence = 0.0;
};

/// The reading of one view, or of all, after which views agree on people that they do not agree on as given: mirrored,
/// or of images of another size (a quarter to four times). Judged as exchanged files are. Empty for fewer than three
/// and more than twelve views, and where nothing agrees much better.
std::optional<ViewReading> FindMisreadViews(const std::vector<KeypointView>& views,
                                            const std::vector<std::string>& names,
                                            const std::vector<KnownLength>& lengths, double min_confidence);

/// The views as that reads them.
std::vector<KeypointView> WithReading(std::vector<KeypointView> views, const std::vector<std::string>& names,
                                      const ViewReading& reading);

}  // namespace mocurate
