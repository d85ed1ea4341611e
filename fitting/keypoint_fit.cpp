#include "fitting/keypoint_fit.h"

#include <algorithm>
#include <utility>

#include "fitting/evidence/detector_points.h"
#include "fitting/solver/bone_lengths.h"
#include "fitting/solver/joint_track_fit.h"
#include "fitting/triangulation/keypoint_tracks.h"

namespace mocurate {
namespace {

/// Leaves out keypoints that are neither a joint of the body nor a point of it.
JointTracks KnownTracks(const JointTracks& tracks, const Skeleton& body) {
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < tracks.names.size(); ++k) {
    if (body.FindJoint(tracks.names[k])) kept.push_back(k);
  }
  JointTracks known;
  known.time_s = tracks.time_s;
  known.positions = JointPositions(tracks.positions.frames, static_cast<int>(kept.size()));
  for (const std::size_t k : kept) known.names.push_back(tracks.names[k]);
  for (int f = 0; f < tracks.positions.frames; ++f) {
    for (std::size_t i = 0; i < kept.size(); ++i) {
      known.positions.at(f, static_cast<int>(i)) = tracks.positions.at(f, static_cast<int>(kept[i]));
      known.confidence.push_back(tracks.confidence[f * tracks.names.size() + kept[i]]);
    }
  }
  return known;
}

/// Of each joint's samples, (F*J).
std::vector<Matrix3d> PrecisionOnBody(const KeypointTracks& found, const Skeleton& body) {
  const std::size_t keypoints = found.tracks.names.size();
  const auto frames = static_cast<std::size_t>(found.tracks.positions.frames);
  const std::size_t joints = body.joints.size();
  std::vector<Matrix3d> precision(frames * joints, Matrix3d::Identity());
  for (std::size_t k = 0; k < keypoints; ++k) {
    const auto joint = body.FindJoint(found.tracks.names[k]);
    if (!joint) continue;
    for (std::size_t f = 0; f < frames; ++f) {
      precision[f * joints + static_cast<std::size_t>(*joint)] = found.precision[f * keypoints + k];
    }
  }
  return precision;
}

}  // namespace

Expected<BodyTracks> TracksOnBody(const Evidence& evidence, const Skeleton& skeleton, const SkeletonPtr& body,
                                  const KeypointFitOptions& options) {
  Expected<KeypointTracks> found = TriangulateKeypoints(evidence, skeleton, options);
  if (!found) return Forward(found);
  Expected<SkeletonTracks> mapped = MapTracks(KnownTracks(found->tracks, *body), body);
  if (!mapped) return Forward(mapped);
  mapped->precision = PrecisionOnBody(*found, *body);
  return BodyTracks{std::move(*mapped), std::move(found->report), std::move(found->findings)};
}

Expected<FitResult> FitKeypointsOnBody(const Evidence& evidence, const FrameRate& rate, const SkeletonPtr& skeleton,
                                       const SkeletonPtr& body, const std::vector<double>& bone_length,
                                       const FittingOptions& options) {
  Expected<BodyTracks> found = TracksOnBody(evidence, *skeleton, body, options.keypoints);
  if (!found) return Forward(found);
  const std::vector<double> bones =
      bone_length.empty() ? EstimateBoneLengths({found->tracks}, *body, true).length : bone_length;
  Expected<FitResult> fit = FitJointTracks(found->tracks, rate, bones, Bones::kFixed, options.joint_tracks);
  if (!fit) return fit;
  if (!found->report.faults.empty()) fit->rig_audit = FaultsText(found->report.faults);
  fit->keypoints = std::move(found->report);
  fit->findings.insert(fit->findings.begin(), found->findings.begin(), found->findings.end());
  fit->triangulated = WithoutDetectorPoints(found->tracks, skeleton);
  return fit;
}

Expected<FitResult> FitKeypoints(const Evidence& evidence, const FrameRate& rate, const SkeletonPtr& skeleton,
                                 const SkeletonPtr& body, const std::vector<double>& bone_length,
                                 const FittingOptions& options) {
  Expected<FitResult> fit = FitKeypointsOnBody(evidence, rate, skeleton, body, bone_length, options);
  if (fit) fit->motion = WithoutDetectorPoints(fit->motion, skeleton);
  return fit;
}

}  // namespace mocurate
