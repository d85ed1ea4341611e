#include "core/formats/vibe_pickle.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/formats/array_fields.h"
#include "core/formats/pickle_writer.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

VibeTrack Track(std::int64_t id, std::size_t frames) {
  VibeTrack track;
  track.id = id;
  track.frames = frames;
  track.joints = 49;
  const auto fill = [&](std::size_t columns) {
    std::vector<double> values;
    for (std::size_t i = 0; i < frames * columns; ++i) values.push_back(0.01 * static_cast<double>(i + 1));
    return values;
  };
  track.pose = fill(72);
  track.joints3d = fill(49 * 3);
  track.betas = fill(10);
  track.original_camera = fill(4);
  track.predicted_camera = fill(3);
  track.boxes = fill(4);
  for (std::size_t f = 0; f < frames; ++f) track.frame_ids.push_back(static_cast<std::int64_t>(3 + 2 * f));
  return track;
}

void ExpectSame(const VibeTrack& a, const VibeTrack& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.joints, b.joints);
  EXPECT_EQ(a.pose, b.pose);
  EXPECT_EQ(a.joints3d, b.joints3d);
  EXPECT_EQ(a.betas, b.betas);
  EXPECT_EQ(a.original_camera, b.original_camera);
  EXPECT_EQ(a.predicted_camera, b.predicted_camera);
  EXPECT_EQ(a.boxes, b.boxes);
  EXPECT_EQ(a.frame_ids, b.frame_ids);
}

TEST(VibePickle, RoundTripsTracks) {
  std::vector<VibeTrack> tracks{Track(1, 3), Track(7, 2)};
  tracks[1].betas.clear();
  tracks[1].frame_ids.clear();
  const std::string bytes = EncodeVibeTracks(tracks, "v.pkl").value();
  const auto again = ParseVibeTracks(bytes, "v.pkl");
  ASSERT_TRUE(again) << again.error().Message();
  ASSERT_EQ(again->size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) ExpectSame((*again)[i], tracks[i]);
}

TEST(VibePickle, ReadsOneVideoOfACacheAtATime) {
  std::vector<VibeTrack> videos{Track(0, 3), Track(1, 2), Track(2, 4)};
  videos[1].betas.clear();
  for (VibeTrack& video : videos) video.predicted_camera.clear();
  const std::string bytes = EncodeVibeCache(videos, "c.pkl").value();
  const auto cache = VibeCache::Open(bytes, "c.pkl");
  ASSERT_TRUE(cache) << cache.error().Message();
  ASSERT_EQ(cache->size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto video = cache->Track(i);
    ASSERT_TRUE(video) << video.error().Message();
    ExpectSame(*video, videos[i]);
  }
}

/// One track with id 1, with one field changed.
Expected<std::vector<VibeTrack>> ReadWith(const std::string& changed, const std::function<void(PickleWriter&)>& write) {
  PickleWriter writer;
  writer.BeginDict();
  writer.Integer(1);
  writer.BeginDict();
  const std::pair<const char*, NpyArray> fields[] = {{"pose", MakeArray({2, 72}, std::vector<double>(144, 0.1))},
                                                     {"joints3d", MakeArray({2, 1, 3}, std::vector<double>(6, 0.1))},
                                                     {"betas", MakeArray({2, 10}, std::vector<double>(20, 0.1))},
                                                     {"orig_cam", MakeArray({2, 4}, std::vector<double>(8, 0.1))},
                                                     {"pred_cam", MakeArray({2, 3}, std::vector<double>(6, 0.1))},
                                                     {"bboxes", MakeArray({2, 4}, std::vector<double>(8, 0.1))},
                                                     {"frame_ids", MakeArray({2}, {4, 5}, "<i8")}};
  for (const auto& [key, array] : fields) {
    writer.Text(key);
    if (changed == key) {
      write(writer);
    } else {
      writer.Array(array);
    }
  }
  writer.Text("verts");
  writer.None();
  writer.End();
  writer.End();
  return ParseVibeTracks(writer.Finish("v.pkl").value(), "v.pkl");
}

Expected<std::vector<VibeTrack>> ReadWith(const std::string& changed, const NpyArray& array) {
  return ReadWith(changed, [&](PickleWriter& writer) { writer.Array(array); });
}

TEST(VibePickle, NamesEveryCorruptedField) {
  ASSERT_TRUE(ReadWith("", [](PickleWriter&) {}));
  for (const char* key : {"pose", "joints3d", "betas", "orig_cam", "pred_cam", "bboxes", "frame_ids"}) {
    const std::string where = std::string("v.pkl:/1/") + key;
    ExpectMalformed(ReadWith(key, MakeArray({2, 5}, std::vector<double>(10, 0))), where);
    ExpectMalformed(ReadWith(key, [](PickleWriter& w) { w.Text("x"); }), where);
  }
  std::vector<double> infinite(144, 0.0);
  infinite[75] = std::numeric_limits<double>::infinity();
  ExpectMalformed(ReadWith("pose", MakeArray({2, 72}, infinite)), "v.pkl:/1/pose");
  ExpectMalformed(ReadWith("betas", MakeArray({1, 10}, std::vector<double>(10, 0))), "v.pkl:/1/betas");
  ExpectMalformed(ReadWith("frame_ids", MakeArray({2}, {5, 5})), "v.pkl:/1/frame_ids");
  ExpectMalformed(ReadWith("pose", [](PickleWriter& w) { w.None(); }), "v.pkl:/1");
}

TEST(VibePickle, RejectsACacheWithATruncatedList) {
  PickleWriter writer;
  writer.BeginDict();
  writer.Text("pose");
  writer.BeginList();
  writer.Array(MakeArray({1, 72}, std::vector<double>(72, 0)));
  writer.End();
  writer.Text("joints3d");
  writer.BeginList();
  writer.End();
  writer.End();
  const std::string bytes = writer.Finish("c.pkl").value();
  ExpectMalformed(VibeCache::Open(bytes, "c.pkl"), "c.pkl:/joints3d");
}

}  // namespace
}  // namespace mocurate
