#pragma once

#include <optional>
#include <vector>

#include "core/motion/clip.h"
#include "fitting/association/body_shape.h"

namespace mocurate {

/// Cameras whose detections are another camera's.
struct ViewExchange {
  std::vector<std::size_t> source;  ///< (views) camera v's detections lie in the files of camera source[v]
  double agreement = 0.0;           ///< share of the entries that belong to a body, as the files say
  double exchanged = 0.0;           ///< and after the exchange
  double confidence = 0.0;          ///< that it is better than as the files say, and than any other exchange
};

/// The exchange of whole files between cameras after which views agree on more people: all permutations of up to five
/// views, pairs of up to twelve. Judged at 24 moments by which entries belong to a body that others propose
/// (ProposePeople), and how far they are from its rays. Of exchanges that agree alike (a rig may look the same from
/// several sides) the one that moves the fewest files. Empty for fewer than three views, where the files agree as they
/// are, and where no exchange agrees much better.
std::optional<ViewExchange> FindExchangedViews(const std::vector<KeypointView>& views, int keypoints,
                                               const std::vector<KnownLength>& lengths, double min_confidence);

/// Views with their detections (times, entries, keypoints) exchanged; cameras stay.
std::vector<KeypointView> WithExchangedViews(const std::vector<KeypointView>& views,
                                             const std::vector<std::size_t>& source);

}  // namespace mocurate
