// Writes the first inputs of every fuzz target, made by the writers and builders of the tests: fuzz_seeds FOLDER.

#include <cstdio>
#include <filesystem>
#include <string>

#include "core/formats/bvh.h"
#include "core/formats/npy.h"
#include "tests/store/builders.h"
#include "train/checkpoint/checkpoint.h"

namespace {

namespace fs = std::filesystem;
using namespace mocurate;

class Seeds {
 public:
  explicit Seeds(fs::path folder) : folder_(std::move(folder)) {}

  fs::path Next(const std::string& target) {
    fs::create_directories(folder_ / target);
    return folder_ / target / ("seed" + std::to_string(count_++));
  }
  void Text(const std::string& target, const std::string& bytes) { test::PutBytes(Next(target), bytes); }
  void Check(const Status& written) {
    if (written) return;
    std::fprintf(stderr, "fuzz_seeds: %s\n", written.error().Message().c_str());
    failed_ = true;
  }
  bool failed() const { return failed_; }

 private:
  fs::path folder_;
  int count_ = 0;
  bool failed_ = false;
};

void Bvhs(Seeds& seeds) {
  const std::string start =
      "HIERARCHY\nROOT Hips\n{\n OFFSET 1 2 3\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
      "Yrotation\n";
  seeds.Text(
      "bvh",
      start +
          " JOINT A\n {\n  OFFSET 0 5 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n  End Site\n  {\n   "
          "OFFSET 0 1 0\n  }\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.0333\n1 2 3 4 5 6 7 8 9\n1 2 3 4 5 6 7 8 9\n");
  seeds.Text("bvh",
             start + " End Site\n {\n  OFFSET 0 1 0\n }\n}\nMOTION\nFrames: 1\nFrame Time: 1\n1 -2 3e1 .5 5. 6\n");
}

void Tables(Seeds& seeds) {
  std::string table;
  for (int i = 0; i < 9; ++i) table += "-133.46135 562.2903 2687.6377\n";
  seeds.Text("joint_table", table);
  seeds.Text("joint_table", "1,2,3\r\n4,5,6\r\n7,8,9\r\n");
  seeds.Text("joint_table", "1 nan 3\n4 5 6\n7 8 1e3\n");
}

void Npys(Seeds& seeds) {
  for (const char* type : {"<f4", "<f8"}) {
    NpyArray array;
    array.shape = {4, 2, 3};
    array.dtype = type;
    array.values.assign(24, 1.5);
    seeds.Text("npy", WriteNpy(array));
  }
}

void DepthSequences(Seeds& seeds) {
  seeds.Text(
      "depth_sequence",
      R"({"body":"male","fps":12,"frames":1,"labels":[{"action":"idle","first":0,"last":0}],"views":{"d1":{"R_p_to_d":
      [[1,0,0],[0,1,0],[0,0,1]],"t_m":[1,2,3],"fx_fy_cx_cy":[360,361,250,200],"size":[512,424]}},"frames_data":[
      {"frame":0,"rotvec24":[[0,0,0],[0,0,1]],"translation_added":[0,1,0],"joints_m":[[1,2,3],[4,5,6]]}]})");
}

/// {"w": 2 x 3 floats} as torch.save wrote it before zip files.
void TorchPickles(Seeds& seeds) {
  const auto pickle = [](const std::string& body) { return std::string("\x80\x02", 2) + body + "."; };
  const auto text = [](const std::string& value) {
    return std::string("X") + static_cast<char>(value.size()) + std::string(3, '\0') + value;
  };
  const std::string storage = "((" + text("storage") + "ctorch\nFloatStorage\n" + text("7") + text("cpu") + "K\x06NtQ";
  const std::string object = "}" + text("w") + "ctorch._utils\n_rebuild_tensor_v2\n" + storage +
                             std::string("K\0K\x02K\x03\x86K\x03K\x01\x86\x89NtRs", 16);
  const std::string bytes = std::string("\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19\x2e", 15) +
                            pickle(std::string("M\xe9\x03", 3)) + pickle("}" + text("little_endian") + "\x88s") +
                            pickle(object) + pickle("](" + text("7") + "e") + std::string("\x06\0\0\0\0\0\0\0", 8) +
                            std::string(24, '\0');
  seeds.Text("torch_pickle", bytes);
}

void Configs(Seeds& seeds) {
  seeds.Text("config",
             "seed: 12\nheight: 180 cm\ntitle: \"a ${seed}\"\nlabels: {a01: walk}\ntrim:\n  enabled: false\n");
  seeds.Text("config", "joints: [{name: x}, {name: '2', weight: 5}]\npeople: &p [a, b]\nlabels: {x: y}\n");
  seeds.Text("config", "angle: 30 deg\nstep: 1/30 s\nrate: 25 fps\noffsets:\n- 10 cm\n- -0.5\n# remark\nloss: huber\n");
  seeds.Text("config", std::string("trim: {still_speed: 1}\0trim.still_speed=2 m/s", 46));
}

void Patterns(Seeds& seeds) {
  seeds.Text("pattern", "a{action}_s{person}_e{repetition}_realworld.txt\na01_s07_e03_realworld.txt");
  seeds.Text("pattern", "P{person:2}G{group:2}A{action:4}.npy\nP01G02A0304.npy");
  seeds.Text("pattern", "{a}/{b}_{a}.x\nq/r_q.x");
}

void Stores(Seeds& seeds) {
  seeds.Check(WriteDataset(test::MakeDataset(), seeds.Next("store")));
  seeds.Check(WriteEvidence(test::MakeEvidenceClip(true), seeds.Next("store")));
  seeds.Check(WriteTruth(test::MakeTruth(), seeds.Next("store")));
}

void Checkpoints(Seeds& seeds) {
  Checkpoint checkpoint;
  checkpoint.kind = kGruRecogniserKind;
  checkpoint.labels = {"a", "b"};
  checkpoint.skeleton = test::Walker();
  checkpoint.history["loss"] = {3.0, 2.0};
  AddLinear("classifier", 3, 2, checkpoint.parameters);
  Random random(1, "seeds");
  Initialise(checkpoint.parameters, random);
  seeds.Check(WriteCheckpoint(checkpoint, seeds.Next("checkpoint")));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
    return 2;
  }
  Seeds seeds{fs::path(argv[1])};
  Bvhs(seeds);
  Tables(seeds);
  Npys(seeds);
  DepthSequences(seeds);
  TorchPickles(seeds);
  Configs(seeds);
  Patterns(seeds);
  Stores(seeds);
  Checkpoints(seeds);
  return seeds.failed() ? 74 : 0;
}
