// Tracks of VIBE: files with a video's tracks, one of which is the person, and the videos of UESTC's cache.

#include <algorithm>
#include <filesystem>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/vibe_pickle.h"
#include "core/motion/kinematics.h"
#include "ingest/checks/angle_checks.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/people/vibe_people.h"
#include "ingest/sources/body_check.h"
#include "ingest/sources/kept_open.h"
#include "ingest/sources/smpl_motion.h"
#include "ingest/sources/uestc_folder.h"

namespace mocurate {
namespace {

using OpenCache = MappedArchive<VibeCache>;

Expected<std::shared_ptr<const OpenCache>> CacheOf(const std::filesystem::path& container) {
  static KeptOpen<OpenCache> last;
  return last.Get(container, OpenCache::Open);
}

/// The videos of UESTC's cache, by the names in info/ beside it; the second camera's moving view is excluded. Error
/// kInconsistent where info/ lists another number of videos than the cache, so that names cannot be assigned.
Expected<std::vector<ContainerEntry>> UestcEntries(const SourceOptions& source, const std::filesystem::path& folder) {
  const std::filesystem::path container = folder / source.container;
  const Expected<UestcFolder> info = ReadUestcFolder(container.parent_path());
  if (!info) return Forward(info);
  const auto cache = CacheOf(container);
  if (!cache) return Forward(cache);
  if ((*cache)->archive.size() != info->videos.size()) {
    return Fail(ErrorCode::kInconsistent,
                "info/names.txt names " + Counted(static_cast<long long>(info->videos.size()), "video") +
                    ", the file holds " + std::to_string((*cache)->archive.size()) +
                    ": names cannot be assigned to videos",
                DisplayPath(source.container), "use info/ and the cache of one release");
  }
  std::vector<ContainerEntry> entries;
  for (std::size_t i = 0; i < info->videos.size(); ++i) {
    const UestcVideo& video = info->videos[i];
    ContainerEntry entry{video.Name(), info->actions[static_cast<std::size_t>(video.action)], info->frames[i], ""};
    if (video.side == 2 && video.view == 8) entry.excluded = "the second camera moves in view 8";
    if (info->frames[i] == 0) entry.excluded = "info/num_frames_min.txt declares 0 frames";
    entries.push_back(std::move(entry));
  }
  return entries;
}

Expected<VibeTrack> ReadUestcVideo(const SourceFile& file) {
  const auto opened = CacheOf(file.container);
  if (!opened) return Forward(opened);
  const VibeCache& cache = (*opened)->archive;
  if (Status there = CheckEntry(file.entry, cache.size(), file.name); !there) return Forward(there);
  return cache.Track(static_cast<std::size_t>(file.entry));
}

/// The performer's starting point has two coordinates in the image.
Status CheckStart(const SourceOptions& s) {
  if (!ByBoxes(s.people.rule) || s.people.start_px.size() == 2) return {};
  return Fail(ErrorCode::kConfig,
              "the performer's starting point has " + std::to_string(s.people.start_px.size()) + " numbers",
              "ingest.source.people.start", "write two: pixels across and down");
}

constexpr std::size_t kMidHip = 8;  // of VIBE's 49 points

Vector3d JointPlace(const VibeTrack& track, std::size_t frame, std::size_t joint) {
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
                name, "name each joint of the file in its order, '-' for one that is skipped");
  }
  return {};
}

/// A track in the world: the file's positions moved by `shift` (F) in file axes and rotated by `world_from_file`.
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
      root_translation.push_back(world_from_file * Vector3d(shift[f] + JointPlace(track, f, kMidHip)));
    }
    Expected<std::vector<Quaterniond>> local =
        SmplLocalRotations(**skeleton, SmplRotations{track.pose, track.frames}, world_from_file);
    if (!local) return Forward(local);
    ingested.clip.motion =
        MakeMotion(*skeleton, ingested.clip.rate, std::move(root_translation), *std::move(local), {});
    if (std::optional<Finding> invalid_poses = CheckAngleUnits(track))
      ingested.findings.push_back(*std::move(invalid_poses));
    // The clip does not keep its joints; an inspection reads them beside the rotations.
    CheckPoints(source, ReadRawVibeTrack(track, "vibe_tracks"), ingested);
    return ingested;
  }
  JointPositions joints(static_cast<int>(track.frames), (*skeleton)->joint_count());
  std::vector<bool> found((*skeleton)->joints.size(), false);
  for (std::size_t k = 0; k < source.joints.size(); ++k) {
    const std::optional<int> joint = (*skeleton)->FindJoint(source.joints[k]);
    if (!joint) continue;
    found[*joint] = true;
    for (int f = 0; f < joints.frames; ++f) {
      const auto frame = static_cast<std::size_t>(f);
      joints.at(f, *joint) = world_from_file * Vector3d(shift[frame] + JointPlace(track, frame, k));
    }
  }
  for (int j = 0; j < joints.joints; ++j) {
    if (found[j]) continue;
    return Fail(
        ErrorCode::kConfig,
        "joint '" + (*skeleton)->joints[j].name + "' of skeleton '" + (*skeleton)->name + "' is not in the source",
        "ingest.source.joints", "joints-only motion needs every joint of its skeleton");
  }
  ingested.clip.motion = MakeJointsOnly(*skeleton, ingested.clip.rate, std::move(joints));
  // The source may skip joints that show more.
  CheckPoints(source, ReadRawVibeTrack(track, "vibe_tracks"), ingested);
  return ingested;
}

void KeepFrames(std::vector<double>& values, std::size_t frames, std::size_t wanted) {
  if (frames > 0) values.resize(values.size() / frames * wanted);
}

/// The root's motion in file axes, relative to its position in the first frame.
Expected<std::vector<Vector3d>> ShiftOf(const VibeTrack& track, const SourceOptions& source, const std::string& name) {
  const bool published = source.root_translation == RootTranslation::kPublished;
  const bool by_camera = source.root_translation == RootTranslation::kCamera || (published && source.format == "uestc");
  if (!by_camera) return std::vector<Vector3d>(track.frames, Vector3d::Zero());
  if (track.original_camera.empty()) {
    return Fail(ErrorCode::kInconsistent, "the video has no 'orig_cam'", name,
                "it holds the person's position: use the file that has it, or set root_translation: still");
  }
  Expected<std::vector<Vector3d>> shift = UestcTranslation(track.original_camera);
  if (shift) return shift;
  Error error = shift.error();
  error.where = name;
  return tl::unexpected<Error>(error);
}

/// The person of a file of tracks, by name or by `people.rule`.
Expected<UestcPerson> ChosenPerson(const SourceFile& file, bool by_name) {
  Expected<std::vector<VibeTrack>> tracks = ParseVibeTracks(file.bytes, file.name);
  if (!tracks) return Forward(tracks);
  if (!by_name) return ChooseVibePerson(*tracks, file.source.people, *file.source.rate_hz, file.name);
  std::string keys;
  for (const VibeTrack& track : *tracks) {
    keys += (keys.empty() ? "" : ", ") + std::to_string(track.id);
    if (std::to_string(track.id) == file.source.track) return NamedVibePerson(track, file.name);
  }
  return Fail(ErrorCode::kInconsistent, "the file has no track " + file.source.track, file.name,
              keys.empty() ? "it has none: no person was found in the video" : "its tracks are " + keys);
}

/// Rows that a track lacks are interpolated; the released cache does not mark them.
void MarkFilled(const std::vector<char>& filled, Motion& motion) {
  if (std::count(filled.begin(), filled.end(), 1) == 0) return;
  motion.state.clear();
  for (int f = 0; f < motion.frame_count(); ++f) {
    const bool is_filled = filled[static_cast<std::size_t>(f)] != 0;
    motion.state.insert(motion.state.end(), static_cast<std::size_t>(motion.joint_count()),
                        is_filled ? JointState::kInterpolated : JointState::kObserved);
  }
}

/// The clip of the chosen person.
Expected<IngestedClip> ClipOfPerson(const UestcPerson& person, const SourceFile& file,
                                    const Quaterniond& world_from_file) {
  const Expected<std::vector<Vector3d>> shift = ShiftOf(person.track, file.source, file.name);
  if (!shift) return Forward(shift);
  Expected<IngestedClip> ingested = MotionOf(person.track, file.source, world_from_file, *shift, file.name);
  if (!ingested) return ingested;
  ingested->findings.insert(ingested->findings.end(), person.findings.begin(), person.findings.end());
  if (file.source.people.rule != TrackRule::kUestcReleased) MarkFilled(person.interpolated, *ingested->clip.motion);
  std::string ids;
  for (const std::int64_t id : person.chosen) ids += (ids.empty() ? "" : "+") + std::to_string(id);
  if (!ids.empty()) ingested->clip.provenance["tracks"] = ids;
  if (file.container.empty() || file.entry < 0) ingested->content.clear();  // the content is the file's bytes
  return ingested;
}

/// One track of VIBE. On a skeleton with SMPL's joints: its rotations, with the pelvis at the middle of the hips; on
/// another: the positions of `joints`, without rotations.
Expected<IngestedClip> ReadVibeTrackClip(const SourceFile& file) {
  const Expected<Quaterniond> world_from_file = RotationOfAxes(file.source.axes);
  if (!world_from_file) return Forward(world_from_file);
  const Expected<UestcPerson> person = ChosenPerson(file, !file.source.track.empty());
  return person ? ClipOfPerson(*person, file, *world_from_file) : Forward(person);
}

/// One video of UESTC's cache, as VIBE's tracks, moved by the camera's estimate: (tx, ty, 500 / (270 sx)) of ACTOR.
/// Side 2 is rotated back by the view's angle.
Expected<IngestedClip> ReadUestcClip(const SourceFile& file) {
  const Expected<Quaterniond> world_from_file = RotationOfAxes(file.source.axes);
  if (!world_from_file) return Forward(world_from_file);
  // a12_d4_p007_c2_color.avi in the cache; for a file of tracks, its own name or its folder's.
  const std::filesystem::path path(file.name);
  Expected<UestcVideo> video = ParseUestcName(path.stem().string(), file.name);
  if (!video && path.has_parent_path()) {
    Expected<UestcVideo> of_folder = ParseUestcName(path.parent_path().filename().string(), file.name);
    if (of_folder) video = std::move(of_folder);
  }
  if (!video) return Forward(video);
  UestcPerson person;
  if (file.source.container.empty()) {
    Expected<UestcPerson> chosen = ChosenPerson(file, false);
    if (!chosen) return Forward(chosen);
    person = std::move(*chosen);
  } else {
    Expected<VibeTrack> track = ReadUestcVideo(file);
    if (!track) return Forward(track);
    person.track = std::move(*track);
  }
  VibeTrack& track = person.track;
  if (auto finding = CheckFrameCount(file.most_frames, track.frames, file.entry)) person.findings.push_back(*finding);
  if (file.most_frames > 0 && static_cast<std::size_t>(file.most_frames) < track.frames) {
    const auto wanted = static_cast<std::size_t>(file.most_frames);
    KeepFrames(track.pose, track.frames, wanted);
    KeepFrames(track.joints3d, track.frames, wanted);
    KeepFrames(track.original_camera, track.frames, wanted);
    track.frames = wanted;
  }
  const Quaterniond turned(UestcWorldFromView(video->view, video->side));
  return ClipOfPerson(person, file, *world_from_file * turned);
}

}  // namespace

const FormatDriver& VibeTracksFormat() {
  static const FormatDriver driver = [] {
    FormatDriver d;
    d.name = "vibe_tracks";
    d.inspected = "vibe_tracks";
    d.gives = EvidenceKind::kMotion;
    d.rotations = true;
    d.unit = UnitOf::kMetres;
    d.needs_skeleton = true;
    d.options = {"track", "root_translation", "people"};
    d.check = CheckStart;
    d.to_clip = ReadVibeTrackClip;
    return d;
  }();
  return driver;
}

const FormatDriver& UestcFormat() {
  static const FormatDriver driver = [] {
    FormatDriver d;
    d.name = "uestc";
    d.inspected = "vibe_cache";
    d.gives = EvidenceKind::kMotion;
    d.rotations = true;
    d.unit = UnitOf::kMetres;
    d.needs_skeleton = true;
    d.container = Container::kMay;
    d.options = {"container", "root_translation", "people"};
    d.check = CheckStart;
    d.sniff = [](const FileBytes& file, FileKind) { return IsUestcInfo(file.path); };
    d.read_raw = ReadRawUestcInfo;
    d.to_clip = ReadUestcClip;
    d.entries = UestcEntries;
    return d;
  }();
  return driver;
}

}  // namespace mocurate
