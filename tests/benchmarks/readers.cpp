// bench_readers FOLDER make: writes a folder of files per set below FOLDER, recorded ones from $MOCURATE_DATA, the
// others synthetic. bench_readers FOLDER SET|all [REPEATS]: reads every file of a set from memory; one JSON line per
// set. bench_readers FOLDER SET memory: reads every file of a set from the disk, one at a time; one JSON line with the
// peak memory. readers.py reads the same folders with NumPy and Python; compare_readers.py runs both.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "core/base/file.h"
#include "core/formats/amass.h"
#include "core/formats/amc.h"
#include "core/formats/array_fields.h"
#include "core/formats/babel.h"
#include "core/formats/bvh.h"
#include "core/formats/c3d.h"
#include "core/formats/expmap_table.h"
#include "core/formats/humanact12_pickle.h"
#include "core/formats/joint_table.h"
#include "core/formats/npy.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/openpose.h"
#include "core/formats/opensim_table.h"
#include "core/formats/phspd_text.h"
#include "core/formats/point_cloud.h"
#include "core/formats/trc.h"
#include "core/formats/vibe_pickle.h"
#include "tests/benchmarks/json_line.h"
#include "tests/support/cloud_writers.h"
#include "tests/support/humanact12_clips.h"

#ifdef MOCURATE_ASSIMP
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

namespace {

using namespace mocurate;
namespace fs = std::filesystem;

/// Whether the file was read.
using Read = bool (*)(const std::string& bytes);

bool ReadTable(const std::string& bytes, int rows_per_frame) {
  JointTableLayout layout;
  layout.rows_per_frame = rows_per_frame;
  return ParseJointTable(bytes, layout, "file").has_value();
}

struct Set {
  const char* name;
  const char* recorded;  ///< folder below $MOCURATE_DATA; null: synthetic
  const char* ending;
  Read read;
};

const Set kSets[] = {
    {"kard", "kinect/kard", "_realworld.txt", [](const std::string& bytes) { return ReadTable(bytes, 15); }},
    {"florence3d", "kinect/florence3d", ".txt", [](const std::string& bytes) { return ReadTable(bytes, 1); }},
    {"msr_action3d", "kinect/msr_action3d", "3D.txt", [](const std::string& bytes) { return ReadTable(bytes, 1); }},
    {"expmap", "cmu/expmap", ".txt", [](const std::string& bytes) { return ParseExpmapTable(bytes, "f").has_value(); }},
    {"phspd_pose", nullptr, ".txt", [](const std::string& bytes) { return ParsePhspdPose(bytes, "f").has_value(); }},
    {"opensim", "pose2sim", ".mot", [](const std::string& bytes) { return ParseOpenSimTable(bytes, "f").has_value(); }},
    {"bvh", "bvh/bandai1", ".bvh", [](const std::string& bytes) { return ParseBvh(bytes, "f").has_value(); }},
    {"c3d_float", "c3d_trc", "mocap36.c3d", [](const std::string& bytes) { return ParseC3d(bytes, "f").has_value(); }},
    {"c3d_integer", "c3d_trc", "Gait.c3d", [](const std::string& bytes) { return ParseC3d(bytes, "f").has_value(); }},
    {"trc", "c3d_trc", ".trc", [](const std::string& bytes) { return ParseTrc(bytes, "f").has_value(); }},
    {"ntu_skeleton", "ntu", ".skeleton", [](const std::string& b) { return ParseNtuSkeleton(b, "f").has_value(); }},
    {"amc", "cmu/asf_amc", ".amc", [](const std::string& bytes) { return ParseAmc(bytes, {}, "f").has_value(); }},
    {"npy", nullptr, ".npy", [](const std::string& bytes) { return ParseNpy(bytes, "f").has_value(); }},
    {"amass_npz", "amass_babel", ".npz", [](const std::string& bytes) { return ParseAmass(bytes, "f").has_value(); }},
    {"humanact12_pickle", nullptr, ".pkl",
     [](const std::string& bytes) { return ParseHumanAct12Pickle(bytes, "f").has_value(); }},
    {"uestc_pickle", nullptr, ".pkl",
     [](const std::string& bytes) {
       const auto cache = VibeCache::Open(bytes, "f");
       for (std::size_t i = 0; cache && i < cache->size(); ++i) {
         if (!cache->Track(i)) return false;
       }
       return cache.has_value();
     }},
    {"babel_json", nullptr, ".json", [](const std::string& bytes) { return ParseBabel(bytes, "f").has_value(); }},
    {"openpose_json", nullptr, ".json", [](const std::string& bytes) { return ParseOpenPose(bytes, "f").has_value(); }},
    {"ply_ascii", nullptr, ".ply", [](const std::string& bytes) { return ParsePly(bytes, "f").has_value(); }},
    {"ply_binary", nullptr, ".ply", [](const std::string& bytes) { return ParsePly(bytes, "f").has_value(); }},
    {"pcd", "rgbd100/views", ".pcd", [](const std::string& bytes) { return ParsePcd(bytes, "f").has_value(); }}};

std::vector<fs::path> FilesOf(const fs::path& folder, const std::string& ending) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool ends = name.size() >= ending.size() && name.substr(name.size() - ending.size()) == ending;
    if (entry.is_regular_file() && ends) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

double Wave(std::size_t i) { return static_cast<double>(i * 2654435761u % 20011) / 20011.0 - 0.5; }

std::vector<double> Waves(std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = Wave(i);
  return values;
}

/// A mesh of a sphere's grid.
Ply Sphere(Ply::Encoding encoding) {
  constexpr std::size_t kSide = 256;
  Ply ply;
  ply.encoding = encoding;
  PlyElement vertices{"vertex", kSide * kSide, {}};
  for (const char* axis : {"x", "y", "z"}) {
    vertices.properties.push_back({axis, kFloat32, {}, {}, {}});
    for (std::size_t i = 0; i < vertices.count; ++i) {
      vertices.properties.back().values.push_back(RoundedTo(kFloat32, Wave(7 * i + axis[0])));
    }
  }
  PlyProperty corners{"vertex_indices", kInt32, kUint8, {}, {0}};
  for (std::size_t i = 0; i + kSide + 1 < vertices.count; ++i) {
    for (const std::size_t corner : {i, i + 1, i + kSide}) corners.values.push_back(static_cast<double>(corner));
    corners.first.push_back(corners.values.size());
  }
  PlyElement faces{"face", corners.first.size() - 1, {corners}};
  ply.elements = {vertices, faces};
  return ply;
}

std::string Babel() {
  std::vector<BabelSequence> sequences;
  for (int i = 0; i < 4000; ++i) {
    BabelSequence sequence;
    sequence.key = std::to_string(i);
    sequence.babel_sid = i;
    sequence.url = "https://example.org/" + sequence.key + ".mp4";
    sequence.feat_p = "CMU/CMU/01/01_" + sequence.key + "_poses.npz";
    sequence.dur = 12.5;
    BabelAnnotation annotation;
    for (int k = 0; k < 8; ++k) {
      annotation.labels.push_back(
          {"walk forward", "walk", std::vector<std::string>{"walk"}, "s" + std::to_string(k), 1.5 * k, 1.5 * k + 1.25});
    }
    sequence.frame_anns = {annotation};
    for (BabelLabel& label : annotation.labels) label.start_t = label.end_t = std::nullopt;
    annotation.labels.resize(1);
    sequence.seq_anns = {annotation};
    sequences.push_back(std::move(sequence));
  }
  return EncodeBabel(sequences);
}

std::string OpenPose(std::size_t number) {
  OpenPoseFrame frame;
  frame.people.resize(3);
  for (OpenPosePerson& person : frame.people) {
    for (std::size_t i = 0; i < 25; ++i) {
      person.pose.push_back({960 + 700 * Wave(number + i), 540 + 400 * Wave(number + 3 * i), 0.75});
    }
  }
  return WriteOpenPose(frame);
}

/// Files of a synthetic set: (name, bytes).
std::vector<std::pair<std::string, std::string>> Made(const std::string& set) {
  if (set == "ply_ascii") return {{"a.ply", WritePly(Sphere(Ply::Encoding::kAscii))}};
  if (set == "ply_binary") return {{"a.ply", WritePly(Sphere(Ply::Encoding::kBinaryLittleEndian))}};
  if (set == "babel_json") return {{"train.json", Babel()}};
  if (set == "phspd_pose") {
    PhspdPose pose;
    for (int f = 0; f < 4000; ++f) pose.frame.push_back(f);
    pose.position_m = Waves(4000 * 72);
    for (double& value : pose.position_m) value = std::round(value * 1e6) / 1e6;
    return {{"pose.txt", WritePhspdPose(pose)}};
  }
  std::vector<std::pair<std::string, std::string>> files;
  if (set == "openpose_json") {
    for (std::size_t i = 0; i < 600; ++i) files.emplace_back(std::to_string(i) + ".json", OpenPose(i));
  } else if (set == "npy") {
    for (std::size_t i = 0; i < 200; ++i) {
      files.emplace_back(std::to_string(i) + ".npy", WriteNpy(MakeArray({100, 24, 3}, Waves(7200), "<f4")));
    }
  } else if (set == "humanact12_pickle") {
    const HumanAct12Clip clip{75, Waves(75 * 72), Waves(75 * 72), 3};
    files.emplace_back("a.pkl", EncodeHumanAct12Pickle(std::vector<HumanAct12Clip>(400, clip), "a").value());
  } else if (set == "uestc_pickle") {
    VibeTrack track;
    track.frames = 120;
    track.joints = 49;
    track.pose = Waves(120 * 72);
    track.joints3d = Waves(120 * 49 * 3);
    track.betas = Waves(120 * 10);
    track.original_camera = Waves(120 * 4);
    files.emplace_back("a.pkl", EncodeVibeCache(std::vector<VibeTrack>(200, track), "a").value());
  }
  return files;
}

int Make(const fs::path& folder) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) return std::fprintf(stderr, "MOCURATE_DATA is not set\n"), 1;
  for (const Set& set : kSets) {
    const fs::path own = folder / set.name;
    fs::remove_all(own);
    fs::create_directories(own);
    if (set.recorded == nullptr) {
      for (const auto& [name, bytes] : Made(set.name)) {
        if (!WriteFile(own / name, bytes)) return std::fprintf(stderr, "cannot write to %s\n", own.c_str()), 1;
      }
    } else {
      for (const fs::path& file : FilesOf(fs::path(data) / set.recorded, set.ending)) {
        fs::copy_file(file, own / file.filename(), fs::copy_options::overwrite_existing);
      }
    }
  }
  return 0;
}

#ifdef MOCURATE_ASSIMP
bool AssimpReads(const std::string& bytes, const char* ending) {
  Assimp::Importer importer;
  return importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, ending) != nullptr;
}
#endif

int Measure(const fs::path& folder, const Set& set, int repeats) {
  std::vector<std::string> files;
  double megabytes = 0;
  for (const fs::path& path : FilesOf(folder / set.name, set.ending)) {
    files.push_back(ReadFile(path).value());
    megabytes += static_cast<double>(files.back().size()) / 1e6;
    if (!set.read(files.back())) return std::fprintf(stderr, "%s was refused\n", path.c_str()), 1;
  }
  if (files.empty()) return std::fprintf(stderr, "%s is empty: run `make`\n", set.name), 1;
  benchmarks::Report((std::string("read_") + set.name).c_str(), megabytes, "MB", repeats, [&] {
    for (const std::string& bytes : files) {
      if (!set.read(bytes)) std::abort();
    }
  });
  if (std::string(set.name) == "c3d_float") {
    std::string copy;
    benchmarks::Report("copy_c3d_float", megabytes, "MB", repeats, [&] {
      for (const std::string& bytes : files) {
        copy.resize(bytes.size());
        std::memcpy(copy.data(), bytes.data(), bytes.size());
        benchmark::DoNotOptimize(copy.data());
      }
    });
  }
#ifdef MOCURATE_ASSIMP
  const std::string name = set.name;
  if (name == "bvh" || name.substr(0, 3) == "ply") {
    benchmarks::Report(("assimp_" + name).c_str(), megabytes, "MB", repeats, [&] {
      for (const std::string& bytes : files) {
        if (!AssimpReads(bytes, set.ending + 1)) std::abort();
      }
    });
  }
#endif
  return 0;
}

double PeakMegabytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

int Memory(const fs::path& folder, const Set& set) {
  const double before = PeakMegabytes();
  double most = 0, sum = 0;
  std::size_t count = 0;
  for (const fs::path& path : FilesOf(folder / set.name, set.ending)) {
    const std::string bytes = ReadFile(path).value();
    if (!set.read(bytes)) return std::fprintf(stderr, "%s was refused\n", path.c_str()), 1;
    most = std::max(most, static_cast<double>(bytes.size()) / 1e6);
    sum += static_cast<double>(bytes.size()) / 1e6;
    ++count;
  }
  std::printf(
      "{\"name\": \"memory_%s\", \"files\": %zu, \"MB\": %.3f, \"largest_file_MB\": %.3f, \"peak_MB\": %.1f, "
      "\"peak_before_MB\": %.1f}\n",
      set.name, count, sum, most, PeakMegabytes(), before);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: bench_readers FOLDER make | SET|all [REPEATS|memory]\nsets:");
    for (const Set& set : kSets) std::fprintf(stderr, " %s", set.name);
    std::fprintf(stderr, "\n");
    return 2;
  }
  const std::string wanted = argv[2];
  if (wanted == "make") return Make(argv[1]);
  const bool memory = argc > 3 && std::strcmp(argv[3], "memory") == 0;
  bool known = false;
  for (const Set& set : kSets) {
    if (wanted != "all" && wanted != set.name) continue;
    known = true;
    const int failed = memory ? Memory(argv[1], set) : Measure(argv[1], set, argc > 3 ? std::atoi(argv[3]) : 3);
    if (failed != 0) return failed;
  }
  return known ? 0 : (std::fprintf(stderr, "no set is named %s\n", argv[2]), 2);
}
