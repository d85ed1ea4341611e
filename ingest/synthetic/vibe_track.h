#pragma once

#include <string>

#include "core/formats/vibe_pickle.h"
#include "core/motion/motion.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// VIBE's output for a person in an image with focal length 500: rotations, 49 points around the pelvis, and
/// weak-perspective cameras of 540 x 540 pixels, for which z = 500 / (270 sx). `motion` is in the camera's axes (x
/// right, y down, z forward), boxes are around `image_centre` (pixels). Points have the errors of the options; a
/// missing point is extrapolated from its last position, and exchanged limbs affect the points only. Noise, bias and
/// wander, taken as displacements of the end of a 0.25 m limb, give the rotation errors; the root's position has the
/// same error, four times along the line of sight.
VibeTrack VibeTrackOf(const Motion& motion, const TrackerOptions& options, std::int64_t seed, const std::string& item,
                      const Vector2d& image_centre = {270.0, 270.0});

}  // namespace mocurate
