#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

// Cameras around a subject who stands at the origin of the studio's world: metres, y up, the floor at y = 0, the
// subject facing +z. Cameras are named as their sets name them.

/// One calibration of PHSPD, its poses as published (JimmyZou/PolarHumanPoseShape, CamParams0906 and CamParams0909),
/// millimetres.
struct PhspdCalibration {
  using Pose = std::array<double, 7>;  ///< qw qx qy qz tx ty tz; not quite normalised, as published
  const char* name = "";
  std::array<Pose, 3> depth_from_polar;   ///< "d1p" to "d3p"
  std::array<Pose, 3> colour_from_depth;  ///< "cd1" to "cd3"
};

/// That of the subject, 1 to 12.
const PhspdCalibration& PhspdCalibrationOf(int subject);

/// Pose of the studio's world in the polarisation camera's frame: the subject where the axes of all cameras meet, the
/// camera level. This is a choice: the set does not publish its floor.
RigidTransform PhspdPolarFromWorld();

/// p, d1, d2, d3, c1, c2, c3, with pinhole lenses.
std::vector<Camera> PhspdRig(int subject);

/// CamParamsNNNN.pkl: arrays of float32 under the set's keys. The boards p1w to p3w, of which the set has about 30
/// each, are three each around the subject.
Expected<std::string> EncodePhspdCalibration(const PhspdCalibration& calibration);

/// Human3.6M's four cameras with their lenses, as calibrated for subject S1.
std::vector<Camera> Human36mRig();

enum class SensorKind { kDepth, kColour };

/// Looking at a point a metre above the floor; camera k stands at 2 pi k / cameras from +z towards +x.
std::vector<Camera> RingRig(const RigOptions& options, SensorKind sensor);

/// By RigOptions::kind; PHSPD's are those of subject 1.
std::vector<Camera> RigOf(const RigOptions& options, SensorKind sensor);

/// How the cameras of a capture deviate from their calibration.
struct RigFaults {
  std::vector<double> clock_s;  ///< camera k's clock offset: it records this much later
  std::vector<Camera> real;     ///< the true cameras
};
RigFaults FaultsOf(const RigOptions& options, const std::vector<Camera>& calibrated, std::int64_t seed);

}  // namespace mocurate
