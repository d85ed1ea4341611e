#include "ingest/people/vibe_people.h"

#include <algorithm>
#include <utility>

#include "ingest/people/choose_people.h"

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
  People chosen = ChoosePeople(std::move(people), 1, options.rule, options.false_tracks, FalseTrackLimits(), parents,
                               lengths, frames);
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
  UestcPerson person = JoinVibeTracks(pieces, UestcRule::kCorrected);
  findings.insert(findings.end(), chosen.findings.begin(), chosen.findings.end());
  findings.insert(findings.end(), person.findings.begin(), person.findings.end());
  person.findings = std::move(findings);
  return person;
}

}  // namespace

Expected<UestcPerson> NamedVibePerson(const VibeTrack& track, const std::string& name) {
  if (track.frame_ids.empty()) return UestcPerson{track, {}, {}, {}};
  const Expected<FrameRange> range = FramesOf({track}, name);
  if (!range) return Forward(range);
  UestcPerson person = JoinVibeTracks({&track}, UestcRule::kCorrected);
  person.chosen.clear();  // its name is the source's
  return person;
}

Expected<UestcPerson> ChooseVibePerson(const std::vector<VibeTrack>& tracks, const PeopleOptions& options,
                                       double rate_hz, const std::string& name) {
  if (tracks.empty()) return Fail(ErrorCode::kInconsistent, "no person was found in the video", name, "leave it out");
  const Expected<FrameRange> range = FramesOf(tracks, name);
  if (!range) return Forward(range);
  if (!ByBoxes(options.rule)) {
    return ChooseByPlaces(tracks, options, *range, rate_hz, name);
  }
  const UestcRule rule = options.rule == TrackRule::kUestcReleased ? UestcRule::kPublished : UestcRule::kCorrected;
  Expected<UestcPerson> person = SelectUestcTrack(tracks, Vector2d(options.start_px[0], options.start_px[1]), rule);
  if (person) return person;
  Error error = person.error();
  error.where = name + ": " + error.where;
  return tl::unexpected<Error>(error);
}

}  // namespace mocurate
