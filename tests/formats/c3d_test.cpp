#include "core/formats/c3d.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "core/base/file.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

/// Some points that are seen and some that are not, labels beyond 255, and a list of angles.
C3dFile MadeFile(C3dProcessor processor, bool floats, int points = 300, int frames = 7) {
  C3dFile c3d;
  c3d.processor = processor;
  c3d.floats = floats;
  c3d.scale = 0.1;
  c3d.first_frame = 725;
  c3d.frames = frames;
  c3d.rate_hz = 100.0;
  c3d.units = "mm";
  c3d.x_screen = "+Y";
  c3d.y_screen = "+Z";
  c3d.subjects = {"Anna"};
  for (int p = 0; p < points; ++p) c3d.points.push_back({"P" + std::to_string(p), "point", p == 2 ? "ANGLES" : ""});
  for (int i = 0; i < points * frames; ++i) {
    const bool seen = i % 5 != 3;
    for (int k = 0; k < 3; ++k) c3d.values.push_back(seen ? 1000.0 * std::sin(0.1 * i + k) : 0.0);
    c3d.residual.push_back(seen ? static_cast<float>(i % 7) * 0.1F : -1.0F);
  }
  return c3d;
}

double LargestDifference(const C3dFile& a, const C3dFile& b) {
  double most = a.values.size() == b.values.size() ? 0.0 : 1e300;
  for (std::size_t i = 0; i < a.values.size() && most < 1e300; ++i) {
    const bool both = a.residual[i / 3] >= 0.0F && b.residual[i / 3] >= 0.0F;
    if ((a.residual[i / 3] >= 0.0F) != (b.residual[i / 3] >= 0.0F)) return 1e300;
    if (both) most = std::max(most, std::abs(a.values[i] - b.values[i]));
  }
  return most;
}

class C3dForms : public ::testing::TestWithParam<std::pair<C3dProcessor, bool>> {};

TEST_P(C3dForms, ComeBackAsTheyWereWritten) {
  const auto [processor, floats] = GetParam();
  const C3dFile made = MadeFile(processor, floats);
  const auto bytes = WriteC3d(made, "a.c3d");
  ASSERT_TRUE(bytes) << bytes.error().Message();
  EXPECT_EQ(bytes->size() % 512, 0u);
  const auto read = ParseC3d(*bytes, "a.c3d");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_EQ(read->processor, processor);
  EXPECT_EQ(read->floats, floats);
  EXPECT_EQ(read->first_frame, 725);
  EXPECT_EQ(read->frames, 7);
  EXPECT_DOUBLE_EQ(read->rate_hz, 100.0);
  EXPECT_EQ(read->units + read->x_screen + read->y_screen, "mm+Y+Z");
  EXPECT_THAT(read->subjects, ElementsAre("Anna"));
  ASSERT_THAT(read->points, SizeIs(300));
  EXPECT_EQ(read->points[299].label, "P299") << "of LABELS2";
  EXPECT_EQ(read->points[2].quantity, "ANGLES");
  EXPECT_EQ(read->points[3].quantity, "");
  EXPECT_LE(LargestDifference(*read, made), floats ? 1e-4 : 0.51 * 1000.0 / 32000.0);
  EXPECT_TRUE(read->findings.empty());
  if (floats) {
    EXPECT_NEAR(read->residual[6], 0.6, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(AllSix, C3dForms,
                         ::testing::Values(std::pair(C3dProcessor::kIntel, true),
                                           std::pair(C3dProcessor::kIntel, false), std::pair(C3dProcessor::kDec, true),
                                           std::pair(C3dProcessor::kDec, false), std::pair(C3dProcessor::kSgi, true),
                                           std::pair(C3dProcessor::kSgi, false)));

TEST(C3d, MoreThan65535FramesComeBack) {
  const C3dFile made = MadeFile(C3dProcessor::kIntel, false, 1, 70000);
  const auto read = ParseC3d(*WriteC3d(made, "long.c3d"), "long.c3d");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_EQ(read->frames, 70000);
  EXPECT_TRUE(read->findings.empty());
}

/// A small file of one point in three frames, to be damaged.
std::string SmallFile() { return *WriteC3d(MadeFile(C3dProcessor::kIntel, true, 1, 3), "a.c3d"); }
/// The first byte of the value of a parameter of numbers without extents.
std::size_t ValueOf(const std::string& bytes, const std::string& name) {
  return bytes.find(name, 512) + name.size() + 4;
}

TEST(C3d, WhatContradictsIsRefusedAndNamed) {
  const std::string sound = SmallFile();
  const auto with = [&sound](std::size_t at, int byte) {
    std::string bytes = sound;
    bytes[at] = static_cast<char>(byte);
    return ParseC3d(bytes, "a.c3d");
  };
  ExpectMalformed(with(1, 0), "a.c3d: header");
  ExpectMalformed(with(0, 0), "a.c3d: header");
  ExpectMalformed(with(0, 200), "a.c3d: header");
  ExpectError(with(515, 87), ErrorCode::kUnsupported, "a.c3d: parameters");
  ExpectError(with(2, 2), ErrorCode::kInconsistent, "a.c3d: POINT:USED");
  ExpectError(with(15, 0x3f), ErrorCode::kInconsistent, "a.c3d: POINT:SCALE");  // the sign
  ExpectError(with(16, 9), ErrorCode::kInconsistent, "a.c3d: POINT:DATA_START");
  ExpectMalformed(with(ValueOf(sound, "USED") - 1, 60), "a.c3d: USED");  // extents that reach out of the file
  ExpectMalformed(ParseC3d(sound.substr(0, 700), "a.c3d"), "a.c3d: header");
}

TEST(C3d, TheSamplesDecideBetweenNumbersOfFrames) {
  std::string bytes = SmallFile();
  bytes[8] = static_cast<char>(0xd6);  // last frame: 726 of the header, 727 elsewhere
  const auto read = ParseC3d(bytes, "a.c3d");
  ExpectError(read, ErrorCode::kInconsistent, "a.c3d: POINT:FRAMES");  // both fit the last block
  std::string large = *WriteC3d(MadeFile(C3dProcessor::kIntel, true, 40, 9), "a.c3d");
  large[8] = static_cast<char>(0xdc);  // one less than elsewhere
  const auto decided = ParseC3d(large, "a.c3d");
  ASSERT_TRUE(decided) << decided.error().Message();
  EXPECT_EQ(decided->frames, 9);
  ASSERT_THAT(decided->findings, SizeIs(1));
  EXPECT_EQ(decided->findings[0].code, "count_contradiction");
}

TEST(C3d, AFileThatIsCutOffKeepsItsWholeFramesWhereThatIsAskedFor) {
  const std::string whole = *WriteC3d(MadeFile(C3dProcessor::kDec, true, 100, 9), "a.c3d");
  const std::string cut = whole.substr(0, whole.size() - 2000);
  ExpectError(ParseC3d(cut, "a.c3d"), ErrorCode::kInconsistent, "a.c3d");
  const auto read = ParseC3d(cut, "a.c3d", DamagedRows::kReport);
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_EQ(read->frames, 8);
  ASSERT_THAT(read->findings, SizeIs(1));
  EXPECT_EQ(read->findings[0].code, "cut_off");
}

TEST(C3d, ParametersMayStandBehindTheSamples) {
  const C3dFile made = MadeFile(C3dProcessor::kSgi, true, 5, 40);
  std::string bytes = *WriteC3d(made, "a.c3d");
  const std::size_t samples = (static_cast<std::size_t>(static_cast<unsigned char>(bytes[17])) - 1) * 512;
  const std::string parameters = bytes.substr(512, samples - 512);
  std::fill(bytes.begin() + 512, bytes.begin() + static_cast<std::ptrdiff_t>(samples), '\x7f');
  bytes[0] = static_cast<char>(bytes.size() / 512 + 1);
  const auto read = ParseC3d(bytes + parameters, "a.c3d");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_LE(LargestDifference(*read, made), 1e-4);
  EXPECT_EQ(read->points[4].label, "P4");
}

TEST(C3d, RotationsAloneSaySo) {
  std::string bytes = SmallFile();
  bytes[2] = 0;
  bytes[ValueOf(bytes, "USED")] = 0;
  ExpectError(ParseC3d(bytes, "a.c3d"), ErrorCode::kUnsupported, "a.c3d");
}

Expected<C3dFile> Recorded(const char* name) {
  const std::filesystem::path folder = std::filesystem::path(std::getenv("MOCURATE_DATA")) / "c3d_trc";
  const auto bytes = ReadFile(folder / name);
  if (!bytes) return Forward(bytes);
  return ParseC3d(*bytes, name);
}

long long Unseen(const C3dFile& c3d) {
  return std::count_if(c3d.residual.begin(), c3d.residual.end(), [](float r) { return r < 0.0F; });
}

TEST(RecordedC3d, FourEncodingsOfATakeAgreeAndThoseWrittenHereToo) {
  if (std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto first = Recorded("Eb015pi.c3d");
  ASSERT_TRUE(first) << first.error().Message();
  EXPECT_THAT(first->points, SizeIs(26));
  EXPECT_EQ(first->frames, 450);
  EXPECT_EQ(Unseen(*first), 226);
  EXPECT_NEAR(first->at(0, 0)[0], 248.583, 1e-3);
  EXPECT_NEAR(first->at(0, 0)[1], 226.833, 1e-3);
  EXPECT_NEAR(first->at(0, 0)[2], 37.417, 1e-3);
  for (const char* name : {"Eb015pr.c3d", "Eb015si.c3d", "Eb015vi.c3d"}) {
    const auto other = Recorded(name);
    ASSERT_TRUE(other) << other.error().Message();
    EXPECT_LE(LargestDifference(*first, *other), std::strcmp(name, "Eb015pr.c3d") == 0 ? 1.2e-4 : 0.0) << name;
    EXPECT_THAT(other->residual, ::testing::Pointwise(::testing::FloatNear(1e-3F), first->residual)) << name;
  }
  for (const auto& processor : {C3dProcessor::kSgi, C3dProcessor::kDec}) {
    C3dFile floats = *first;
    floats.floats = true;
    floats.processor = processor;
    const auto again = ParseC3d(*WriteC3d(floats, "again"), "again");
    ASSERT_TRUE(again) << again.error().Message();
    EXPECT_LE(LargestDifference(*first, *again), 2e-4);
    EXPECT_THAT(again->residual, ::testing::Pointwise(::testing::FloatNear(1e-3F), first->residual));
  }
}

TEST(RecordedC3d, ProgramsFilesAreReadAsTheyAre) {
  if (std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  struct Row {
    const char* name;
    std::size_t points;
    int first, frames;
    double hz;
    long long unseen;
  };
  for (const Row& row :
       {Row{"PiG_Motion3_FF.c3d", 97, 725, 293, 100.0, 4429}, Row{"mocap36.c3d", 36, 1, 1380, 100.0, 8244},
        Row{"Gait.c3d", 33, 1, 487, 100.0, -1}, Row{"pose2sim_coco.c3d", 27, 1, 137, 120.0, -1}}) {
    const auto read = Recorded(row.name);
    ASSERT_TRUE(read) << read.error().Message();
    EXPECT_EQ(read->points.size(), row.points) << row.name;
    EXPECT_EQ(read->first_frame, row.first) << row.name;
    EXPECT_EQ(read->frames, row.frames) << row.name;
    EXPECT_DOUBLE_EQ(read->rate_hz, row.hz) << row.name;
    EXPECT_EQ(read->units, "mm") << row.name;
    if (row.unseen >= 0) {
      EXPECT_EQ(Unseen(*read), row.unseen) << row.name;
    }
  }
  const auto vicon = Recorded("PiG_Motion3_FF.c3d");
  EXPECT_EQ(
      std::count_if(vicon->points.begin(), vicon->points.end(), [](const C3dPoint& p) { return p.quantity == ""; }), 61)
      << "97 points less 12 angles, 10 forces, 8 moments and 6 powers";
}

}  // namespace
}  // namespace mocurate
