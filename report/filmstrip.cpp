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

const Motion* MotionOf(const DrawnClip& clip) {
  if (clip.fitted.motion) return &*clip.fitted.motion;
  return clip.evidence.motion ? &*clip.evidence.motion : nullptr;
}

const JointTracks* TracksOf(const DrawnClip& clip) {
  return clip.evidence.evidence.tracks ? &*clip.evidence.evidence.tracks : nullptr;
}

bool Present(const JointTracks& tracks, int frame, int point) {
  if (frame >= tracks.positions.frames) return false;
  const std::size_t index = static_cast<std::size_t>(frame) * tracks.positions.joints + point;
  return tracks.confidence[index] > 0.0 && tracks.positions.at(frame, point).allFinite();
}

Viewpoint ViewpointOf(const DrawnClip& clip) {
  const Motion* motion = MotionOf(clip);
  return motion != nullptr ? FrontView(*motion) : Viewpoint{kThreeQuarter, kRaised};
}

Vector3d OriginOf(const DrawnClip& clip) {
  if (const Motion* motion = MotionOf(clip)) return motion->joints.at(0, 0);
  if (const JointTracks* tracks = TracksOf(clip)) {
    for (int f = 0; f < tracks->positions.frames; ++f) {
      for (int k = 0; k < tracks->positions.joints; ++k) {
        if (Present(*tracks, f, k)) return tracks->positions.at(f, k);
      }
    }
  }
  return Vector3d::Zero();
}

const char* BoneClass(int side) { return side > 0 ? "bone left" : side < 0 ? "bone right" : "bone"; }

std::string SegmentLine(const Vector3d& a, const Vector3d& b, const char* css_class) {
  return "<line x1=\"" + Coordinate(a.x()) + "\" y1=\"" + Coordinate(a.y()) + "\" x2=\"" + Coordinate(b.x()) +
         "\" y2=\"" + Coordinate(b.y()) + "\" class=\"" + css_class + "\"/>";
}

/// Places one still after the other on a strip.
class StripDrawing {
 public:
  StripDrawing(const DrawnClip& clip, const std::vector<int>& frames, StripLayers layers)
      : clip_(clip), layers_(layers), view_(ViewpointOf(clip)) {
    for (const int frame : frames) AddExtent(frame);
    if (!(high_ > low_)) low_ = -1.0, high_ = 1.0;
    scale_ = (kHeight - 34.0) / (high_ - low_);
    cell_ = std::clamp((right_ - left_) * scale_ + 20.0, 60.0, 260.0);
  }

  double cell() const { return cell_; }
  static constexpr double kHeight = 210.0;

  std::string Still(int frame, int position) const {
    const Vector3d centre = view_.Turn(CentreOf(frame));
    const auto place = [&](const Vector3d& world) {
      const Vector3d seen = view_.Turn(world);
      return Vector3d((position + 0.5) * cell_ + scale_ * (seen.x() - centre.x() - 0.5 * (left_ + right_)),
                      8.0 + scale_ * (high_ - seen.y()), 0.0);
    };
    std::string svg = "<g>";
    const Motion* motion = MotionOf(clip_);
    const JointTracks* tracks = TracksOf(clip_);
    const TrackDrawing drawing =
        tracks ? MatchTracks(*tracks, motion ? motion->skeleton.get() : nullptr) : TrackDrawing();
    const bool points = tracks != nullptr && layers_ != StripLayers::kFit;
    const bool bones = motion != nullptr && layers_ != StripLayers::kEvidence;
    for (const auto& [a, b] : drawing.lines) {
      if (!points || !Present(*tracks, frame, a) || !Present(*tracks, frame, b)) continue;
      svg += SegmentLine(place(tracks->positions.at(frame, a)), place(tracks->positions.at(frame, b)), "seen");
    }
    const std::vector<int> sides = motion ? SidesOf(*motion->skeleton) : std::vector<int>();
    for (int j = 1; bones && j < motion->joint_count(); ++j) {
      const int parent = motion->skeleton->joints[j].parent;
      svg +=
          SegmentLine(place(motion->joints.at(frame, parent)), place(motion->joints.at(frame, j)), BoneClass(sides[j]));
    }
    for (int k = 0; points && k < tracks->positions.joints; ++k) {
      if (!Present(*tracks, frame, k)) continue;
      const Vector3d at = place(tracks->positions.at(frame, k));
      svg += "<circle cx=\"" + Coordinate(at.x()) + "\" cy=\"" + Coordinate(at.y()) + "\" r=\"2.6\" class=\"point\"/>";
    }
    return svg + "</g>\n";
  }

 private:
  Vector3d CentreOf(int frame) const {
    if (const Motion* motion = MotionOf(clip_)) return motion->joints.at(frame, 0);
    Vector3d sum = Vector3d::Zero();
    int count = 0;
    if (const JointTracks* tracks = TracksOf(clip_)) {
      for (int k = 0; k < tracks->positions.joints; ++k) {
        if (!Present(*tracks, frame, k)) continue;
        sum += tracks->positions.at(frame, k);
        ++count;
      }
    }
    return count > 0 ? Vector3d(sum / count) : sum;
  }

  void AddExtent(int frame) {
    const Vector3d centre = view_.Turn(CentreOf(frame));
    const auto add = [&](const Vector3d& world) {
      const Vector3d seen = view_.Turn(world);
      low_ = std::min(low_, seen.y());
      high_ = std::max(high_, seen.y());
      left_ = std::min(left_, seen.x() - centre.x());
      right_ = std::max(right_, seen.x() - centre.x());
    };
    if (const Motion* motion = MotionOf(clip_)) {
      for (int j = 0; j < motion->joint_count(); ++j) add(motion->joints.at(frame, j));
    } else if (const JointTracks* tracks = TracksOf(clip_)) {
      for (int k = 0; k < tracks->positions.joints; ++k) {
        if (Present(*tracks, frame, k)) add(tracks->positions.at(frame, k));
      }
    }
  }

  const DrawnClip& clip_;
  StripLayers layers_;
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

TrackDrawing MatchTracks(const JointTracks& tracks, const Skeleton* skeleton) {
  TrackDrawing drawing;
  if (skeleton == nullptr) return drawing;
  drawing.point_of_joint.assign(skeleton->joints.size(), -1);
  for (std::size_t k = 0; k < tracks.names.size(); ++k) {
    if (const auto joint = skeleton->FindJoint(tracks.names[k])) drawing.point_of_joint[*joint] = static_cast<int>(k);
  }
  for (int j = 0; j < skeleton->joint_count(); ++j) {
    if (drawing.point_of_joint[j] < 0) continue;
    int ancestor = skeleton->joints[j].parent;
    while (ancestor >= 0 && drawing.point_of_joint[ancestor] < 0) ancestor = skeleton->joints[ancestor].parent;
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

int FrameCountOf(const DrawnClip& clip) {
  if (const Motion* motion = MotionOf(clip)) return motion->frame_count();
  const JointTracks* tracks = TracksOf(clip);
  return tracks != nullptr ? tracks->positions.frames : 0;
}

std::vector<int> StillFrames(int frame_count, int stills) {
  std::vector<int> frames;
  const int count = std::min(frame_count, stills);
  for (int i = 0; i < count; ++i) {
    frames.push_back(count == 1 ? 0 : static_cast<int>(static_cast<std::int64_t>(i) * (frame_count - 1) / (count - 1)));
  }
  return frames;
}

std::string FilmstripSvg(const DrawnClip& clip, StripLayers layers) {
  const std::vector<int> frames = StillFrames(FrameCountOf(clip));
  if (frames.empty()) return "";
  const StripDrawing drawing(clip, frames, layers);
  const double width = drawing.cell() * static_cast<double>(frames.size());
  const FrameRate rate = MotionOf(clip) != nullptr ? MotionOf(clip)->rate : clip.evidence.rate;
  std::string svg = "<svg class=\"strip\" viewBox=\"0 0 " + Coordinate(width) + " " +
                    Coordinate(StripDrawing::kHeight) + "\" role=\"img\" aria-label=\"Stick figures of " +
                    EscapeHtml(clip.item) + ", " + std::to_string(frames.size()) + " stills from " +
                    std::to_string(FrameCountOf(clip)) + " frames\">\n";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    svg += drawing.Still(frames[i], static_cast<int>(i));
    svg += "<text x=\"" + Coordinate((static_cast<double>(i) + 0.5) * drawing.cell()) + "\" y=\"" +
           Coordinate(StripDrawing::kHeight - 4.0) + "\" text-anchor=\"middle\" class=\"label\">" +
           FixedText(rate.FrameTime(frames[i]), 2) + " s</text>\n";
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

nlohmann::json PlayerData(const DrawnClip& clip, int most_numbers) {
  const Motion* motion = MotionOf(clip);
  const JointTracks* tracks = TracksOf(clip);
  const Vector3d origin = OriginOf(clip);
  const int per_frame = 3 * ((motion ? motion->joint_count() : 0) + (tracks ? tracks->positions.joints : 0));
  const int frames = FrameCountOf(clip);
  const int allowed = std::max(2, most_numbers / std::max(1, per_frame));
  const int step = std::max(1, (frames + allowed - 1) / allowed);
  const Viewpoint view = ViewpointOf(clip);
  nlohmann::json data = {{"name", clip.item},
                         {"hz", motion ? motion->rate.hz() : clip.evidence.rate.hz()},
                         {"step", step},
                         {"yaw", std::round(view.yaw * 1e3) / 1e3},
                         {"pitch", view.pitch},
                         {"bones", nlohmann::json::array()},
                         {"lines", nlohmann::json::array()},
                         {"joints", nlohmann::json::array()},
                         {"points", nlohmann::json::array()}};
  if (motion != nullptr) {
    const std::vector<int> sides = SidesOf(*motion->skeleton);
    for (int j = 1; j < motion->joint_count(); ++j)
      data["bones"].push_back({motion->skeleton->joints[j].parent, j, sides[j]});
  }
  if (tracks != nullptr) {
    for (const auto& line : MatchTracks(*tracks, motion ? motion->skeleton.get() : nullptr).lines)
      data["lines"].push_back(line);
  }
  for (int f = 0; f < frames; f += step) {
    if (motion != nullptr) data["joints"].push_back(JointFrame(*motion, f, origin));
    if (tracks != nullptr) data["points"].push_back(PointFrame(*tracks, f, origin));
  }
  return data;
}

Expected<DrawnClip> ReadDrawnClip(const StageRequest& request, std::vector<Finding>* findings) {
  std::map<std::string, std::filesystem::path> depth_files;
  const StageInput* evidence_input = nullptr;
  const StageInput* fit_input = nullptr;
  for (const StageInput& input : request.inputs) {
    if (input.role == "depth") depth_files[input.name] = input.path;
    if (input.role == "evidence") evidence_input = &input;
    if (input.role == "fit") fit_input = &input;
  }
  if (evidence_input == nullptr) return Fail(ErrorCode::kInternal, "a picture needs evidence", request.item);
  if (fit_input == nullptr) return Fail(ErrorCode::kInternal, "a picture needs a fit", request.item);
  auto evidence = ReadEvidence(evidence_input->path);
  if (!evidence) return Forward(evidence);
  auto fit = ReadDataset(fit_input->path);
  if (!fit) return Forward(fit);
  if (fit->clips.empty()) return Fail(ErrorCode::kInconsistent, "the fit has no clip", request.item);
  DrawnClip drawn;
  drawn.item = fit_input->name;
  drawn.evidence = std::move(*evidence);
  ResolveDepthFiles(depth_files, drawn.evidence.evidence);
  drawn.fitted = std::move(fit->clips.front());
  if (findings != nullptr) *findings = std::move(fit->findings);
  return drawn;
}

}  // namespace mocurate
