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
std::vector<int> SamplesOf(const Clip& clip, const std::vector<double>& time_s) {
  std::vector<int> samples(static_cast<std::size_t>(clip.motion->frame_count()), -1);
  if (time_s.empty()) return samples;
  const double begin = time_s.front() + BeginInRecording(clip), half = 0.5 / RecordedRate(clip).hz() + 1e-6;
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

JointTracks TracksOfClip(const Clip& clip, const JointTracks& recorded) {
  const int frames = clip.motion->frame_count(), points = recorded.positions.joints;
  JointTracks tracks;
  tracks.names = recorded.names;
  tracks.positions = JointPositions(frames, points);
  tracks.confidence.assign(static_cast<std::size_t>(frames) * points, 0.0);
  const std::vector<int> samples = SamplesOf(clip, recorded.time_s);
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
    evidence_ = std::move(recorded->evidence);
    recording_ = recording;
    ResolveDepthFiles(depth_, evidence_);
  }
  if (evidence_.tracks) seen.tracks = TracksOfClip(clip, *evidence_.tracks);
  for (const DepthView& view : evidence_.depth_views) seen.cameras.push_back(view.camera);
  for (const KeypointView& view : evidence_.keypoint_views) seen.cameras.push_back(view.camera);
  for (Camera& camera : seen.cameras) {
    camera.camera_from_world = camera.camera_from_world * Inverse(clip.canonical_from_source);
  }
  if (clouds_ && (evidence_.clouds || !evidence_.depth_views.empty())) {
    if (Status added = AddClouds(clip, seen); !added) return Forward(added);
  }
  return seen;
}

Status RecordedEvidence::AddClouds(const Clip& clip, ClipEvidence& seen) const {
  const std::vector<int> samples = SamplesOf(clip, SurfaceTimes(evidence_));
  seen.clouds.resize(samples.size());
  for (std::size_t f = 0; f < samples.size(); ++f) {
    if (samples[f] < 0) continue;
    const PosedBody body = BodyOf(clip, static_cast<int>(f));
    std::vector<Vector3d> all;
    for (std::size_t v = 0; v < evidence_.depth_views.size(); ++v) {
      DepthView view = evidence_.depth_views[v];
      view.camera = seen.cameras[v];
      const auto points = PointsNear(body, view, samples[f], kPixels, kReach);
      if (!points) return Forward(points);
      for (const NearPoint& point : *points) all.push_back(point.place);
    }
    if (evidence_.clouds) {
      const auto points = PointsOf(*evidence_.clouds, samples[f], clip.canonical_from_source, body);
      if (!points) return Forward(points);
      all.insert(all.end(), points->begin(), points->end());
    }
    const std::size_t kept = std::min(kPoints, all.size());
    for (std::size_t i = 0; i < kept; ++i) seen.clouds[f].push_back(all[i * all.size() / kept]);
  }
  return {};
}

}  // namespace mocurate
