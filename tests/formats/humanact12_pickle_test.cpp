#include "core/formats/humanact12_pickle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/formats/array_fields.h"
#include "core/formats/pickle_writer.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

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

TEST(HumanAct12Pickle, WrittenAndReadAgainIsTheSame) {
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

std::string HumanAct12Fails(const std::vector<NpyArray>& poses, const std::vector<NpyArray>& joints,
                            const std::vector<std::int64_t>& labels, const std::string& left_out = "") {
  PickleWriter writer;
  writer.BeginDict();
  const auto list = [&](const char* key, const std::vector<NpyArray>& arrays) {
    if (left_out == key) return;
    writer.Text(key);
    writer.BeginList();
    for (const NpyArray& array : arrays) writer.Array(array);
    writer.End();
  };
  list("poses", poses);
  list("joints3D", joints);
  if (left_out != "y") {
    writer.Text("y");
    writer.BeginList();
    for (const std::int64_t label : labels) writer.Integer(label);
    writer.End();
  }
  writer.End();
  const auto clips = ParseHumanAct12Pickle(writer.Finish("h.pkl").value(), "h.pkl");
  return clips ? "parsed" : clips.error().Message();
}

TEST(HumanAct12Pickle, AnyCorruptedFieldIsNamed) {
  const NpyArray poses = MakeArray({2, 72}, std::vector<double>(144, 0.1));
  const NpyArray joints = MakeArray({2, 24, 3}, std::vector<double>(144, 0.1));
  const NpyArray shorter = MakeArray({1, 24, 3}, std::vector<double>(72, 0.1));
  EXPECT_EQ(HumanAct12Fails({poses}, {joints}, {3}), "parsed");
  EXPECT_THAT(HumanAct12Fails({joints}, {joints}, {3}), HasSubstr("h.pkl:/poses/0: numbers of shape (2, 24, 3)"));
  EXPECT_THAT(HumanAct12Fails({poses, poses}, {joints, shorter}, {3, 3}),
              HasSubstr("h.pkl:/joints3D/1: numbers of shape"));
  EXPECT_THAT(HumanAct12Fails({poses}, {joints, joints}, {3}), HasSubstr("h.pkl:/joints3D: 2 clips, but 1"));
  EXPECT_THAT(HumanAct12Fails({poses}, {joints}, {3, 4}), HasSubstr("h.pkl:/y: 2 clips, but 1"));
  EXPECT_THAT(HumanAct12Fails({poses}, {joints}, {12}), HasSubstr("h.pkl:/y/0: class 12 is none of 0 to 11"));
  for (const char* key : {"poses", "joints3D", "y"}) {
    EXPECT_THAT(HumanAct12Fails({poses}, {joints}, {3}, key),
                HasSubstr(std::string("the key '") + key + "' is missing"));
  }
}

}  // namespace
}  // namespace mocurate
