#include "core/formats/amass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>

#include "core/base/file.h"
#include "core/formats/array_fields.h"
#include "core/formats/npz.h"
#include "tests/formats/expect_error.h"
#include "tests/support/amass_writer.h"

namespace mocurate {
namespace {

Amass SmallAmass(Amass::Layout layout, std::size_t columns) {
  Amass amass;
  amass.layout = layout;
  amass.rate_hz = 120.00004577636719;
  amass.gender = "female";
  amass.frames = 2;
  amass.pose_columns = columns;
  for (std::size_t i = 0; i < 2 * columns; ++i) amass.poses.push_back(0.001 * static_cast<double>(i));
  amass.translation_m = {0, 0.1, 0.9, 0, 0.2, 0.95};
  amass.betas = {0.5, -1};
  if (layout == Amass::Layout::kLegacy) {
    amass.markers = 2;
  } else {
    amass.surface_model = "smplx";
  }
  return amass;
}

NpyArray& At(Npz& npz, const std::string& name) {
  for (NpzMember& member : npz.members) {
    if (member.name == name) return member.array;
  }
  throw std::logic_error("no member " + name);
}

Expected<Amass> AmassOf(const Npz& npz) { return ParseAmass(EncodeNpz(npz, "m.npz").value(), "m.npz"); }

TEST(Amass, RoundTripsBothLayouts) {
  for (const auto& [layout, columns] : {std::pair{Amass::Layout::kLegacy, 156}, std::pair{Amass::Layout::kSplit, 156},
                                        std::pair{Amass::Layout::kSplit, 165}}) {
    const Amass amass = SmallAmass(layout, static_cast<std::size_t>(columns));
    const auto again = AmassOf(AmassWithMarkers(amass));
    ASSERT_TRUE(again) << again.error().Message();
    EXPECT_EQ(again->layout, amass.layout);
    EXPECT_EQ(again->rate_hz, amass.rate_hz);
    EXPECT_EQ(again->gender, amass.gender);
    EXPECT_EQ(again->surface_model, amass.surface_model);
    EXPECT_EQ(again->frames, 2u);
    EXPECT_EQ(again->poses, amass.poses);
    EXPECT_EQ(again->translation_m, amass.translation_m);
    EXPECT_EQ(again->betas, amass.betas);
    EXPECT_EQ(again->markers, amass.markers);
  }
}

TEST(Amass, ReadsTheSamePosesFromTheSplitKeys) {
  const Amass amass = SmallAmass(Amass::Layout::kSplit, 165);
  Npz npz = AmassWithMarkers(amass);
  npz.members.erase(npz.members.begin());  // poses
  const auto again = AmassOf(npz);
  ASSERT_TRUE(again) << again.error().Message();
  EXPECT_EQ(again->poses, amass.poses);
}

TEST(Amass, ReadsGenderAsBytesTextOrPrintedBytes) {
  for (const auto& [dtype, text] :
       {std::pair{"|S6", "male"}, std::pair{"<U4", "male"}, std::pair{"<U7", "b'male'"}, std::pair{"<U4", "Male"}}) {
    Npz npz = AmassWithMarkers(SmallAmass(Amass::Layout::kLegacy, 156));
    At(npz, "gender").dtype = dtype;
    At(npz, "gender").texts = {text};
    const auto amass = AmassOf(npz);
    ASSERT_TRUE(amass) << amass.error().Message();
    EXPECT_EQ(amass->gender, "male");
  }
}

TEST(Amass, ReportsMissingPosesWhenTheirKeyHasAnotherName) {
  Npz npz = AmassWithMarkers(SmallAmass(Amass::Layout::kLegacy, 156));
  for (NpzMember& member : npz.members) {
    if (member.name == "poses") member.name = "pose";
  }
  ExpectMalformed(AmassOf(npz), "m.npz:poses");
}

TEST(Amass, NamesTheArrayWhoseLengthDiffersFromTheOthers) {
  for (const char* key : {"poses", "trans"}) {
    Npz npz = AmassWithMarkers(SmallAmass(Amass::Layout::kLegacy, 156));
    NpyArray& array = At(npz, key);
    array.values.resize(array.values.size() / 2);
    array.shape[0] = 1;
    ExpectError(AmassOf(npz), ErrorCode::kInconsistent, std::string("m.npz:") + key);
  }
}

TEST(Amass, RejectsPosesOfAnotherShape) {
  Npz npz = AmassWithMarkers(SmallAmass(Amass::Layout::kLegacy, 156));
  for (const std::vector<std::size_t>& shape : {std::vector<std::size_t>{156, 2}, {2, 52, 3}}) {
    At(npz, "poses").shape = shape;
    ExpectError(AmassOf(npz), ErrorCode::kInconsistent, "m.npz:poses");
  }
}

TEST(Amass, ReadsBetasWithAnAxisOfOnePerson) {
  Npz npz = AmassWithMarkers(SmallAmass(Amass::Layout::kLegacy, 156));
  At(npz, "betas").shape = {1, 2};
  const auto amass = AmassOf(npz);
  ASSERT_TRUE(amass) << amass.error().Message();
  EXPECT_EQ(amass->betas, SmallAmass(Amass::Layout::kLegacy, 156).betas);
}

TEST(Amass, NamesEveryCorruptedField) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* key;
    std::function<void(NpyArray&)> corrupt;
    ErrorCode code = ErrorCode::kMalformed;
  };
  constexpr ErrorCode kDisagrees = ErrorCode::kInconsistent;
  const auto cut = [](NpyArray& array) {
    array.values.resize(array.values.size() / array.shape[0]);
    array.shape[0] = 1;
  };
  const Case legacy[] = {{"poses", [&](NpyArray& a) { a.values[157] = nan; }},
                         {"poses",
                          [&](NpyArray& a) {
                            a = MakeArray({2, 100}, std::vector<double>(200, 0.0));
                          }},
                         {"trans", cut, kDisagrees},
                         {"trans", [&](NpyArray& a) { a.values[4] = nan; }},
                         {"betas", [&](NpyArray& a) { a.values[1] = nan; }},
                         {"betas",
                          [&](NpyArray& a) {
                            a.shape = {2, 1};
                          }},
                         {"mocap_framerate", [](NpyArray& a) { a.values[0] = 0; }},
                         {"mocap_framerate", [&](NpyArray& a) { a.values[0] = nan; }},
                         {"mocap_framerate",
                          [](NpyArray& a) {
                            a = MakeArray({2}, {120, 120});
                          }},
                         {"gender", [](NpyArray& a) { a = MakeTextArray("mole"); }},
                         {"gender", [](NpyArray& a) { a = MakeArray({}, {1}); }},
                         {"dmpls", cut, kDisagrees},
                         {"marker_data", cut, kDisagrees}};
  for (const Case& c : legacy) {
    Npz npz = AmassWithMarkers(SmallAmass(Amass::Layout::kLegacy, 156));
    c.corrupt(At(npz, c.key));
    ExpectError(AmassOf(npz), c.code, std::string("m.npz:") + c.key);
  }
  const Case split[] = {{"root_orient", cut, kDisagrees},
                        {"pose_body", [](NpyArray& a) { a.values[7] += 0.1; }, kDisagrees},
                        {"pose_jaw", [&](NpyArray& a) { a.values[1] = nan; }},
                        {"pose_eye", cut, kDisagrees},
                        {"pose_hand", cut, kDisagrees},
                        {"mocap_frame_rate", [](NpyArray& a) { a.values[0] = -30; }}};
  for (const Case& c : split) {
    Npz npz = AmassWithMarkers(SmallAmass(Amass::Layout::kSplit, 165));
    c.corrupt(At(npz, c.key));
    ExpectError(AmassOf(npz), c.code, std::string("m.npz:") + c.key);
  }
  for (const char* key : {"trans", "betas", "mocap_framerate"}) {
    Npz npz = AmassWithMarkers(SmallAmass(Amass::Layout::kLegacy, 156));
    for (NpzMember& member : npz.members) member.name = member.name == key ? "other" : member.name;
    ExpectMalformed(AmassOf(npz), std::string("m.npz:") + key);
  }
}

TEST(Amass, RejectsRatesThatContradictEachOtherOrTheLength) {
  Npz npz = AmassWithMarkers(SmallAmass(Amass::Layout::kLegacy, 156));
  npz.members.push_back({"mocap_frame_rate", MakeArray({}, {60}), ""});
  ExpectError(AmassOf(npz), ErrorCode::kInconsistent, "m.npz:mocap_frame_rate");
  npz = AmassWithMarkers(SmallAmass(Amass::Layout::kSplit, 165));
  npz.members.push_back({"mocap_time_length", MakeArray({}, {10}), ""});
  ExpectError(AmassOf(npz), ErrorCode::kInconsistent, "m.npz:mocap_time_length");
}

TEST(Amass, RejectsAShapeFileAsMotion) {
  Npz npz;
  npz.members.push_back({"betas", MakeArray({2}, {1, 2}), ""});
  npz.members.push_back({"gender", MakeTextArray("male"), ""});
  ExpectError(AmassOf(npz), ErrorCode::kUnsupported, "m.npz");
}

TEST(Amass, ReadsThePublishedSample) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto bytes = ReadFile(std::filesystem::path(data) / "amass_babel/amass_sample.npz");
  ASSERT_TRUE(bytes) << bytes.error().Message();
  const auto amass = ParseAmass(*bytes, "amass_sample.npz");
  ASSERT_TRUE(amass) << amass.error().Message();
  EXPECT_EQ(amass->frames, 601u);
  EXPECT_EQ(amass->pose_columns, 156u);
  EXPECT_EQ(amass->rate_hz, 120.0);
  EXPECT_EQ(amass->gender, "male");
  EXPECT_EQ(amass->betas.size(), 16u);
  EXPECT_EQ(amass->markers, 85u);
  const auto again = AmassOf(AmassWithMarkers(*amass));
  ASSERT_TRUE(again) << again.error().Message();
  EXPECT_EQ(again->poses, amass->poses);
}

}  // namespace
}  // namespace mocurate
