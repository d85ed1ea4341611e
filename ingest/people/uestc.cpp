#include "ingest/people/uestc.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/file.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr const char* kCounts = "info/num_frames_min.txt";

Expected<std::string> ReadBeside(const std::filesystem::path& folder, const std::string& name) {
  Expected<std::string> bytes = ReadFile(folder / name);
  if (!bytes && bytes.error().code == ErrorCode::kNotFound) {
    return Fail(ErrorCode::kNotFound, "the file is not in the folder: the container does not name its clips", name,
                "put it beside the container; `mocurate doctor --source NAME` lists what is needed");
  }
  return bytes;
}

constexpr double kDriftPerFrame = 10.0;  // pixels that a person may have moved on for each lost frame
constexpr std::size_t kPoseJoints = 24;

using Quaternion = Eigen::Vector4d;  // (w, x, y, z), as it comes: signs matter here

/// Every field of a track that has one row per frame.
struct TrackField {
  std::vector<double> VibeTrack::*values;
  std::size_t columns;
};

std::vector<TrackField> TrackFields(const VibeTrack& track) {
  return {{&VibeTrack::joints3d, track.joints * 3}, {&VibeTrack::betas, 10}, {&VibeTrack::original_camera, 4},
          {&VibeTrack::predicted_camera, 3},        {&VibeTrack::boxes, 4},  {&VibeTrack::pose, kPoseJoints * 3}};
}

std::int64_t Begin(const VibeTrack& track) { return track.frame_ids.front(); }
std::int64_t End(const VibeTrack& track) { return track.frame_ids.back(); }

Vector2d BoxCentre(const VibeTrack& track, std::size_t row) { return {track.boxes[4 * row], track.boxes[4 * row + 1]}; }

double BoxSize(const VibeTrack& track, std::size_t row) {
  return std::max(track.boxes[4 * row + 2], track.boxes[4 * row + 3]);
}

Status Check(const std::vector<VibeTrack>& tracks) {
  if (tracks.empty()) return Fail(ErrorCode::kInconsistent, "no person was found in the video", "tracks");
  for (const VibeTrack& track : tracks) {
    const std::string name = "track " + std::to_string(track.id);
    if (track.frames == 0 || track.frame_ids.size() != track.frames)
      return Fail(ErrorCode::kInconsistent, name + " does not declare its frames", "frame_ids");
    if (track.boxes.size() != 4 * track.frames)
      return Fail(ErrorCode::kInconsistent, name + " has no box per frame", "bboxes",
                  "boxes distinguish the performer from others");
    for (const TrackField& field : TrackFields(track)) {
      const std::vector<double>& values = track.*(field.values);
      if (!values.empty() && values.size() != field.columns * track.frames)
        return Fail(ErrorCode::kInconsistent, name + " has a field that is not as long as its frames", "tracks");
      const bool unlike =
          values.empty() != (tracks.front().*(field.values)).empty() || track.joints != tracks.front().joints;
      if (unlike) return Fail(ErrorCode::kInconsistent, name + " has other fields than the first", "tracks");
    }
  }
  return {};
}

/// Which of `rivals` (indices) is the person.
std::size_t Choose(const std::vector<VibeTrack>& tracks, const std::vector<std::size_t>& rivals, const Vector2d& last,
                   TrackRule rule) {
  const auto distance = [&](std::size_t i) { return (BoxCentre(tracks[i], 0) - last).norm(); };
  const auto nearest = *std::min_element(rivals.begin(), rivals.end(),
                                         [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  if (rule == TrackRule::kUestcReleased || distance(nearest) > 0.5 * BoxSize(tracks[nearest], 0)) return nearest;
  std::size_t best = nearest;
  for (const std::size_t i : rivals) {
    const bool near = distance(i) <= 0.5 * BoxSize(tracks[i], 0);
    if (near && Begin(tracks[i]) < Begin(tracks[best])) best = i;
  }
  return best;
}

Quaternion QuaternionOf(const double* axis_angle, double sign) {
  const Vector3d vector = sign * Vector3d(axis_angle[0], axis_angle[1], axis_angle[2]);
  const double angle = vector.norm();
  const double factor = angle < 1e-6 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), factor * vector.x(), factor * vector.y(), factor * vector.z()};
}

Vector3d AxisAngleOf(const Quaternion& q) {
  const Vector3d vector = q.tail<3>();
  const double half = std::atan2(vector.norm(), q[0]);
  const double angle = 2.0 * half;
  const double factor = std::abs(angle) < 1e-6 ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  return vector / factor;
}

Vector3d Between(const double* from, const double* to, double share, bool root, TrackRule rule) {
  const Quaternion q0 = QuaternionOf(from, 1.0), q1 = QuaternionOf(to, 1.0);
  if (rule == TrackRule::kUestcCorrected) {
    const Quaterniond a(q0[0], q0[1], q0[2], q0[3]), b(q1[0], q1[1], q1[2], q1[3]);
    return LogQuaternion(Slerp(a, b, share));
  }
  const Quaternion inverse = QuaternionOf(to, -1.0);
  const Quaternion target = root && (q0 - inverse).norm() < (q0 - q1).norm() ? inverse : q1;
  const Quaternion mixed = (1.0 - share) * q0 + share * target;
  return AxisAngleOf(mixed.norm() > 0.0 ? Quaternion(mixed / mixed.norm()) : q0);
}

/// Row of every field `share` of the way from the last of `track` to row `row` of `piece`, at the end of `track`.
void AppendBetween(const VibeTrack& piece, std::size_t row, std::size_t last_row, double share, TrackRule rule,
                   VibeTrack& track) {
  for (const TrackField& field : TrackFields(piece)) {
    const std::vector<double>& to = piece.*(field.values);
    std::vector<double>& values = track.*(field.values);
    if (to.empty()) continue;
    std::vector<double> filled(field.columns);
    const double* a = values.data() + last_row * field.columns;
    const double* b = to.data() + row * field.columns;
    if (field.values == &VibeTrack::pose) {
      for (std::size_t j = 0; j < kPoseJoints; ++j) {
        const Vector3d turned = Between(a + 3 * j, b + 3 * j, share, j == 0, rule);
        std::copy(turned.data(), turned.data() + 3, filled.begin() + static_cast<std::ptrdiff_t>(3 * j));
      }
    } else {
      for (std::size_t i = 0; i < field.columns; ++i) filled[i] = (1.0 - share) * a[i] + share * b[i];
    }
    values.insert(values.end(), filled.begin(), filled.end());
  }
}

/// A row of a track behind those of the person, and the frames between them.
void AppendRow(const VibeTrack& piece, std::size_t row, TrackRule rule, UestcPerson& person) {
  VibeTrack& track = person.track;
  if (track.frames > 0) {
    const std::int64_t last = End(track), next = piece.frame_ids[row];
    const std::size_t last_row = track.frames - 1;
    for (std::int64_t frame = last + 1; frame < next; ++frame) {
      const double share = static_cast<double>(frame - last) / static_cast<double>(next - last);
      AppendBetween(piece, row, last_row, share, rule, track);
      track.frame_ids.push_back(frame);
      person.interpolated.push_back(1);
      ++track.frames;
    }
  }
  for (const TrackField& field : TrackFields(piece)) {
    const std::vector<double>& from = piece.*(field.values);
    if (from.empty()) continue;
    const auto at = from.begin() + static_cast<std::ptrdiff_t>(row * field.columns);
    std::vector<double>& values = track.*(field.values);
    values.insert(values.end(), at, at + static_cast<std::ptrdiff_t>(field.columns));
  }
  track.frame_ids.push_back(piece.frame_ids[row]);
  person.interpolated.push_back(0);
  ++track.frames;
}

void NoteFilled(TrackRule rule, UestcPerson& person) {
  const std::vector<char>& filled = person.interpolated;
  for (std::size_t f = 0; f < filled.size(); ++f) {
    if (filled[f] == 0) continue;
    const std::size_t begin = f;
    while (f < filled.size() && filled[f] != 0) ++f;
    Finding finding =
        FrameFinding("frames_filled", static_cast<int>(begin), static_cast<int>(f), "", static_cast<double>(f - begin),
                     std::to_string(f - begin) + " frames without the person are interpolated" +
                         (rule == TrackRule::kUestcReleased ? ", as released, however long the gap" : ""));
    finding.severity = Severity::kInfo;
    finding.action = FindingAction::kInterpolated;
    person.findings.push_back(std::move(finding));
  }
}

}  // namespace

Expected<UestcFolder> ReadUestcFolder(const std::filesystem::path& folder) {
  const Expected<std::string> names = ReadBeside(folder, "info/names.txt");
  if (!names) return Forward(names);
  Expected<std::vector<UestcVideo>> videos = ParseUestcNames(*names, "info/names.txt");
  if (!videos) return Forward(videos);
  const Expected<std::string> counts = ReadBeside(folder, kCounts);
  if (!counts) return Forward(counts);
  Expected<std::vector<int>> frames = ParseUestcFrameCounts(*counts, kCounts, videos->size());
  if (!frames) return Forward(frames);
  const Expected<std::string> words = ReadBeside(folder, "info/action_classes.txt");
  if (!words) return Forward(words);
  Expected<std::vector<std::string>> actions = ParseUestcActions(*words, "info/action_classes.txt");
  if (!actions) return Forward(actions);
  return UestcFolder{*std::move(videos), *std::move(frames), *std::move(actions)};
}

std::optional<Finding> CheckFrameCount(int declared, std::size_t frames, int entry) {
  if (declared <= 0 || static_cast<std::size_t>(declared) <= frames) return std::nullopt;
  return MakeFinding(
      "count_contradiction", Severity::kError, declared,
      std::string(kCounts) + ":" + std::to_string(entry + 1) + " declares " + std::to_string(declared) +
          " frames, VIBE's track of the video has " + std::to_string(frames) +
          ": those are used; correct the line, or copy info/ and the cache again if other lines differ too",
      FindingAction::kKept);
}

Expected<UestcPerson> SelectUestcTrack(const std::vector<VibeTrack>& tracks, const Vector2d& start, TrackRule rule) {
  if (Status ok = Check(tracks); !ok) return Forward(ok);
  UestcPerson person;
  person.track.joints = tracks.front().joints;
  person.track.id = tracks.front().id;
  std::vector<std::size_t> remaining(tracks.size());
  std::iota(remaining.begin(), remaining.end(), std::size_t{0});
  Vector2d last = start;
  while (!remaining.empty()) {
    const std::size_t first = *std::min_element(remaining.begin(), remaining.end(), [&](std::size_t a, std::size_t b) {
      return Begin(tracks[a]) < Begin(tracks[b]);
    });
    std::vector<std::size_t> rivals;
    for (const std::size_t i : remaining) {
      if (Begin(tracks[i]) <= End(tracks[first])) rivals.push_back(i);
    }
    const std::size_t taken = rivals.size() == 1 ? first : Choose(tracks, rivals, last, rule);
    const VibeTrack& track = tracks[taken];
    const double distance = (BoxCentre(track, 0) - last).norm();
    if (rule == TrackRule::kUestcCorrected && !person.chosen.empty()) {
      const double lost = static_cast<double>(Begin(track) - End(person.track));
      const double size = BoxSize(person.track, person.track.frames - 1);
      if (distance > size + kDriftPerFrame * lost) {
        person.findings.push_back(
            FrameFinding("other_person", static_cast<int>(Begin(track)), static_cast<int>(End(track)) + 1, "", distance,
                         "track " + std::to_string(track.id) + " begins " + Digits(distance) +
                             " pixels from where the person was, who is " + Digits(size) + " high: another person"));
        person.findings.back().action = FindingAction::kExcluded;
        remaining.erase(std::find(remaining.begin(), remaining.end(), taken));
        continue;
      }
    }
    for (std::size_t row = 0; row < track.frames; ++row) AppendRow(track, row, rule, person);
    person.chosen.push_back(track.id);
    last = BoxCentre(track, track.frames - 1);
    const std::int64_t end = End(track);
    remaining.erase(
        std::remove_if(remaining.begin(), remaining.end(), [&](std::size_t i) { return Begin(tracks[i]) <= end; }),
        remaining.end());
  }
  NoteFilled(rule, person);
  return person;
}

UestcPerson JoinVibeTracks(const std::vector<const VibeTrack*>& tracks) {
  constexpr TrackRule rule = TrackRule::kUestcCorrected;
  struct Row {
    const VibeTrack* track;
    std::size_t row;
  };
  std::vector<Row> rows;
  UestcPerson person;
  person.track.joints = tracks.front()->joints;
  person.track.id = tracks.front()->id;
  for (const VibeTrack* track : tracks) {
    person.chosen.push_back(track->id);
    for (std::size_t row = 0; row < track->frames; ++row) rows.push_back({track, row});
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.track->frame_ids[a.row] < b.track->frame_ids[b.row]; });
  for (const Row& row : rows) AppendRow(*row.track, row.row, rule, person);
  NoteFilled(rule, person);
  return person;
}

Expected<std::vector<Vector3d>> CameraPlaces(const std::vector<double>& original_camera) {
  if (original_camera.size() % 4 != 0) {
    return Fail(ErrorCode::kInconsistent, "a camera has four numbers (sx, sy, tx, ty)", "orig_cam");
  }
  std::vector<Vector3d> places;
  for (std::size_t f = 0; 4 * f < original_camera.size(); ++f) {
    const double scale = original_camera[4 * f];
    if (!(scale > 0.0)) {
      return Fail(ErrorCode::kInconsistent,
                  "the camera's scale is " + FormatDouble(scale) + " in frame " + std::to_string(f), "orig_cam",
                  "a weak-perspective camera has a positive scale: the detector lost the person");
    }
    places.emplace_back(original_camera[4 * f + 2], original_camera[4 * f + 3], 500.0 / (270.0 * scale));
  }
  return places;
}

Expected<std::vector<Vector3d>> UestcTranslation(const std::vector<double>& original_camera) {
  Expected<std::vector<Vector3d>> translation = CameraPlaces(original_camera);
  if (!translation) return translation;
  for (std::size_t f = translation->size(); f-- > 0;) (*translation)[f] -= (*translation)[0];
  return translation;
}

Matrix3d UestcWorldFromView(int view, int side) {
  if (side == 1) return Matrix3d::Identity();
  return ExpMatrix(Vector3d(0.0, -view * kPi / 4.0, 0.0));
}

}  // namespace mocurate
