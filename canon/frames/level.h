#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "canon/options.h"
#include "core/motion/clip.h"

namespace mocurate {

/// The floor in front of a static sensor: the plane up . x = height, in the world of its clips.
struct FloorPlane {
  Vector3d up = Vector3d::UnitY();  ///< unit
  double height = 0.0;              ///< metres along `up`
  double tilt_sigma = 0.0;          ///< radians, of `up`, standard deviation of its worse direction
  double height_sigma = 0.0;        ///< metres
  double lean = 0.0;                ///< mean forward lean of standing people, radians
  int contacts = 0;                 ///< number of stance phases of a foot
  int clips = 0;                    ///< clips with stance phases

  double tilt() const;  ///< radians between `up` and +y
};
void to_json(nlohmann::json& json, const FloorPlane& floor);
/// Reads what LevelClip needs.
void from_json(const nlohmann::json& json, FloorPlane& floor);

/// The floor by least squares over all motions of one sensor. The lower joint of each foot is on it in each stance
/// phase (one equation each). Standing people are upright except for a common lean along their facing. Where they faced
/// all directions or stood far apart, tilt and lean are separable; else `tilt_sigma` is that of the lean's prior. With
/// FloorRule::kHeight `up` is +y. Nothing without stance phases, or where the skeletons have no legs.
std::optional<FloorPlane> EstimateFloor(const LevelOptions& options, const std::vector<Motion>& motions);

/// Moves the clip onto a floor; its tilt and sigma (degrees) go to provenance ("level.tilt_deg", "level.sigma_deg"),
/// and kOriginFloor.
void LevelClip(const FloorPlane& floor, Clip& clip);

}  // namespace mocurate
