#include "core/formats/vibe_pickle.h"

#include <utility>

#include "core/formats/array_fields.h"
#include "core/formats/pickle_writer.h"

namespace mocurate {
namespace {

/// A field of a track: its key, where it goes, and its width (0: joints x 3).
struct TrackField {
  const char* key;
  std::vector<double> VibeTrack::*values;
  std::size_t columns;
  bool needed;
};

constexpr std::size_t kPerJoint = 0;
constexpr TrackField kTrackFields[] = {{"pose", &VibeTrack::pose, 72, true},
                                       {"joints3d", &VibeTrack::joints3d, kPerJoint, true},
                                       {"betas", &VibeTrack::betas, 10, false},
                                       {"orig_cam", &VibeTrack::original_camera, 4, false},
                                       {"pred_cam", &VibeTrack::predicted_camera, 3, false},
                                       {"bboxes", &VibeTrack::boxes, 4, false}};

/// `item` is the array of one field; frames are set by the first one.
Status TakeTrackField(const TrackField& field, const PickleRef& item, const std::string& name, VibeTrack& track) {
  const Expected<NpyArray> array = item.Array();
  if (!array) return Forward(array);
  const std::string where = name + ":" + item.path();
  const std::size_t frames = track.frames == 0 ? kAnyExtent : track.frames;
  std::vector<std::size_t> wanted{frames, field.columns};
  if (field.columns == kPerJoint) wanted = {frames, kAnyExtent, 3};
  if (Status s = CheckField(*array, wanted, where); !s) return s;
  if (array->shape[0] == 0) return item.Bad("the track has no frames");
  track.frames = array->shape[0];
  if (field.columns == kPerJoint) track.joints = array->shape[1];
  if (field.columns == kPerJoint && track.joints == 0) return item.Bad("the track has no joints");
  track.*(field.values) = array->values;
  return {};
}

Status TakeFrameIds(const PickleRef& item, const std::string& name, VibeTrack& track) {
  const Expected<NpyArray> array = item.Array();
  if (!array) return Forward(array);
  const std::string where = name + ":" + item.path();
  if (Status s = CheckField(*array, {track.frames}, where); !s) return s;
  Expected<std::vector<std::int64_t>> ids = WholeNumbers(*array, 0, std::int64_t{1} << 40, where);
  if (!ids) return Forward(ids);
  for (std::size_t i = 1; i < ids->size(); ++i) {
    if ((*ids)[i] <= (*ids)[i - 1]) return item.Bad("frame ids do not rise at [" + std::to_string(i) + "]");
  }
  track.frame_ids = std::move(*ids);
  return {};
}

/// `find` returns the array of a key, or empty; None means absent in VIBE's files.
template <class Find>
Status TakeAll(const Find& find, const PickleRef& holder, const std::string& name, VibeTrack& track) {
  for (const TrackField& field : kTrackFields) {
    const std::optional<PickleRef> item = find(field.key);
    if (!item || item->kind() == PickleKind::kNone) {
      if (field.needed) return holder.Bad(std::string("the key '") + field.key + "' is missing");
      continue;
    }
    if (Status s = TakeTrackField(field, *item, name, track); !s) return s;
  }
  const std::optional<PickleRef> ids = find("frame_ids");
  if (!ids || ids->kind() == PickleKind::kNone) return {};
  return TakeFrameIds(*ids, name, track);
}

NpyArray ArrayOf(const VibeTrack& track, const TrackField& field) {
  std::vector<std::size_t> shape{track.frames, field.columns};
  if (field.columns == kPerJoint) shape = {track.frames, track.joints, 3};
  return MakeArray(std::move(shape), track.*(field.values));
}

NpyArray FrameIdsOf(const VibeTrack& track) {
  return MakeArray({track.frames}, {track.frame_ids.begin(), track.frame_ids.end()}, "<i8");
}

}  // namespace

Expected<std::vector<VibeTrack>> ParseVibeTracks(std::string_view bytes, const std::string& name) {
  const Expected<Pickle> pickle = ParsePickle(bytes, name);
  if (!pickle) return Forward(pickle);
  const PickleRef top = pickle->top();
  if (top.kind() != PickleKind::kDict) return top.Bad("a dictionary of tracks is expected");
  std::vector<VibeTrack> tracks;
  for (std::size_t i = 0; i < top.size(); ++i) {
    const PickleRef value = top.ValueAt(i);
    const Expected<std::int64_t> id = top.KeyAt(i).Integer();
    if (!id) return value.Bad("the key of a track is not an integer");
    for (const VibeTrack& other : tracks) {
      if (other.id == *id) return value.Bad("two tracks have this id");
    }
    if (value.kind() != PickleKind::kDict) return value.Bad("a track is not a dictionary");
    VibeTrack track;
    track.id = *id;
    if (Status s = TakeAll([&](const char* key) { return value.Find(key); }, value, name, track); !s) return Forward(s);
    tracks.push_back(std::move(track));
  }
  return tracks;
}

Expected<VibeCache> VibeCache::Open(std::string_view bytes, const std::string& name) {
  Expected<Pickle> pickle = ParsePickle(bytes, name);
  if (!pickle) return Forward(pickle);
  VibeCache cache;
  cache.pickle_ = std::move(*pickle);
  const PickleRef top = cache.pickle_.top();
  const Expected<PickleRef> poses = top.Key("pose");
  if (!poses) return Forward(poses);
  cache.size_ = poses->size();
  for (std::size_t i = 0; i < top.size(); ++i) {
    const PickleRef list = top.ValueAt(i);
    if (list.kind() != PickleKind::kList) return list.Bad("a list with one array per video is expected");
    if (list.size() != cache.size_) {
      return list.Bad(std::to_string(list.size()) + " videos, but " + std::to_string(cache.size_) + " under 'pose'");
    }
  }
  return cache;
}

Expected<VibeTrack> VibeCache::Track(std::size_t video) const {
  const PickleRef top = pickle_.top();
  VibeTrack track;
  track.id = static_cast<std::int64_t>(video);
  const auto find = [&](const char* key) -> std::optional<PickleRef> {
    const std::optional<PickleRef> list = top.Find(key);
    if (!list || video >= list->size()) return std::nullopt;
    return list->Item(video);
  };
  if (Status s = TakeAll(find, top, pickle_.name, track); !s) return Forward(s);
  return track;
}

Expected<std::string> EncodeVibeTracks(const std::vector<VibeTrack>& tracks, const std::string& name) {
  PickleWriter writer;
  writer.BeginDict();
  for (const VibeTrack& track : tracks) {
    writer.Integer(track.id);
    writer.BeginDict();
    for (const TrackField& field : kTrackFields) {
      if ((track.*(field.values)).empty()) continue;
      writer.Text(field.key);
      writer.Array(ArrayOf(track, field));
    }
    if (!track.frame_ids.empty()) {
      writer.Text("frame_ids");
      writer.Array(FrameIdsOf(track));
    }
    writer.End();
  }
  writer.End();
  return writer.Finish(name);
}

Expected<std::string> EncodeVibeCache(const std::vector<VibeTrack>& videos, const std::string& name) {
  PickleWriter writer;
  writer.BeginDict();
  const auto list = [&](const char* key, const auto& empty, const auto& array) {
    std::size_t absent = 0;
    for (const VibeTrack& video : videos) absent += empty(video) ? 1 : 0;
    if (absent == videos.size() && absent > 0) return;
    writer.Text(key);
    writer.BeginList();
    for (const VibeTrack& video : videos) {
      if (empty(video)) {
        writer.None();
      } else {
        writer.Array(array(video));
      }
    }
    writer.End();
  };
  for (const TrackField& field : kTrackFields) {
    list(
        field.key, [&](const VibeTrack& video) { return (video.*(field.values)).empty(); },
        [&](const VibeTrack& video) { return ArrayOf(video, field); });
  }
  list(
      "frame_ids", [](const VibeTrack& video) { return video.frame_ids.empty(); }, FrameIdsOf);
  writer.End();
  return writer.Finish(name);
}

}  // namespace mocurate
