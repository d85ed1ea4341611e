#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "fitting/association/associate.h"
#include "fitting/association/rig_view.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {

/// A camera's pose from a moment on.
struct CameraPart {
  Camera camera;
  double from_s = -std::numeric_limits<double>::infinity();
};

/// Parameters of a rig: clocks and poses of its cameras, and exchanged sides (index: view).
struct RigModel {
  explicit RigModel(const std::vector<RigView>& rig);

  std::vector<double> clock_s;                  ///< a view's stamp t is the time t + clock
  std::vector<std::vector<CameraPart>> camera;  ///< one part, or two for a camera moved during the take
  std::vector<bool> sides_exchanged;            ///< left and right are exchanged in the view
};

/// A person at a moment of the take.
struct RigMoment {
  int person = 0;
  double time_s = 0.0;
};

/// Moments; fewest for clocks, poses and sides: one for each span of both halves (HalvesOf).
inline constexpr int kFewestMoments = 10;

/// First moments of takes of one rig that were joined in sequence, seconds, increasing. Empty: one take.
using TakeStarts = std::vector<double>;

/// The take of a moment; 0 for one take.
std::size_t TakeAt(const TakeStarts& takes, double time_s);

/// (takes) mean decrease of the moments' costs in each take; none for a take in which no cost changes, as where the
/// corrected camera detects nothing.
std::vector<std::optional<double>> GainOfTakes(const TakeStarts& takes, const std::vector<double>& time_s,
                                               const std::vector<double>& worse, const std::vector<double>& better);

/// Detections of all people in all views at some moments, under models of the rig. M moments, K keypoints.
class RigSamples {
 public:
  /// `other_side` (K): OtherSides. `rig`, `take` and `other_side` must outlive this.
  RigSamples(const std::vector<RigView>& rig, const Association& take, const std::vector<std::size_t>& other_side,
             std::vector<RigMoment> moments);

  /// At most `most` moments at which at least two views observe a person, evenly spaced over the take; sorted by time.
  /// Excluded: repeated frames, and takes without movement. `noise_px`: standard deviation of a detection.
  /// `takes`: several takes in sequence, each with its share of `most`.
  static std::vector<RigMoment> Spread(const std::vector<RigView>& rig, const Association& take, int most,
                                       double noise_px, const TakeStarts& takes = {});

  /// The moments of one half of the take (HalvesOf).
  RigSamples Half(int half) const;

  const std::vector<RigMoment>& moments() const { return moments_; }
  int count() const { return static_cast<int>(moments_.size()); }
  int keypoints() const { return rig_[0].keypoints; }
  std::size_t views() const { return rig_.size(); }
  /// Median seconds between two frames of the view.
  double Step(std::size_t view) const { return step_[view]; }

  /// Detections of a view at all moments, `later_s` later than in the model. Camera of the part; moments of other parts
  /// are unobserved. (M*K)
  ViewKeypoints View(const RigModel& model, std::size_t view, std::size_t part, double later_s = 0.0) const;

  /// All views, with a further one for each second part; `view_of` (if given) receives their view indices.
  std::vector<ViewKeypoints> Views(const RigModel& model, std::vector<std::size_t>* view_of = nullptr) const;

 private:
  const std::vector<RigView>& rig_;
  const Association& take_;
  const std::vector<std::size_t>& other_side_;
  std::vector<RigMoment> moments_;
  std::vector<double> step_;
};

/// Pixel errors of detections against points, without lens distortion; infinite behind the camera.
Vector2d PixelError(const ViewKeypoints& view, std::size_t at, const Vector3d& point);

/// Fit of a rig to its detections: heavy-tailed negative log likelihoods of the pixel errors, summed over each moment's
/// detections (M). Detections without a point have the largest cost.
std::vector<double> CostOfMoments(const std::vector<ViewKeypoints>& views, const TriangulatedTracks& points,
                                  double noise_px);

/// CostOfMoments under a model.
std::vector<double> CostsUnder(const RigSamples& samples, const RigModel& model, const TriangulationOptions& options);

/// CostsUnder, the moments of each half of the take (HalvesOf) under the model that `fit` gives for the other half.
std::vector<double> HeldOutCosts(const RigSamples& samples, const TriangulationOptions& options,
                                 const std::function<RigModel(const RigSamples&)>& fit);

/// Sum over all moments.
double Sum(const std::vector<double>& costs);

/// (views, 12) median pixel error of each view's detections in equal spans of a take; 0 without detections.
std::vector<std::vector<double>> ResidualMap(const RigSamples& samples, const RigModel& model,
                                             const std::vector<double>& take_s, const TriangulationOptions& options);

/// The views with the model's clocks, camera poses and left-right assignments. A camera that was moved during the take
/// becomes two views. The later one is named "NAME from frame N", by `time_s`, the frames of the take.
std::vector<RigView> CorrectedRig(const std::vector<RigView>& rig, const RigModel& model,
                                  const std::vector<std::size_t>& other_side, const std::vector<double>& time_s);

/// The first frame at or after a moment.
int FrameAt(const std::vector<double>& time_s, double moment);

}  // namespace mocurate
