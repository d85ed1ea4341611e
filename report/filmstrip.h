#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/motion/clip.h"
#include "core/pipeline/stage.h"

namespace mocurate {

/// One clip to draw: observations and fit, which of a given motion is that motion.
struct DrawnClip {
  std::string item;
  std::string rank;  ///< "best fit", "median fit", "worst fit", "fit 2 of 5"
  Clip evidence;
  Clip fitted;
  nlohmann::json figures;  ///< of the fitting stage
};

/// Mapping of tracked points to a skeleton: point of each joint (-1 for none) and lines between points of joints whose
/// nearest observed ancestor is also observed.
struct TrackDrawing {
  std::vector<int> point_of_joint;        ///< (J)
  std::vector<std::array<int, 2>> lines;  ///< pairs of points
};
TrackDrawing MatchTracks(const std::vector<std::string>& names, const Skeleton& skeleton);
/// Whether a point was observed in a frame.
bool Observes(const JointTracks& tracks, int frame, int point);

/// Direction of view in the world: the camera looks from the person's front, rotated by `yaw` and raised by `pitch`.
struct Viewpoint {
  double yaw = 0.0;    ///< radians about +y
  double pitch = 0.0;  ///< radians, above the horizon

  /// x to the right, y up, z towards the eye.
  Vector3d Turn(const Vector3d& point) const;
};

/// The yaw of a view from the front of the person in the middle frame (its hips, else its shoulders); 0 without both.
double FrontYaw(const Motion& motion);
/// Three-quarter view on the person in the middle frame of a motion (its hips, else its shoulders).
Viewpoint FrontView(const Motion& motion);

/// Frames of stills, evenly spread, first and last included.
std::vector<int> StillFrames(int frame_count, int stills = 8);

/// Canvas and controls of a player of viewer/player.js.
std::string PlayerHtml(const std::string& name);

/// -1 right, 1 left, 0 midline: from mirror partners and rest offsets.
std::vector<int> SidesOf(const Skeleton& skeleton);

/// Tracked points of the evidence; null without.
const JointTracks* TracksOf(const DrawnClip& clip);

/// The clip of an input "evidence" and its fit, read from the inputs of a stage: "fit" of the same name, and "depth".
/// `findings` receives those stored with the fit. Errors of ReadEvidence and ReadDataset, kInconsistent for a fit
/// without a clip and for a clip without a motion.
Expected<DrawnClip> ReadDrawnClip(const StageRequest& request, const StageInput& evidence,
                                  std::vector<Finding>* findings = nullptr);
/// The same of a stage that draws one clip.
Expected<DrawnClip> ReadDrawnClip(const StageRequest& request, std::vector<Finding>* findings = nullptr);

}  // namespace mocurate
