#include <algorithm>
#include <string>

#include "core/base/random.h"
#include "core/base/text.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/uestc_info.h"
#include "core/formats/vibe_pickle.h"
#include "core/motion/kinematics.h"
#include "core/motion/motion.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/studio_options.h"
#include "ingest/synthetic/take_plan.h"
#include "ingest/synthetic/tracker.h"

namespace mocurate {
namespace {

constexpr double kFocal = 500.0;
constexpr double kHalfImage = 270.0;
constexpr double kBoxMargin = 1.1;
constexpr double kCropScale = 0.9;   // of a box, filled by the person in VIBE's crop
constexpr double kLimb = 0.25;       // metres; bone length that converts position errors to rotation errors
constexpr double kDepthError = 4.0;  // of one image: error along the line of sight, relative to across

/// Errors of the rotations and the root, generated as for tracked points; the last one is the root.
JointPositions ErrorsOf(const Motion& motion, const TrackerOptions& options, std::int64_t seed,
                        const std::string& item) {
  TrackerOptions persistent = options;
  persistent.dropout_share = persistent.outlier_share = persistent.frozen_share = 0.0;
  persistent.swap_share = persistent.swapped_share = 0.0;
  std::vector<std::string> names;
  for (const Joint& joint : motion.skeleton->joints) names.push_back(joint.name);
  names.emplace_back("place of the root");
  const JointPositions still(motion.frame_count(), static_cast<int>(names.size()));
  return Track(still, names, persistent, seed, item + "/rotations").positions;
}

/// Rotations and root with these errors.
Motion DeclaredMotion(const Motion& motion, const JointPositions& errors) {
  const int joints = motion.joint_count();
  std::vector<Vector3d> root = motion.root_translation;
  std::vector<Quaterniond> rotation = motion.rotation;
  for (int f = 0; f < motion.frame_count(); ++f) {
    root[f] += errors.at(f, joints).cwiseProduct(Vector3d(1.0, 1.0, kDepthError));
    for (int j = 0; j < joints; ++j) {
      Quaterniond& own = rotation[static_cast<std::size_t>(f) * joints + j];
      own = (own * ExpQuaternion(errors.at(f, j) / kLimb)).normalized();
    }
  }
  return MakeMotion(motion.skeleton, motion.rate, std::move(root), std::move(rotation), motion.bone_length);
}

constexpr std::int64_t kVibeRateHz = 30;
constexpr int kViews = 8;  // of UESTC's second camera; the ninth moves

/// From the world to a level camera at `height` metres and `away` metres distance, with the subject rotated by `turned`
/// about the vertical. Camera axes: x right, y down, z forward.
RigidTransform CameraFromWorld(double height, double away, double turned) {
  const RigidTransform turn{Quaterniond(Eigen::AngleAxisd(turned, Vector3d::UnitY())), Vector3d::Zero()};
  const RigidTransform shift{Quaterniond::Identity(), Vector3d(0.0, -height, -away)};
  return HalfRotationAboutX() * shift * turn;
}

/// A video of UESTC: both cameras record each take, the second from one of eight sides.
struct Video {
  UestcVideo name;
  const PlannedTake* take = nullptr;

  std::string Person() const { return "p" + ZeroPadded(name.subject, 3); }
  /// "a12_d4_p007_c2"
  std::string Recording() const {
    const std::string whole = name.Name();
    return whole.substr(0, whole.rfind("_color"));
  }
};

Expected<std::vector<PlannedTake>> UestcTakes(const StudioOptions& options) {
  return PlanTakes(options, UestcClasses(), {118, 2, static_cast<double>(kVibeRateHz), 0.3, 0.8});
}

std::vector<Video> VideosOf(const std::vector<PlannedTake>& takes) {
  std::vector<Video> videos;
  for (const PlannedTake& take : takes) {
    const int view = (take.subject + take.repetition + take.kind->id) % kViews;
    videos.push_back({{take.kind->id, view, take.subject, 1}, &take});
    videos.push_back({{take.kind->id, view, take.subject, 2}, &take});
  }
  return videos;
}

/// World (canonical axes) from the video's camera: the set's own reader rotates side 2 back by its view.
RigidTransform TurnedBack(const Video& video) {
  const double back = video.name.side == 1 ? 0.0 : 0.25 * kPi * video.name.view;
  return RigidTransform{Quaterniond(Eigen::AngleAxisd(back, Vector3d::UnitY())), Vector3d::Zero()} *
         HalfRotationAboutX();
}

/// The motion of a video, in its camera's axes. The second camera stands higher and nearer.
Motion SeenIn(const Video& video, const Motion& motion) {
  if (video.name.side == 1) return SelectFrames(motion, CameraFromWorld(1.1, 3.6, 0.0));
  return SelectFrames(motion, CameraFromWorld(1.25, 3.3, -0.25 * kPi * video.name.view));
}

void AddVideoTruth(const Video& video, const std::string& source, const Motion& seen, StudioFolder& folder) {
  const std::string person = video.Person();
  folder.AddTruth(person, source + "/" + person + "/" + video.Recording(), SelectFrames(seen, TurnedBack(video)));
}

/// Frames [begin, end) of a track under another id.
VibeTrack Piece(const VibeTrack& whole, std::int64_t id, std::size_t begin, std::size_t end) {
  VibeTrack piece = whole;
  piece.id = id;
  piece.frames = end - begin;
  const auto cut = [&](auto& values) {
    const auto width = static_cast<std::ptrdiff_t>(values.size() / whole.frames);
    values.erase(values.begin() + width * static_cast<std::ptrdiff_t>(end), values.end());
    values.erase(values.begin(), values.begin() + width * static_cast<std::ptrdiff_t>(begin));
  };
  for (auto field : {&VibeTrack::pose, &VibeTrack::joints3d, &VibeTrack::betas, &VibeTrack::original_camera,
                     &VibeTrack::predicted_camera, &VibeTrack::boxes}) {
    cut(piece.*field);
  }
  cut(piece.frame_ids);
  return piece;
}

constexpr std::size_t kLost = 3;  // frames between two ids of one person

/// The performer's track; in files with a bystander, under two ids, with the bystander's track.
std::vector<VibeTrack> VibeTracksOf(const Video& video, const Actor& bystander, const Motion& seen,
                                    const StudioOptions& options) {
  const Vector2d image_centre(480.0, 270.0);
  const std::string name = video.name.Name();
  VibeTrack whole = VibeTrackOf(seen, options.tracker, options.seed, name, image_centre);
  Random random(static_cast<std::uint64_t>(options.seed), "studio.bystander", name);
  if (random.Uniform() >= options.false_track_share || whole.frames < 4 * kLost) return {std::move(whole)};
  Script standing;
  standing.frames = seen.frame_count();
  standing.sway_phase = random.Uniform(0.0, 2.0 * kPi);
  const Motion other = PerformScript(standing, bystander.subject, bystander.skeleton, FrameRate{kVibeRateHz, 1});
  RigidTransform aside = CameraFromWorld(1.1, 4.4, 0.0);
  aside.translation.x() += random.Uniform() < 0.5 ? -1.5 : 1.5;
  VibeTrack theirs =
      VibeTrackOf(SelectFrames(other, aside), options.tracker, options.seed, name + "/bystander", image_centre);
  theirs.id = 2;
  const std::size_t lost = whole.frames / 2;
  return {Piece(whole, 1, 0, lost), std::move(theirs), Piece(whole, 3, lost + kLost, whole.frames)};
}

}  // namespace

VibeTrack VibeTrackOf(const Motion& motion, const TrackerOptions& options, std::int64_t seed, const std::string& item,
                      const Vector2d& image_centre) {
  VibeTrack track;
  track.id = 1;
  track.frames = static_cast<std::size_t>(motion.frame_count());
  const std::vector<std::string> names = NamesOf(Vibe49Places());
  track.joints = names.size();
  const JointPositions truth = PlacesOf(motion, Vibe49Places());
  TrackedTake tracked = Track(truth, names, options, seed, item);
  ExtrapolateMissing(options, seed, item, tracked);
  const Motion declared = DeclaredMotion(motion, ErrorsOf(motion, options, seed, item));
  for (int f = 0; f < motion.frame_count(); ++f) {
    const std::vector<double> pose = RotationVectors(declared, f);
    track.pose.insert(track.pose.end(), pose.begin(), pose.end());
    const Vector3d root = motion.root_translation[f];
    Vector2d low = Vector2d::Constant(1e9), high = Vector2d::Constant(-1e9);
    for (int k = 0; k < truth.joints; ++k) {
      const Vector3d at = tracked.positions.at(f, k) - root;
      track.joints3d.insert(track.joints3d.end(), at.data(), at.data() + 3);
      const Vector3d place = truth.at(f, k);
      const Vector2d pixel = kFocal * place.head<2>() / place.z() + image_centre;
      low = low.cwiseMin(pixel);
      high = high.cwiseMax(pixel);
    }
    track.betas.insert(track.betas.end(), 10, 0.0);
    const Vector3d declared_root = declared.root_translation[f];
    const double scale = kFocal / (kHalfImage * declared_root.z());
    track.original_camera.insert(track.original_camera.end(), {scale, scale, declared_root.x(), declared_root.y()});
    const Vector2d centre = 0.5 * (low + high);
    const double side = kBoxMargin * (high - low).maxCoeff();
    const double crop = kCropScale * scale * 2.0 * kHalfImage / side;
    const Vector2d shift = (kFocal * root.head<2>() / root.z() + image_centre - centre) / side;
    track.predicted_camera.insert(track.predicted_camera.end(), {crop, 2.0 * shift.x() / crop, 2.0 * shift.y() / crop});
    track.boxes.insert(track.boxes.end(), {centre.x(), centre.y(), side, side});
    track.frame_ids.push_back(f);
  }
  return track;
}

Status WriteUestcLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const auto takes = UestcTakes(options);
  if (!takes) return Forward(takes);
  const std::vector<Video> videos = VideosOf(*takes);
  std::vector<VibeTrack> tracks(videos.size());
  std::vector<int> frames(videos.size());
  Status done = folder.ForEach(videos.size(), [&](std::size_t i) -> Status {
    const Video& video = videos[i];
    const Actor& actor = actors[static_cast<std::size_t>(video.take->subject - 1)];
    const Motion motion = PerformScript(video.take->script, actor.subject, actor.skeleton, FrameRate{kVibeRateHz, 1});
    const Motion seen = SeenIn(video, motion);
    tracks[i] = VibeTrackOf(seen, options.tracker, options.seed, video.name.Name());
    frames[i] = motion.frame_count();
    AddVideoTruth(video, "uestc", seen, folder);
    return {};
  });
  if (!done) return done;
  std::vector<UestcVideo> names;
  for (const Video& video : videos) names.push_back(video.name);
  const Expected<std::string> cache = EncodeVibeCache(tracks, "vibe_cache_refined.pkl");
  if (!cache) return Forward(cache);
  std::string classes;
  for (const SetClass& kind : UestcClasses()) classes += std::string(kind.label) + "\n";
  for (const auto& [name, bytes] : {std::pair<std::string, std::string>("info/names.txt", WriteUestcNames(names)),
                                    {"info/num_frames_min.txt", WriteUestcFrameCounts(frames)},
                                    {"info/action_classes.txt", classes},
                                    {"vibe_cache_refined.pkl", *cache}}) {
    if (Status written = folder.Write("uestc/" + name, bytes); !written) return written;
  }
  return {};
}

Status WriteUestcVibeLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const auto takes = UestcTakes(options);
  if (!takes) return Forward(takes);
  const std::vector<Video> videos = VideosOf(*takes);
  return folder.ForEach(videos.size(), [&](std::size_t i) -> Status {
    const Video& video = videos[i];
    const auto performer = static_cast<std::size_t>(video.take->subject - 1);
    const Actor& actor = actors[performer];
    const Motion motion = PerformScript(video.take->script, actor.subject, actor.skeleton, FrameRate{kVibeRateHz, 1});
    const Motion seen = SeenIn(video, motion);
    const std::string name = video.Recording() + "_color/vibe_output.pkl";
    const Expected<std::string> bytes =
        EncodeVibeTracks(VibeTracksOf(video, actors[(performer + 1) % actors.size()], seen, options), name);
    if (!bytes) return Forward(bytes);
    AddVideoTruth(video, "uestc_vibe", seen, folder);
    return folder.Write("uestc_vibe/" + name, *bytes);
  });
}

Status WriteNtuVibeLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const auto takes = PlanTakes(options, Ntu13Classes(), {40, 2, static_cast<double>(kVibeRateHz), 0.2, 0.6});
  if (!takes) return Forward(takes);
  std::vector<std::string> names(takes->size());
  Status done = folder.ForEach(takes->size(), [&](std::size_t i) -> Status {
    const PlannedTake& take = (*takes)[i];
    const Actor& actor = actors[static_cast<std::size_t>(take.subject - 1)];
    const std::string person = "P" + ZeroPadded(take.subject, 3);
    const std::string recording =
        NtuName{FirstSetupOf(take.kind->id), 1, take.subject, take.repetition, take.kind->id}.Text();
    const Motion motion = PerformScript(take.script, actor.subject, actor.skeleton, FrameRate{kVibeRateHz, 1});
    const Motion seen = SelectFrames(motion, CameraFromWorld(1.2, 3.4, 0.0));
    const VibeTrack track = VibeTrackOf(seen, options.tracker, options.seed, recording);
    names[i] = recording + ".pkl";
    const Expected<std::string> bytes = EncodeVibeTracks({track}, names[i]);
    if (!bytes) return Forward(bytes);
    if (Status written = folder.Write("ntu13/" + names[i], *bytes); !written) return written;
    folder.AddTruth(person, "ntu13/" + person + "/" + recording, SelectFrames(seen, HalfRotationAboutX()));
    return {};
  });
  if (!done) return done;
  std::string list;
  for (const std::string& name : names) list += name + "\n";
  return folder.Write("ntu13/ntu_vibe_list.txt", list);
}

}  // namespace mocurate
