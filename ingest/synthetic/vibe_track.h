#pragma once

#include <string>

#include "core/formats/vibe_pickle.h"
#include "core/motion/motion.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// What VIBE says of a person in an image of 540 x 540 pixels, focal length 500: rotations, 49 points around the
/// pelvis, and weak-perspective cameras, for which z = 500 / (270 sx). `motion` stands in the camera's axes (x right, y
/// down, z forward). Points err as the options say; one that is not seen is guessed where it was last; swapped limbs
/// stay in the points alone.
VibeTrack VibeTrackOf(const Motion& motion, const TrackerOptions& options, std::int64_t seed, const std::string& item);

}  // namespace mocurate
