// One field of a small file damaged at a time: the error names the field, or the line that holds it. And counts of
// headers that what follows contradicts: the error says what was announced and what the file holds.

#include "core/formats/bvh.h"
#include "core/formats/depth_sequence.h"
#include "core/formats/header_count.h"
#include "core/formats/joint_table.h"
#include "core/formats/npy.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/opensim_table.h"
#include "core/formats/pcd.h"
#include "core/formats/ply.h"
#include "corruption.h"
#include "damage.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

constexpr const char* kBvh =
    "HIERARCHY\nROOT Hips\n{\n OFFSET 1 2 3\n CHANNELS 3 Xposition Yposition Zposition\n JOINT Knee\n {\n  OFFSET 0 5 "
    "0\n"
    "  CHANNELS 3 Zrotation Xrotation Yrotation\n  End Site\n  {\n   OFFSET 0 1 0\n  }\n }\n}\nMOTION\nFrames: 2\n"
    "Frame Time: 0.5\n1 2 3 4 5 6\n7 8 9 1 2 3\n";

template <class T>
Status StatusOfDamaged(const Expected<T>& read) {
  return read ? Status() : Status(Forward(read));
}

template <class T>
std::string MessageOfDamaged(const Expected<T>& read) {
  return read ? "parsed" : read.error().Message();
}

TEST(DamagedFields, OfABvhAreNamedWithTheirLine) {
  ExpectEveryDamagedWordIsNamed(
      kBvh, [](const std::string& text) { return StatusOfDamaged(ParseBvh(text, "file")); },
      [](std::string_view, std::string_view word) { return word == "Hips" || word == "Knee"; });
}

TEST(DamagedFields, OfATableOfNumbersAreNamedWithTheirLine) {
  JointTableLayout layout;
  layout.rows_per_frame = 2;
  for (const char* text : {"1 2 3\n4 5 6\n7 8 9\n1 2 3\n", "1,2,3\n4,5,6\n7,8,9\n1,2,3\n"}) {
    ExpectEveryDamagedWordIsNamed(
        text, [&](const std::string& damaged) { return StatusOfDamaged(ParseJointTable(damaged, layout, "file")); },
        nullptr);
  }
}

TEST(DamagedFields, OfADepthSequenceAreNamedWithTheirPath) {
  const auto document = nlohmann::json::parse(
      R"({"body":"male","fps":12,"frames":1,"labels":[{"action":"idle","first":0,"last":0}],"views":{"d1":{"R_p_to_d":
      [[1,0,0],[0,1,0],[0,0,1]],"t_m":[1,2,3],"fx_fy_cx_cy":[360,361,250,200],"size":[512,424]}},"frames_data":[
      {"rotvec24":[[0,0,0],[0,0,1]],"translation_added":[0,1,0],"joints_m":[[1,2,3],[4,5,6]]}]})");
  test::EachFieldIsRefusedWhenDamaged(
      document,
      [](const std::string& bytes) {
        const auto sequence = ParseDepthSequence(bytes, "s.json");
        return sequence ? MessageOfDamaged(ParseDepthSequenceTruth(bytes, "s.json")) : MessageOfDamaged(sequence);
      },
      [](const std::string& path) { return path == "/body"; });
}

TEST(DamagedFields, OfTheHeaderOfAnArrayAreNamed) {
  NpyArray array;
  array.shape = {2, 3};
  array.dtype = "<f8";
  array.values.assign(6, 1.0);
  const std::string good = WriteNpy(array);
  const auto message = [&](const std::string& from, const std::string& to) {
    return MessageOfDamaged(ParseNpy(Replaced(good, from, to), "a.npy"));
  };
  EXPECT_EQ(message("NUMPY", "NUMPY"), "parsed");
  EXPECT_THAT(message("NUMPY", "NUMPX"), HasSubstr("does not begin as a numpy array"));
  EXPECT_THAT(message(std::string("\x01\x00", 2), std::string("\x04\x00", 2)), HasSubstr("format version 4"));
  EXPECT_THAT(message("'<f8'", "<f8,,"), HasSubstr("the type in quotes"));
  EXPECT_THAT(message("'<f8'", "'<f9'"), HasSubstr("arrays of type '<f9' are not read"));
  EXPECT_THAT(message("'descr'", "'desc?'"), HasSubstr("descr, fortran_order or shape"));
  EXPECT_THAT(message("False", "Falsy"), HasSubstr("True or False"));
  EXPECT_THAT(message("'fortran_order'", "'fortran_orde?'"), HasSubstr("descr, fortran_order or shape"));
  EXPECT_THAT(message("(2, 3)", "(2, x)"), HasSubstr("the shape in parentheses"));
  EXPECT_THAT(message("(2, 3)", "(2, 4)"), HasSubstr("shape (2, 4) announces 8, the file holds 6"));
}

struct Contradiction {
  const char* name;
  Status read;
  double announced;
  const char* held;
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

TEST(HeaderCounts, ThatContradictWhatFollowsAreToldWithBothNumbersAndTheirPlace) {
  const Contradiction cases[] = {
      {"BVH, more", StatusOfDamaged(ParseBvh(BvhOf("3"), "f")), 3, "Frames announces 3, the file holds 2", "f:17"},
      {"BVH, fewer", StatusOfDamaged(ParseBvh(BvhOf("1"), "f")), 1, "Frames announces 1, the file holds 2", "f:17"},
      {"NTU, more", StatusOfDamaged(ParseNtuSkeleton(SkeletonText("7"), "f")), 7,
       "the frame count announces 7, the file holds 2", "f:1"},
      {"NTU, fewer", StatusOfDamaged(ParseNtuSkeleton(SkeletonText("1"), "f")), 1, "the file holds 2", "f:1"},
      {"PLY text, more", StatusOfDamaged(ParsePly(PlyText("3", false), "f")), 3,
       "element vertex announces 3, the file holds 2", "f:9"},
      {"PLY text, fewer", StatusOfDamaged(ParsePly(PlyText("1", false), "f")), 1, "the file holds 2", "f:8"},
      {"PLY binary, more", StatusOfDamaged(ParsePly(PlyText("3", true), "f")), 3, "the file holds 2", "f:6"},
      {"PLY binary, fewer", StatusOfDamaged(ParsePly(PlyText("1", true), "f")), 1, "the file holds 2", "f"},
      {"PCD text, more", StatusOfDamaged(ParsePcd(PcdText("3", false), "f")), 3, "POINTS announces 3, the file holds 2",
       "f:10"},
      {"PCD text, fewer", StatusOfDamaged(ParsePcd(PcdText("1", false), "f")), 1, "the file holds 2", "f:10"},
      {"PCD binary, more", StatusOfDamaged(ParsePcd(PcdText("3", true), "f")), 3, "the file holds 2", "f:10"},
      {"PCD binary, fewer", StatusOfDamaged(ParsePcd(PcdText("1", true), "f")), 1, "the file holds 2", "f:10"},
      {"rows", StatusOfDamaged(ParseOpenSimTable(Mot("3", "2"), "f")), 3, "nRows announces 3, the file holds 2", "f:2"},
      {"columns", StatusOfDamaged(ParseOpenSimTable(Mot("2", "4"), "f")), 4, "nColumns announces 4, the file holds 2",
       "f:3"}};
  for (const Contradiction& c : cases) {
    ASSERT_FALSE(c.read) << c.name;
    EXPECT_THAT(c.read.error().what, HasSubstr(c.held)) << c.name;
    EXPECT_EQ(c.read.error().where, c.place) << c.name;
    EXPECT_EQ(c.read.error().reason, Reason::kCount) << c.name;
    EXPECT_EQ(c.read.error().number, c.announced) << c.name;
  }
  EXPECT_EQ(ParseBvh(Replaced(kBvh, "1 2 3 4", "1 2 x 4"), "f").error().reason, Reason::kNone);
}

TEST(HeaderCounts, OfABvhAreAFindingWhereThatIsAskedForAndNoRowMoves) {
  const Bvh right = ParseBvh(kBvh, "f").value();
  for (const char* count : {"1", "3", "99999999999"}) {
    const auto bvh = ParseBvh(BvhOf(count), "f", DamagedRows::kReport);
    ASSERT_TRUE(bvh) << bvh.error().Message();
    EXPECT_EQ(bvh->values, right.values);
    EXPECT_EQ(bvh->frames, 2);
    ASSERT_EQ(bvh->findings.size(), 1u);
    EXPECT_EQ(bvh->findings[0].code, "count_contradiction");
    EXPECT_EQ(bvh->findings[0].value, std::stod(count));
    EXPECT_THAT(bvh->findings[0].message, HasSubstr("f:17: Frames announces"));
  }
  EXPECT_TRUE(ParseBvh(kBvh, "f", DamagedRows::kReport)->findings.empty());
}

TEST(HeaderCounts, ALastRowOfABvhThatIsCutOffIsLeftOutAndSaid) {
  const std::string text = kBvh;
  const auto bvh = ParseBvh(text.substr(0, text.size() - 4), "f", DamagedRows::kReport);
  ASSERT_TRUE(bvh) << bvh.error().Message();
  EXPECT_EQ(bvh->frames, 1);
  ASSERT_EQ(bvh->findings.size(), 2u);
  EXPECT_EQ(bvh->findings[0].code, "cut_off");
  EXPECT_EQ(bvh->findings[0].frame_begin, 1);
  EXPECT_EQ(bvh->findings[1].code, "count_contradiction");
}

TEST(HeaderCounts, ADamagedRowOfABvhKeepsItsPlaceUnlessRowsMayHaveMoved) {
  for (const auto& [row, code] : {std::pair<std::string, std::string>{"1 2 3 4", "row_length"},
                                  {"1 2 three 4 5 6", "not_a_number"},
                                  {"1 2 nan 4 5 6", "not_a_number"},
                                  {"1 2 3 4 5 -1e31", "number_too_large"}}) {
    const std::string text = Replaced(kBvh, "1 2 3 4 5 6", row);
    EXPECT_FALSE(ParseBvh(text, "f")) << "refused where nothing else is asked for";
    const auto bvh = ParseBvh(text, "f", DamagedRows::kReport);
    ASSERT_TRUE(bvh) << bvh.error().Message();
    EXPECT_EQ(bvh->frames, 2);
    EXPECT_EQ(bvh->damaged, std::vector<int>{0});
    EXPECT_EQ(bvh->value(0, 0), 7.0) << "of the row beside it";
    EXPECT_EQ(bvh->value(1, 0), 7.0);
    ASSERT_EQ(bvh->findings.size(), 1u);
    EXPECT_EQ(bvh->findings[0].code, code);
    EXPECT_THAT(bvh->findings[0].message, HasSubstr("f:19: "));
  }
  EXPECT_FALSE(ParseBvh(Replaced(kBvh, "3 4 5", "3\n4 5"), "f", DamagedRows::kReport)) << "split: rows would move";
  EXPECT_FALSE(ParseBvh(Replaced(kBvh, "6\n7", "6 7"), "f", DamagedRows::kReport)) << "joined: rows would move";
}

}  // namespace
}  // namespace mocurate
