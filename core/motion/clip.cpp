#include "core/motion/clip.h"

#include "core/base/text.h"

namespace mocurate {

std::string ClipIdentity::id() const {
  return source + "/" + person + "/" + recording + "#" + std::to_string(begin_frame) + "-" + std::to_string(end_frame);
}

std::string RecordingOf(const std::string& id) { return id.substr(0, id.rfind('#')); }

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

}  // namespace mocurate
