#include <gmock/gmock.h>

#include <limits>

#include "tests/motion/builders.h"

namespace mocurate {
namespace {

using test::FullClip;
using ::testing::HasSubstr;

/// The error of a valid clip's evidence after `harm`; empty without one.
template <class Harm>
std::string ErrorAfter(const Harm& harm) {
  Evidence evidence = FullClip("openni16", 3).evidence;
  harm(evidence, evidence.keypoint_views[0]);
  const Status checked = CheckKeypoints(evidence);
  return checked ? "" : checked.error().Message();
}

TEST(CheckKeypoints, ValidAndEmptyEvidencePasses) {
  EXPECT_EQ(ErrorAfter([](Evidence&, KeypointView&) {}), "");
  EXPECT_TRUE(CheckKeypoints({}));
}

TEST(CheckKeypoints, NamesTheCameraAndThePlaceOfAnImpossibleValue) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ErrorAfter([&](Evidence&, KeypointView& v) { v.values[0] = nan, v.values[2] = 0.0; }), "")
      << "not detected";
  EXPECT_THAT(ErrorAfter([&](Evidence&, KeypointView& v) { v.values[3 * 8 + 1] = nan; }),
              HasSubstr("left: frame 1, person 0, right_knee"));
  EXPECT_THAT(ErrorAfter([](Evidence&, KeypointView& v) { v.values[5] = 1.5; }), HasSubstr("confidence 1.5"));
  EXPECT_THAT(ErrorAfter([](Evidence&, KeypointView& v) { v.values[5] = -0.5; }), HasSubstr("person 0, left_knee"));
  EXPECT_THAT(ErrorAfter([&](Evidence&, KeypointView& v) { v.values[5] = nan; }), HasSubstr("person 0, left_knee"));
}

TEST(CheckKeypoints, SizesTimesAndCamerasAreChecked) {
  EXPECT_THAT(ErrorAfter([](Evidence&, KeypointView& v) { v.values.pop_back(); }), HasSubstr("53 values"));
  EXPECT_THAT(ErrorAfter([](Evidence&, KeypointView& v) { v.people = 3; }), HasSubstr("3 people"));
  EXPECT_THAT(ErrorAfter([](Evidence&, KeypointView& v) { v.people = -1; }), HasSubstr("-1 people"));
  EXPECT_THAT(ErrorAfter([](Evidence&, KeypointView& v) { v.time_s[2] = v.time_s[1]; }), HasSubstr("of frame 2"));
  EXPECT_THAT(ErrorAfter([](Evidence&, KeypointView& v) { v.camera.fx = 0.0; }), HasSubstr("focal length"));
  EXPECT_THAT(ErrorAfter([](Evidence&, KeypointView& v) { v.camera.camera_from_world.rotation.coeffs() *= 1.1; }),
              HasSubstr("pose"));
  EXPECT_THAT(ErrorAfter([](Evidence&, KeypointView& v) { v.camera.name.clear(); }), HasSubstr("empty"));
  EXPECT_THAT(ErrorAfter([](Evidence& e, KeypointView& v) { e.keypoint_views.push_back(KeypointView(v)); }),
              HasSubstr("'left' is empty or appears twice"));
}

TEST(CheckKeypoints, NamesAndSubjectAreChecked) {
  EXPECT_THAT(ErrorAfter([](Evidence& e, KeypointView&) { e.keypoint_names[2] = "nose"; }), HasSubstr("'nose'"));
  EXPECT_THAT(ErrorAfter([](Evidence& e, KeypointView&) { e.keypoint_names.clear(); }), HasSubstr("no names"));
  EXPECT_THAT(ErrorAfter([](Evidence& e, KeypointView&) { e.subject = -1; }), HasSubstr("subject -1"));
  EXPECT_THAT(ErrorAfter([](Evidence& e, KeypointView&) { e.keypoint_views.clear(); }), HasSubstr("without views"));
}

}  // namespace
}  // namespace mocurate
