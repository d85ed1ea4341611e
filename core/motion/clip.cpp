#include "core/motion/clip.h"

#include <cmath>
#include <set>
#include "core/base/text.h"

namespace mocurate {
namespace {

Status Inconsistent(const std::string& what, const std::string& where) {
  return Fail(ErrorCode::kInconsistent, what, where);
}

Status CheckCamera(const Camera& camera) {
  const LensDistortion& lens = camera.distortion;
  for (const double number :
       {camera.fx, camera.fy, camera.cx, camera.cy, lens.k1, lens.k2, lens.p1, lens.p2, lens.k3}) {
    if (!std::isfinite(number)) return Inconsistent("the camera's numbers are not finite", camera.name);
  }
  if (camera.fx == 0.0 || camera.fy == 0.0) return Inconsistent("the camera's focal length is 0", camera.name);
  if (camera.width < 0 || camera.height < 0) return Inconsistent("the image has a negative size", camera.name);
  const RigidTransform& pose = camera.camera_from_world;
  if (!(std::abs(pose.rotation.norm() - 1.0) <= 1e-6) || !pose.translation.allFinite()) {
    return Inconsistent("the camera's pose is not a rotation and a translation", camera.name);
  }
  return {};
}

Status CheckValues(const KeypointView& view, const std::vector<std::string>& names) {
  for (int f = 0; f < view.frames(); ++f) {
    for (int p = 0; p < view.people; ++p) {
      for (std::size_t k = 0; k < names.size(); ++k) {
        const double* v = view.at(f, p, static_cast<int>(k));
        const bool good = v[2] == 0.0 || (v[2] > 0.0 && v[2] <= 1.0 && std::isfinite(v[0]) && std::isfinite(v[1]));
        if (good) continue;
        return Inconsistent("frame " + std::to_string(f) + ", person " + std::to_string(p) + ", " + names[k] + " is (" +
                                FormatDouble(v[0]) + ", " + FormatDouble(v[1]) + ") px with confidence " +
                                FormatDouble(v[2]) + "; observed points must be finite, confidences in [0, 1]",
                            view.camera.name);
      }
    }
  }
  return {};
}

Status CheckView(const KeypointView& view, const std::vector<std::string>& names) {
  if (Status checked = CheckCamera(view.camera); !checked) return checked;
  for (std::size_t f = 0; f < view.time_s.size(); ++f) {
    if (std::isfinite(view.time_s[f]) && (f == 0 || view.time_s[f] > view.time_s[f - 1])) continue;
    return Inconsistent("time " + FormatDouble(view.time_s[f]) + " of frame " + std::to_string(f) +
                            " is not finite or not after the one before",
                        view.camera.name);
  }
  if (view.people < 0) return Inconsistent(std::to_string(view.people) + " people", view.camera.name);
  const std::size_t expected = view.time_s.size() * static_cast<std::size_t>(view.people) * names.size() * 3;
  if (view.values.size() != expected) {
    return Inconsistent(std::to_string(view.values.size()) + " values; " + std::to_string(view.time_s.size()) +
                            " images of " + std::to_string(view.people) + " people with " +
                            std::to_string(names.size()) + " points have " + std::to_string(expected),
                        view.camera.name);
  }
  return CheckValues(view, names);
}

}  // namespace

std::string ClipIdentity::id() const {
  return source + "/" + person + "/" + recording + "#" + std::to_string(begin_frame) + "-" + std::to_string(end_frame);
}

std::string RecordingOf(const std::string& id) { return id.substr(0, id.rfind('#')); }

int BeginFrameOf(const std::string& id) {
  const std::size_t mark = id.rfind('#'), end = id.find('-', mark == std::string::npos ? id.size() : mark);
  if (mark == std::string::npos || end == std::string::npos) return 0;
  return static_cast<int>(ParseInteger(id.substr(mark + 1, end - mark - 1)).value_or(0));
}

std::string PersonOf(const std::string& id) {
  const std::size_t source = id.find('/');
  const std::size_t person = source == std::string::npos ? source : id.find('/', source + 1);
  if (person == std::string::npos) return {};
  const std::string name = id.substr(source + 1, person - source - 1);
  return name.empty() || name == "unknown" ? std::string() : id.substr(0, person);
}

bool IsCalled(const std::string& id, const std::string& name) {
  const auto is_end = [&](const std::string& whole) {
    return whole == name || EndsWith(whole, "/" + name) || (EndsWith(whole, name) && name[0] == '[');
  };
  return is_end(id) || is_end(RecordingOf(id));
}

bool IsCalled(const Clip& clip, const std::string& name) {
  const auto inspected = clip.provenance.find("inspected_as");
  if (IsCalled(clip.id(), name) || inspected == clip.provenance.end()) return IsCalled(clip.id(), name);
  std::string file = inspected->second;  // "takes/b1.npy[1]"
  if (IsCalled(file, name)) return true;
  const std::size_t place = std::min(file.find('['), file.size()), ending = file.rfind('.', place);
  if (ending != std::string::npos) file.erase(ending, place - ending);
  return IsCalled(file, name);
}

std::string Clip::Noted(const std::string& key) const {
  const auto noted = provenance.find(key);
  return noted == provenance.end() ? std::string() : noted->second;
}

const std::vector<double>& SurfaceTimes(const Evidence& evidence) {
  static const std::vector<double> none;
  if (!evidence.depth_views.empty()) return evidence.depth_views.front().time_s;
  return evidence.clouds ? evidence.clouds->time_s : none;
}

const std::vector<double>& EvidenceTimes(const Evidence& evidence) {
  if (evidence.tracks) return evidence.tracks->time_s;
  const std::vector<double>& surface = SurfaceTimes(evidence);
  return surface.empty() && !evidence.keypoint_views.empty() ? evidence.keypoint_views.front().time_s : surface;
}

int FrameCount(const Clip& clip) {
  return clip.motion ? clip.motion->frame_count() : static_cast<int>(EvidenceTimes(clip.evidence).size());
}

void ResolveDepthFiles(const std::map<std::string, std::filesystem::path>& files, Evidence& evidence) {
  const auto resolve = [&files](std::vector<std::filesystem::path>& paths) {
    for (std::filesystem::path& file : paths) {
      const auto found = files.find(file.string());
      if (found != files.end()) file = found->second;
    }
  };
  for (DepthView& view : evidence.depth_views) {
    resolve(view.files);
    resolve(view.masks);
  }
  if (evidence.clouds) resolve(evidence.clouds->files);
}

FrameRate RecordedRate(const Clip& clip) {
  const auto noted = clip.provenance.find(kRecordedRate);
  if (noted != clip.provenance.end()) {
    if (const auto rate = FrameRate::Parse(noted->second)) return *rate;
  }
  return clip.motion ? clip.motion->rate : clip.rate;
}

long long FirstRecordedFrame(const Clip& clip) {
  return clip.identity.begin_frame + ParseInteger(clip.Noted("first_frame")).value_or(0);
}

double BeginInRecording(const Clip& clip) {
  return static_cast<double>(FirstRecordedFrame(clip)) / RecordedRate(clip).hz();
}

int KeypointView::points() const {
  const std::size_t people_seen = time_s.size() * static_cast<std::size_t>(people);
  return people_seen == 0 ? 0 : static_cast<int>(values.size() / 3 / people_seen);
}

const double* KeypointView::at(int frame, int person, int point) const {
  const std::size_t row =
      static_cast<std::size_t>(frame) * static_cast<std::size_t>(people) + static_cast<std::size_t>(person);
  return values.data() + 3 * (row * static_cast<std::size_t>(points()) + static_cast<std::size_t>(point));
}

Status CheckKeypoints(const Evidence& evidence) {
  if (evidence.keypoint_views.empty()) {
    if (evidence.keypoint_names.empty() && evidence.subject == 0) return {};
    return Inconsistent("names of keypoints or a subject without views", "keypoints");
  }
  if (evidence.subject < 0) return Inconsistent("subject " + std::to_string(evidence.subject), "keypoints");
  std::set<std::string> names;
  for (const std::string& name : evidence.keypoint_names) {
    if (name.empty() || !names.insert(name).second) {
      return Inconsistent("keypoint name '" + name + "' is empty or appears twice", "keypoints");
    }
  }
  if (names.empty()) return Inconsistent("the views have no names of keypoints", "keypoints");
  std::set<std::string> cameras;
  for (const KeypointView& view : evidence.keypoint_views) {
    if (view.camera.name.empty() || !cameras.insert(view.camera.name).second) {
      return Inconsistent("camera name '" + view.camera.name + "' is empty or appears twice", "keypoints");
    }
    if (Status checked = CheckView(view, evidence.keypoint_names); !checked) return checked;
  }
  return {};
}

}  // namespace mocurate
