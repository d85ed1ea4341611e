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

std::array<int, 3> Millimetres(const Vector3d& point, const Vector3d& origin) {
  std::array<int, 3> mm{};
  for (int i = 0; i < 3; ++i)
    mm[i] = static_cast<int>(std::lround(std::clamp(1e3 * (point[i] - origin[i]), -1e6, 1e6)));
  return mm;
}

/// Whole millimetres of some points, null instead of those not `seen`.
template <class Seen>
nlohmann::json FrameJson(const JointPositions& points, int frame, const Vector3d& origin, Seen&& seen) {
  nlohmann::json row = nlohmann::json::array();
  for (int j = 0; j < points.joints; ++j) {
    const std::array<int, 3> mm = Millimetres(seen(j) ? Vector3d(points.at(frame, j)) : origin, origin);
    for (const int value : mm) row.push_back(seen(j) ? nlohmann::json(value) : nlohmann::json());
  }
  return row;
}

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

std::string PlayerHtml(const std::string& name, const std::string& id, bool has_points) {
  const std::string escaped = EscapeHtml(name);
  return "<div class=\"player\" role=\"group\" aria-label=\"Player of " + escaped +
         "\">\n<canvas tabindex=\"0\" role=\"img\" aria-label=\"" + escaped +
         " in motion; drag or use the arrow keys to turn\"></canvas>\n<div class=\"controls\"><button "
         "type=\"button\">Play</button>"
         "<input type=\"range\" min=\"0\" value=\"0\" step=\"1\" aria-label=\"Frame of " +
         escaped + "\"><output>0.00 s</output><label" + std::string(has_points ? "" : " hidden") + " for=\"seen-" + id +
         "\"><input type=\"checkbox\" id=\"seen-" + id + "\" checked> evidence</label></div>\n</div>\n";
}

nlohmann::json PlayerData(const std::string& name, const Motion& motion, const JointTracks* tracks, int most_numbers) {
  const Vector3d origin = motion.joints.at(0, 0);
  const int per_frame = 3 * (motion.joint_count() + (tracks ? tracks->positions.joints : 0));
  const int frames = motion.frame_count();
  const int allowed = std::max(2, most_numbers / std::max(1, per_frame));
  const int step = std::max(1, (frames + allowed - 1) / allowed);
  const Viewpoint view = FrontView(motion);
  nlohmann::json data = {{"name", name},
                         {"hz", motion.rate.hz()},
                         {"step", step},
                         {"yaw", std::round(view.yaw * 1e3) / 1e3},
                         {"pitch", view.pitch},
                         {"bones", nlohmann::json::array()},
                         {"lines", nlohmann::json::array()},
                         {"joints", nlohmann::json::array()},
                         {"points", nlohmann::json::array()}};
  const std::vector<int> sides = SidesOf(*motion.skeleton);
  for (int j = 1; j < motion.joint_count(); ++j) {
    data["bones"].push_back({motion.skeleton->joints[j].parent, j, sides[j]});
  }
  if (tracks != nullptr) {
    for (const auto& line : MatchTracks(tracks->names, *motion.skeleton).lines) data["lines"].push_back(line);
  }
  for (int f = 0; f < frames; f += step) {
    data["joints"].push_back(FrameJson(motion.joints, f, origin, [](int) { return true; }));
    if (tracks == nullptr) continue;
    data["points"].push_back(
        FrameJson(tracks->positions, f, origin, [&](int point) { return Observes(*tracks, f, point); }));
  }
  return data;
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
