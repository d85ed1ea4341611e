#include "fitting/solver/body_size.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"
#include "fitting/association/body_shape.h"
#include "fitting/evidence/noise.h"
#include "fitting/solver/bone_lengths.h"

namespace mocurate {
namespace {

constexpr double kSmallestPerson = 0.35;  ///< ratio to the rest skeleton, at least
constexpr double kLargestPerson = 2.0;    ///< ratio to the rest skeleton, at most
/// Relative difference of a clip's bones from the person's that is reported. Source: 1,213 recorded clips
/// (docs/fitting.md)
constexpr double kSizeDiffers = 0.08;
constexpr double kPoint = 0.02;         ///< metres, standard deviation of joints along their longest direction
constexpr double kFlatBody = 0.005;     ///< ratio of thickness to extent, both standard deviations
constexpr int kFewestFlatFrames = 10;   ///< frames; fewer may be a planar pose
constexpr double kNearlyAlways = 0.95;  ///< of the frames
constexpr int kFewestJoints = 6;        ///< joints that a frame must show, at least

/// Standard deviations of the joints of a frame along their thinnest and their longest direction; empty with too few
/// joints.
std::optional<std::pair<double, double>> Extents(const SkeletonTracks& clip, int frame) {
  Vector3d mean = Vector3d::Zero();
  int count = 0;
  for (int j = 0; j < clip.joints(); ++j) {
    if (!clip.seen(frame, j)) continue;
    mean += clip.positions.at(frame, j);
    ++count;
  }
  if (count < kFewestJoints) return {};
  mean /= count;
  Matrix3d scatter = Matrix3d::Zero();
  for (int j = 0; j < clip.joints(); ++j) {
    if (!clip.seen(frame, j)) continue;
    const Vector3d away = clip.positions.at(frame, j) - mean;
    scatter += away * away.transpose() / count;
  }
  const Vector3d squares =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(scatter, Eigen::EigenvaluesOnly).eigenvalues().cwiseMax(0.0);
  return std::pair(std::sqrt(squares[0]), std::sqrt(squares[2]));
}

/// Millimetres to the tenth.
double Tenths(double metres) { return std::round(1e4 * metres) / 10.0; }

bool IsNear(double a, double b) { return std::abs(std::log(a / b)) <= std::log(kAnotherSize); }

}  // namespace

double SizeAgainst(const SkeletonTracks& clip, const std::vector<double>& bone_length) {
  const std::vector<double> white = {EstimateNoise(clip, {}).white};
  std::vector<double> ratios;
  for (int j = 1; j < clip.joints(); ++j) {
    const Joint& joint = clip.skeleton->joints[j];
    if (joint.rest_offset.norm() < kShortestKnownBone || bone_length[j] <= 0.0) continue;
    const BoneDistance seen = DistanceOver({clip}, white, j, joint.parent);
    if (seen.samples > 0) ratios.push_back(seen.length / bone_length[j]);
  }
  return MeanMedian(ratios);
}

std::vector<bool> HasPersonsSize(const std::vector<double>& sizes) {
  double person = 0.0;
  bool of_a_person = false;
  std::ptrdiff_t most = 0;
  for (const double size : sizes) {
    if (size <= 0.0) continue;
    const bool human = size >= kSmallestPerson && size <= kLargestPerson;
    const auto alike =
        std::count_if(sizes.begin(), sizes.end(), [&](double other) { return other > 0.0 && IsNear(size, other); });
    const bool nearer = person <= 0.0 || std::abs(std::log(size)) < std::abs(std::log(person));
    const bool better = human != of_a_person ? human : alike != most ? alike > most : nearer;
    if (person > 0.0 && !better) continue;
    person = size;
    of_a_person = human;
    most = alike;
  }
  std::vector<bool> of_it;
  for (const double size : sizes) of_it.push_back(size <= 0.0 || IsNear(size, person));
  return of_it;
}

Expected<std::optional<Finding>> CheckSize(const SkeletonTracks& clip, const std::vector<double>& bone_length,
                                           const std::string& where) {
  const double size = SizeAgainst(clip, bone_length);
  if (size <= 0.0 || std::abs(size - 1.0) <= kSizeDiffers) return std::optional<Finding>();
  const std::string compared =
      "the clip's bones are " + RoundedText(size, 3) + " times as long as those of the person's other clips";
  if (IsNear(size, 1.0)) {
    Finding finding = FrameFinding("size_differs", 0, 0, "", size,
                                   compared +
                                       ": check the clip's person. For a tracker that measures people anew in each "
                                       "recording, set proportions.body_of: recording");
    return std::optional<Finding>(std::move(finding));
  }
  const auto unit = FindUnit(size);
  return Fail(ErrorCode::kInconsistent, compared + (unit ? ": it looks like " + unit->text : std::string()), where,
              "correct the unit of this clip, or assign it to another person");
}

Status CheckBody(const SkeletonTracks& clip, const std::string& where) {
  std::vector<double> thickness, length;
  long long frames = 0, flat = 0;
  for (int f = 0; f < clip.frames(); ++f) {
    const auto extents = Extents(clip, f);
    if (!extents) continue;
    ++frames;
    length.push_back(extents->second);
    if (extents->second < kPoint) continue;  // no person
    thickness.push_back(extents->first);
    flat += extents->first <= kFlatBody * extents->second ? 1 : 0;
  }
  if (frames == 0 && clip.joints() >= kFewestJoints) {
    return Fail(ErrorCode::kInconsistent,
                "no frame shows " + std::to_string(kFewestJoints) + " joints: the pose of the body is not determined",
                where, "map more joints of the source (ingest.source.joints), or drop the clip");
  }
  const auto bodies = static_cast<long long>(thickness.size());
  if (frames > 0 && bodies == 0) {
    return Fail(ErrorCode::kInconsistent,
                "no person: all joints lie in one point (to " + RoundedText(Tenths(MeanMedian(length)), 3) +
                    " mm in the median) in all of " + Counted(frames, "frame"),
                where, "drop the clip; where the point means \"not observed\", set ingest.source.missing: zero");
  }
  if (flat < kFewestFlatFrames || flat < kNearlyAlways * static_cast<double>(bodies)) return {};
  return Fail(ErrorCode::kInconsistent,
              "all joints lie in one plane (to " + RoundedText(Tenths(MeanMedian(thickness)), 3) +
                  " mm in the median) in " + std::to_string(flat) + " of " + Counted(bodies, "frame") +
                  ": 2-D points without depth are not joint tracks, as the pose across the plane is unknown",
              where, "give positions with their depth, or the 2-D points of two calibrated cameras (keypoints)");
}

}  // namespace mocurate
