#include "core/formats/amc.h"
#include "core/formats/bvh.h"
#include "core/formats/expmap_table.h"
#include "core/formats/joint_table.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/phspd_text.h"
#include "tests/fuzz/seeds.h"
#include "tests/support/acclaim_writers.h"
#include "tests/support/expmap_writer.h"

namespace mocurate {
namespace {

void AddBvh(FuzzSeeds& seeds) {
  using C = BvhChannel;
  const std::vector<C> rotations = {C::kZRotation, C::kXRotation, C::kYRotation};
  std::vector<C> all = {C::kXPosition, C::kYPosition, C::kZPosition};
  all.insert(all.end(), rotations.begin(), rotations.end());
  Bvh bvh;
  bvh.joints = {{"Hips", -1, {1, 2, 3}, all, 0, false, {}},
                {"Knee", 0, {0, 5, 0}, rotations, 6, true, {0, 1, 0}},
                {"Spine", 0, {0, -5, 0}, {}, 9, false, {}}};
  bvh.channel_count = 9;
  bvh.frames = 2;
  bvh.frame_time_s = 1.0 / 30;
  for (int i = 0; i < 18; ++i) bvh.values.push_back(1.5 * i - 3);
  seeds.push_back({"bvh", WriteBvh(bvh)});
  seeds.push_back(
      {"bvh",
       "HIERARCHY\r\nROOT a\r\n{\r\n OFFSET 0 0 0\r\n CHANNELS 1 Yposition\r\n End Site\r\n {\r\n  OFFSET 0 "
       "1 0\r\n }\r\n}\r\nMOTION\r\nFrames: 2\r\nFrame Time: 1\r\n3e1\r\n-.5\r\n"});
}

void AddAcclaim(FuzzSeeds& seeds) {
  const std::string text =
      ":version 1.10\n:name a\n:units\n mass 1\n length 0.45\n angle deg\n:documentation\n text\n:root\n order TX TY "
      "TZ RX "
      "RY RZ\n axis XYZ\n position 0 0 0\n orientation 0 0 0\n:bonedata\n begin\n id 1\n name a\n direction 1 0 0\n "
      "length "
      "2\n axis 0 0 90 XYZ\n dof rx rz\n limits (-1 2)\n (-inf inf)\n end\n begin\n id 2\n name b\n direction 0 1 0\n "
      "length 1\n axis 0 0 0 XYZ\n dof ry\n end\n:hierarchy\n begin\n root a\n a b\n end\n";
  const Asf asf = ParseAsf(text, "seed").value();
  seeds.push_back({"asf", WriteAsf(asf)});
  const std::string motion =
      "#!OML:ASF\n:FULLY-SPECIFIED\n:DEGREES\n1\nroot 1 2 3 4 5 6\na 7 8\nb 9\n2\nroot 1 2 3 4 5 6\na 7 8\nb 9\n";
  seeds.push_back({"amc", motion});
  seeds.push_back({"amc", WriteAmc(ParseAmc(motion, {&asf, DamagedRows::kRefuse}, "seed").value())});
}

void AddTables(FuzzSeeds& seeds) {
  JointTable table;
  table.frames = 3;
  table.rows_per_frame = 3;
  table.columns = 3;
  for (int i = 0; i < 27; ++i) table.values.push_back(-133.46135 + 562.2903 * i);
  seeds.push_back({"joint_table", WriteJointTable(table)});
  seeds.push_back({"joint_table", WriteJointTable(table, ',')});
  seeds.push_back({"joint_table", "1 nan 3\n4 5 6\n7 8 1e3\n"});
  seeds.push_back({"joint_layout", "frame 2*(x y z)\n1,2,3,4,5,6,7,\n2,2,3,4,5,6,7,\nEND\n"});
  seeds.push_back({"joint_layout",
                   "frame 1*(rotation rotation_confidence x y z confidence) skip\n"
                   "1,1,0,0,0,1,0,0,0,1,1,5,6,7,1,9\n"});
  ExpmapTable expmap;
  expmap.frames = 2;
  expmap.joints = 2;
  expmap.root = {1, 2, 3, 4, 5, 6};
  expmap.rotation_rad.assign(12, 0.25);
  seeds.push_back({"expmap_table", WriteExpmapTable(expmap)});
  seeds.push_back({"opensim_table",
                   "Coordinates\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\nendheader\n"
                   "time\ta\tb\n0\t1\t2\n1\t3\t4\n"});
  seeds.push_back({"opensim_table", "DataRate=100\nDataType=Vec3\nendheader\ntime\ta\n0\t1,2,3\n0.5\t4,5,6\n"});
}

void AddPeople(FuzzSeeds& seeds) {
  NtuSkeleton scene;
  scene.frames = {{NtuBody()}, {}, {NtuBody(), NtuBody()}};
  scene.frames[0][0].id = 72057594037931649u;
  scene.frames[2][1].id = 7;
  scene.frames[2][1].joints[3] = {0.1, -0.2, 3.5, 250, 200, 900, 500, 1, 0, 0, 0, 2};
  seeds.push_back({"ntu_skeleton", WriteNtuSkeleton(scene)});
  seeds.push_back({"ntu_skeleton", "S001C002P003R001A058.skeleton"});
  PhspdPose pose;
  pose.frame = {3, 9};
  pose.position_m.assign(144, 0.5);
  seeds.push_back({"phspd_text", WritePhspdPose(pose)});
  PhspdShape shape;
  shape.frame = {3};
  shape.translation_m.assign(3, 1.5);
  shape.betas.assign(kPhspdBetas, -0.5);
  shape.pose_rad.assign(72, 0.125);
  seeds.push_back({"phspd_text", WritePhspdShape(shape)});
  seeds.push_back({"phspd_text", "subject03_group2_time4"});
}

}  // namespace

void AddMotionSeeds(FuzzSeeds& seeds) {
  AddBvh(seeds);
  AddAcclaim(seeds);
  AddTables(seeds);
  AddPeople(seeds);
}

}  // namespace mocurate
