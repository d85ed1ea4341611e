// Damaged files: a reader returns a value or an error in bounded time and never crashes. scripts/sanitize.sh runs
// these tests under sanitizers; tests/fuzz drives the same readers by libFuzzer.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/base/random.h"
#include "core/formats/amc.h"
#include "core/formats/array_fields.h"
#include "core/formats/bandai_label.h"
#include "core/formats/bvh.h"
#include "core/formats/camera_files.h"
#include "core/formats/depth_sequence.h"
#include "core/formats/expmap_table.h"
#include "core/formats/humanact12_pickle.h"
#include "core/formats/joint_layout.h"
#include "core/formats/joint_table.h"
#include "core/formats/npy.h"
#include "core/formats/npz.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/openpose.h"
#include "core/formats/opensim_table.h"
#include "core/formats/phspd_text.h"
#include "core/formats/pickle.h"
#include "core/formats/point_cloud.h"
#include "core/formats/uestc_info.h"
#include "core/formats/vibe_pickle.h"
#include "pickle_samples.h"
#include "tests/support/acclaim_writers.h"
#include "tests/support/cloud_writers.h"
#include "tests/support/humanact12_clips.h"
#include "tests/support/keypoints_equal.h"
#include "tests/support/mutation.h"
#include "tests/support/ntu_equal.h"

namespace mocurate {
namespace {

void Survives(const std::string& seed, int rounds, const std::function<void(const std::string&)>& read) {
  read(seed);
  Random random(7, "mutation");
  for (int i = 0; i < rounds; ++i) read(test::Mutated(seed, random));
}

TEST(DamagedFiles, DoNotCrashTheBvhReader) {
  const std::string seed =
      "HIERARCHY\nROOT Hips\n{\n OFFSET 1 2 3\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
      "Yrotation\n"
      " JOINT A\n {\n  OFFSET 0 5 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n  End Site\n  {\n   OFFSET 0 1 0\n  "
      "}\n"
      " }\n}\nMOTION\nFrames: 2\nFrame Time: 0.0333\n1 2 3 4 5 6 7 8 9\n1 2 3 4 5 6 7 8 9\n";
  int read = 0;
  Survives(seed, 20000, [&](const std::string& bytes) {
    const auto bvh = ParseBvh(bytes, "damaged");
    if (!bvh) return;
    ++read;
    ASSERT_EQ(bvh->values.size(), static_cast<std::size_t>(bvh->frames) * bvh->channel_count);
    std::vector<Vector3d> positions;
    BvhForward(*bvh, bvh->frames - 1, positions);
    const auto again = ParseBvh(WriteBvh(*bvh), "again");
    ASSERT_TRUE(again) << again.error().Message() << "\n" << bytes;
    ASSERT_EQ(again->values, bvh->values);
  });
  EXPECT_GT(read, 100);
}

TEST(DamagedFiles, DoNotCrashTheJointTableReader) {
  std::string seed;
  for (int i = 0; i < 30; ++i) seed += "-133.46135 562.2903 2687.6377\n";
  JointTableLayout layout;
  layout.rows_per_frame = 3;
  Survives(seed, 20000, [&](const std::string& bytes) {
    const auto table = ParseJointTable(bytes, layout, "damaged");
    if (!table) return;
    ASSERT_EQ(table->values.size(), static_cast<std::size_t>(table->frames) * 3 * table->columns);
    for (const double value : table->values) ASSERT_TRUE(std::isfinite(value));
  });
}

TEST(DamagedFiles, DoNotCrashTheNpyReader) {
  NpyArray array;
  array.shape = {4, 2, 3};
  array.dtype = "<f4";
  array.values.assign(24, 1.5);
  Survives(WriteNpy(array), 20000, [](const std::string& bytes) {
    const auto read = ParseNpy(bytes, "damaged");
    if (!read) return;
    ASSERT_LE(read->values.size() * 4, bytes.size());
  });
}

TEST(DamagedFiles, DoNotCrashTheNpzReader) {
  Npz npz;
  npz.members.push_back({"a", MakeArray({4, 2}, {1, 2, 3, 4, 5, 6, 7, 8}, "<f4"), ""});
  npz.members.push_back({"t", MakeTextArray("male"), ""});
  Survives(EncodeNpz(npz, "seed").value(), 5000, [](const std::string& bytes) { (void)ParseNpz(bytes, "damaged"); });
}

/// Visits every value below a value, as a caller would.
void Visit(const PickleRef& value) {
  (void)value.Array();
  (void)value.Sparse();
  (void)value.Text();
  (void)value.Number();
  const bool pairs = value.kind() == PickleKind::kDict;
  for (std::size_t i = 0; i < value.size(); ++i) Visit(pairs ? value.ValueAt(i) : value.Item(i));
}

TEST(DamagedFiles, DoNotCrashThePickleReader) {
  int read = 0;
  for (const char* digits : {kPickleP0, kPickleP2, kPickleP4, kPickleP5, kPickleJoblib, kPickleCsc, kPickleCh0}) {
    Survives(FromHex(digits), 5000, [&](const std::string& bytes) {
      const auto pickle = ParsePickle(bytes, "damaged");
      if (!pickle) return;
      ++read;
      Visit(pickle->top());
    });
  }
  EXPECT_GT(read, 100);
}

TEST(DamagedFiles, DoNotCrashTheReadersOfBodyEstimates) {
  VibeTrack track;
  track.frames = 2;
  track.joints = 2;
  track.pose.assign(144, 0.5);
  track.joints3d.assign(12, 0.5);
  Survives(EncodeVibeTracks({track}, "seed").value(), 5000,
           [](const std::string& bytes) { (void)ParseVibeTracks(bytes, "damaged"); });
  HumanAct12Clip clip{1, std::vector<double>(72, 0.5), std::vector<double>(72, 0.5), 3};
  Survives(EncodeHumanAct12Pickle({clip}, "seed").value(), 5000,
           [](const std::string& bytes) { (void)ParseHumanAct12Pickle(bytes, "damaged"); });
}

TEST(DamagedFiles, DoNotCrashTheCloudAndMeshReaders) {
  const std::string header = "element vertex 2\nproperty float x\nproperty list uchar short n\nend_header\n";
  for (const std::string& seed : {"ply\nformat ascii 1.0\n" + header + "1.5 2 7 8\n2.5 0\n",
                                  "ply\nformat binary_big_endian 1.0\n" + header + std::string("abcd\1efghij\0", 12)}) {
    Survives(seed, 20000, [](const std::string& bytes) {
      const auto ply = ParsePly(bytes, "damaged");
      if (!ply) return;
      (void)PlyTriangles(*ply, "damaged");
      const auto again = ParsePly(WritePly(*ply), "again");
      ASSERT_TRUE(again && *again == *ply) << bytes;
    });
  }
  Pcd pcd;
  pcd.width = 2;
  pcd.missing = {0, 1};
  pcd.fields = {{"x", kFloat32, 1, {1, 0}}, {"rgb", kFloat32, 1, {7, 8}}};
  for (const Pcd::Encoding encoding :
       {Pcd::Encoding::kAscii, Pcd::Encoding::kBinary, Pcd::Encoding::kBinaryCompressed}) {
    pcd.encoding = encoding;
    Survives(WritePcd(pcd), 20000, [](const std::string& bytes) {
      const auto read = ParsePcd(bytes, "damaged");
      if (!read) return;
      const auto again = ParsePcd(WritePcd(*read), "again");
      ASSERT_TRUE(again && *again == *read) << bytes;
    });
  }
}

TEST(DamagedFiles, DoNotCrashTheKeypointAndCameraReaders) {
  Survives(R"({"version":1.3,"people":[{"person_id":[-1],"pose_keypoints_2d":[1,2,0.5,0,0,0]}]})", 20000,
           [](const std::string& bytes) {
             const auto frame = ParseOpenPose(bytes, "damaged");
             if (!frame) return;
             const auto again = ParseOpenPose(WriteOpenPose(*frame), "again");
             ASSERT_TRUE(again && again->people == frame->people) << bytes;
           });
  const std::string pose = R"("R":[[1,0,0],[0,1,0],[0,0,1]],"T":[[1],[2],[3]],"fx":4,"fy":4,"cx":1,"cy":1,)";
  for (const std::string& seed :
       {"{\"0\":{" + pose + R"("k":[0,0,0],"p":[0,0]}})",
        std::string(
            "[c]\nname = \"c\"\nsize = [ 10.0, 20.0,]\nmatrix = [ [ 5.0, 0.0, 1.0,], [ 0.0, 5.0, 2.0,], [ 0, 0, "
            "1,],]\ndistortions = [ 0.1, 0.2, 0.3, 0.4,]\nrotation = [1.0, 0, 0]\ntranslation = [0, 0, 4]\n"),
        std::string("<?xml version='1.0'?><calibration><cameras><camera serial='a'><fov_video left='0' top='0'/>"
                    "</camera></cameras></calibration>")}) {
    Survives(seed, 10000, [](const std::string& bytes) {
      const auto calibration = ParseCalibration(bytes, "damaged");
      if (!calibration) return;
      for (const CalibratedView& view : calibration->views) {
        const Camera camera = CameraOf(view, PoseConvention::kCentre, 0.001);
        ASSERT_TRUE(camera.Centre().allFinite() || !view.translation.allFinite()) << bytes;
      }
    });
  }
}

TEST(DamagedFiles, DoNotCrashTheDepthSequenceReader) {
  const std::string seed =
      R"({"body":"male","fps":12,"frames":1,"labels":[{"action":"idle","first":0,"last":0}],"views":{"d1":{"R_p_to_d":
      [[1,0,0],[0,1,0],[0,0,1]],"t_m":[1,2,3],"fx_fy_cx_cy":[360,361,250,200],"size":[512,424]}},"frames_data":[
      {"frame":0,"rotvec24":[[0,0,0],[0,0,1]],"translation_added":[0,1,0],"joints_m":[[1,2,3],[4,5,6]]}]})";
  Survives(seed, 5000, [](const std::string& bytes) {
    (void)ParseDepthSequence(bytes, "damaged");
    (void)ParseDepthSequenceTruth(bytes, "damaged");
  });
  Survives(std::string(100000, '['), 3, [](const std::string& bytes) { (void)ParseDepthSequence(bytes, "deep"); });
}

TEST(DamagedFiles, DoNotCrashTheAcclaimReader) {
  const std::string skeleton =
      ":version 1.10\n:units\n length 0.45\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n"
      ":bonedata\n begin\n id 1\n name a\n direction 1 0 0\n length 2\n axis 0 0 90 XYZ\n dof rx rz\n limits (-1 2)\n"
      " (-inf inf)\n end\n:hierarchy\n begin\n root a\n end\n";
  int read = 0;
  Survives(skeleton, 20000, [&](const std::string& bytes) {
    const auto asf = ParseAsf(bytes, "damaged");
    if (!asf) return;
    ++read;
    const std::string text = WriteAsf(*asf);
    const auto again = ParseAsf(text, "again");
    ASSERT_TRUE(again) << again.error().Message() << "\n" << bytes;
    ASSERT_EQ(WriteAsf(*again), text);
  });
  EXPECT_GT(read, 100);
  const Asf arm = ParseAsf(skeleton, "arm").value();
  Survives(":DEGREES\n1\nroot 1 2 3 4 5 6\na 7 8\n2\nroot 1 2 3 4 5 6\na 7 8\n", 20000, [&](const std::string& bytes) {
    for (const DamagedRows damaged : {DamagedRows::kRefuse, DamagedRows::kReport}) {
      const auto amc = ParseAmc(bytes, {&arm, damaged}, "damaged");
      if (!amc) continue;
      ASSERT_EQ(amc->values.size(), static_cast<std::size_t>(amc->frames) * 8u);
      std::vector<Vector3d> ends;
      AcclaimForward(arm, *amc, amc->frames - 1, ends);
      ASSERT_FALSE(ends[0].hasNaN());
    }
  });
}

TEST(DamagedFiles, DoNotCrashTheNtuSkeletonReader) {
  NtuSkeleton scene;
  scene.frames = {{NtuBody()}, {}, {NtuBody()}};
  scene.frames[0][0].id = 72057594037931649u;
  int read = 0;
  Survives(WriteNtuSkeleton(scene), 5000, [&](const std::string& bytes) {
    const auto skeleton = ParseNtuSkeleton(bytes, "damaged");
    if (!skeleton) return;
    ++read;
    ASSERT_TRUE(ParseNtuSkeleton(WriteNtuSkeleton(*skeleton), "again").value() == *skeleton);
  });
  EXPECT_GT(read, 10);
}

TEST(DamagedFiles, DoNotCrashTheJointLayoutReader) {
  Survives("frame 1*(rotation rotation_confidence x y z confidence) 1*(x y z)", 5000,
           [](const std::string& text) { (void)ParseJointLayout(text, "damaged"); });
  const JointLayout layout = ParseJointLayout("frame 2*(x y z)", "layout").value();
  JointTableLayout table;
  table.end_word = "END";
  table.damaged_rows = DamagedRows::kReport;
  Survives("1,2,3,4,5,6,7,\n2,2,3,4,5,6,7,\n3,2,3,4,5,6,7,\nEND\n", 20000, [&](const std::string& bytes) {
    const auto rows = ParseJointRows(bytes, layout, table, "damaged");
    if (!rows) return;
    ASSERT_EQ(rows->position.size(), static_cast<std::size_t>(rows->frames) * 6u);
    for (const double value : rows->position) ASSERT_TRUE(std::isfinite(value) || !rows->findings.empty());
  });
}

TEST(DamagedFiles, DoNotCrashTheTableAndListReaders) {
  Survives("Coordinates\nnRows=2\nnColumns=3\ninDegrees=yes\nendheader\ntime\ta\tb\n0\t1\t2\n1\t3\t4\n", 20000,
           [](const std::string& bytes) {
             const auto table = ParseOpenSimTable(bytes, "damaged");
             if (!table) return;
             ASSERT_EQ(table->values.size(),
                       table->time_s.size() * table->labels.size() * static_cast<std::size_t>(table->components));
           });
  Survives("1,2,3,0,0,1\n4,5,6,0,0,2\n", 20000,
           [](const std::string& bytes) { (void)ParseExpmapTable(bytes, "damaged", 0, DamagedRows::kReport); });
  Survives(R"({"content": 6, "style": 11})", 5000,
           [](const std::string& bytes) { (void)ParseBandaiLabel(bytes, "damaged"); });
  Survives("a12_d4_p007_c2_color.avi\na12_d4_p008_c2_color.avi\n", 5000, [](const std::string& bytes) {
    (void)ParseUestcNames(bytes, "damaged");
    (void)ParseUestcFrameCounts(bytes, "damaged");
  });
  PhspdPose pose;
  pose.frame = {3, 9};
  pose.position_m.assign(144, 0.5);
  Survives(WritePhspdPose(pose), 5000, [](const std::string& bytes) {
    (void)ParsePhspdPose(bytes, "damaged");
    (void)ParsePhspdShape(bytes, "damaged");
  });
}

}  // namespace
}  // namespace mocurate
