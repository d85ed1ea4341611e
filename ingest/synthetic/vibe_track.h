#pragma once

#include <string>

#include "core/formats/vibe_pickle.h"
#include "core/motion/motion.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// What VIBE says of a person in an image, focal length 500: rotations, 49 points around the pelvis, and
/// weak-perspective cameras of 540 x 540 pixels, for which z = 500 / (270 sx). `motion` stands in the camera's axes (x
/// right, y down, z forward), boxes around `image_centre` (pixels). Points err as the options say; one that is not seen
/// is guessed where it was last; swapped limbs stay in the points alone. Rotations are off as far as noise, bias and
/// wander move the end of a limb of 0.25 m, the place of the root by as much, four times along the line of sight.
VibeTrack VibeTrackOf(const Motion& motion, const TrackerOptions& options, std::int64_t seed, const std::string& item,
                      const Vector2d& image_centre = {270.0, 270.0});

}  // namespace mocurate
