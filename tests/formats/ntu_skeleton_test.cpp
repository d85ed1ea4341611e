#include "core/formats/ntu_skeleton.h"

#include <gtest/gtest.h>

#include <set>

#include "core/base/text.h"
#include "tests/formats/corruption.h"
#include "tests/formats/expect_error.h"
#include "tests/support/ntu_equal.h"

namespace mocurate {
namespace {

constexpr std::uint64_t kFirst = 72057594037931648u;  // kFirst + 1 is not representable as a double

NtuBody Body(std::uint64_t id, double x) {
  NtuBody body;
  body.id = id;
  for (std::size_t j = 0; j < body.joints.size(); ++j) {
    const bool leaf = j == 3 || j == 15 || j == 19 || j > 20;
    body.joints[j] = {x + 0.01 * static_cast<double>(j), 0.5, 3.1, 270, 190, 1030, 510, leaf ? 0.0 : 1.0, 0, 0, 0, 2};
  }
  body.joints[5].tracking = 1;
  return body;
}

/// Three frames: one person, no person, then two people in reverse order.
NtuSkeleton Scene() {
  NtuSkeleton scene;
  scene.frames = {{Body(kFirst, 0.1)}, {}, {Body(kFirst + 1, -0.4), Body(kFirst, 0.2)}};
  return scene;
}

std::string WithoutLine(const std::string& text, int line) {
  std::string shorter;
  int number = 0;
  for (const std::string_view each : SplitText(text, '\n')) {
    if (++number != line && !each.empty()) shorter += std::string(each) + "\n";
  }
  return shorter;
}

TEST(NtuSkeletonText, ReadsPeopleWhoComeAndGoWithAllBitsOfTheirIds) {
  const auto scene = ParseNtuSkeleton(WriteNtuSkeleton(Scene()), "a.skeleton");
  ASSERT_TRUE(scene) << scene.error().Message();
  EXPECT_TRUE(*scene == Scene());
  EXPECT_TRUE(scene->frames[1].empty());
  EXPECT_EQ(scene->frames[2][0].id, kFirst + 1);
}

TEST(NtuSkeletonText, IgnoresCarriageReturnsAndReadsAnEmptyTake) {
  std::string text;
  for (const char c : WriteNtuSkeleton(Scene())) text += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_TRUE(ParseNtuSkeleton(text, "a.skeleton").value() == Scene());
  EXPECT_TRUE(ParseNtuSkeleton("0\r\n", "a.skeleton").value().frames.empty());
}

TEST(NtuSkeletonText, RejectsEmptyFramesThatTakeMoreMemoryThanTheFileMay) {
  const auto of = [](int frames) {
    std::string text = std::to_string(frames) + "\n";
    for (int f = 0; f < frames; ++f) text += "0\n";
    return ParseNtuSkeleton(text, "a.skeleton");
  };
  EXPECT_TRUE(of(1000));
  ExpectMalformed(of(60000), "a.skeleton");
}

TEST(NtuSkeletonText, RejectsCountsThatContradictTheDataWithTheirLine) {
  const std::string text = WriteNtuSkeleton(Scene());
  const std::string same_id = Replaced(text, std::to_string(kFirst + 1), std::to_string(kFirst));
  for (const auto& [damaged, where] : {std::pair<std::string, const char*>{"2" + text.substr(1), "a.skeleton:1"},
                                       {"4" + text.substr(1), "a.skeleton:1"},
                                       {Replaced(text, "\n25\n", "\n24\n"), "a.skeleton:4"},
                                       {"3\n2" + text.substr(3), "a.skeleton:31"},
                                       {"3\n0" + text.substr(3), "a.skeleton:3"},
                                       {"", "a.skeleton:1"}}) {
    ExpectError(ParseNtuSkeleton(damaged, "a.skeleton"), ErrorCode::kInconsistent, where);
  }
  ExpectMalformed(ParseNtuSkeleton(same_id, "a.skeleton"), "a.skeleton:59");
  ExpectMalformed(ParseNtuSkeleton("99999999999\n", "a.skeleton"), "a.skeleton:1");
}

TEST(NtuSkeletonText, ReportsEveryMissingLine) {
  const std::string text = WriteNtuSkeleton(Scene());
  for (int line = 1; line <= 3 + 3 * 27 + 1; ++line) {
    EXPECT_FALSE(ParseNtuSkeleton(WithoutLine(text, line), "a.skeleton")) << line;
  }
  for (std::size_t length = 0; length + 2 < text.size(); length += 13) {
    EXPECT_FALSE(ParseNtuSkeleton(text.substr(0, length), "a.skeleton")) << length;
  }
}

TEST(NtuSkeletonText, ReportsTheLineOfEveryDamagedField) {
  NtuSkeleton one;
  one.frames = {{Body(kFirst, 0.1)}};
  ExpectEveryDamagedWordIsNamed(
      WriteNtuSkeleton(one), [](const std::string& text) { return StatusOf(ParseNtuSkeleton(text, "file")); }, nullptr);
  const std::string text = WriteNtuSkeleton(one);
  const auto altered = [&](const std::string& from, const std::string& to) {
    return ParseNtuSkeleton(Replaced(text, from, to), "a.skeleton");
  };
  ExpectMalformed(altered("0.13 0.5 3.1 270", "0.13 0.5 x 270"), "a.skeleton:8");
  ExpectError(altered("0.13 0.5 3.1 270", "0.13 0.5 270"), ErrorCode::kInconsistent, "a.skeleton:8");
  ExpectMalformed(altered(" 510 1 0 0 0 2\n", " 510 1 0 0 0 7\n"), "a.skeleton:5");
  ExpectMalformed(altered("\n" + std::to_string(kFirst), "\n7.2e16"), "a.skeleton:3");
}

TEST(NtuSkeletonText, DropsOnlyTheJointOfADamagedLineOnRequest) {
  const std::string text = WriteNtuSkeleton(Scene());
  NtuSkeleton expected = Scene();
  expected.frames[0][0].joints[3] = NtuJoint();
  for (const auto& [line, code] : {std::pair{"0.13 NaN 3.1 270", "not_a_number"}, {"0.13 0.5 270", "row_length"}}) {
    const std::string damaged = Replaced(text, "0.13 0.5 3.1 270", line);
    EXPECT_FALSE(ParseNtuSkeleton(damaged, "a.skeleton"));
    const auto skeleton = ParseNtuSkeleton(damaged, "a.skeleton", DamagedRows::kReport);
    ASSERT_TRUE(skeleton) << skeleton.error().Message();
    EXPECT_TRUE(*skeleton == expected);
    ASSERT_EQ(skeleton->findings.size(), 1u);
    EXPECT_EQ(skeleton->findings[0].code, code);
    EXPECT_EQ(skeleton->findings[0].joint, "3");
    EXPECT_EQ(skeleton->findings[0].frame_begin, 0);
  }
  const auto lean = ParseNtuSkeleton(Replaced(text, " 0 0 1 0 1 0 0 0 2\n", " 0 0 1 0 1 0 nan 0 2\n"), "a.skeleton",
                                     DamagedRows::kReport);
  ASSERT_TRUE(lean) << lean.error().Message();
  EXPECT_TRUE(*lean == Scene());
  EXPECT_EQ(lean->findings.size(), 1u);
  for (int line = 2; line <= 3 + 3 * 27 + 1; ++line) {
    const auto shorter = ParseNtuSkeleton(WithoutLine(text, line), "a.skeleton", DamagedRows::kReport);
    EXPECT_TRUE(!shorter || !shorter->findings.empty()) << "line " << line << " is lost without a finding";
  }
}

TEST(NtuSkeletonText, ReportsAContradictoryFrameCountOnRequest) {
  const std::string text = WriteNtuSkeleton(Scene());
  for (const char* count : {"2", "4"}) {
    const auto skeleton = ParseNtuSkeleton(count + text.substr(1), "a.skeleton", DamagedRows::kReport);
    ASSERT_TRUE(skeleton) << skeleton.error().Message();
    EXPECT_TRUE(*skeleton == Scene());
    ASSERT_EQ(skeleton->findings.size(), 1u);
    EXPECT_EQ(skeleton->findings[0].code, "count_contradiction");
    EXPECT_EQ(skeleton->findings[0].value, std::stod(count));
  }
  EXPECT_TRUE(ParseNtuSkeleton(text, "a.skeleton", DamagedRows::kReport)->findings.empty());
}

TEST(NtuSkeletonText, KeepsCompleteFramesOfATruncatedFileOnRequest) {
  const std::string text = WriteNtuSkeleton(Scene());
  ASSERT_EQ(Scene().frames.size(), 3u);
  std::set<std::size_t> kept;
  for (std::size_t end = 2; end + 1 < text.size(); ++end) {
    const auto skeleton = ParseNtuSkeleton(text.substr(0, end), "a.skeleton", DamagedRows::kReport);
    if (!skeleton) continue;  // no complete frame yet
    kept.insert(skeleton->frames.size());
    for (std::size_t f = 0; f + 1 < skeleton->frames.size(); ++f) EXPECT_TRUE(skeleton->frames[f] == Scene().frames[f]);
    if (skeleton->frames.size() == 3u) continue;  // the cut is within the last number
    ASSERT_FALSE(skeleton->findings.empty()) << end;
    EXPECT_EQ(skeleton->findings.back().code, "count_contradiction");
    EXPECT_EQ(skeleton->findings.back().severity, Severity::kError);
    EXPECT_EQ(skeleton->findings.back().joint, "");
  }
  EXPECT_EQ(kept, (std::set<std::size_t>{0, 1, 2, 3}));
}

TEST(NtuSkeletonFiles, ReadTheKnownFactsOfEachFile) {
  const auto folder = RecordedData("ntu");
  if (folder.empty()) GTEST_SKIP() << "NTU data not found";
  const struct {
    const char* name;
    std::size_t frames, bodies;
  } facts[] = {{"S001C001P001R001A011", 82, 1},
               {"S001C003P008R002A058", 70, 2},
               {"S002C001P003R001A003", 100, 1},
               {"S004C002P003R001A017", 124, 1}};
  for (const auto& fact : facts) {
    const auto skeleton = ParseNtuSkeleton(Bytes(folder / (std::string(fact.name) + ".skeleton")), fact.name);
    ASSERT_TRUE(skeleton) << skeleton.error().Message();
    EXPECT_EQ(skeleton->frames.size(), fact.frames);
    EXPECT_TRUE(*skeleton == ParseNtuSkeleton(WriteNtuSkeleton(*skeleton), "again").value());
    for (const auto& frame : skeleton->frames) {
      EXPECT_EQ(frame.size(), fact.bodies);
      for (const NtuBody& body : frame) {
        EXPECT_GT(body.id, std::uint64_t{1} << 56);
        for (const std::size_t leaf : {3u, 15u, 19u, 21u, 22u, 23u, 24u}) {
          const NtuJoint& joint = body.joints[leaf];
          EXPECT_TRUE(joint.qw == 0 && joint.qx == 0 && joint.qy == 0 && joint.qz == 0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace mocurate
