#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/motion/clip.h"

namespace mocurate {

/// One clip that is drawn: what was observed and what was fitted to it. Without a fit (given motion, tracks only)
/// `fitted` has no motion of its own and the evidence is drawn alone.
struct DrawnClip {
  std::string item;
  std::string rank;  ///< "best fit", "median fit", "worst fit", "fit 2 of 5"
  Clip evidence;
  Clip fitted;
  nlohmann::json figures;  ///< of the fitting stage
};

/// How tracked points belong to a skeleton: point of each joint (-1 for none) and lines between points of joints whose
/// nearest observed ancestor is also observed.
struct TrackDrawing {
  std::vector<int> point_of_joint;        ///< (J)
  std::vector<std::array<int, 2>> lines;  ///< pairs of points
};
TrackDrawing MatchTracks(const JointTracks& tracks, const Skeleton* skeleton);

/// Direction of view in the world: the camera looks from the person's front, turned by `yaw` and raised by `pitch`.
struct Viewpoint {
  double yaw = 0.0;    ///< radians about +y
  double pitch = 0.0;  ///< radians, above the horizon

  /// x to the right, y up, z towards the eye.
  Vector3d Turn(const Vector3d& point) const;
};

/// Three-quarter view on the person in the middle frame of a motion (its hips, else its shoulders).
Viewpoint FrontView(const Motion& motion);

/// Frames of stills, evenly spread, first and last included.
std::vector<int> StillFrames(int frame_count, int stills);
int FrameCountOf(const DrawnClip& clip);

/// Stick figures side by side: tracked points grey, fitted skeleton in colour, or one of both alone at the same places.
enum class StripLayers { kBoth, kEvidence, kFit };
std::string FilmstripSvg(const DrawnClip& clip, int stills, StripLayers layers = StripLayers::kBoth);

/// Canvas and controls of the player that draws the JSON of PlayerData at the same place in the page; `id` is its own.
std::string PlayerHtml(const std::string& name, const std::string& id, bool has_points);

/// What the player of the page draws: {"name", "hz", "step", "yaw", "pitch", "bones": [[a,b,side]...], "joints":
/// [[mm...] per frame], "lines", "points"}; positions are whole millimetres relative to the first root; a missing point
/// is null in place of its x, y, z. At most `most_numbers` numbers: longer clips are thinned, `step` says by how much.
nlohmann::json PlayerData(const DrawnClip& clip, int most_numbers);

/// -1 right, 1 left, 0 midline: from mirror partners and rest offsets.
std::vector<int> SidesOf(const Skeleton& skeleton);

}  // namespace mocurate
