// Tracks of VIBE: NTU-13's files, one track each, and the videos of UESTC's cache.

#include <cmath>

#include "core/base/text.h"
#include "core/formats/uestc_info.h"
#include "core/motion/kinematics.h"
#include "ingest/sources/container.h"
#include "ingest/sources/smpl_motion.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr double kFocal_px = 500.0;  // of ACTOR's weak perspective
constexpr double kHalfImage_px = 270.0;
constexpr std::size_t kMidHip = 8;  // of VIBE's 49 points
constexpr double kRadiansPerView = EIGEN_PI / 4.0;

Vector3d Place(const VibeTrack& track, std::size_t frame, std::size_t joint) {
  const double* xyz = &track.joints3d[(frame * track.joints + joint) * 3];
  return {xyz[0], xyz[1], xyz[2]};
}

Status CheckTrack(const VibeTrack& track, const SourceOptions& source, bool rotations, const std::string& name) {
  if (rotations && track.joints <= kMidHip) {
    return Fail(ErrorCode::kInconsistent,
                "the track has " + std::to_string(track.joints) + " joints, the middle of the hips is VIBE's joint 8",
                name);
  }
  if (!rotations && track.joints != source.joints.size()) {
    return Fail(ErrorCode::kInconsistent,
                "the track has " + std::to_string(track.joints) + " joints, " + std::to_string(source.joints.size()) +
                    " are named under ingest.source.joints",
                name, "name each joint of the file in its order, '-' for one that is passed over");
  }
  return {};
}

/// A track in the world, the file's places moved by `shift` (F) in file axes and turned by `world_from_file`.
Expected<IngestedClip> MotionOf(const VibeTrack& track, const SourceOptions& source, const Quaterniond& world_from_file,
                                const std::vector<Vector3d>& shift, const std::string& name) {
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (!skeleton) return Forward(skeleton);
  const bool rotations = HasSmplTree(**skeleton);
  if (Status fits = CheckTrack(track, source, rotations, name); !fits) return Forward(fits);
  IngestedClip ingested;
  ingested.content = BytesOf(track.pose) + BytesOf(track.joints3d) + BytesOf(track.original_camera);
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  if (rotations) {
    std::vector<Vector3d> root_translation;
    for (std::size_t f = 0; f < track.frames; ++f) {
      root_translation.push_back(world_from_file * Vector3d(shift[f] + Place(track, f, kMidHip)));
    }
    Expected<std::vector<Quaterniond>> local =
        SmplLocalRotations(**skeleton, SmplRotations{track.pose, track.frames}, world_from_file);
    if (!local) return Forward(local);
    ingested.clip.motion =
        MakeMotion(*skeleton, ingested.clip.rate, std::move(root_translation), *std::move(local), {});
    return ingested;
  }
  JointPositions joints(static_cast<int>(track.frames), (*skeleton)->joint_count());
  std::vector<bool> told((*skeleton)->joints.size(), false);
  for (std::size_t k = 0; k < source.joints.size(); ++k) {
    const std::optional<int> joint = (*skeleton)->FindJoint(source.joints[k]);
    if (!joint) continue;
    told[*joint] = true;
    for (int f = 0; f < joints.frames; ++f) {
      const auto frame = static_cast<std::size_t>(f);
      joints.at(f, *joint) = world_from_file * Vector3d(shift[frame] + Place(track, frame, k));
    }
  }
  for (int j = 0; j < joints.joints; ++j) {
    if (told[j]) continue;
    return Fail(
        ErrorCode::kConfig,
        "joint '" + (*skeleton)->joints[j].name + "' of skeleton '" + (*skeleton)->name + "' is not in the source",
        "ingest.source.joints", "joints-only motion needs every joint of its skeleton");
  }
  ingested.clip.motion = MakeJointsOnly(*skeleton, ingested.clip.rate, std::move(joints));
  return ingested;
}

void Cut(std::vector<double>& values, std::size_t frames, std::size_t wanted) {
  if (frames > 0) values.resize(values.size() / frames * wanted);
}

}  // namespace

Expected<IngestedClip> ReadVibeTrackClip(const SourceFile& file) {
  const Expected<Quaterniond> world_from_file = TurnOf(file.source.axes);
  if (!world_from_file) return Forward(world_from_file);
  const Expected<std::vector<VibeTrack>> tracks = ParseVibeTracks(file.bytes, file.name);
  if (!tracks) return Forward(tracks);
  std::string keys;
  for (const VibeTrack& track : *tracks) {
    keys += (keys.empty() ? "" : ", ") + std::to_string(track.id);
    if (std::to_string(track.id) != file.source.track) continue;
    const std::vector<Vector3d> still(track.frames, Vector3d::Zero());
    Expected<IngestedClip> ingested = MotionOf(track, file.source, *world_from_file, still, file.name);
    if (ingested) ingested->content.clear();  // the file's bytes are what is read
    return ingested;
  }
  return Fail(ErrorCode::kInconsistent, "the file has no track " + file.source.track, file.name,
              keys.empty() ? "it has none: nobody was found in the video" : "its tracks are " + keys);
}

Expected<IngestedClip> ReadUestcClip(const SourceFile& file) {
  const Expected<Quaterniond> world_from_file = TurnOf(file.source.axes);
  if (!world_from_file) return Forward(world_from_file);
  const Expected<UestcVideo> video = ParseUestcName(file.name, file.name);
  if (!video) return Forward(video);
  Expected<VibeTrack> track = ReadUestcVideo(file.container, file.entry, file.name);
  if (!track) return Forward(track);
  if (track->original_camera.empty()) {
    return Fail(ErrorCode::kInconsistent, "the video has no 'orig_cam'", file.name,
                "it says where the person stands: take the cache that holds it");
  }
  if (file.most_frames > 0 && static_cast<std::size_t>(file.most_frames) < track->frames) {
    const auto wanted = static_cast<std::size_t>(file.most_frames);
    Cut(track->pose, track->frames, wanted);
    Cut(track->joints3d, track->frames, wanted);
    Cut(track->original_camera, track->frames, wanted);
    track->frames = wanted;
  }
  std::vector<Vector3d> shift;
  for (std::size_t f = 0; f < track->frames; ++f) {
    const double* camera = &track->original_camera[4 * f];  // sx, sy, tx, ty
    if (!(camera[0] > 0.0)) {
      return Fail(ErrorCode::kInconsistent,
                  "the camera's scale is " + FormatDouble(camera[0]) + " in frame " + std::to_string(f), file.name,
                  "a scale is above 0: the detector lost the person");
    }
    shift.push_back(Vector3d(camera[2], camera[3], kFocal_px / (kHalfImage_px * camera[0])));
  }
  for (std::size_t f = track->frames; f-- > 0;) shift[f] -= shift[0];
  const double back = video->side == 1 ? 0.0 : -kRadiansPerView * video->view;
  const Quaterniond turned(Eigen::AngleAxisd(back, Vector3d::UnitY()));
  return MotionOf(*track, file.source, *world_from_file * turned, shift, file.name);
}

}  // namespace mocurate
