#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/uestc_info.h"
#include "core/formats/vibe_pickle.h"
#include "core/geometry/rotation.h"
#include "ingest/options.h"

namespace mocurate {

/// The videos of a cache by UESTC's info/, in the cache's order.
struct UestcFolder {
  std::vector<UestcVideo> videos;
  std::vector<int> frames;           ///< (videos) maximum number of frames of the clip
  std::vector<std::string> actions;  ///< (40)
};

/// info/ of the folder with the cache. Errors of the formats ("info/names.txt:3"); kNotFound names the missing file.
Expected<UestcFolder> ReadUestcFolder(const std::filesystem::path& folder);

/// "count_contradiction" where more frames are declared than the track of video `entry` (from 0) has. Fewer are
/// correct: the set counts the frames that all its recordings of a video share.
std::optional<Finding> CheckFrameCount(int declared, std::size_t frames, int entry);

/// The performer of a video, one frame after the other.
struct UestcPerson {
  VibeTrack track;                   ///< frame_ids without gaps
  std::vector<std::int64_t> chosen;  ///< ids of the tracks, in order
  std::vector<char> interpolated;    ///< (F) 1: filled
  std::vector<Finding> findings;     ///< "frames_filled" (info), "other_person" (corrected: tracks passed over)
};

/// The performer of a UESTC video among VIBE's tracks, who stood at `start` (pixels) first.
///
/// TrackRule::kUestcReleased, as in ACTOR's preprocessing (Petrovich et al. 2021): while tracks remain, the one that
/// begins first, against all that begin before it ends; the nearest by its first box to where the person was last is
/// taken, and all that begin before it ends are gone. In gaps all numbers are weighted linearly, quaternions without
/// aligning their signs, and the root goes towards the *inverse* of the next rotation where that quaternion is nearer.
///
/// kUestcCorrected, the same with three faults corrected: of the rivals near enough to be the person the one that
/// begins first is taken, so that no frames are lost to a later detection; a track that is farther than a body's size
/// is another person, also when it has no rival; gaps are filled along the shortest arc.
///
/// `tracks` need frame_ids, boxes and pose. One track is taken as it is, only filled. Error kInconsistent: no track, or
/// a field of another length.
Expected<UestcPerson> SelectUestcTrack(const std::vector<VibeTrack>& tracks, const Vector2d& start, TrackRule rule);

/// Tracks of one person as one, row by row in order of their frames (which they must not share), gaps filled along
/// the shortest arc; findings "frames_filled". At least one track.
UestcPerson JoinVibeTracks(const std::vector<const VibeTrack*>& tracks);

/// Where a weak-perspective camera (F x 4: sx, sy, tx, ty) sees the person: (tx, ty, z) with z = 500 / (270 sx), as
/// below. Error kInconsistent: a scale that is not positive.
Expected<std::vector<Vector3d>> CameraPlaces(const std::vector<double>& original_camera);

/// Weak-perspective camera (F x 4: sx, sy, tx, ty) -> root translation (F), minus that of the first frame: (tx, ty, z)
/// with z = 500 / (270 sx): focal length 500, image 540 (the released ratio of heights of body and picture, in which
/// the body cancels). VIBE's units and axes. Error kInconsistent: a scale that is not positive.
Expected<std::vector<Vector3d>> UestcTranslation(const std::vector<double>& original_camera);

/// World from the camera of a video: views of side 2 stand at multiples of 45 degrees, side 1 is the front. Rotates
/// root rotations, joints and translations alike.
Matrix3d UestcWorldFromView(int view, int side);

}  // namespace mocurate
