#pragma once

#include <string>
#include <vector>

#include "core/geometry/depth_image.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// Depth of an empty room: the floor y = 0 and a wall `wall` metres behind the origin at -z, from a camera; 0 where
/// neither is visible. Metres, (height*width).
std::vector<float> RoomDepth(const Camera& camera, const std::vector<Vector2d>& rays, double wall);

/// The sensor's measurement of a body before a background (empty: no background). Noise and quantisation grow with the
/// distance (Nguyen et al. 2012, Khoshelham 2012); edges have flying pixels; holes and surfaces at a grazing angle have
/// no value. Millimetres, 0 for no value. `item` keys the randomness.
DepthImage SimulateDepth(const std::vector<float>& body, const std::vector<float>& background, const Camera& camera,
                         const std::vector<Vector2d>& rays, const DepthSensorOptions& options, std::int64_t seed,
                         const std::string& item);

/// The same without background: a masked image.
DepthImage SimulateMaskedDepth(const std::vector<float>& body, const Camera& camera, const std::vector<Vector2d>& rays,
                               const DepthSensorOptions& options, std::int64_t seed, const std::string& item);

/// Left and right exchanged, as Kinects write their images.
DepthImage Mirrored(const DepthImage& image);

}  // namespace mocurate
