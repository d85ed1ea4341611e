#pragma once

#include <vector>

#include "core/base/finding.h"
#include "fitting/triangulation/keypoint_tracks.h"
#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {

/// `points` of all views, or, where cameras disagree with the others, those of the other views alone: a point of one
/// such camera and one other cannot be checked by a third, and may be anywhere along the other's ray. The cameras'
/// agreement stays that of `points`. With fewer than two other views nothing is excluded.
TriangulatedTracks WithoutOddCameras(TriangulatedTracks points, std::vector<ViewKeypoints> views, int frames,
                                     int keypoints, const TriangulationOptions& options);

/// "camera_without_person" (`unseen`: share of each camera's frames without the person) and "camera_disagrees".
void ReportRigCameras(const KeypointReport& report, const std::vector<double>& unseen, double outlier,
                      std::vector<Finding>& findings);

}  // namespace mocurate
