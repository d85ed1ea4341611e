#include "report/filmstrip.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/store/store.h"
#include "report/html.h"

namespace mocurate {
namespace {

constexpr double kThreeQuarter = 0.45;  ///< radians
constexpr double kRaised = 0.12;

}  // namespace

bool Observes(const JointTracks& tracks, int frame, int point) {
  if (frame >= tracks.positions.frames) return false;
  const std::size_t index = static_cast<std::size_t>(frame) * tracks.positions.joints + point;
  return tracks.confidence[index] > 0.0 && tracks.positions.at(frame, point).allFinite();
}

std::vector<int> SidesOf(const Skeleton& skeleton) {
  std::vector<int> sides(skeleton.joints.size(), 0);
  std::vector<double> place;  // along x in the rest pose, of the whole chain: a single bone may point inwards
  for (const Joint& joint : skeleton.joints) {
    place.push_back(joint.rest_offset.x() + (joint.parent >= 0 ? place[static_cast<std::size_t>(joint.parent)] : 0.0));
  }
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint& joint = skeleton.joints[j];
    if (joint.mirror < 0 || joint.mirror == j) continue;
    const double apart = place[j] - place[joint.mirror];
    if (std::abs(apart) > 1e-6)
      sides[j] = apart > 0.0 ? 1 : -1;
    else if (joint.parent >= 0)
      sides[j] = sides[joint.parent];
  }
  return sides;
}

TrackDrawing MatchTracks(const std::vector<std::string>& names, const Skeleton& skeleton) {
  TrackDrawing drawing;
  drawing.point_of_joint.assign(skeleton.joints.size(), -1);
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (const auto joint = skeleton.FindJoint(names[k])) drawing.point_of_joint[*joint] = static_cast<int>(k);
  }
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (drawing.point_of_joint[j] < 0) continue;
    int ancestor = skeleton.joints[j].parent;
    while (ancestor >= 0 && drawing.point_of_joint[ancestor] < 0) ancestor = skeleton.joints[ancestor].parent;
    if (ancestor >= 0) drawing.lines.push_back({drawing.point_of_joint[ancestor], drawing.point_of_joint[j]});
  }
  return drawing;
}

Vector3d Viewpoint::Turn(const Vector3d& point) const {
  const double x = std::cos(yaw) * point.x() - std::sin(yaw) * point.z();
  const double z = std::sin(yaw) * point.x() + std::cos(yaw) * point.z();
  return {x, std::cos(pitch) * point.y() - std::sin(pitch) * z, std::sin(pitch) * point.y() + std::cos(pitch) * z};
}

double FrontYaw(const Motion& motion) {
  const int frame = motion.frame_count() / 2;
  for (const auto& pair : {motion.skeleton->Hips(), motion.skeleton->Shoulders()}) {
    if (!pair || motion.frame_count() == 0) continue;
    const Vector3d sideways = motion.joints.at(frame, (*pair)[0]) - motion.joints.at(frame, (*pair)[1]);
    if (std::hypot(sideways.x(), sideways.z()) >= 1e-6) return -std::atan2(sideways.z(), sideways.x());
  }
  return 0.0;
}

Viewpoint FrontView(const Motion& motion) { return {kThreeQuarter + FrontYaw(motion), kRaised}; }

std::vector<int> StillFrames(int frame_count, int stills) {
  std::vector<int> frames;
  const int count = std::min(frame_count, stills);
  for (int i = 0; i < count; ++i) {
    frames.push_back(count == 1 ? 0 : static_cast<int>(static_cast<std::int64_t>(i) * (frame_count - 1) / (count - 1)));
  }
  return frames;
}

std::string PlayerHtml(const std::string& name) {
  const std::string escaped = EscapeHtml(name);
  return "<div class=\"player\" role=\"group\" aria-label=\"Player of " + escaped +
         "\">\n<canvas tabindex=\"0\" role=\"img\" aria-label=\"" + escaped +
         " in motion; drag or use the arrow keys to turn\"></canvas>\n<div class=\"controls\"><button "
         "type=\"button\">Play</button><input type=\"range\" min=\"0\" value=\"0\" step=\"1\" aria-label=\"Frame of " +
         escaped + "\"><output>0.00 s</output></div>\n</div>\n";
}

const JointTracks* TracksOf(const DrawnClip& clip) {
  return clip.evidence.evidence.tracks ? &*clip.evidence.evidence.tracks : nullptr;
}

Expected<DrawnClip> ReadDrawnClip(const StageRequest& request, const StageInput& evidence,
                                  std::vector<Finding>* findings) {
  DrawnClip drawn;
  drawn.item = evidence.name;
  auto clip = ReadEvidence(evidence.path);
  if (!clip) return Forward(clip);
  drawn.evidence = std::move(*clip);
  const StageInput* fit = nullptr;
  std::map<std::string, std::filesystem::path> depth_files;
  for (const StageInput& input : request.inputs) {
    if (input.role == "depth") depth_files[input.name] = input.path;
    if (input.role == "fit" && input.name == evidence.name) fit = &input;
  }
  ResolveDepthFiles(depth_files, drawn.evidence.evidence);
  if (fit == nullptr || fit->path == evidence.path) {
    drawn.fitted = drawn.evidence;
  } else {
    auto fitted = ReadDataset(fit->path);
    if (!fitted) return Forward(fitted);
    if (fitted->clips.empty()) return Fail(ErrorCode::kInconsistent, "the fit has no clip", fit->name);
    drawn.fitted = std::move(fitted->clips.front());
    if (findings != nullptr) *findings = std::move(fitted->findings);
  }
  if (!drawn.fitted.motion) return Fail(ErrorCode::kInconsistent, "the clip has no motion", drawn.item);
  return drawn;
}

Expected<DrawnClip> ReadDrawnClip(const StageRequest& request, std::vector<Finding>* findings) {
  const StageInput* evidence = FindInput(request, "evidence");
  if (evidence == nullptr) return Fail(ErrorCode::kInternal, "a picture needs evidence", request.item);
  return ReadDrawnClip(request, *evidence, findings);
}

}  // namespace mocurate
