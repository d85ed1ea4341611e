#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/formats/amass.h"
#include "core/formats/array_fields.h"
#include "core/formats/c3d.h"
#include "core/formats/humanact12_pickle.h"
#include "core/formats/npz.h"
#include "core/formats/pickle_writer.h"
#include "core/formats/point_cloud.h"
#include "core/formats/safetensors.h"
#include "core/formats/smpl_model.h"
#include "core/formats/trc.h"
#include "core/formats/vibe_pickle.h"
#include "core/formats/zip_archive.h"
#include "tests/formats/pickle_samples.h"
#include "tests/fuzz/seeds.h"
#include "tests/support/cloud_writers.h"
#include "tests/support/smpl_model_writer.h"

namespace mocurate {
namespace {

void Add(FuzzSeeds& seeds, const std::string& target, const Expected<std::string>& bytes) {
  if (!bytes) {
    std::fprintf(stderr, "seed of %s: %s\n", target.c_str(), bytes.error().Message().c_str());
    std::abort();
  }
  seeds.push_back({target, *bytes});
}

void AddArrays(FuzzSeeds& seeds) {
  for (const char* type : {"<f4", ">f8", "<i8", "|u1", "<f2", "|b1"}) {
    Add(seeds, "npy", EncodeNpy(MakeArray({4, 2}, {1, 0, 1, 1, 0, 0, 1, 0}, type), "seed"));
  }
  Add(seeds, "npy", EncodeNpy(MakeTextArray("female"), "seed"));
  Npz npz;
  npz.members.push_back({"a", MakeArray({4, 2}, {1, 2, 3, 4, 5, 6, 7, 8}, "<f4"), ""});
  npz.members.push_back({"t", MakeTextArray("male"), ""});
  Add(seeds, "npz", EncodeNpz(npz, "seed"));
  for (const auto& [layout, columns] :
       {std::pair{Amass::Layout::kLegacy, 156}, std::pair{Amass::Layout::kSplit, 165}}) {
    Amass amass;
    amass.layout = layout;
    amass.rate_hz = 120.00004577636719;
    amass.gender = "female";
    amass.frames = 2;
    amass.pose_columns = static_cast<std::size_t>(columns);
    amass.poses.assign(2 * amass.pose_columns, 0.25);
    amass.translation_m = {0, 0.1, 0.9, 0, 0.2, 0.95};
    amass.betas = {0.5, -1};
    if (layout == Amass::Layout::kSplit) amass.surface_model = "smplx";
    Add(seeds, "amass", EncodeAmass(amass, "seed"));
  }
}

SmplModel SmallModel() {
  SmplModel model;
  model.vertices = 4;
  model.joints = 3;
  model.shapes = 2;
  model.pose_columns = 18;
  model.v_template = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  model.shapedirs.assign(24, 0.1);
  model.posedirs.assign(4 * 3 * 18, 0.01);
  model.joint_regressor = {1, 0, 0, 0, 0, 0.5, 0.5, 0, 0, 0, 0, 1};
  model.weights = {1, 0, 0, 0.5, 0.5, 0, 0, 1, 0, 0, 0, 1};
  model.parents = {-1, 0, 1};
  model.faces = {0, 1, 2, 0, 2, 3};
  return model;
}

void AddPickles(FuzzSeeds& seeds) {
  for (const char* digits : {kPickleP0, kPickleP1, kPickleP2, kPickleP3, kPickleP4, kPickleP5, kPickleJoblib,
                             kPickleCsc, kPickleCsr, kPickleCh2, kPickleCh0, kPickleFortran, kPicklePy2}) {
    seeds.push_back({"pickle", FromHex(digits)});
  }
  VibeTrack track;
  track.id = 3;
  track.frames = 2;
  track.joints = 2;
  track.pose.assign(144, 0.5);
  track.joints3d.assign(12, 0.5);
  track.betas.assign(20, 0.25);
  track.original_camera.assign(8, 1);
  track.frame_ids = {0, 4};
  Add(seeds, "vibe_pickle", EncodeVibeTracks({track}, "seed"));
  track.id = 0;
  track.frame_ids.clear();
  Add(seeds, "vibe_pickle", EncodeVibeCache({track, track}, "seed"));
  const HumanAct12Clip clip{1, std::vector<double>(72, 0.5), std::vector<double>(72, 0.5), 3};
  Add(seeds, "humanact12_pickle", EncodeHumanAct12Pickle({clip, clip}, "seed"));
  seeds.push_back({"mdm_results", FromHex(kMdmResults)});
  const std::string model = EncodeSmplModelNpz(SmallModel(), "seed").value();
  seeds.push_back({"smpl_model", model});
  PickleWriter writer;
  writer.BeginDict();
  const Npz members = ParseNpz(model, "seed").value();
  for (const NpzMember& member : members.members) {
    writer.Text(member.name);
    writer.Array(member.array);
  }
  writer.End();
  Add(seeds, "smpl_model", writer.Finish("seed"));
}

/// {"w": 2 x 3 floats} of torch.save, in the format before zip files and in the zip format.
void AddTorch(FuzzSeeds& seeds) {
  const auto pickle = [](const std::string& body) { return std::string("\x80\x02", 2) + body + "."; };
  const auto text = [](const std::string& value) {
    return std::string("X") + static_cast<char>(value.size()) + std::string(3, '\0') + value;
  };
  const auto object = [&](const std::string& end_of_storage) {
    const std::string storage =
        "((" + text("storage") + "ctorch\nFloatStorage\n" + text("7") + text("cpu") + "K\x06" + end_of_storage + "tQ";
    return "}" + text("w") + "ctorch._utils\n_rebuild_tensor_v2\n" + storage +
           std::string("K\0K\x02K\x03\x86K\x03K\x01\x86\x89NtRs", 16);
  };
  const std::string numbers(24, '\0');
  seeds.push_back({"torch_pickle", std::string("\x80\x02\x8a\x0a\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19\x2e", 15) +
                                       pickle(std::string("M\xe9\x03", 3)) +
                                       pickle("}" + text("little_endian") + "\x88s") + pickle(object("N")) +
                                       pickle("](" + text("7") + "e") + std::string("\x06\0\0\0\0\0\0\0", 8) +
                                       numbers});
  Add(seeds, "torch_pickle",
      WriteStoredZip({{"archive/data.pkl", pickle(object(""))}, {"archive/data/7", numbers}}, "seed"));
}

void AddNetworks(FuzzSeeds& seeds) {
  Safetensors file;
  file.metadata = {{"format", "pt"}};
  file.tensors = {{"weight", {2, 3}, {1, 2, 3, 4, 5, 6}}, {"bias", {2}, {0.5F, -1}}, {"scale", {}, {1}}};
  seeds.push_back({"safetensors", EncodeSafetensors(file)});
  seeds.push_back({"safetensors", EncodeSafetensors({})});
}

void AddMarkers(FuzzSeeds& seeds) {
  C3dFile c3d;
  c3d.frames = 3;
  c3d.first_frame = 5;
  c3d.rate_hz = 100.0;
  c3d.scale = 0.1;
  c3d.units = "mm";
  c3d.x_screen = "+X";
  c3d.y_screen = "+Z";
  c3d.points = {{"A:LKNE", "knee", ""}, {"A:LHipAngles", "", "ANGLES"}};
  c3d.values = {1, 2, 3, 4, 5, 6, 0, 0, 0, 7, 8, 9, -1, -2, -3, 1e3, 2e3, 3e3};
  c3d.residual = {0.1F, 0.2F, -1.0F, 0.0F, 0.3F, 0.0F};
  for (const C3dProcessor processor : {C3dProcessor::kIntel, C3dProcessor::kDec, C3dProcessor::kSgi}) {
    c3d.processor = processor;
    c3d.floats = !c3d.floats;
    Add(seeds, "c3d", WriteC3d(c3d, "seed"));
  }
  TrcFile trc;
  trc.rate_hz = 100.0;
  trc.units = "mm";
  trc.names = {"LKNE", "C 7"};
  trc.frame_number = {1, 2, 4};
  trc.time_s = {0.0, 0.01, 0.03};
  trc.values = {1, 2, 3, NAN, NAN, NAN, 4, 5, 6, 7, 8, 9, -1, -2, -3.5, 1e3, 2, 1};
  seeds.push_back({"trc", WriteTrc(trc)});
  seeds.push_back({"trc", "PathFileType 4 (X/Y/Z) a\nDataRate NumFrames Units\n50 1 m\nFrame# Time A\n1 0 1 2 3\n"});
  seeds.push_back(
      {"trc", "PathFileType,4,(X/Y/Z),a\r\nDataRate,Units\r\n50,\r\nFrame#,Time,A,,,B\r\n1,0,1,2,3,,,NaN\r\n"});
}

void AddClouds(FuzzSeeds& seeds) {
  Ply ply;
  PlyElement vertices{"vertex", 3, {}};
  for (const char* axis : {"x", "y", "z"}) vertices.properties.push_back({axis, kFloat32, {}, {1, 2, 3}, {}});
  PlyElement faces{"face", 1, {{"vertex_indices", kInt32, kUint8, {0, 1, 2}, {0, 3}}}};
  ply.elements = {vertices, faces};
  using PlyEncoding = Ply::Encoding;
  for (const auto encoding : {PlyEncoding::kAscii, PlyEncoding::kBinaryLittleEndian, PlyEncoding::kBinaryBigEndian}) {
    ply.encoding = encoding;
    seeds.push_back({"ply", WritePly(ply)});
  }
  Pcd pcd;
  pcd.width = 2;
  pcd.missing = {0, 1};
  pcd.fields = {
      {"x", kFloat32, 1, {1, 0}}, {"y", kFloat32, 1, {2, 0}}, {"z", kFloat32, 1, {3, 0}}, {"rgb", kFloat32, 1, {7, 8}}};
  using PcdEncoding = Pcd::Encoding;
  for (const auto encoding : {PcdEncoding::kAscii, PcdEncoding::kBinary, PcdEncoding::kBinaryCompressed}) {
    pcd.encoding = encoding;
    seeds.push_back({"pcd", WritePcd(pcd)});
  }
}

}  // namespace

void AddBinarySeeds(FuzzSeeds& seeds) {
  AddArrays(seeds);
  AddPickles(seeds);
  AddTorch(seeds);
  AddNetworks(seeds);
  AddMarkers(seeds);
  AddClouds(seeds);
}

}  // namespace mocurate
