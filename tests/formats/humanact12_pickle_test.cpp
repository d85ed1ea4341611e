#include "core/formats/humanact12_pickle.h"

#include <gtest/gtest.h>

#include "core/formats/array_fields.h"
#include "core/formats/pickle_writer.h"
#include "tests/formats/expect_error.h"
#include "tests/support/humanact12_clips.h"

namespace mocurate {
namespace {

HumanAct12Clip ClipOfLabel(std::size_t frames, int label) {
  HumanAct12Clip clip;
  clip.frames = frames;
  clip.label = label;
  for (std::size_t i = 0; i < frames * 72; ++i) {
    clip.poses.push_back(0.01 * static_cast<double>(i));
    clip.joints.push_back(-0.02 * static_cast<double>(i));
  }
  return clip;
}

TEST(HumanAct12Pickle, RoundTripsThroughTheWriter) {
  const std::vector<HumanAct12Clip> clips{ClipOfLabel(3, 0), ClipOfLabel(8, 11)};
  const auto again = ParseHumanAct12Pickle(EncodeHumanAct12Pickle(clips, "h.pkl").value(), "h.pkl");
  ASSERT_TRUE(again) << again.error().Message();
  ASSERT_EQ(again->size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*again)[i].frames, clips[i].frames);
    EXPECT_EQ((*again)[i].poses, clips[i].poses);
    EXPECT_EQ((*again)[i].joints, clips[i].joints);
    EXPECT_EQ((*again)[i].label, clips[i].label);
  }
}

Expected<std::vector<HumanAct12Clip>> ClipsOf(const std::vector<NpyArray>& poses, const std::vector<NpyArray>& joints,
                                              const std::vector<std::int64_t>& labels,
                                              const std::string& excluded = "") {
  PickleWriter writer;
  writer.BeginDict();
  const auto list = [&](const char* key, const std::vector<NpyArray>& arrays) {
    if (excluded == key) return;
    writer.Text(key);
    writer.BeginList();
    for (const NpyArray& array : arrays) writer.Array(array);
    writer.End();
  };
  list("poses", poses);
  list("joints3D", joints);
  if (excluded != "y") {
    writer.Text("y");
    writer.BeginList();
    for (const std::int64_t label : labels) writer.Integer(label);
    writer.End();
  }
  writer.End();
  return ParseHumanAct12Pickle(writer.Finish("h.pkl").value(), "h.pkl");
}

TEST(HumanAct12Pickle, NamesEveryCorruptedField) {
  const NpyArray poses = MakeArray({2, 72}, std::vector<double>(144, 0.1));
  const NpyArray joints = MakeArray({2, 24, 3}, std::vector<double>(144, 0.1));
  const NpyArray shorter = MakeArray({1, 24, 3}, std::vector<double>(72, 0.1));
  EXPECT_TRUE(ClipsOf({poses}, {joints}, {3}));
  ExpectMalformed(ClipsOf({joints}, {joints}, {3}), "h.pkl:/poses/0");
  ExpectMalformed(ClipsOf({poses, poses}, {joints, shorter}, {3, 3}), "h.pkl:/joints3D/1");
  ExpectMalformed(ClipsOf({poses}, {joints, joints}, {3}), "h.pkl:/joints3D");
  ExpectMalformed(ClipsOf({poses}, {joints}, {3, 4}), "h.pkl:/y");
  ExpectMalformed(ClipsOf({poses}, {joints}, {12}), "h.pkl:/y/0");
  for (const char* key : {"poses", "joints3D", "y"}) {
    ExpectMalformed(ClipsOf({poses}, {joints}, {3}, key), "h.pkl:/");
  }
}

}  // namespace
}  // namespace mocurate
