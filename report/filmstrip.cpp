#include "report/filmstrip.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/store/store.h"
#include "report/html.h"
#include "report/svg.h"

namespace mocurate {
namespace {

constexpr double kThreeQuarter = 0.45;  ///< radians
constexpr double kRaised = 0.12;

bool Present(const JointTracks& tracks, int frame, int point) {
  if (frame >= tracks.positions.frames) return false;
  const std::size_t index = static_cast<std::size_t>(frame) * tracks.positions.joints + point;
  return tracks.confidence[index] > 0.0 && tracks.positions.at(frame, point).allFinite();
}

const char* BoneClass(int side) { return side > 0 ? "bone left" : side < 0 ? "bone right" : "bone"; }

std::string SegmentLine(const Vector3d& a, const Vector3d& b, const char* css_class) {
  return "<line x1=\"" + Coordinate(a.x()) + "\" y1=\"" + Coordinate(a.y()) + "\" x2=\"" + Coordinate(b.x()) +
         "\" y2=\"" + Coordinate(b.y()) + "\" class=\"" + css_class + "\"/>";
}

/// Places one still after the other on a strip.
class StripDrawing {
 public:
  StripDrawing(const Motion& motion, const JointTracks* tracks, const std::vector<int>& frames, bool bones)
      : motion_(motion), tracks_(tracks), bones_(bones), view_(FrontView(motion)) {
    for (const int frame : frames) AddExtent(frame);
    if (!(high_ > low_)) low_ = -1.0, high_ = 1.0;
    scale_ = (kHeight - 34.0) / (high_ - low_);
    cell_ = std::clamp((right_ - left_) * scale_ + 20.0, 60.0, 260.0);
  }

  double cell() const { return cell_; }
  static constexpr double kHeight = 210.0;

  std::string Still(int frame, int position) const {
    const Vector3d centre = view_.Turn(motion_.joints.at(frame, 0));
    const auto place = [&](const Vector3d& world) {
      const Vector3d seen = view_.Turn(world);
      return Vector3d((position + 0.5) * cell_ + scale_ * (seen.x() - centre.x() - 0.5 * (left_ + right_)),
                      8.0 + scale_ * (high_ - seen.y()), 0.0);
    };
    std::string svg = "<g>";
    const TrackDrawing drawing = tracks_ ? MatchTracks(tracks_->names, *motion_.skeleton) : TrackDrawing();
    for (const auto& [a, b] : drawing.lines) {
      if (!Present(*tracks_, frame, a) || !Present(*tracks_, frame, b)) continue;
      svg += SegmentLine(place(tracks_->positions.at(frame, a)), place(tracks_->positions.at(frame, b)), "seen");
    }
    const std::vector<int> sides = SidesOf(*motion_.skeleton);
    for (int j = 1; bones_ && j < motion_.joint_count(); ++j) {
      const Vector3d parent = motion_.joints.at(frame, motion_.skeleton->joints[j].parent);
      svg += SegmentLine(place(parent), place(motion_.joints.at(frame, j)), BoneClass(sides[j]));
    }
    for (int k = 0; tracks_ && k < tracks_->positions.joints; ++k) {
      if (!Present(*tracks_, frame, k)) continue;
      const Vector3d at = place(tracks_->positions.at(frame, k));
      svg += "<circle cx=\"" + Coordinate(at.x()) + "\" cy=\"" + Coordinate(at.y()) + "\" r=\"2.6\" class=\"point\"/>";
    }
    return svg + "</g>\n";
  }

 private:
  void AddExtent(int frame) {
    const Vector3d centre = view_.Turn(motion_.joints.at(frame, 0));
    for (int j = 0; j < motion_.joint_count(); ++j) {
      const Vector3d seen = view_.Turn(motion_.joints.at(frame, j));
      low_ = std::min(low_, seen.y());
      high_ = std::max(high_, seen.y());
      left_ = std::min(left_, seen.x() - centre.x());
      right_ = std::max(right_, seen.x() - centre.x());
    }
  }

  const Motion& motion_;
  const JointTracks* tracks_;
  bool bones_;
  Viewpoint view_;
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
  double left_ = -0.2;  ///< of the middle of a still
  double right_ = 0.2;
  double scale_ = 1.0;
  double cell_ = 100.0;
};

std::array<int, 3> Millimetres(const Vector3d& point, const Vector3d& origin) {
  std::array<int, 3> mm{};
  for (int i = 0; i < 3; ++i)
    mm[i] = static_cast<int>(std::lround(std::clamp(1e3 * (point[i] - origin[i]), -1e6, 1e6)));
  return mm;
}

nlohmann::json JointFrame(const Motion& motion, int frame, const Vector3d& origin) {
  nlohmann::json row = nlohmann::json::array();
  for (int j = 0; j < motion.joint_count(); ++j) {
    for (const int value : Millimetres(motion.joints.at(frame, j), origin)) row.push_back(value);
  }
  return row;
}

nlohmann::json PointFrame(const JointTracks& tracks, int frame, const Vector3d& origin) {
  nlohmann::json row = nlohmann::json::array();
  for (int k = 0; k < tracks.positions.joints; ++k) {
    if (!Present(tracks, frame, k)) {
      for (int i = 0; i < 3; ++i) row.push_back(nullptr);
      continue;
    }
    for (const int value : Millimetres(tracks.positions.at(frame, k), origin)) row.push_back(value);
  }
  return row;
}

}  // namespace

std::vector<int> SidesOf(const Skeleton& skeleton) {
  std::vector<int> sides(skeleton.joints.size(), 0);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint& joint = skeleton.joints[j];
    if (joint.mirror < 0 || joint.mirror == j) continue;
    const double own = joint.rest_offset.x();
    const double other = skeleton.joints[joint.mirror].rest_offset.x();
    if (std::abs(own - other) > 1e-6)
      sides[j] = own > other ? 1 : -1;
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

Viewpoint FrontView(const Motion& motion) {
  Viewpoint view{kThreeQuarter, kRaised};
  const int frame = motion.frame_count() / 2;
  for (const auto& pair : {motion.skeleton->Hips(), motion.skeleton->Shoulders()}) {
    if (!pair || motion.frame_count() == 0) continue;
    const Vector3d sideways = motion.joints.at(frame, (*pair)[0]) - motion.joints.at(frame, (*pair)[1]);
    if (std::hypot(sideways.x(), sideways.z()) < 1e-6) continue;
    view.yaw = kThreeQuarter - std::atan2(sideways.z(), sideways.x());
    break;
  }
  return view;
}

std::vector<int> StillFrames(int frame_count, int stills) {
  std::vector<int> frames;
  const int count = std::min(frame_count, stills);
  for (int i = 0; i < count; ++i) {
    frames.push_back(count == 1 ? 0 : static_cast<int>(static_cast<std::int64_t>(i) * (frame_count - 1) / (count - 1)));
  }
  return frames;
}

std::string FilmstripSvg(const std::string& name, const Motion& motion, const JointTracks* tracks, bool bones) {
  const std::vector<int> frames = StillFrames(motion.frame_count());
  if (frames.empty()) return "";
  const StripDrawing drawing(motion, tracks, frames, bones);
  const double width = drawing.cell() * static_cast<double>(frames.size());
  std::string svg = "<svg class=\"strip\" viewBox=\"0 0 " + Coordinate(width) + " " +
                    Coordinate(StripDrawing::kHeight) + "\" role=\"img\" aria-label=\"Stick figures of " +
                    EscapeHtml(name) + ", " + std::to_string(frames.size()) + " stills from " +
                    std::to_string(motion.frame_count()) + " frames\">\n";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    svg += drawing.Still(frames[i], static_cast<int>(i));
    svg += "<text x=\"" + Coordinate((static_cast<double>(i) + 0.5) * drawing.cell()) + "\" y=\"" +
           Coordinate(StripDrawing::kHeight - 4.0) + "\" text-anchor=\"middle\" class=\"label\">" +
           FixedText(motion.rate.FrameTime(frames[i]), 2) + " s</text>\n";
  }
  return svg + "</svg>\n";
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
    data["joints"].push_back(JointFrame(motion, f, origin));
    if (tracks != nullptr) data["points"].push_back(PointFrame(*tracks, f, origin));
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
