#include "core/formats/babel.h"
#include "core/formats/openpose.h"
#include "core/formats/uestc_info.h"
#include "tests/fuzz/seeds.h"

namespace mocurate {
namespace {

void AddLabels(FuzzSeeds& seeds) {
  BabelSequence sequence;
  sequence.key = "7";
  sequence.babel_sid = 7;
  sequence.url = "https://example.org";
  sequence.feat_p = "CMU/CMU/01/01_01_poses.npz";
  sequence.dur = 5.25;
  BabelAnnotation annotation;
  annotation.mul_act = true;
  annotation.labels = {{"walk", "walk", std::vector<std::string>{"walk"}, "s0", 0.0, 2.5},
                       {"turn", std::nullopt, std::nullopt, "s1", 2.0, 9.5}};
  sequence.frame_anns = {annotation};
  for (BabelLabel& label : annotation.labels) label.start_t = label.end_t = std::nullopt;
  sequence.seq_anns = {annotation};
  seeds.push_back({"babel", EncodeBabel({sequence})});
  sequence.extra = true;
  seeds.push_back({"babel", EncodeBabel({sequence})});
  seeds.push_back({"bandai_label", R"({"content": 6, "style": 11})"});
  seeds.push_back({"span_table", "clip,begin_s,end_s,label\nset/p1/r1,0.5,2.5,\"walk, slow\"\n"});
  seeds.push_back({"span_table", "clip,begin_frame,end_frame,label,fine_label\nr1,10,20,a,a1\n"});
  seeds.push_back({"span_table", "# names\nP01G01R01F0001T0064A0101.npy\n0111006901430102\n"});
  seeds.push_back({"bandai_label", "dataset-1_walk\ndataset-1_run\n"});
  seeds.push_back({"uestc_info", WriteUestcNames({{12, 4, 7, 2}, {3, 8, 118, 1}})});
  seeds.push_back({"uestc_info", WriteUestcFrameCounts({180, 0, 41})});
  std::string actions;
  for (int i = 0; i < 40; ++i) actions += "action-" + std::to_string(i) + "\n";
  seeds.push_back({"uestc_info", actions});
}

void AddDetections(FuzzSeeds& seeds) {
  OpenPoseFrame frame;
  frame.people.resize(2);
  frame.people[0].pose = {{1, 2, 0.5}, {0, 0, 0}};
  frame.people[1].pose = {{3, 4, 1}};
  seeds.push_back({"openpose", WriteOpenPose(frame)});
  seeds.push_back({"openpose",
                   R"({"version":0.7,"univTime":53541.5,"fpsType":"hd_29_97","bodies":[{"id":0,"joints15":[)"
                   "1,2,3,0.5,1,2,3,-1,1,2,3,0.5,1,2,3,0.5,1,2,3,0.5,1,2,3,0.5,1,2,3,0.5,1,2,3,0.5,"
                   "1,2,3,0.5,1,2,3,0.5,1,2,3,0.5,1,2,3,0.5,1,2,3,0.5,1,2,3,0.5,1,2,3,0.5]}]}"});
  seeds.push_back(
      {"depth_sequence",
       R"({"body":"male","fps":12,"frames":1,"labels":[{"action":"idle","first":0,"last":0}],"views":{"d1":{"R_p_to_d":
      [[1,0,0],[0,1,0],[0,0,1]],"t_m":[1,2,3],"fx_fy_cx_cy":[360,361,250,200],"size":[512,424]}},"frames_data":[
      {"frame":0,"rotvec24":[[0,0,0],[0,0,1]],"translation_added":[0,1,0],"joints_m":[[1,2,3],[4,5,6]]}]})"});
}

void AddCalibrations(FuzzSeeds& seeds) {
  const std::string k = R"("K":[[1000,0,500],[0,1000,500],[0,0,1]],)";
  const std::string pose = R"("R":[[1,0,0],[0,1,0],[0,0,1]],"t":[[1],[2],[3]])";
  const std::string rigid = "[1,0,0,0,10,20,30]", lens = "[1000,1000,500,500,0,0,0]";
  const std::string toml =
      "[c]\nname = \"c\"\nsize = [ 10.0, 20.0,]\nmatrix = [ [ 5.0, 0.0, 1.0,], [ 0.0, 5.0, 2.0,], [ 0, 0, 1,],]\n"
      "distortions = [ 0.1, 0.2, 0.3, 0.4,]\nrotation = [1.0, 0, 0]\ntranslation = [0, 0, 4]\nfisheye = false\n";
  const std::string xml =
      R"(<?xml version="1.0"?><calibration><cameras><camera serial="a &amp; b"><fov_video left="0" top="0" right="99" bottom="49"/>
<transform r11="1" r12="0" r13="0" r21="0" r22="1" r23="0" r31="0" r32="0" r33="1" x="1000" y="0" z="0"/>
<intrinsic focalLengthU="6400" focalLengthV="6400" centerPointU="3200" centerPointV="1600" skew="0" radialDistortion1="0"
radialDistortion2="0" radialDistortion3="0" tangentalDistortion1="0" tangentalDistortion2="0"/></camera></cameras></calibration>)";
  for (
      const std::string& text :
      {R"({"units":"mm","convention":"x_cam = R X_world + t","cameras":[{"name":"a","size":[100,50],)" + k +
           R"("dist_k1k2p1p2k3":[0.1,0,0,0,0],)" + pose + "}]}",
       R"({"intrinsics":{"54138969":{"calibration_matrix":[[1000,0,500],[0,1000,500],[0,0,1]],"distortion":[0,0,0,0,0]}},)"
       R"("extrinsics":{"S1":{"54138969":{)" +
           pose + "}}}}",
       std::string(R"({"0":{"R":[[1,0,0],[0,1,0],[0,0,1]],"T":[[1],[2],[3]],"fx":4,"fy":4,"cx":1,"cy":1,"k":[0,0,0],)"
                   R"("p":[0,0]}})"),
       R"({"cameras":[{"name":"00_01","type":"hd","resolution":[1920,1080],)" + k + R"("distCoef":[0,0,0,0,0],)" +
           pose + "}]}",
       R"({"units":"mm","rig":{"A":{"d1p":)" + rigid + R"(,"cd1":)" + rigid + R"(,"param_p":)" + lens +
           R"(,"param_d1":)" + lens + R"(,"param_c1":)" + lens + R"(,"p1w":[)" + rigid + "]}}}",
       toml, xml}) {
    seeds.push_back({"camera_files", text});
  }
  seeds.push_back(
      {"camera_files", "a.b = 1_000 # x\n\"d e\" = 'x\\y'\nt = { f = [1,\n 2], g.h = true }\n[[l]]\nk = 1979-05-27\n"});
  seeds.push_back({"camera_files", "<a><!-- c --><b x='1'/><![CDATA[ < ]]><?p?>&#65;</a>"});
  const std::string nine = "3\n   cols: 3\n   dt: d\n   data: [ 1000, 0, 500, 0, 1000, 400,\n       0, 0, 1. ]\n";
  const std::string three = ": !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 0, 0.5, 1 ]\n";
  const std::string names = "%YAML:1.0\n---\nnames:\n   - \"1\"\n";
  seeds.push_back({"camera_files", names + "K_1: !!opencv-matrix\n   rows: " + nine +
                                       "dist_1: {rows: 1, cols: 4, data: [0, 0, 0, 0]}\nW_1: 640\n" +
                                       std::string(1, '\0') + names + "R_1" + three + "T_1" + three});
  const auto matrix = [](const std::string& key, const std::string& shape, const std::string& numbers) {
    return "<" + key + " type_id=\"opencv-matrix\">" + shape + "<data>" + numbers + "</data></" + key + ">\n";
  };
  const std::string square = "<rows>3</rows><cols>3</cols><dt>f</dt>";
  seeds.push_back({"camera_files", "<?xml version=\"1.0\"?>\n<opencv_storage>\n" +
                                       matrix("intrinsic", square, "525. 0. 320. 0. 525. 240. 0. 0. 1.") +
                                       matrix("R", square, "1 0 0 0 1 0 0 0 1") +
                                       matrix("t", "<rows>3</rows><cols>1</cols>", "1 2 3") + "</opencv_storage>\n"});
}

void AddConfigurations(FuzzSeeds& seeds) {
  for (const std::string& text :
       {std::string("seed: 12\nheight: 180 cm\ntitle: \"a ${seed}\"\nlabels: {a01: walk}\ntrim:\n  enabled: false\n"),
        std::string("joints: [{name: x}, {name: '2', weight: 5}]\npeople: &p [a, b]\nlabels: {x: y}\n"),
        std::string("angle: 30 deg\nstep: 1/30 s\nrate: 25 fps\noffsets:\n- 10 cm\n- -0.5\n# remark\nloss: huber\n"),
        std::string("trim: {still_speed: 1}\0trim.still_speed=2 m/s", 46)}) {
    seeds.push_back({"config", text});
  }
  seeds.push_back({"pattern", "a{action}_s{person}_e{repetition}_realworld.txt\na01_s07_e03_realworld.txt"});
  seeds.push_back({"pattern", "P{person:2}G{group:2}A{action:4}.npy\nP01G02A0304.npy"});
  seeds.push_back({"pattern", "{a}/{b}_{a}.x\nq/r_q.x"});
  seeds.push_back(
      {"where", "label in [walk, 'run'] and frames >= 10 and not (person != p1 or id =~ '^kard/p[0-9]{1,2}')"});
  seeds.push_back({"where", "part('persons') == test or findings(skate) == 0 and segments(step) < 2"});
  seeds.push_back({"where", "provenance(style) not in [old] or rate == 30000/1001 and seconds > 0.5"});
}

}  // namespace

void AddNotedSeeds(FuzzSeeds& seeds) {
  AddLabels(seeds);
  AddDetections(seeds);
  AddCalibrations(seeds);
  AddConfigurations(seeds);
}

}  // namespace mocurate
