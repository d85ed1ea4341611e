#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "canon/options.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Where the floor lies before a sensor that stands still: the plane up . x = height, in the world of its clips.
struct FloorPlane {
  Vector3d up = Vector3d::UnitY();  ///< unit
  double height = 0.0;              ///< metres along `up`
  double tilt_sigma = 0.0;          ///< radians, of `up`, standard deviation of its worse direction
  double height_sigma = 0.0;        ///< metres
  double lean = 0.0;                ///< radians that standing people lean forward on average
  int contacts = 0;                 ///< times that a foot stood
  int clips = 0;                    ///< that had such

  double tilt() const;  ///< radians between `up` and +y
  /// Up to +y, the floor to y = 0.
  RigidTransform LevelFromWorld() const;
};
void to_json(nlohmann::json& json, const FloorPlane& floor);
void from_json(const nlohmann::json& json, FloorPlane& floor);

/// The floor by least squares over all motions of one sensor: the lower joint of each foot stands on it (one equation
/// each time that it stands), and standing people are upright but for a lean along their facing that all share. Where
/// they faced all ways or stood far apart, the two tell tilt and lean apart; else `tilt_sigma` is that of the prior of
/// the lean. With FloorRule::kHeight `up` is +y. Nothing where no foot ever stands or the skeletons have no legs.
std::optional<FloorPlane> EstimateFloor(const LevelOptions& options, const std::vector<Motion>& motions);

/// Moves the clip onto a floor; its tilt and sigma (degrees) go to provenance ("level.tilt_deg", "level.sigma_deg").
void LevelClip(const FloorPlane& floor, Clip& clip);

}  // namespace mocurate
