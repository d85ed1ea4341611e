#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Joint tracks sorted by the joints of a skeleton. F frames, J joints. Where confidence is 0 the position is 0 and
/// means nothing. Metres, canonical world.
struct SkeletonTracks {
  SkeletonPtr skeleton;
  std::vector<double> time_s;      ///< (F) increasing
  JointPositions positions;        ///< (F,J,3)
  std::vector<double> confidence;  ///< (F*J) in [0, 1]
  /// (F*J) or empty: symmetric precision of a sample relative to a typical one, which has the identity. Its information
  /// is precision / sigma^2 with the sigma of the tracks. Replaces the confidence's square.
  std::vector<Matrix3d> precision;
  /// (F*J) or empty: recorded world rotations, up to a constant rotation within each joint; see JointTracks.
  std::vector<Quaterniond> rotation;
  std::vector<double> rotation_confidence;  ///< (F*J) or empty
  /// (J) or empty: standard deviation per axis of a tracked point's constant offset on the person; 0 for joints.
  std::vector<double> place_sigma;

  /// Standard deviation per axis that the noise has at least, metres: markers move with the skin, without noise.
  double least_sigma = 0.0;

  int frames() const { return positions.frames; }
  int joints() const { return positions.joints; }
  double confidence_at(int frame, int joint) const {
    return confidence[static_cast<std::size_t>(frame) * positions.joints + joint];
  }
  bool seen(int frame, int joint) const { return confidence_at(frame, joint) > 0.0; }
  Matrix3d precision_at(int frame, int joint) const {
    const double c = confidence_at(frame, joint);
    return precision.empty() ? Matrix3d(c * c * Matrix3d::Identity())
                             : precision[static_cast<std::size_t>(frame) * positions.joints + joint];
  }
  /// Whether a joint's place is observed in each frame: where it is seen or, of markers, where a marker that moves with
  /// it is, or markers are on both sides of it, above and below. (F*J)
  std::vector<bool> ObservedSamples() const;
  /// Whether the joint is observed in any frame. (J)
  std::vector<bool> JointObservations() const;
  /// Whether any joint is observed in the frame. (F)
  std::vector<bool> ObservedFrames() const;
};

/// Finds the joint of every track by name or synonym; landmarks are skipped. Values with confidence 0 are not read.
/// Errors: kInconsistent for unknown names (all of them), two tracks of one joint, shapes that disagree, time that does
/// not increase, no observation; kMalformed for an observed value that is not finite and for confidence outside [0, 1].
Expected<SkeletonTracks> MapTracks(const JointTracks& tracks, const SkeletonPtr& skeleton);

/// The same samples on the body of a person: a skeleton of the same joints with other rest offsets.
SkeletonTracks OnBody(SkeletonTracks tracks, const SkeletonPtr& body);

/// Frames [begin, end).
SkeletonTracks CutTracks(const SkeletonTracks& tracks, int begin, int end);

}  // namespace mocurate
