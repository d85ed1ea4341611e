// Small files with one damaged field: the error names the field or its line. Headers whose counts contradict the
// data.

#include <nlohmann/json.hpp>
#include "core/formats/bvh.h"
#include "core/formats/depth_sequence.h"
#include "core/formats/file_rules.h"
#include "core/formats/joint_table.h"
#include "core/formats/npy.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/opensim_table.h"
#include "core/formats/point_cloud.h"
#include "corruption.h"
#include "damage.h"
#include "expect_error.h"

namespace mocurate {
namespace {

constexpr const char* kBvh =
    "HIERARCHY\nROOT Hips\n{\n OFFSET 1 2 3\n CHANNELS 3 Xposition Yposition Zposition\n JOINT Knee\n {\n  OFFSET 0 5 "
    "0\n"
    "  CHANNELS 3 Zrotation Xrotation Yrotation\n  End Site\n  {\n   OFFSET 0 1 0\n  }\n }\n}\nMOTION\nFrames: 2\n"
    "Frame Time: 0.5\n1 2 3 4 5 6\n7 8 9 1 2 3\n";

TEST(DamagedFields, OfABvhAreReportedWithTheirLine) {
  ExpectEveryDamagedWordIsNamed(
      kBvh, [](const std::string& text) { return StatusOf(ParseBvh(text, "file")); },
      [](std::string_view, std::string_view word) { return word == "Hips" || word == "Knee"; });
}

TEST(DamagedFields, OfANumberTableAreReportedWithTheirLine) {
  JointTableLayout layout;
  layout.rows_per_frame = 2;
  for (const char* text : {"1 2 3\n4 5 6\n7 8 9\n1 2 3\n", "1,2,3\n4,5,6\n7,8,9\n1,2,3\n"}) {
    ExpectEveryDamagedWordIsNamed(
        text, [&](const std::string& damaged) { return StatusOf(ParseJointTable(damaged, layout, "file")); }, nullptr);
  }
}

TEST(DamagedFields, OfADepthSequenceAreReportedWithTheirPath) {
  const auto document = nlohmann::json::parse(
      R"({"body":"male","fps":12,"frames":1,"labels":[{"action":"idle","first":0,"last":0}],"views":{"d1":{"R_p_to_d":
      [[1,0,0],[0,1,0],[0,0,1]],"t_m":[1,2,3],"fx_fy_cx_cy":[360,361,250,200],"size":[512,424]}},"frames_data":[
      {"rotvec24":[[0,0,0],[0,0,1]],"translation_added":[0,1,0],"joints_m":[[1,2,3],[4,5,6]]}]})");
  test::ExpectEveryDamagedFieldIsRejected(
      document,
      [](const std::string& bytes) {
        const Status sequence = StatusOf(ParseDepthSequence(bytes, "s.json"));
        return sequence ? StatusOf(ParseDepthSequenceTruth(bytes, "s.json")) : sequence;
      },
      [](const std::string& path) { return path == "/body"; });
}

TEST(DamagedFields, OfAnArrayHeaderAreRejected) {
  NpyArray array;
  array.shape = {2, 3};
  array.dtype = "<f8";
  array.values.assign(6, 1.0);
  const std::string good = WriteNpy(array);
  const auto read = [&](const std::string& from, const std::string& to) {
    return ParseNpy(Replaced(good, from, to), "a.npy");
  };
  EXPECT_TRUE(read("NUMPY", "NUMPY"));
  ExpectMalformed(read("NUMPY", "NUMPX"), "a.npy");
  ExpectError(read(std::string("\x01\x00", 2), std::string("\x04\x00", 2)), ErrorCode::kUnsupported, "a.npy");
  ExpectMalformed(read("'<f8'", "<f8,,"), "a.npy:byte 10");
  ExpectError(read("'<f8'", "'<f9'"), ErrorCode::kUnsupported, "a.npy");
  ExpectMalformed(read("'descr'", "'desc?'"), "a.npy:byte 9");
  ExpectMalformed(read("False", "Falsy"), "a.npy:byte 34");
  ExpectMalformed(read("'fortran_order'", "'fortran_orde?'"), "a.npy:byte 33");
  ExpectMalformed(read("(2, 3)", "(2, x)"), "a.npy:byte 54");
  ExpectError(read("(2, 3)", "(2, 4)"), ErrorCode::kInconsistent, "a.npy");
}

struct Contradiction {
  const char* name;
  Status read;
  double announced;
  const char* place;
};

std::string PlyText(const std::string& count, bool binary) {
  const std::string head = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") +
                           " 1.0\nelement vertex " + count + "\nproperty uchar x\nproperty uchar y\nend_header\n";
  return head + (binary ? "abcd" : "1 2\n3 4\n");
}

std::string PcdText(const std::string& count, bool binary) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y\nSIZE 1 1\nTYPE U U\nCOUNT 1 1\nWIDTH " + count +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA " +
         (binary ? std::string("binary\nabcd") : std::string("ascii\n1 2\n3 4\n"));
}

std::string BvhOf(const std::string& frames) { return Replaced(kBvh, "Frames: 2", "Frames: " + frames); }

std::string Mot(const std::string& rows, const std::string& columns) {
  return "Coordinates\nnRows=" + rows + "\nnColumns=" + columns + "\nendheader\ntime\ta\n0\t1\n1\t2\n";
}

std::string SkeletonText(const std::string& count) {
  NtuSkeleton scene;
  scene.frames = {{NtuBody()}, {}};
  return count + WriteNtuSkeleton(scene).substr(1);
}

TEST(HeaderCounts, AreRejectedWithTheirPlaceWhenTheDataDisagree) {
  const Contradiction cases[] = {{"BVH, more", StatusOf(ParseBvh(BvhOf("3"), "f")), 3, "f:17"},
                                 {"BVH, fewer", StatusOf(ParseBvh(BvhOf("1"), "f")), 1, "f:17"},
                                 {"NTU, more", StatusOf(ParseNtuSkeleton(SkeletonText("7"), "f")), 7, "f:1"},
                                 {"NTU, fewer", StatusOf(ParseNtuSkeleton(SkeletonText("1"), "f")), 1, "f:1"},
                                 {"PLY text, more", StatusOf(ParsePly(PlyText("3", false), "f")), 3, "f:9"},
                                 {"PLY text, fewer", StatusOf(ParsePly(PlyText("1", false), "f")), 1, "f:8"},
                                 {"PLY binary, more", StatusOf(ParsePly(PlyText("3", true), "f")), 3, "f:6"},
                                 {"PLY binary, fewer", StatusOf(ParsePly(PlyText("1", true), "f")), 1, "f"},
                                 {"PCD text, more", StatusOf(ParsePcd(PcdText("3", false), "f")), 3, "f:10"},
                                 {"PCD text, fewer", StatusOf(ParsePcd(PcdText("1", false), "f")), 1, "f:10"},
                                 {"PCD binary, more", StatusOf(ParsePcd(PcdText("3", true), "f")), 3, "f:10"},
                                 {"PCD binary, fewer", StatusOf(ParsePcd(PcdText("1", true), "f")), 1, "f:10"},
                                 {"rows", StatusOf(ParseOpenSimTable(Mot("3", "2"), "f")), 3, "f:2"},
                                 {"columns", StatusOf(ParseOpenSimTable(Mot("2", "4"), "f")), 4, "f:3"}};
  for (const Contradiction& c : cases) {
    SCOPED_TRACE(c.name);
    ExpectError(c.read, ErrorCode::kInconsistent, c.place);
    EXPECT_EQ(c.read.error().reason, Reason::kCount);
    EXPECT_EQ(c.read.error().number, c.announced);
  }
  EXPECT_EQ(ParseBvh(Replaced(kBvh, "1 2 3 4", "1 2 x 4"), "f").error().reason, Reason::kNone);
}

TEST(HeaderCounts, OfABvhAreReportedOnRequestWithoutMovingRows) {
  const Bvh right = ParseBvh(kBvh, "f").value();
  for (const char* count : {"0", "-5", "1", "3", "99999999999"}) {
    const auto bvh = ParseBvh(BvhOf(count), "f", DamagedRows::kReport);
    ASSERT_TRUE(bvh) << bvh.error().Message();
    EXPECT_EQ(bvh->values, right.values);
    EXPECT_EQ(bvh->frames, 2);
    ASSERT_EQ(bvh->findings.size(), 1u);
    EXPECT_EQ(bvh->findings[0].code, "count_contradiction");
    EXPECT_EQ(bvh->findings[0].value, std::stod(count));
  }
  EXPECT_TRUE(ParseBvh(kBvh, "f", DamagedRows::kReport)->findings.empty());
}

TEST(HeaderCounts, ExcludeAndReportATruncatedLastRowOfABvh) {
  const std::string text = kBvh;
  const auto bvh = ParseBvh(text.substr(0, text.size() - 4), "f", DamagedRows::kReport);
  ASSERT_TRUE(bvh) << bvh.error().Message();
  EXPECT_EQ(bvh->frames, 1);
  ASSERT_EQ(bvh->findings.size(), 2u);
  EXPECT_EQ(bvh->findings[0].code, "cut_off");
  EXPECT_EQ(bvh->findings[0].frame_begin, 1);
  EXPECT_EQ(bvh->findings[1].code, "count_contradiction");
}

TEST(HeaderCounts, KeepTheTimeOfADamagedBvhRowUnlessRowsMayHaveMoved) {
  for (const auto& [row, code] : {std::pair<std::string, std::string>{"1 2 3 4", "row_length"},
                                  {"1 2 three 4 5 6", "not_a_number"},
                                  {"1 2 nan 4 5 6", "not_a_number"},
                                  {"1 2 3 4 5 -1e31", "number_too_large"}}) {
    const std::string text = Replaced(kBvh, "1 2 3 4 5 6", row);
    EXPECT_FALSE(ParseBvh(text, "f")) << "rejected by default";
    const auto bvh = ParseBvh(text, "f", DamagedRows::kReport);
    ASSERT_TRUE(bvh) << bvh.error().Message();
    EXPECT_EQ(bvh->frames, 2);
    EXPECT_EQ(bvh->damaged, std::vector<int>{0});
    EXPECT_EQ(bvh->value(0, 0), 7.0) << "copied from the neighbouring row";
    EXPECT_EQ(bvh->value(1, 0), 7.0);
    ASSERT_EQ(bvh->findings.size(), 1u);
    EXPECT_EQ(bvh->findings[0].code, code);
    EXPECT_EQ(bvh->findings[0].frame_begin, 0);
    EXPECT_EQ(bvh->findings[0].frame_end, 1);
  }
  EXPECT_FALSE(ParseBvh(Replaced(kBvh, "3 4 5", "3\n4 5"), "f", DamagedRows::kReport)) << "split: rows would move";
  EXPECT_FALSE(ParseBvh(Replaced(kBvh, "6\n7", "6 7"), "f", DamagedRows::kReport)) << "joined: rows would move";
}

}  // namespace
}  // namespace mocurate
