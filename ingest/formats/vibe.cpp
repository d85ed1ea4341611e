// Tracks of VIBE: files with a video's tracks, one of which is the person, and the videos of UESTC's cache.

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/vibe_pickle.h"
#include "core/motion/kinematics.h"
#include "ingest/checks/unit_checks.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/options.h"
#include "ingest/people/person_tracks.h"
#include "ingest/people/uestc.h"
#include "ingest/sources/mapped_file.h"
#include "ingest/sources/smpl_motion.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

/// Bones between VIBE's first points, which are OpenPose's BODY_25, and about how long they are, metres.
struct VibeBone {
  int point, parent;
  double length;
};
constexpr VibeBone kVibeBones[] = {{1, 8, 0.52},  {2, 1, 0.17},   {3, 2, 0.28},  {4, 3, 0.25},  {5, 1, 0.17},
                                   {6, 5, 0.28},  {7, 6, 0.25},   {9, 8, 0.10},  {10, 9, 0.40}, {11, 10, 0.41},
                                   {12, 8, 0.10}, {13, 12, 0.40}, {14, 13, 0.41}};
constexpr std::size_t kPointsWithBones = 15;

/// Frames of the video in which any person is, [first, last].
struct FrameRange {
  std::int64_t first = 0, last = 0;
};

/// Frames between rows are filled and counted: a broken number among the ids must not ask for millions of them.
Expected<FrameRange> FramesOf(const std::vector<VibeTrack>& tracks, const std::string& name) {
  constexpr std::int64_t kMostGaps = 20;  // frames per row
  const VibeTrack* first = nullptr;
  const VibeTrack* last = nullptr;
  std::size_t rows = 0;
  for (const VibeTrack& track : tracks) {
    if (track.frame_ids.empty()) continue;
    if (first == nullptr || track.frame_ids.front() < first->frame_ids.front()) first = &track;
    if (last == nullptr || track.frame_ids.back() > last->frame_ids.back()) last = &track;
    rows += track.frame_ids.size();
  }
  if (first == nullptr) return FrameRange();
  const FrameRange range{first->frame_ids.front(), last->frame_ids.back()};
  if (range.last - range.first < kMostGaps * static_cast<std::int64_t>(rows) + 1000) return range;
  return Fail(ErrorCode::kInconsistent,
              "frame_ids run from " + std::to_string(range.first) + " (track " + std::to_string(first->id) + ") to " +
                  std::to_string(range.last) + " (track " + std::to_string(last->id) + "), but the tracks have " +
                  std::to_string(rows) + " frames together",
              name, "check the ids, write the file again, or exclude it");
}

/// Frames are counted from `first`.
Expected<PersonTrack> PersonOfTrack(const VibeTrack& track, std::int64_t first, const std::string& name) {
  const auto lacks = [&](const char* field) {
    return Fail(ErrorCode::kInconsistent, "track " + std::to_string(track.id) + " has no '" + field + "'", name,
                "without it the place and time of people are unknown: name the person by ingest.source.track instead");
  };
  if (track.joints3d.empty() || track.joints < kPointsWithBones) return lacks("joints3d");
  if (track.original_camera.empty()) return lacks("orig_cam");
  if (track.frame_ids.empty()) return lacks("frame_ids");
  PersonTrack person;
  person.ids = {static_cast<std::uint64_t>(track.id)};
  person.positions.joints = static_cast<int>(track.joints);
  person.positions.frames = static_cast<int>(track.frames);
  person.positions.xyz = track.joints3d;
  person.confidence.assign(track.frames * track.joints, 1.0);
  const Expected<std::vector<Vector3d>> places = CameraPlaces(track.original_camera);
  if (!places) return Forward(places);
  for (std::size_t f = 0; f < track.frames; ++f) {
    person.frames.push_back(static_cast<int>(track.frame_ids[f] - first));
    for (int k = 0; k < person.positions.joints; ++k) person.positions.at(static_cast<int>(f), k) += (*places)[f];
  }
  return person;
}

Expected<UestcPerson> ChooseByPlaces(const std::vector<VibeTrack>& tracks, const PeopleOptions& options,
                                     const FrameRange& range, double rate_hz, const std::string& name) {
  std::vector<int> parents(tracks.front().joints, -1);
  std::vector<double> lengths(parents.size(), 0.0);
  std::vector<PersonTrack> people;
  const int frames = static_cast<int>(range.last - range.first + 1);
  for (const VibeTrack& track : tracks) {
    Expected<PersonTrack> person = PersonOfTrack(track, range.first, name);
    if (!person) return Forward(person);
    people.push_back(std::move(*person));
  }
  for (const VibeBone& bone : kVibeBones) {
    parents[static_cast<std::size_t>(bone.point)] = bone.parent;
    lengths[static_cast<std::size_t>(bone.point)] = bone.length;
  }
  std::vector<double> time_s;
  for (int f = 0; f < frames; ++f) time_s.push_back(f / rate_hz);
  std::vector<Finding> findings;
  people = JoinIds(std::move(people), options, parents, time_s, findings);
  People chosen = ChoosePeople(std::move(people), 1, options.rule, options.false_tracks, parents, lengths, frames);
  if (chosen.chosen.empty()) {
    return Fail(ErrorCode::kInconsistent, "none of its " + std::to_string(tracks.size()) + " tracks is a person", name,
                "leave the file out");
  }
  std::vector<const VibeTrack*> pieces;
  for (const std::uint64_t id : chosen.chosen.front().ids) {
    for (const VibeTrack& track : tracks) {
      if (static_cast<std::uint64_t>(track.id) == id) pieces.push_back(&track);
    }
  }
  UestcPerson person = JoinVibeTracks(pieces);
  findings.insert(findings.end(), chosen.findings.begin(), chosen.findings.end());
  findings.insert(findings.end(), person.findings.begin(), person.findings.end());
  person.findings = std::move(findings);
  return person;
}

/// The track that a source names: frames between its rows are filled along the shortest arc and reported as
/// "frames_filled". A track that does not declare its frames is taken as it is. Errors as of ChooseVibePerson.
Expected<UestcPerson> NamedVibePerson(const VibeTrack& track, const std::string& name) {
  if (track.frame_ids.empty()) return UestcPerson{track, {}, {}, {}};
  const Expected<FrameRange> range = FramesOf({track}, name);
  if (!range) return Forward(range);
  UestcPerson person = JoinVibeTracks({&track});
  person.chosen.clear();  // its name is the source's
  return person;
}

/// The performer of a video among VIBE's tracks by `people.rule`. kUestcReleased and kUestcCorrected: SelectUestcTrack,
/// from `people.start`. Any other rule: where people are is the joints moved by the camera's estimate, frames counted
/// from the first in which any person is; ids that are one person are joined, false tracks are excluded and the rest
/// ranked as of any tracker (person_tracks.h); gaps of who is chosen are filled along the shortest arc. Errors
/// kInconsistent: no track, no person, a field that the rule reads is missing, or frame_ids span more than 20 frames a
/// row and 1000; `name` is the file.
Expected<UestcPerson> ChooseVibePerson(const std::vector<VibeTrack>& tracks, const PeopleOptions& options,
                                       double rate_hz, const std::string& name) {
  if (tracks.empty()) return Fail(ErrorCode::kInconsistent, "no person was found in the video", name, "leave it out");
  const Expected<FrameRange> range = FramesOf(tracks, name);
  if (!range) return Forward(range);
  if (!ByBoxes(options.rule)) {
    return ChooseByPlaces(tracks, options, *range, rate_hz, name);
  }
  const Vector2d start(options.start_px[0], options.start_px[1]);
  Expected<UestcPerson> person = SelectUestcTrack(tracks, start, options.rule);
  if (person) return person;
  Error error = person.error();
  error.where = name + ": " + error.where;
  return tl::unexpected<Error>(error);
}

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
  if (Status there = CheckEntry(file.facts.entry, cache.size(), file.name); !there) return Forward(there);
  return cache.Track(static_cast<std::size_t>(file.facts.entry));
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
  if (file.container.empty() || file.facts.entry < 0) ingested->content.clear();  // the content is the file's bytes
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
  if (auto finding = CheckFrameCount(file.facts.most_frames, track.frames, file.facts.entry))
    person.findings.push_back(*finding);
  if (file.facts.most_frames > 0 && static_cast<std::size_t>(file.facts.most_frames) < track.frames) {
    const auto wanted = static_cast<std::size_t>(file.facts.most_frames);
    KeepFrames(track.pose, track.frames, wanted);
    KeepFrames(track.joints3d, track.frames, wanted);
    KeepFrames(track.original_camera, track.frames, wanted);
    track.frames = wanted;
  }
  const Quaterniond turned(UestcWorldFromView(video->view, video->side));
  return ClipOfPerson(person, file, *world_from_file * turned);
}

void ProposeUestc(const Proposal& proposal, DeclarationWriter& writer) {
  WriteContainer(proposal, "a{action}_d{view}_p{person:3}_c{side}_color.avi", writer);
  writer.Value("person", YamlQuoted("p{person}"), "declared by the format");
  writer.Value("label", YamlQuoted(""), "declared by the format: by the lists of info/");
}

}  // namespace

FormatDriver VibeTracksFormat() {
  FormatDriver d;
  d.name = "vibe_tracks";
  d.gives = EvidenceKind::kMotion;
  d.rotations = true;
  d.unit = UnitOf::kMetres;
  d.needs_skeleton = true;
  d.tree = "smpl24";
  d.options = {"track", "root_translation", "people"};
  d.check = CheckStart;
  d.to_clip = ReadVibeTrackClip;
  return d;
}

FormatDriver UestcFormat() {
  FormatDriver d;
  d.name = "uestc";
  d.inspected = "vibe_cache";
  d.gives = EvidenceKind::kMotion;
  d.rotations = true;
  d.unit = UnitOf::kMetres;
  d.needs_skeleton = true;
  d.tree = "smpl24";
  d.options = {"container", "root_translation", "people"};
  d.check = CheckStart;
  d.sniff = [](const FileBytes& file, FileKind) { return IsUestcInfo(file.path); };
  d.open = ReadRawUestcInfo;
  d.propose = ProposeUestc;
  d.to_clip = ReadUestcClip;
  d.entries = UestcEntries;
  return d;
}

}  // namespace mocurate
