#include "fitting/audit/move_finding.h"

#include <algorithm>
#include <utility>

#include "core/base/median.h"

namespace mocurate {
namespace {

/// Factor on the noise of a detection: smaller shifts of the image are not reported.
constexpr double kLeastShareOfNoise = 2.0;
constexpr double kGrossShift = 3.0;  ///< times the median shift: larger shifts come from wrong pairs of views

/// Longest distance between two cameras.
double ExtentOf(const RigModel& rig) {
  double extent = 0.0;
  for (const auto& one : rig.camera) {
    for (const auto& other : rig.camera) {
      extent = std::max(extent, (one[0].camera.Centre() - other[0].camera.Centre()).norm());
    }
  }
  return extent;
}

}  // namespace

bool HaveSamePose(const Camera& a, const Camera& b) {
  return a.camera_from_world.translation == b.camera_from_world.translation &&
         a.camera_from_world.rotation.coeffs() == b.camera_from_world.rotation.coeffs();
}

std::vector<std::size_t> MovedViews(const RigModel& given, const RigModel& model) {
  std::vector<std::size_t> moved;
  for (std::size_t v = 0; v < given.camera.size(); ++v) {
    const std::vector<CameraPart>& parts = model.camera[v];
    const auto stands = [&](const CameraPart& part) { return HaveSamePose(part.camera, given.camera[v][0].camera); };
    if (!std::all_of(parts.begin(), parts.end(), stands)) moved.push_back(v);
  }
  return moved;
}

bool GoesTooFar(const RigModel& given, const CameraMove& move) {
  double moved = 0.0;
  for (const CameraPart& part : move.camera) {
    moved = std::max(moved, (part.camera.Centre() - given.camera[move.view][0].camera.Centre()).norm());
  }
  return moved > ExtentOf(given);
}

bool IsNotableMove(const Camera& was, const std::vector<CameraPart>& parts, const TriangulatedTracks& points,
                   double noise_px) {
  return std::any_of(parts.begin(), parts.end(), [&](const CameraPart& part) {
    const ObservedMove seen = MoveAtPoints(was, part.camera, points);
    return seen.px >= kLeastShareOfNoise * noise_px && seen.m >= kLeastMove;
  });
}

Matrix3d ShiftBetween(const RigSamples& samples, const RigModel& one, const RigModel& other,
                      const TriangulationOptions& options) {
  const auto points = [&](const RigModel& model) {
    return TriangulateViews(samples.Views(model), samples.count(), samples.keypoints(), options);
  };
  const TriangulatedTracks here = points(one);
  const TriangulatedTracks there = points(other);
  std::vector<Vector3d> shifts;
  std::vector<double> lengths;
  for (std::size_t i = 0; i < here.confidence.size(); ++i) {
    if (here.confidence[i] <= 0.0 || there.confidence[i] <= 0.0) continue;
    shifts.emplace_back(Eigen::Map<const Vector3d>(here.positions.xyz.data() + 3 * i) -
                        Eigen::Map<const Vector3d>(there.positions.xyz.data() + 3 * i));
    lengths.push_back(shifts.back().norm());
  }
  const double gross = kGrossShift * MeanMedian(lengths);
  Matrix3d sum = Matrix3d::Zero();
  double count = 0.0;
  for (const Vector3d& shift : shifts) {
    if (shift.norm() > gross) continue;
    sum += shift * shift.transpose();
    count += 1.0;
  }
  return count > 0.0 ? Matrix3d(sum / count) : sum;
}

RigFault DisagreementOf(const std::vector<RigView>& rig, std::vector<std::size_t> views) {
  std::sort(views.begin(), views.end());
  views.erase(std::unique(views.begin(), views.end()), views.end());
  RigFault fault;
  fault.code = "views_disagree";
  for (const std::size_t v : views) fault.camera += (fault.camera.empty() ? "" : ", ") + rig[v].camera.camera.name;
  fault.message = "views disagree (" + fault.camera + "):";
  return fault;
}

}  // namespace mocurate
