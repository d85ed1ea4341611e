#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/motion/motion.h"
#include "core/quality/handedness.h"

namespace mocurate {

/// One person's points as a view for the detectors of this module: the data must outlive the view. Metres and seconds;
/// any axes, except where y up is required.
struct TrackedPoints {
  const JointPositions& positions;        ///< (F,K,3)
  const std::vector<double>& confidence;  ///< (F*K), 0 is missing; empty: all are there
  const std::vector<double>& time_s;      ///< (F) increasing
  std::vector<std::string> names = {};    ///< (K), or empty
  std::vector<int> parents = {};          ///< (K) the point at the other end of its bone, -1 for none; or empty
  std::vector<double> rest_lengths = {};  ///< (K) of that bone in a rest pose, in any unit, 0 unknown; or empty
  BodyLandmarks body = {};                ///< which of them are hips, knees ...; -1 where that is not known

  int frames() const { return positions.frames; }
  int count() const { return positions.joints; }
  double confidence_at(int frame, int point) const {
    return confidence.empty() ? 1.0 : confidence[static_cast<std::size_t>(frame) * positions.joints + point];
  }
  bool sees(int frame, int point) const { return confidence_at(frame, point) > 0.0; }
  Vector3d at(int frame, int point) const { return positions.at(frame, point); }
  /// Diagonal of the bounding box of the observed points of a frame, if there are at least `fewest`.
  std::optional<double> Extent(int frame, int fewest) const {
    int seen = 0;
    Vector3d low = Vector3d::Zero(), high = Vector3d::Zero();
    for (int k = 0; k < count(); ++k) {
      if (!sees(frame, k)) continue;
      const Vector3d place = at(frame, k);
      low = seen == 0 ? place : Vector3d(low.cwiseMin(place));
      high = seen == 0 ? place : Vector3d(high.cwiseMax(place));
      ++seen;
    }
    return seen >= fewest ? std::optional<double>((high - low).norm()) : std::nullopt;
  }
  std::string name(int point) const {
    return names.empty() ? "#" + std::to_string(point) : names[static_cast<std::size_t>(point)];
  }
};

/// Bones between the points `names` as in `skeleton`: a point that the skeleton does not know has none, and a bone
/// skips joints that are not among the points.
struct PointBones {
  std::vector<int> parents;          ///< (K)
  std::vector<double> rest_lengths;  ///< (K) metres, of the skeleton
};
PointBones BonesBetween(const std::vector<std::string>& names, const Skeleton& skeleton);

/// Position of a person in a frame: the median of each coordinate of the observed points, at least three. Not observed
/// where there are fewer.
struct BodyCentre {
  bool seen = false;
  Vector3d place = Vector3d::Zero();
};
std::vector<BodyCentre> BodyCentres(const TrackedPoints& points);

/// Displacement of a person between two frames: the median of each coordinate over the points observed in both, at
/// least three. Empty where there are fewer.
std::optional<Vector3d> BodyStep(const TrackedPoints& points, int from, int to);

/// A finding of [begin, end) about `joint` (empty: all); severity warning, action "flagged".
Finding FrameFinding(const char* code, int begin, int end, const std::string& joint, double value, std::string message);

/// "0.87": to three significant digits.
std::string Digits(double value);

}  // namespace mocurate
