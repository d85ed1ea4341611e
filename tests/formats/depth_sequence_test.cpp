#include "core/formats/depth_sequence.h"

#include <gtest/gtest.h>

#include "tests/formats/corruption.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

constexpr const char* kSequence = R"({"body": "male", "fps": 12, "frames": 2, "floor": "y = 0.75 m",
  "labels": [{"action": "idle", "first": 0, "last": 1}],
  "views": {"d1": {"R_p_to_d": [[0, -1, 0], [1, 0, 0], [0, 0, 1]], "t_m": [1, 2, 3],
                   "fx_fy_cx_cy": [360, 361, 250, 200], "size": [512, 424]}},
  "frames_data": [{"rotvec24": [[0, 0, 0], [0, 0, 1]], "translation_added": [0, 1, 0], "joints_m": [[1, 2, 3], [4, 5, 6]]},
                  {"rotvec24": [[0, 0, 0], [0, 0, 2]], "translation_added": [0, 1, 0], "joints_m": [[1, 2, 3], [4, 5, 6]]}]})";

/// Parses the sequence and its ground truth with one piece of the text replaced.
Status AlteredSequence(const std::string& from, const std::string& to) {
  const std::string text = Replaced(kSequence, from, to);
  const Status sequence = StatusOf(ParseDepthSequence(text, "s.json"));
  return sequence ? StatusOf(ParseDepthSequenceTruth(text, "s.json")) : sequence;
}

TEST(DepthSequence, ReadsCamerasLabelsAndGroundTruthSeparately) {
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

TEST(DepthSequence, RejectsBadInputWithItsKey) {
  ExpectMalformed(ParseDepthSequence("", "s.json"), "s.json");
  ExpectMalformed(ParseDepthSequence("{\"fps\": 12", "s.json"), "s.json:1:11");
  ExpectMalformed(ParseDepthSequence("[]", "s.json"), "s.json:");
  ExpectMalformed(AlteredSequence("\"fps\": 12", "\"fps\": 0"), "s.json:/fps");
  ExpectError(AlteredSequence("[0, -1, 0]", "[0, 1, 0]"), ErrorCode::kInconsistent, "s.json:/views/d1/R_p_to_d");
  ExpectMalformed(AlteredSequence("[1, 2, 3],", "[1, 2],"), "s.json:/views/d1/t_m");
  ExpectMalformed(AlteredSequence("\"last\": 1", "\"last\": 2"), "s.json:/labels/0/last");
  ExpectMalformed(AlteredSequence("[512, 424]", "[512, 0]"), "s.json:/views/d1");
  ExpectMalformed(AlteredSequence("[[0, 0, 0], [0, 0, 2]]", "[[0, 0, 0]]"), "s.json:/frames_data/1/rotvec24");
  ExpectError(AlteredSequence("\"frames\": 2", "\"frames\": 3"), ErrorCode::kInconsistent, "s.json:/frames_data");
  ExpectError(AlteredSequence("frames_data", "frames_dat"), ErrorCode::kNotFound, "s.json");
}

}  // namespace
}  // namespace mocurate
