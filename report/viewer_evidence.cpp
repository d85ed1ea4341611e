#include "report/viewer_evidence.h"

#include <algorithm>
#include <cmath>

#include "core/base/file.h"
#include "core/formats/point_cloud.h"
#include "core/store/store.h"
#include "report/painters.h"

namespace mocurate {
namespace {

constexpr double kReach = 0.3;        // metres outside the body
constexpr int kPixels = 4;            // every fourth row and column of a depth image
constexpr std::size_t kPoints = 300;  // of a frame

/// Of each frame of a clip the sample of its recording nearest in time; -1 where it is more than half a frame away.
std::vector<int> SamplesOf(const Clip& clip, const Clip& recorded, const std::vector<double>& time_s) {
  std::vector<int> samples(static_cast<std::size_t>(clip.motion->frame_count()), -1);
  if (time_s.empty()) return samples;
  const double begin = EvidenceTimes(recorded.evidence).front() + BeginInRecording(clip) - BeginInRecording(recorded);
  const double half = 0.5 / RecordedRate(clip).hz() + 1e-6;
  for (std::size_t f = 0; f < samples.size(); ++f) {
    const double time = begin + clip.motion->rate.FrameTime(static_cast<std::int64_t>(f));
    auto next = std::lower_bound(time_s.begin(), time_s.end(), time);
    if (next == time_s.end() || (next != time_s.begin() && time - *std::prev(next) < *next - time)) --next;
    if (std::abs(*next - time) <= half) samples[f] = static_cast<int>(next - time_s.begin());
  }
  return samples;
}

/// Points of a file that are near the body.
Expected<std::vector<Vector3d>> PointsOf(const CloudFiles& clouds, int sample, const RigidTransform& moved,
                                         const PosedBody& body) {
  const auto& file = clouds.files[static_cast<std::size_t>(sample)];
  if (file.empty()) return std::vector<Vector3d>();
  const auto bytes = ReadFile(file);
  if (!bytes) return Forward(bytes);
  const auto cloud = ParsePointCloud(*bytes, DisplayPath(file));
  if (!cloud) return Forward(cloud);
  std::vector<Vector3d> near;
  const std::size_t step = std::max<std::size_t>(1, cloud->points.size() / (20 * kPoints));
  for (std::size_t i = 0; i < cloud->points.size(); i += step) {
    const Vector3d place = moved * (clouds.world_from_file * Vector3d(clouds.metres_per_unit * cloud->points[i]));
    const auto closest = ClosestOnBody(body.capsules, body.points.data(), place);
    if (closest && closest->on_capsule.distance < kReach) near.push_back(place);
  }
  return near;
}

}  // namespace

JointTracks TracksOfClip(const Clip& clip, const Clip& recording) {
  const JointTracks& recorded = *recording.evidence.tracks;
  const int frames = clip.motion->frame_count(), points = recorded.positions.joints;
  JointTracks tracks;
  tracks.names = recorded.names;
  tracks.positions = JointPositions(frames, points);
  tracks.confidence.assign(static_cast<std::size_t>(frames) * points, 0.0);
  const std::vector<int> samples = SamplesOf(clip, recording, recorded.time_s);
  for (int f = 0; f < frames; ++f) {
    const int sample = samples[static_cast<std::size_t>(f)];
    for (int k = 0; sample >= 0 && k < points; ++k) {
      tracks.positions.at(f, k) = clip.canonical_from_source * Vector3d(recorded.positions.at(sample, k));
      tracks.confidence[static_cast<std::size_t>(f) * points + k] =
          recorded.confidence[static_cast<std::size_t>(sample) * points + k];
    }
  }
  return tracks;
}

RecordedEvidence::RecordedEvidence(const StageRequest& request, const std::string& name, bool clouds)
    : clouds_(clouds) {
  for (const StageInput& input : request.inputs) {
    if (input.role == "evidence of " + name) files_[input.name] = input.path;
    if (input.role == "depth of " + name) depth_[input.name] = input.path;
  }
}

Expected<ClipEvidence> RecordedEvidence::Of(const Clip& clip) {
  ClipEvidence seen;
  const std::string recording = RecordingOf(clip.id());
  const auto file = files_.find(recording);
  if (file == files_.end()) return seen;
  if (recording != recording_) {
    auto recorded = ReadEvidence(file->second);
    if (!recorded) return Forward(recorded);
    recorded_ = std::move(*recorded);
    recording_ = recording;
    ResolveDepthFiles(depth_, recorded_.evidence);
  }
  const Evidence& evidence = recorded_.evidence;
  if (evidence.tracks) seen.tracks = TracksOfClip(clip, recorded_);
  for (const DepthView& view : evidence.depth_views) seen.cameras.push_back(view.camera);
  for (const KeypointView& view : evidence.keypoint_views) seen.cameras.push_back(view.camera);
  for (Camera& camera : seen.cameras) {
    camera.camera_from_world = camera.camera_from_world * Inverse(clip.canonical_from_source);
  }
  if (clouds_) AddClouds(clip, seen);
  return seen;
}

void RecordedEvidence::AddClouds(const Clip& clip, ClipEvidence& seen) const {
  std::vector<DepthView> views = recorded_.evidence.depth_views;
  std::vector<std::vector<int>> samples;
  for (std::size_t v = 0; v < views.size(); ++v) {
    views[v].camera = seen.cameras[v];
    samples.push_back(SamplesOf(clip, recorded_, views[v].time_s));
  }
  const auto& clouds = recorded_.evidence.clouds;
  const std::vector<int> files = clouds ? SamplesOf(clip, recorded_, clouds->time_s) : std::vector<int>();
  seen.clouds.resize(static_cast<std::size_t>(clip.motion->frame_count()));
  bool any = false;
  for (std::size_t f = 0; f < seen.clouds.size(); ++f) {
    const PosedBody body = BodyOf(clip, static_cast<int>(f));
    std::vector<Vector3d> all;
    bool whole = true;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (samples[v][f] < 0) continue;
      const auto points = PointsNear(body, views[v], samples[v][f], kPixels, kReach);
      whole = whole && points;
      for (const NearPoint& point : points.value_or(std::vector<NearPoint>())) all.push_back(point.place);
    }
    if (clouds && files[f] >= 0) {
      const auto points = PointsOf(*clouds, files[f], clip.canonical_from_source, body);
      whole = whole && points;
      if (points) all.insert(all.end(), points->begin(), points->end());
    }
    if (!whole) ++seen.lost;
    const std::size_t kept = std::min(kPoints, all.size());
    for (std::size_t i = 0; i < kept; ++i) seen.clouds[f].push_back(all[i * all.size() / kept]);
    any = any || kept > 0;
  }
  if (!any) seen.clouds.clear();
}

}  // namespace mocurate
