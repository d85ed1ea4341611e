#include "core/formats/depth_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mocurate {
namespace {

using ::testing::HasSubstr;

constexpr const char* kSequence = R"({"body": "male", "fps": 12, "frames": 2, "floor": "y = 0.75 m",
  "labels": [{"action": "idle", "first": 0, "last": 1}],
  "views": {"d1": {"R_p_to_d": [[0, -1, 0], [1, 0, 0], [0, 0, 1]], "t_m": [1, 2, 3],
                   "fx_fy_cx_cy": [360, 361, 250, 200], "size": [512, 424]}},
  "frames_data": [{"rotvec24": [[0, 0, 0], [0, 0, 1]], "translation_added": [0, 1, 0], "joints_m": [[1, 2, 3], [4, 5, 6]]},
                  {"rotvec24": [[0, 0, 0], [0, 0, 2]], "translation_added": [0, 1, 0], "joints_m": [[1, 2, 3], [4, 5, 6]]}]})";

std::string SequenceFails(const std::string& from, const std::string& to) {
  std::string text = kSequence;
  text.replace(text.find(from), from.size(), to);
  const auto sequence = ParseDepthSequence(text, "s.json");
  if (!sequence) return sequence.error().Message();
  const auto truth = ParseDepthSequenceTruth(text, "s.json");
  return truth ? "parsed" : truth.error().Message();
}

TEST(DepthSequence, CamerasLabelsAndTruthAreReadApart) {
  const auto sequence = ParseDepthSequence(kSequence, "s.json");
  ASSERT_TRUE(sequence) << sequence.error().Message();
  EXPECT_EQ(sequence->frames, 2);
  ASSERT_EQ(sequence->views.size(), 1u);
  const DepthSequenceView& view = sequence->views[0];
  EXPECT_EQ(view.name, "d1");
  EXPECT_TRUE((view.camera_from_rig * Vector3d(1, 0, 0)).isApprox(Vector3d(1, 3, 3), 1e-12));
  EXPECT_EQ(view.width, 512);
  EXPECT_EQ(sequence->labels[0].last, 1);
  const auto truth = ParseDepthSequenceTruth(kSequence, "s.json");
  ASSERT_TRUE(truth) << truth.error().Message();
  EXPECT_EQ(truth->joints, 2);
  EXPECT_EQ(truth->rotation_vector[3].z(), 2.0);
}

TEST(DepthSequence, BadInputIsRefusedWithTheKey) {
  EXPECT_EQ(ParseDepthSequence("", "s.json").error().Message(), "s.json: the file is empty");
  EXPECT_THAT(ParseDepthSequence("{\"fps\": 12", "s.json").error().Message(), HasSubstr("not valid JSON"));
  EXPECT_THAT(ParseDepthSequence("[]", "s.json").error().Message(), HasSubstr("the key 'fps' is missing"));
  EXPECT_THAT(SequenceFails("\"fps\": 12", "\"fps\": 0"),
              HasSubstr("s.json:/fps: the frame rate must be from 1e-6 to 1e6 Hz"));
  EXPECT_THAT(SequenceFails("[0, -1, 0]", "[0, 1, 0]"),
              HasSubstr("s.json:/views/d1/R_p_to_d: the matrix is no rotation"));
  EXPECT_THAT(SequenceFails("[1, 2, 3],", "[1, 2],"), HasSubstr("/views/d1/t_m: 3 numbers are expected"));
  EXPECT_THAT(SequenceFails("\"last\": 1", "\"last\": 2"), HasSubstr("/labels/0/last: a whole number from 0 to 1"));
  EXPECT_THAT(SequenceFails("[512, 424]", "[512, 0]"), HasSubstr("image size"));
  EXPECT_THAT(SequenceFails("[[0, 0, 0], [0, 0, 2]]", "[[0, 0, 0]]"),
              HasSubstr("/frames_data/1/rotvec24: 2 rows are expected"));
  EXPECT_THAT(SequenceFails("\"frames\": 2", "\"frames\": 3"), HasSubstr("frames_data does not hold the 3 frames"));
  EXPECT_THAT(SequenceFails("frames_data", "frames_dat"), HasSubstr("carries no truth"));
}

}  // namespace
}  // namespace mocurate
