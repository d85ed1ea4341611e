#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/clouds/view_comparison.h"

namespace mocurate {

/// What each view saw of a moment; null where it observed no person.
using ObservedMoment = std::vector<const ViewSurface*>;

/// Views of a rig at some moments, and where its cameras may stand.
struct ObservedRig {
  std::vector<DepthView> views;                            ///< as given
  std::vector<ObservedMoment> moments;                     ///< those of one group on end
  int together = 1;                                        ///< moments of a group, consecutive frames: one judgement
  Vector3d centre = Vector3d::Zero();                      ///< of the person over all moments, as given
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< views that are compared, first < second
};

/// Cameras of the views, as given.
std::vector<Camera> CamerasOf(const std::vector<DepthView>& views);

/// Loss per point of each pair at each group of moments, in [0, 1]; kNotObserved where one of both observed no person.
/// (groups * pairs)
inline constexpr double kNotObserved = -1.0;
std::vector<double> LossOfSamples(const ObservedRig& rig, const std::vector<Camera>& cameras);

/// Mean of the losses that were seen; 0 without any.
double MeanLoss(const std::vector<double>& losses);

/// How sure it is that losses are lower than others, of those samples that both have seen (ConfidenceOfSeparate).
double ConfidenceOfLosses(const std::vector<double>& worse, const std::vector<double>& better);

/// What places of cameras come to for views of one rig that may be moved, as it is tied to the others by what both see:
/// point-to-plane distances of all moments together, matched again after every step, each step a pose graph over the
/// free cameras (node 0: all others) whose edges are the normal equations of the pairs. Where nothing ties a camera it
/// stays. `from`: where the search begins. Errors of SolvePoseGraph.
Expected<std::vector<Camera>> Register(const ObservedRig& rig, const std::vector<bool>& free, std::vector<Camera> from);

/// How far a camera's pose takes the person from where another one does: a turn about the centre and a shift there.
struct CameraMoveAt {
  double shift = 0.0;  ///< m
  double turn = 0.0;   ///< rad
};
CameraMoveAt MoveBetween(const Camera& given, const Camera& other, const Vector3d& centre);

}  // namespace mocurate
