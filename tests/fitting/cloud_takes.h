#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "ingest/synthetic/rigs.h"
#include "ingest/synthetic/sensors.h"
#include "tests/fitting/studio_clips.h"
#include "tests/support/depth_files.h"

namespace mocurate {

/// One of the studio's clips as PHSPD's three depth cameras see it.
struct CloudTake {
  StudioClip clip;
  Evidence evidence;              ///< files in the folder given
  double heading = 0.0;           ///< radians about y, where the person faces in the first frame
  double reported_heading = 0.0;  ///< within 45 degrees of it
  bool seated = false;            ///< in the first frame
};

struct CloudTakeOptions {
  std::uint64_t seed = 101;
  int subjects = 5;
  int clips = 60;
  int frames = 60;      ///< of a clip, at most
  bool stills = false;  ///< the frame in the middle of each clip alone
  double rate_hz = 30.0;
  bool room = false;  ///< floor and wall behind the person
  StudioClipErrors errors = StudioClipErrors::Stated();
};

inline double HeadingOf(const Motion& motion, int frame) {
  const Vector3d front = motion.rotation_at(frame, 0) * Vector3d::UnitZ();
  return std::atan2(front.x(), front.z());
}

/// Joint tracks of the same frames.
inline SkeletonTracks AtFrames(const SkeletonTracks& tracks, const std::vector<int>& frames) {
  SkeletonTracks at = tracks;
  at.positions = JointPositions(static_cast<int>(frames.size()), tracks.joints());
  at.confidence.clear();
  at.time_s.clear();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const int f = frames[i];
    for (int j = 0; j < tracks.joints(); ++j) {
      at.positions.at(static_cast<int>(i), j) = Vector3d(tracks.positions.at(f, j));
      at.confidence.push_back(tracks.confidence[static_cast<std::size_t>(f) * tracks.joints() + j]);
    }
    at.time_s.push_back(tracks.time_s[static_cast<std::size_t>(f)]);
  }
  return at;
}

/// The body's depth, with the sensor's errors, as PNG files in `folder`. Empty without MOCURATE_DATA's body.
inline std::vector<CloudTake> CloudTakes(const CloudTakeOptions& options, const std::filesystem::path& folder) {
  std::vector<CloudTake> takes;
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) return takes;
  const auto body = ReadBodyTemplate(std::filesystem::path(data) / "body_cc0" / "body_cc0.h5");
  if (!body) return takes;
  StudioOptions studio;
  studio.seed = static_cast<std::int64_t>(options.seed);
  const auto actors = ActorsOf(studio, options.subjects, &*body);
  const std::vector<Camera> phspd = PhspdRig(1);
  const std::vector<Camera> rig(phspd.begin() + 1, phspd.begin() + 4);
  std::vector<std::vector<Vector2d>> rays;
  std::vector<std::vector<float>> rooms;
  for (const Camera& camera : rig) {
    rays.push_back(PixelRays(camera));
    rooms.push_back(options.room ? RoomDepth(camera, rays.back(), 2.0) : std::vector<float>{});
  }
  std::filesystem::create_directories(folder);
  for (StudioClip& clip : StudioClips(options.seed, options.subjects, false, options.errors, options.rate_hz)) {
    if (static_cast<int>(takes.size()) == options.clips) break;
    std::vector<int> frames;
    for (int f = 0; f < std::min(options.frames, clip.truth.frame_count()); ++f) frames.push_back(f);
    if (options.stills) frames = {clip.truth.frame_count() / 2};
    const Motion whole = clip.truth;
    clip.truth = SelectFrames(whole, frames, RigidTransform{});
    clip.tracks = AtFrames(clip.tracks, frames);
    CloudTake take;
    const Actor& actor = (*actors)[static_cast<std::size_t>(clip.subject - 1)];
    const BodyView view(actor);
    for (std::size_t c = 0; c < rig.size(); ++c) {
      DepthView depth_view;
      depth_view.camera = rig[c];
      for (const int f : frames) {
        const std::string item = clip.name + "_" + rig[c].name + "_" + std::to_string(f);
        depth_view.files.push_back(folder / (item + ".png"));
        depth_view.time_s.push_back(clip.truth.rate.FrameTime(f));
        if (std::filesystem::exists(depth_view.files.back())) continue;
        const DepthImage image = SimulateDepth(view.Depth(whole, f, rig[c], rays[c]), rooms[c], rig[c], rays[c],
                                               studio.depth, studio.seed, item);
        if (!WriteDepthImage(image, depth_view.files.back())) return {};
      }
      take.evidence.depth_views.push_back(std::move(depth_view));
    }
    Random random(options.seed, "cloud take", clip.name);
    take.heading = HeadingOf(clip.truth, 0);
    take.reported_heading = take.heading + (2.0 * random.Uniform() - 1.0) * 0.7853981633974483;
    const int knee = *clip.truth.skeleton->FindJoint("left_knee");
    const int hip = *clip.truth.skeleton->FindJoint("left_hip");
    const Vector3d thigh = clip.truth.joints.at(0, knee) - clip.truth.joints.at(0, hip);
    take.seated = -thigh.y() < 0.5 * thigh.norm();
    take.clip = std::move(clip);
    takes.push_back(std::move(take));
  }
  return takes;
}

}  // namespace mocurate
