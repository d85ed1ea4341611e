#pragma once

#include <limits>
#include <vector>

#include "fitting/association/associate.h"
#include "fitting/association/rig_view.h"
#include "fitting/audit/confidence.h"
#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {

/// A camera from a moment on.
struct CameraPart {
  Camera camera;
  double from_s = -std::numeric_limits<double>::infinity();
};

/// What a rig is taken for: clocks and poses of its cameras, and what they call left (index: view).
struct RigModel {
  explicit RigModel(const std::vector<RigView>& rig);

  std::vector<double> clock_s;                  ///< what a view stamps t happens at t + clock
  std::vector<std::vector<CameraPart>> camera;  ///< one, or a second one after it was moved
  std::vector<bool> sides_exchanged;            ///< what the view lists as left is right
};

/// A person at a moment of the take.
struct RigMoment {
  int person = 0;
  double time_s = 0.0;
};

/// What the cameras of a rig see of everybody at some moments, under models of the rig. M moments, K keypoints.
class RigSamples {
 public:
  /// `other_side` (K): OtherSides. `rig`, `take` and `other_side` must outlive this.
  RigSamples(const std::vector<RigView>& rig, const Association& take, const std::vector<std::size_t>& other_side,
             std::vector<RigMoment> moments);

  /// At most `most` moments at which at least two views observe a person, spread over the take; sorted by time.
  static std::vector<RigMoment> Spread(const std::vector<RigView>& rig, const Association& take, int most);

  const std::vector<RigMoment>& moments() const { return moments_; }
  int count() const { return static_cast<int>(moments_.size()); }
  int keypoints() const { return rig_[0].keypoints; }
  std::size_t views() const { return rig_.size(); }
  /// Seconds between two frames of the view.
  double Step(std::size_t view) const { return step_[view]; }

  /// Detections of a view at all moments, `later_s` later than the model says; the camera is the part's, and what it
  /// does not hold for is not seen. (M*K)
  ViewKeypoints View(const RigModel& model, std::size_t view, std::size_t part, double later_s = 0.0) const;

  /// All views, with a further one for each second part; `view_of` (if given) tells whose.
  std::vector<ViewKeypoints> Views(const RigModel& model, std::vector<std::size_t>* view_of = nullptr) const;

 private:
  const std::vector<RigView>& rig_;
  const Association& take_;
  const std::vector<std::size_t>& other_side_;
  std::vector<RigMoment> moments_;
  std::vector<double> step_;
};

/// Pixel errors of detections against points, lens distortion taken off on both sides; infinite behind the camera.
Vector2d PixelError(const ViewKeypoints& view, std::size_t at, const Vector3d& point);

/// How well a rig explains what it sees: heavy-tailed negative log likelihoods of the pixel errors, summed over each
/// moment's detections (M); what belongs to no point costs as much as the worst.
std::vector<double> CostOfMoments(const std::vector<ViewKeypoints>& views, const TriangulatedTracks& points,
                                  double noise_px);

/// Of all moments.
double Sum(const std::vector<double>& costs);

/// (views, 12) median pixel error of each view's detections in equal spans of a take; 0 where it observes no person.
std::vector<std::vector<double>> ResidualMap(const RigSamples& samples, const RigModel& model,
                                             const std::vector<double>& take_s, const TriangulationOptions& options);

}  // namespace mocurate
