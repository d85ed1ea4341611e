#include "fitting/audit/move_doubt.h"

#include <algorithm>
#include <utility>

namespace mocurate {
namespace {

constexpr double kLeastShareOfNoise = 2.0;   ///< of the noise of a detection
constexpr double kLeastDoubtedMove = 0.008;  ///< m, at the person

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

bool StandAlike(const Camera& a, const Camera& b) {
  return a.camera_from_world.translation == b.camera_from_world.translation &&
         a.camera_from_world.rotation.coeffs() == b.camera_from_world.rotation.coeffs();
}

std::vector<std::size_t> MovedViews(const RigModel& given, const RigModel& model) {
  std::vector<std::size_t> moved;
  for (std::size_t v = 0; v < given.camera.size(); ++v) {
    const std::vector<CameraPart>& parts = model.camera[v];
    const auto stands = [&](const CameraPart& part) { return StandAlike(part.camera, given.camera[v][0].camera); };
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
    const SeenMove seen = MoveAtPoints(was, part.camera, points);
    return seen.px >= kLeastShareOfNoise * noise_px && seen.m >= kLeastDoubtedMove;
  });
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
