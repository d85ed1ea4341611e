#include <cmath>

#include "core/store/fields.h"

namespace mocurate::store {
namespace {

/// The cameras of `views` (DepthView, KeypointView) below "/depth" or "/keypoints".
template <class View>
void PackCameras(const std::vector<View>& views, const std::string& group, Content& content) {
  std::vector<std::string> names;
  std::vector<std::int32_t> width;
  std::vector<std::int32_t> height;
  std::vector<double> intrinsics;
  std::vector<double> distortion;
  std::vector<double> extrinsics;
  for (const View& view : views) {
    const Camera& camera = view.camera;
    names.push_back(camera.name);
    width.push_back(camera.width);
    height.push_back(camera.height);
    intrinsics.insert(intrinsics.end(), {camera.fx, camera.fy, camera.cx, camera.cy});
    const LensDistortion& lens = camera.distortion;
    distortion.insert(distortion.end(), {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3});
    AppendTransform(extrinsics, camera.camera_from_world);
  }
  const std::uint64_t rows = views.size();
  content.Put(group + "/camera", {rows}, std::move(names));
  content.Put(group + "/width", {rows}, std::move(width));
  content.Put(group + "/height", {rows}, std::move(height));
  content.Put(group + "/intrinsics", {rows, 4}, std::move(intrinsics));
  content.Put(group + "/distortion", {rows, 5}, std::move(distortion));
  content.Put(group + "/camera_from_world", {rows, 7}, std::move(extrinsics));
}

Camera CameraFrom(const Content& content, const std::string& group, std::size_t row) {
  const double* k = content.Values<double>(group + "/intrinsics").data() + 4 * row;
  const double* d = content.Values<double>(group + "/distortion").data() + 5 * row;
  Camera camera;
  camera.name = content.Values<std::string>(group + "/camera")[row];
  camera.width = content.Values<std::int32_t>(group + "/width")[row];
  camera.height = content.Values<std::int32_t>(group + "/height")[row];
  camera.fx = k[0];
  camera.fy = k[1];
  camera.cx = k[2];
  camera.cy = k[3];
  camera.distortion = {d[0], d[1], d[2], d[3], d[4]};
  camera.camera_from_world = TransformFrom(content.Values<double>(group + "/camera_from_world"), row);
  return camera;
}

Status CheckDepth(const std::vector<DepthView>& views) {
  for (const DepthView& view : views) {
    const bool masks =
        (view.masks.empty() || view.masks.size() == view.files.size()) && view.mask_sha256.size() == view.masks.size();
    if (!masks) {
      return Fail(ErrorCode::kInconsistent,
                  "view has " + std::to_string(view.files.size()) + " depth images, " +
                      std::to_string(view.masks.size()) + " masks and " + std::to_string(view.mask_sha256.size()) +
                      " hashes of masks",
                  view.camera.name);
    }
    if (view.sha256.size() == view.files.size() && view.time_s.size() == view.files.size()) continue;
    return Fail(ErrorCode::kInconsistent,
                "view has " + std::to_string(view.files.size()) + " depth images, " +
                    std::to_string(view.sha256.size()) + " hashes and " + std::to_string(view.time_s.size()) + " times",
                view.camera.name);
  }
  return {};
}

void PackMasks(const std::vector<DepthView>& views, Content& content) {
  std::vector<std::string> paths;
  std::vector<std::string> hashes;
  bool any = false;
  for (const DepthView& view : views) {
    any = any || !view.masks.empty();
    for (std::size_t i = 0; i < view.files.size(); ++i) {
      paths.push_back(view.masks.empty() ? "" : view.masks[i].native());
      hashes.push_back(view.masks.empty() ? "" : view.mask_sha256[i]);
    }
  }
  if (!any) return;
  const std::uint64_t D = paths.size();
  content.Put("/depth_masks/path", {D}, std::move(paths));
  content.Put("/depth_masks/sha256", {D}, std::move(hashes));
}

void PackDepth(const std::vector<DepthView>& views, Content& content) {
  std::vector<std::string> paths;
  std::vector<std::string> hashes;
  std::vector<double> scale;
  std::vector<double> times;
  std::vector<std::int64_t> counts;
  for (const DepthView& view : views) {
    scale.push_back(view.metres_per_unit);
    counts.push_back(static_cast<std::int64_t>(view.files.size()));
    for (const auto& file : view.files) paths.push_back(file.native());
    hashes.insert(hashes.end(), view.sha256.begin(), view.sha256.end());
    times.insert(times.end(), view.time_s.begin(), view.time_s.end());
  }
  const std::uint64_t V = views.size();
  const std::uint64_t D = paths.size();
  PackCameras(views, "/depth", content);
  content.Put("/depth/metres_per_unit", {V}, std::move(scale));
  content.Put("/depth/count", {V}, std::move(counts));
  content.Put("/depth/path", {D}, std::move(paths));
  content.Put("/depth/sha256", {D}, std::move(hashes));
  content.Put("/depth/time_s", {D}, std::move(times));
  PackMasks(views, content);
}

/// Masks of the images [next, next + files), if they have any.
void UnpackMasks(const Content& content, std::size_t next, DepthView& view) {
  if (!content.Has("/depth_masks/path") || view.files.empty()) return;
  const auto& paths = content.Values<std::string>("/depth_masks/path");
  const auto& hashes = content.Values<std::string>("/depth_masks/sha256");
  if (paths[next].empty()) return;
  for (std::size_t i = next; i < next + view.files.size(); ++i) {
    view.masks.emplace_back(paths[i]);
    view.mask_sha256.push_back(hashes[i]);
  }
}

std::vector<DepthView> UnpackDepth(const Content& content) {
  std::vector<DepthView> views;
  std::size_t next = 0;
  const auto& counts = content.Values<std::int64_t>("/depth/count");
  for (std::size_t row = 0; row < counts.size(); ++row) {
    DepthView view;
    view.camera = CameraFrom(content, "/depth", row);
    view.metres_per_unit = content.Values<double>("/depth/metres_per_unit")[row];
    for (const std::size_t end = next + static_cast<std::size_t>(counts[row]); next < end; ++next) {
      view.files.emplace_back(content.Values<std::string>("/depth/path")[next]);
      view.sha256.push_back(content.Values<std::string>("/depth/sha256")[next]);
      view.time_s.push_back(content.Values<double>("/depth/time_s")[next]);
    }
    UnpackMasks(content, next - view.files.size(), view);
    views.push_back(std::move(view));
  }
  return views;
}

Status PackClouds(const CloudFiles& clouds, Content& content) {
  const std::uint64_t G = clouds.files.size();
  if (clouds.sha256.size() != G || clouds.time_s.size() != G) {
    return Fail(ErrorCode::kInconsistent,
                "the clip has " + std::to_string(G) + " clouds, " + std::to_string(clouds.sha256.size()) +
                    " hashes and " + std::to_string(clouds.time_s.size()) + " times",
                "/clouds");
  }
  std::vector<std::string> paths;
  for (const auto& file : clouds.files) paths.push_back(file.native());
  std::vector<double> world_from_file;
  AppendTransform(world_from_file, clouds.world_from_file);
  content.Put("/clouds/path", {G}, std::move(paths));
  content.Put("/clouds/sha256", {G}, clouds.sha256);
  content.Put("/clouds/time_s", {G}, clouds.time_s);
  content.Put("/clouds/metres_per_unit", {1}, std::vector<double>{clouds.metres_per_unit});
  content.Put("/clouds/world_from_file", {1, 7}, std::move(world_from_file));
  return {};
}

CloudFiles UnpackClouds(const Content& content) {
  CloudFiles clouds;
  for (const std::string& path : content.Values<std::string>("/clouds/path")) clouds.files.emplace_back(path);
  clouds.sha256 = content.Values<std::string>("/clouds/sha256");
  clouds.time_s = content.Values<double>("/clouds/time_s");
  clouds.metres_per_unit = content.Values<double>("/clouds/metres_per_unit")[0];
  clouds.world_from_file = TransformFrom(content.Values<double>("/clouds/world_from_file"), 0);
  return clouds;
}

void PackKeypoints(const Evidence& evidence, Content& content) {
  std::vector<std::int32_t> people;
  std::vector<std::int64_t> counts;
  std::vector<double> times;
  std::vector<double> values;
  for (const KeypointView& view : evidence.keypoint_views) {
    people.push_back(view.people);
    counts.push_back(static_cast<std::int64_t>(view.time_s.size()));
    times.insert(times.end(), view.time_s.begin(), view.time_s.end());
    values.insert(values.end(), view.values.begin(), view.values.end());
  }
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {  // never read where nothing was observed
    if (values[i + 2] != 0.0) continue;
    for (std::size_t k = i; k < i + 2; ++k) values[k] = std::isfinite(values[k]) ? values[k] : 0.0;
  }
  const std::uint64_t W = people.size();
  const std::uint64_t I = times.size();
  const std::uint64_t E = evidence.keypoint_names.size();
  const std::uint64_t U = values.size() / 3 / E;
  content.Put("/keypoints/names", {E}, evidence.keypoint_names);
  content.Put("/keypoints/subject", {1}, std::vector<std::int32_t>{evidence.subject});
  PackCameras(evidence.keypoint_views, "/keypoints", content);
  content.Put("/keypoints/people", {W}, std::move(people));
  content.Put("/keypoints/count", {W}, std::move(counts));
  content.Put("/keypoints/time_s", {I}, std::move(times));
  content.Put("/keypoints/values", {U, E, 3}, std::move(values));
}

void UnpackKeypoints(const Content& content, Evidence& evidence) {
  evidence.keypoint_names = content.Values<std::string>("/keypoints/names");
  evidence.subject = content.Values<std::int32_t>("/keypoints/subject")[0];
  const auto& counts = content.Values<std::int64_t>("/keypoints/count");
  auto time = content.Values<double>("/keypoints/time_s").begin();
  auto value = content.Values<double>("/keypoints/values").begin();
  for (std::size_t row = 0; row < counts.size(); ++row) {
    KeypointView view;
    view.camera = CameraFrom(content, "/keypoints", row);
    view.people = content.Values<std::int32_t>("/keypoints/people")[row];
    view.time_s.assign(time, time + counts[row]);
    time += counts[row];
    const auto numbers =
        static_cast<std::ptrdiff_t>(view.people * counts[row]) * std::ptrdiff_t(3 * evidence.keypoint_names.size());
    view.values.assign(value, value + numbers);
    value += numbers;
    evidence.keypoint_views.push_back(std::move(view));
  }
}

Status PackTrackRotations(const JointTracks& tracks, Content& content) {
  if (tracks.rotation.empty() && tracks.rotation_confidence.empty()) return {};
  if (tracks.rotation.size() != tracks.confidence.size() ||
      tracks.rotation_confidence.size() != tracks.confidence.size()) {
    return Fail(ErrorCode::kInconsistent,
                "tracks have " + std::to_string(tracks.confidence.size()) + " positions, but " +
                    std::to_string(tracks.rotation.size()) + " rotations and " +
                    std::to_string(tracks.rotation_confidence.size()) + " confidences of rotations",
                "/track_rotations");
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < tracks.rotation.size(); ++i) {
    const bool recorded = tracks.rotation_confidence[i] != 0.0;
    const Quaterniond q = recorded ? tracks.rotation[i] : Quaterniond::Identity();
    values.insert(values.end(), {q.w(), q.x(), q.y(), q.z()});
  }
  const std::uint64_t T = tracks.time_s.size();
  const std::uint64_t K = tracks.names.size();
  content.Put("/track_rotations/rotation", {T, K, 4}, std::move(values));
  content.Put("/track_rotations/confidence", {T, K}, tracks.rotation_confidence);
  return {};
}

void UnpackTrackRotations(const Content& content, JointTracks& tracks) {
  if (!content.Has("/track_rotations/rotation")) return;
  const auto& values = content.Values<double>("/track_rotations/rotation");
  for (std::size_t i = 0; i < values.size(); i += 4)
    tracks.rotation.emplace_back(values[i], values[i + 1], values[i + 2], values[i + 3]);
  tracks.rotation_confidence = content.Values<double>("/track_rotations/confidence");
}

}  // namespace

Status PackEvidence(const Evidence& evidence, Content& content) {
  if (Status checked = CheckDepth(evidence.depth_views); !checked) return checked;
  if (Status checked = CheckKeypoints(evidence); !checked) return checked;
  if (!evidence.depth_views.empty()) PackDepth(evidence.depth_views, content);
  if (evidence.clouds) {
    if (Status packed = PackClouds(*evidence.clouds, content); !packed) return packed;
  }
  if (!evidence.keypoint_views.empty()) PackKeypoints(evidence, content);
  if (!evidence.tracks) return {};
  const JointTracks& tracks = *evidence.tracks;
  const std::uint64_t T = tracks.time_s.size();
  const std::uint64_t K = tracks.names.size();
  if (tracks.positions.xyz.size() != T * K * 3 || tracks.confidence.size() != T * K) {
    return Fail(ErrorCode::kInconsistent,
                "tracks have " + std::to_string(T) + " times and " + std::to_string(K) + " names, but " +
                    std::to_string(tracks.positions.xyz.size()) + " coordinates and " +
                    std::to_string(tracks.confidence.size()) + " confidences",
                "/tracks");
  }
  std::vector<double> positions = tracks.positions.xyz;
  for (std::size_t i = 0; i < positions.size(); ++i) {  // never read where nothing was observed
    if (tracks.confidence[i / 3] == 0.0 && positions[i] - positions[i] != 0.0) positions[i] = 0.0;
  }
  content.Put("/tracks/names", {K}, tracks.names);
  content.Put("/tracks/time_s", {T}, tracks.time_s);
  content.Put("/tracks/positions", {T, K, 3}, std::move(positions));
  content.Put("/tracks/confidence", {T, K}, tracks.confidence);
  return PackTrackRotations(tracks, content);
}

Evidence UnpackEvidence(const Content& content) {
  Evidence evidence;
  if (content.Has("/depth/count")) evidence.depth_views = UnpackDepth(content);
  if (content.Has("/clouds/path")) evidence.clouds = UnpackClouds(content);
  if (content.Has("/keypoints/count")) UnpackKeypoints(content, evidence);
  if (!content.Has("/tracks/names")) return evidence;
  JointTracks tracks;
  tracks.names = content.Values<std::string>("/tracks/names");
  tracks.time_s = content.Values<double>("/tracks/time_s");
  tracks.positions = JointPositions(static_cast<int>(tracks.time_s.size()), static_cast<int>(tracks.names.size()));
  tracks.positions.xyz = content.Values<double>("/tracks/positions");
  tracks.confidence = content.Values<double>("/tracks/confidence");
  UnpackTrackRotations(content, tracks);
  evidence.tracks = std::move(tracks);
  return evidence;
}

}  // namespace mocurate::store
