// Clouds and meshes: PLY, PCD.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <set>

#include "core/formats/point_cloud.h"
#include "tests/formats/corruption.h"
#include "tests/formats/damage.h"
#include "tests/formats/expect_error.h"
#include "tests/support/cloud_writers.h"

namespace mocurate {
namespace {

Ply SmallPly(Ply::Encoding encoding) {
  Ply ply;
  ply.encoding = encoding;
  PlyElement vertex{"vertex", 4, {}};
  vertex.properties.push_back({"x", kFloat64, {}, {0, 1, 0, 0.1}, {}});
  vertex.properties.push_back({"y", kFloat32, {}, {0, 0, 1, static_cast<double>(0.1F)}, {}});
  vertex.properties.push_back({"z", kInt16, {}, {-300, 0, 0, 32767}, {}});
  vertex.properties.push_back({"red", kUint8, {}, {0, 255, 1, 2}, {}});
  PlyElement face{"face", 2, {}};
  face.properties.push_back({"vertex_indices", kInt32, kUint8, {0, 1, 2, 3, 2, 1, 0}, {0, 3, 7}});
  face.properties.push_back({"weights", kFloat32, kUint16, {1.5}, {0, 0, 1}});
  ply.elements = {vertex, face, {"empty", 0, {{"q", kInt8, {}, {}, {}}}}};
  return ply;
}

Status ReadPly(const std::string& bytes) {
  const auto ply = ParsePly(bytes, "c.ply");
  return ply ? StatusOf(PlyTriangles(*ply, "c.ply")) : StatusOf(ply);
}

TEST(Ply, RoundTripsInEveryEncoding) {
  for (const Ply::Encoding encoding :
       {Ply::Encoding::kAscii, Ply::Encoding::kBinaryLittleEndian, Ply::Encoding::kBinaryBigEndian}) {
    const Ply ply = SmallPly(encoding);
    std::string bytes = WritePly(ply);
    bytes.insert(bytes.find("element"), "comment made by hand\ncomment\nobj_info a scan\n");
    const auto back = ParsePly(bytes, "c.ply");
    ASSERT_TRUE(back) << back.error().Message();
    EXPECT_TRUE(*back == ply);
    const auto triangles = PlyTriangles(*back, "c.ply");
    ASSERT_TRUE(triangles);
    EXPECT_THAT(*triangles, ::testing::ElementsAre(std::array{0, 1, 2}, std::array{3, 2, 1}, std::array{3, 1, 0}));
    EXPECT_EQ((*PlyPoints(*back, "c.ply"))[0], Vector3d(0, 0, -300));
  }
}

TEST(Clouds, ReadHeadersOfManyNamesInLinearTime) {
  std::string ply = "ply\nformat ascii 1.0\nelement vertex 0\n", pcd = "VERSION 0.7\nFIELDS";
  for (int i = 0; i < 60000; ++i) {
    ply += "property float x" + std::to_string(i) + "\n";
    pcd += " x" + std::to_string(i);
  }
  for (int i = 0; i < 60000; ++i) ply += "element e" + std::to_string(i) + " 0\n";
  const std::clock_t begin = std::clock();
  EXPECT_TRUE(ParsePly(ply + "end_header\n", "c.ply"));
  EXPECT_FALSE(ParsePcd(pcd + "\n", "c.pcd"));
  EXPECT_LT(std::clock() - begin, 2 * CLOCKS_PER_SEC) << "comparing all names takes ten times as long";
}

TEST(Ply, RejectsABinaryFileTruncatedAtAnyByte) {
  const std::string bytes = WritePly(SmallPly(Ply::Encoding::kBinaryBigEndian));
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(ReadPly(bytes.substr(0, size))) << size;
  ExpectError(ReadPly(bytes + "x"), ErrorCode::kInconsistent, "c.ply");
  ExpectError(ReadPly(bytes.substr(0, bytes.size() - 1)), ErrorCode::kInconsistent, "c.ply:face 1");
}

TEST(Ply, ReportsTheLineOfEveryDamagedWordOfATextFile) {
  Ply ply = SmallPly(Ply::Encoding::kAscii);
  ExpectEveryDamagedWordIsNamed(
      WritePly(ply), [](const std::string& bytes) { return StatusOf(ParsePly(bytes, "c.ply")); },
      [](std::string_view line, std::string_view word) {
        const bool names = line.rfind("property ", 0) == 0 || line.rfind("element ", 0) == 0;
        static const std::set<std::string_view> free = {"vertex", "face", "empty",          "x",       "y",
                                                        "z",      "red",  "vertex_indices", "weights", "q"};
        return word == "ply" || (names && free.count(word) > 0);
      });
  ExpectMalformed(ReadPly("plx" + WritePly(ply).substr(3)), "c.ply");
}

TEST(Ply, RejectsInvalidNumbersAndVertices) {
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nend_header\n";
  ExpectMalformed(ReadPly(head + "0 0\n0 nan\n"), "c.ply:8:vertex 1/y");
  ExpectMalformed(ReadPly(head + "0 0\n0 1e39\n"), "c.ply:8:vertex 1/y");
  ExpectError(ReadPly(head + "0 0\n"), ErrorCode::kInconsistent, "c.ply:8");
  ExpectError(ReadPly(head + "0 0\n1 1\n2 2\n"), ErrorCode::kInconsistent, "c.ply:9");
  ExpectError(ReadPly("ply\nformat ascii 1.0\nelement vertex 1000000000\nproperty float x\nend_header\n0\n"),
              ErrorCode::kInconsistent, "c.ply:5");
  ExpectError(ReadPly("ply\nelement vertex 0\nproperty float x\nformat binary_big_endian 1.0\nend_header\n"),
              ErrorCode::kMalformed, "c.ply:2");
  const std::string face = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\nend_header\n";
  ExpectError(ReadPly(face + "3 0 1 2\n"), ErrorCode::kInconsistent, "c.ply:face 0/vertex_index");
  ExpectMalformed(ReadPly(face + "300 0 1 2\n"), "c.ply:6:face 0/vertex_index");
}

TEST(Ply, ReadsTheDoublePrecisionMeshOfTheHandheldScan) {
  MOCURATE_RECORDED(bytes, "clouds/handheld_head/Mesh_DepthOnly__A_hat1__every_10th_14frames.ply");
  const auto ply = ParsePly(bytes, "mesh.ply");
  ASSERT_TRUE(ply) << ply.error().Message();
  EXPECT_EQ(ply->Find("vertex")->count, 8611u);
  EXPECT_EQ(ply->Find("vertex")->Find("nx")->type, kFloat64);
  EXPECT_EQ(PlyTriangles(*ply, "mesh.ply")->size(), 16672u);
  const auto points = PlyPoints(*ply, "mesh.ply");
  for (const Vector3d& point : *points) ASSERT_LT(point.norm(), 3.0);
  EXPECT_EQ(WritePly(*ply), Replaced(bytes, "comment Created by Open3D\n", ""));
}

Pcd SmallPcd(Pcd::Encoding encoding) {
  Pcd pcd;
  pcd.encoding = encoding;
  pcd.width = 3;
  pcd.viewpoint = {0.5, 0, 0, 1, 0, 0, 0};
  pcd.fields = {{"x", kFloat32, 1, {1, 0, 3}},
                {"y", kFloat32, 1, {1, 0, static_cast<double>(0.1F)}},
                {"z", kFloat64, 1, {0.1, 0, 5}},
                {"rgb", kFloat32, 1, {0xA05030, 0x000001, 0xFFFFFF}},
                {"histogram", kUint8, 2, {0, 1, 2, 3, 4, 255}}};
  pcd.missing = {0, 1, 0};
  return pcd;
}

TEST(Pcd, RoundTripsMissingPointsAndPackedColoursInEveryEncoding) {
  for (const Pcd::Encoding encoding :
       {Pcd::Encoding::kAscii, Pcd::Encoding::kBinary, Pcd::Encoding::kBinaryCompressed}) {
    const Pcd pcd = SmallPcd(encoding);
    const auto back = ParsePcd(WritePcd(pcd), "c.pcd");
    ASSERT_TRUE(back) << back.error().Message();
    EXPECT_TRUE(*back == pcd) << static_cast<int>(encoding);
    EXPECT_EQ(PcdPoints(*back, "c.pcd")->size(), 2u);
  }
}

TEST(Pcd, MarksAPointMissingWhenOneCoordinateIsMissing) {
  const std::string head =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n";
  const auto pcd = ParsePcd(head + "1 nan 3\n4 5 6\n", "c.pcd");
  ASSERT_TRUE(pcd) << pcd.error().Message();
  EXPECT_EQ(pcd->Find("z")->values, (std::vector<double>{0, 6}));
  EXPECT_THAT(*PcdPoints(*pcd, "c.pcd"), ::testing::ElementsAre(Vector3d(4, 5, 6)));
  EXPECT_TRUE(*ParsePcd(WritePcd(*pcd), "again") == *pcd);
}

TEST(Pcd, ReadsColoursWithAlphaAsValidPoints) {
  std::string bytes =
      "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA binary\n";
  for (const double value : {1.0, 2.0, 3.0}) AppendNumber(bytes, value, kFloat32);
  AppendNumber(bytes, 0xFFC0A050, kUint32);
  const auto pcd = ParsePcd(bytes, "c.pcd");
  ASSERT_TRUE(pcd) << pcd.error().Message();
  EXPECT_EQ(pcd->Find("rgb")->values[0], 0xC0A050);
  EXPECT_EQ(PcdPoints(*pcd, "c.pcd")->size(), 1u);
}

TEST(Pcd, ReportsTheLineOfEveryDamagedWordOfATextFile) {
  const std::string text = WritePcd(SmallPcd(Pcd::Encoding::kAscii));
  ExpectEveryDamagedWordIsNamed(
      text.substr(text.find('\n') + 1), [](const std::string& bytes) { return StatusOf(ParsePcd(bytes, "c.pcd")); },
      [](std::string_view line, std::string_view word) { return line.rfind("FIELDS ", 0) == 0 && word != "FIELDS"; },
      " \n", {"x?"});  // a NaN point is a missing point
}

TEST(Pcd, RejectsABinaryFileTruncatedAtAnyByte) {
  for (const Pcd::Encoding encoding : {Pcd::Encoding::kBinary, Pcd::Encoding::kBinaryCompressed}) {
    const std::string bytes = WritePcd(SmallPcd(encoding));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_FALSE(ParsePcd(bytes.substr(0, size), "c.pcd")) << size;
    }
    EXPECT_FALSE(ParsePcd(bytes + "x", "c.pcd"));
  }
}

TEST(Pcd, RejectsACompressedBlockThatTakesMoreMemoryThanTheFileMay) {
  constexpr int kPoints = 8'000'000;
  std::string bytes =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 8000000\nHEIGHT 1\nPOINTS 8000000\nDATA "
      "binary_compressed\n";
  const std::string block(kPoints * 12 / 88 + 1, 'x');
  AppendNumber(bytes, static_cast<double>(block.size()), kUint32);
  AppendNumber(bytes, 12.0 * kPoints, kUint32);
  ExpectMalformed(ParsePcd(bytes + block, "c.pcd"), "c.pcd:7");
}

TEST(Pcd, UnpacksBackReferencesOfCompressedBlocks) {
  // 'abc', then 9 bytes copied from 3 back (long reference), then 3 bytes from 1 back (short reference).
  const std::string block = {'\x02', 'a', 'b', 'c', '\xE0', '\x00', '\x02', '\x20', '\x00'};
  EXPECT_EQ(UnpackLzf(block, 15), "abcabcabcabcccc");
  EXPECT_EQ(UnpackLzf(block, 14), std::nullopt);
  EXPECT_EQ(UnpackLzf(block, 16), std::nullopt);
  EXPECT_EQ(UnpackLzf(std::string("\x20\x05", 2), 3), std::nullopt);
  std::string long_text;
  for (int i = 0; i < 1000; ++i) long_text += static_cast<char>(i * 7);
  EXPECT_EQ(UnpackLzf(PackLzf(long_text), 1000), long_text);
}

TEST(Pcd, ReadsTheDepthViewClouds) {
  MOCURATE_RECORDED(bytes, "rgbd100/views/0000000050.pcd");
  const auto pcd = ParsePcd(bytes, "50.pcd");
  ASSERT_TRUE(pcd) << pcd.error().Message();
  const auto points = PcdPoints(*pcd, "50.pcd");
  const auto junk = std::count_if(points->begin(), points->end(), [](const Vector3d& p) { return p.z() > 3.0; });
  const double share = static_cast<double>(junk) / static_cast<double>(points->size());
  EXPECT_GT(share, 0.022);
  EXPECT_LT(share, 0.0265);
  const PcdField* colour = pcd->Find("rgb");
  ASSERT_NE(colour, nullptr);
  EXPECT_GT(*std::max_element(colour->values.begin(), colour->values.end()), 0x400000);
  EXPECT_TRUE(*ParsePcd(WritePcd(*pcd), "again") == *pcd);
}

TEST(Clouds, ReadNormalsOnlyWhenEveryPointHasOne) {
  Ply ply = SmallPly(Ply::Encoding::kAscii);
  const auto bare = ParsePointCloud(WritePly(ply), "c.ply");
  ASSERT_TRUE(bare) << bare.error().Message();
  EXPECT_EQ(bare->points.size(), 4u);
  EXPECT_EQ(bare->triangles, 3u);
  EXPECT_TRUE(bare->normals.empty());
  std::vector<PlyProperty>& columns = ply.elements[0].properties;
  columns.push_back({"nx", kFloat32, {}, {0, 0, 2, 1}, {}});
  columns.push_back({"ny", kFloat32, {}, {1, 0, 0, 0}, {}});
  columns.push_back({"nz", kFloat32, {}, {0, -1, 0, 0}, {}});
  const auto cloud = ParsePointCloud(WritePly(ply), "c.ply");
  ASSERT_TRUE(cloud) << cloud.error().Message();
  EXPECT_THAT(cloud->normals,
              ::testing::ElementsAre(Vector3d(0, 1, 0), Vector3d(0, 0, -1), Vector3d(1, 0, 0), Vector3d(1, 0, 0)));
  columns[4].values[2] = 0;
  EXPECT_TRUE(ParsePointCloud(WritePly(ply), "c.ply")->normals.empty()) << "one normal is zero";

  const std::string pcd =
      "VERSION 0.7\nFIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\nWIDTH 3\nHEIGHT 1\n"
      "POINTS 3\nDATA ascii\n0 0 1 0 0 1\nnan nan nan nan nan nan\n1 0 1 0 1 0\n";
  const auto scan = ParsePointCloud(pcd, "c.pcd");
  ASSERT_TRUE(scan) << scan.error().Message();
  EXPECT_THAT(scan->points, ::testing::ElementsAre(Vector3d(0, 0, 1), Vector3d(1, 0, 1)));
  EXPECT_THAT(scan->normals, ::testing::ElementsAre(Vector3d(0, 0, 1), Vector3d(0, 1, 0)));
  EXPECT_EQ(ParsePointCloud("v 0 0 0\nf 1 1 1\n", "c.obj").error().code, ErrorCode::kUnsupported);
  EXPECT_FALSE(ParsePointCloud("", "c.ply"));
}

TEST(Clouds, RejectImplausibleCoordinatesWithTheirPlace) {
  for (const std::string value : {"1e300", "-1e38", "2e12"}) {
    ExpectMalformed(ParsePly("ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
                             "property double z\nend_header\n0 0 0\n1 " +
                                 value + " 0\n",
                             "m.ply"),
                    "m.ply:9:vertex 1/y");
    ExpectMalformed(ParsePcd("VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n"
                             "DATA ascii\n0 0 0\n1 " +
                                 value + " 0\n",
                             "m.pcd"),
                    "m.pcd:10:point 1/y");
  }
}

}  // namespace
}  // namespace mocurate
