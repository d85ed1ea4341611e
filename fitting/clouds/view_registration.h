#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/clouds/view_surface.h"

namespace mocurate {

/// Surfaces of all views at a moment; null for a view without a person.
using ObservedMoment = std::vector<const ViewSurface*>;

/// Views of a rig at some moments.
struct ObservedRig {
  std::vector<DepthView> views;                            ///< as given
  std::vector<ObservedMoment> moments;                     ///< ordered by group
  int together = 1;                                        ///< moments per group, in consecutive frames: a group is one
                                                           ///< sample
  Vector3d centre = Vector3d::Zero();                      ///< of the person, mean over all moments, as given
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< compared views, first < second
};

/// Cameras of the views, as given.
std::vector<Camera> CamerasOf(const std::vector<DepthView>& views);

/// Loss per point of each pair at each group of moments, in [0, 1]; kNotObserved when one of both has no person
/// (numerical). (groups * pairs)
inline constexpr double kNotObserved = -1.0;
std::vector<double> LossOfSamples(const ObservedRig& rig, const std::vector<Camera>& cameras);

/// Mean of the losses without kNotObserved; 0 without any.
double MeanLoss(const std::vector<double>& losses);

/// Confidence that losses are lower than others, over samples that both have, of pairs with `view` if given: the lower
/// one of single samples and of the means of groups of moments, where there is more than one.
double ConfidenceOfLosses(const ObservedRig& rig, const std::vector<double>& worse, const std::vector<double>& better,
                          std::optional<std::size_t> view = {});

/// Half (0, 1) of each sample of LossOfSamples: alternate groups of moments; of one group, alternate pairs.
std::vector<int> HalvesOfSamples(const ObservedRig& rig);

/// Registers the free cameras of a rig to the others by their common surfaces. Minimises point-to-plane distances over
/// all moments, with new matches after every step. Each step is a pose graph over the free cameras (node 0: all others)
/// whose edges are the normal equations of the pairs. A camera without matches keeps its pose. `from`: initial cameras.
/// Errors of SolvePoseGraph.
Expected<std::vector<Camera>> Register(const ObservedRig& rig, const std::vector<bool>& free, std::vector<Camera> from);

/// (2) cameras registered to the samples of each half alone (HalvesOfSamples). Errors of Register.
Expected<std::vector<std::vector<Camera>>> RegisterHalves(const ObservedRig& rig, const std::vector<bool>& free,
                                                          const std::vector<Camera>& from);

/// LossOfSamples, the samples of each half with the cameras `of_half` of the other half.
std::vector<double> HeldOutLosses(const ObservedRig& rig, const std::vector<std::vector<Camera>>& of_half);

/// Displacement of the person by a change of a camera's pose: rotation about the centre and shift there.
struct CameraMoveAt {
  double shift = 0.0;  ///< m
  double turn = 0.0;   ///< rad
};
CameraMoveAt MoveBetween(const Camera& given, const Camera& other, const Vector3d& centre);

/// The fault of such a move; the audit sets confidence and correction. `centre`: of the person.
RigFault CameraMoved(const Camera& was, const Camera& is, const Vector3d& centre);

}  // namespace mocurate
