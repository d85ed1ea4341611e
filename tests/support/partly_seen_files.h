#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/formats/amass.h"
#include "core/formats/bvh.h"
#include "core/formats/c3d.h"
#include "core/formats/expmap_table.h"
#include "core/formats/humanact12_pickle.h"
#include "core/formats/npy.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/openpose.h"
#include "core/formats/panoptic_bodies.h"
#include "core/formats/phspd_text.h"
#include "core/formats/png.h"
#include "core/formats/trc.h"
#include "core/formats/vibe_pickle.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"
#include "tests/support/expmap_writer.h"

/// Small sets of many formats, some frames of which are without a person. Each builder writes its files into a folder
/// and returns the configuration of a job that reads them. The people are the studio's.
namespace mocurate::variants {

namespace fs = std::filesystem;

/// For each frame whether the person is seen.
using Seen = std::vector<bool>;

/// All frames but those of the spans [begin, end).
inline Seen Without(int frames, const std::vector<std::pair<int, int>>& spans) {
  Seen seen(static_cast<std::size_t>(frames), true);
  for (const auto& [begin, end] : spans) {
    for (int f = begin; f < end; ++f) seen[static_cast<std::size_t>(f)] = false;
  }
  return seen;
}

/// The folder that `mocurate synthesize` writes with these options, made once per process. Each test program defines
/// it.
const fs::path& Studio(const std::string& layout, const std::vector<std::string>& options);

inline std::string Contents(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

inline void Place(const fs::path& path, const std::string& bytes) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

/// A tracker that hardly errs.
inline std::vector<std::string> SteadyTracker(std::vector<std::string> more) {
  for (const char* error : {"noise=2 mm", "wander=0 mm", "dropout=0", "outlier=0", "swap=0"})
    more.push_back(std::string("tracker.") + error);
  return more;
}

/// True motions of two people on smpl24, 30 Hz, each with rotations; no two alike.
inline const std::vector<Motion>& Takes() {
  static const std::vector<Motion> takes = [] {
    const fs::path& studio =
        Studio("tracks", SteadyTracker({"actions=[walk, sit, boxing_right_left]", "subjects=2", "clips=2"}));
    std::vector<Motion> all;
    for (const char* person : {"p01", "p02"}) {
      const auto truth = ReadTruth(studio / "truth" / (std::string(person) + ".h5"));
      EXPECT_TRUE(truth) << truth.error().Message();
      if (!truth) continue;
      for (const auto& [id, motion] : truth->motion) all.push_back(motion);
    }
    return all;
  }();
  return takes;
}

/// Of a motion of `length` frames that goes to its end and back: the frame at `f`.
inline int ToAndFro(int f, int length) {
  const int period = 2 * (length - 1);
  const int at = f % period;
  return at < length ? at : period - at;
}

/// A take of any length: it goes to its end, and back.
inline Motion Lasting(const Motion& take, int frames) {
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  const int joints = take.joint_count();
  for (int f = 0; f < frames; ++f) {
    const int at = ToAndFro(f, take.frame_count());
    root.push_back(take.root_translation[static_cast<std::size_t>(at)]);
    for (int j = 0; j < joints; ++j) rotation.push_back(take.rotation_at(at, j));
  }
  for (int j = 0; j < joints; ++j) {
    MakeSignContinuous(rotation.data() + j, static_cast<std::size_t>(frames), static_cast<std::size_t>(joints));
  }
  return MakeMotion(take.skeleton, take.rate, std::move(root), std::move(rotation), take.bone_length);
}

inline Motion Take(int frames, std::size_t which = 0) { return Lasting(Takes().at(which), frames); }

inline std::string Digits(int number, int width) {
  const std::string text = std::to_string(number);
  return std::string(static_cast<std::size_t>(std::max(0, width - static_cast<int>(text.size()))), '0') + text;
}

/// A job with these lines under `ingest.source`, and `more` at the top level.
inline std::string Job(const fs::path& folder, const std::string& skeleton, const std::vector<std::string>& source,
                       const std::string& more = "") {
  std::string text = "name: v\nskeleton: \"" + skeleton + "\"\n" + more + "ingest:\n  path: " + folder.string() +
                     "\n  source:\n    name: v\n";
  for (const std::string& line : source) text += "    " + line + "\n";
  return text;
}

/// A job that includes a declaration of configs/sources.
inline std::string JobOf(const std::string& declaration, const fs::path& folder, const std::string& skeleton,
                         const std::vector<std::string>& source = {}, const std::string& more = "") {
  std::string text = "include: sources/" + declaration + ".yaml\nname: v\nskeleton: \"" + skeleton + "\"\n" + more +
                     "ingest:\n  path: " + folder.string() + "\n";
  if (!source.empty()) text += "  source:\n";
  for (const std::string& line : source) text += "    " + line + "\n";
  return text;
}

inline std::string List(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "[" : ", ") + word;
  return text + "]";
}

inline std::vector<std::string> JointNamesOf(const Skeleton& skeleton) {
  std::vector<std::string> names;
  for (const Joint& joint : skeleton.joints) names.push_back(joint.name);
  return names;
}

inline std::string Row(const Vector3d& at) {
  return " " + std::to_string(at.x()) + " " + std::to_string(at.y()) + " " + std::to_string(at.z());
}

const std::string kGiven = "fitting: {method: none}\n";

// Tables of joints.

/// Rows of zeros where no person is seen; `missing: zero` says so.
inline std::string ZeroTable(const fs::path& folder, const Seen& seen) {
  const Motion motion = Take(static_cast<int>(seen.size()));
  std::string text;
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < motion.joint_count(); ++j)
      text += Row(seen[static_cast<std::size_t>(f)] ? Vector3d(motion.joints.at(f, j)) : Vector3d::Zero());
    text += "\n";
  }
  Place(folder / "walk.txt", text);
  return Job(folder, "smpl24",
             {"format: joint_table", "files: \"{clip}.txt\"", "units: m", "axes: \"+x +y +z\"", "rate: 30 Hz",
              "skeleton: smpl24", "layout: \"24*(x y z)\"", "missing: zero", "person: p", "label: \"\"",
              "joints: " + List(JointNamesOf(*motion.skeleton))});
}

/// Numbered rows; those of frames without a person are left out. The first frame has the number `first`.
inline std::string NumberedTable(const fs::path& folder, const Seen& seen, int first = 1) {
  const Motion motion = Take(static_cast<int>(seen.size()));
  std::string text;
  for (int f = 0; f < motion.frame_count(); ++f) {
    if (!seen[static_cast<std::size_t>(f)]) continue;
    text += std::to_string(first + f);
    for (int j = 0; j < motion.joint_count(); ++j) text += Row(motion.joints.at(f, j));
    text += "\n";
  }
  Place(folder / "walk.txt", text);
  return Job(folder, "smpl24",
             {"format: joint_table", "files: \"{clip}.txt\"", "units: m", "axes: \"+x +y +z\"", "rate: 30 Hz",
              "skeleton: smpl24", "layout: \"frame 24*(x y z)\"", "person: p", "label: \"\"",
              "joints: " + List(JointNamesOf(*motion.skeleton))});
}

// Kinect v2.

/// One person seen by the middle camera of the studio's NTU.
inline NtuSkeleton NtuTake(int frames, int camera = 2) {
  const fs::path& studio =
      Studio("ntu", SteadyTracker({"actions=[hand_waving]", "subjects=1", "clips=1", "depth.enabled=false"}));
  NtuSkeleton take;
  for (const auto& entry : fs::directory_iterator(studio / "nturgb+d_skeletons")) {
    const std::string name = entry.path().filename().string();
    if (name.find("C" + Digits(camera, 3)) == std::string::npos) continue;
    const auto whole = ParseNtuSkeleton(Contents(entry.path()), name);
    EXPECT_TRUE(whole) << whole.error().Message();
    for (int f = 0; whole && f < frames; ++f) {
      take.frames.push_back(
          whole->frames[static_cast<std::size_t>(ToAndFro(f, static_cast<int>(whole->frames.size())))]);
    }
  }
  EXPECT_EQ(take.frames.size(), static_cast<std::size_t>(frames));
  return take;
}

/// Frames without bodies.
inline std::string NtuFile(const fs::path& folder, const Seen& seen) {
  NtuSkeleton take = NtuTake(static_cast<int>(seen.size()));
  for (std::size_t f = 0; f < seen.size(); ++f) {
    if (!seen[f]) take.frames[f].clear();
  }
  Place(folder / "S001C002P001R001A023.skeleton", WriteNtuSkeleton(take));
  return JobOf("ntu", folder, "ntu25");
}

inline const std::vector<std::string>& Kinect2Joints() {
  static const std::vector<std::string> names = {
      "spine_base",     "spine_mid",     "neck",       "head",           "left_shoulder",
      "left_elbow",     "left_wrist",    "left_hand",  "right_shoulder", "right_elbow",
      "right_wrist",    "right_hand",    "left_hip",   "left_knee",      "left_ankle",
      "left_foot",      "right_hip",     "right_knee", "right_ankle",    "right_foot",
      "spine_shoulder", "left_hand_tip", "left_thumb", "right_hand_tip", "right_thumb"};
  return names;
}

/// The numbers of a recorder of the Kinect v2: `column(frame)`, then x y z of 25 joints. Frames without a person have
/// no row.
inline std::string KinectTable(const fs::path& folder, const Seen& seen, const std::function<std::string(int)>& column,
                               const std::string& layout) {
  const NtuSkeleton take = NtuTake(static_cast<int>(seen.size()));
  std::string text;
  for (std::size_t f = 0; f < seen.size(); ++f) {
    if (!seen[f]) continue;
    text += column(static_cast<int>(f));
    for (const NtuJoint& joint : take.frames[f].at(0).joints)
      text += "," + std::to_string(joint.x_m) + "," + std::to_string(joint.y_m) + "," + std::to_string(joint.z_m);
    text += "\n";
  }
  Place(folder / "walk.csv", text);
  return Job(folder, "ntu25",
             {"format: joint_table", "files: \"{clip}.csv\"", "units: m", "axes: \"-x +y -z\"", "rate: 30 Hz",
              "skeleton: ntu25", "layout: \"" + layout + "\"", "person: p", "label: \"\"",
              "joints: " + List(Kinect2Joints())});
}

// Motion with rotations.

/// Rows of frames without a person are damaged. Centimetres.
inline std::string BvhText(const Motion& motion, const Seen& seen) {
  Bvh bvh;
  const double deg = 180.0 / M_PI;
  bvh.frames = motion.frame_count();
  bvh.frame_time_s = 1.0 / motion.rate.hz();
  for (const Joint& joint : motion.skeleton->joints) {
    BvhJoint out;
    out.name = joint.name;
    out.parent = joint.parent;
    out.offset = joint.parent < 0 ? Vector3d(Vector3d::Zero()) : Vector3d(100.0 * joint.rest_offset);
    if (joint.parent < 0) out.channels = {BvhChannel::kXPosition, BvhChannel::kYPosition, BvhChannel::kZPosition};
    out.channels.insert(out.channels.end(), {BvhChannel::kZRotation, BvhChannel::kYRotation, BvhChannel::kXRotation});
    out.first_channel = bvh.channel_count;
    bvh.channel_count += static_cast<int>(out.channels.size());
    bvh.joints.push_back(out);
  }
  for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
    const auto is_child = [&](const BvhJoint& other) { return other.parent == static_cast<int>(j); };
    if (std::any_of(bvh.joints.begin(), bvh.joints.end(), is_child)) continue;
    bvh.joints[j].has_end_site = true;
    bvh.joints[j].end_site = Vector3d(0.0, 5.0, 0.0);
  }
  for (int f = 0; f < bvh.frames; ++f) {
    const Vector3d root = 100.0 * motion.root_translation[static_cast<std::size_t>(f)];
    bvh.values.insert(bvh.values.end(), root.data(), root.data() + 3);
    for (int j = 0; j < motion.joint_count(); ++j) {
      const Matrix3d r = motion.rotation_at(f, j).toRotationMatrix();
      bvh.values.push_back(deg * std::atan2(r(1, 0), r(0, 0)));
      bvh.values.push_back(-deg * std::asin(std::clamp(r(2, 0), -1.0, 1.0)));
      bvh.values.push_back(deg * std::atan2(r(2, 1), r(2, 2)));
    }
  }
  std::string text = WriteBvh(bvh);
  std::size_t row = text.find('\n', text.find("Frame Time:")) + 1;
  for (const bool whole : seen) {
    if (!whole) text.insert(row, "x");
    row = text.find('\n', row) + 1;
  }
  return text;
}

inline std::vector<std::string> BvhSource(const std::string& files) {
  return {"format: bvh", "files: \"" + files + "\"", "units: cm", "axes: \"+x +y +z\"", "skeleton: \"\""};
}

inline std::string BvhFile(const fs::path& folder, const Seen& seen) {
  Place(folder / "walk.bvh", BvhText(Take(static_cast<int>(seen.size())), seen));
  std::vector<std::string> source = BvhSource("{clip}.bvh");
  source.insert(source.end(), {"person: p", "label: \"\""});
  return Job(folder, "", source, kGiven);
}

/// Frames without a person are NaN. World z up.
inline std::string AmassBytes(const Motion& motion, const Seen& seen) {
  const Quaterniond z_up(Eigen::AngleAxisd(0.5 * M_PI, Vector3d::UnitX()));
  Amass amass;
  amass.rate_hz = motion.rate.hz();
  amass.gender = "neutral";
  amass.frames = static_cast<std::size_t>(motion.frame_count());
  amass.pose_columns = 156;
  amass.poses.assign(amass.frames * amass.pose_columns, 0.0);
  amass.betas.assign(16, 0.0);
  for (int f = 0; f < motion.frame_count(); ++f) {
    const bool whole = seen[static_cast<std::size_t>(f)];
    for (int j = 0; j < 22; ++j) {
      const Quaterniond local = motion.rotation_at(f, j);
      const Vector3d vector = LogQuaternion(j == 0 ? z_up * local : local);
      for (int k = 0; k < 3; ++k)
        amass.poses[static_cast<std::size_t>(f) * 156 + static_cast<std::size_t>(3 * j + k)] =
            whole ? vector[k] : std::nan("");
    }
    const Vector3d root = z_up * motion.root_translation[static_cast<std::size_t>(f)];
    for (int k = 0; k < 3; ++k) amass.translation_m.push_back(whole ? root[k] : std::nan(""));
  }
  const auto bytes = EncodeAmass(amass, "walk_poses.npz");
  EXPECT_TRUE(bytes) << bytes.error().Message();
  return bytes ? *bytes : std::string();
}

inline std::vector<std::string> AmassSource(const std::string& files) {
  return {"format: amass", "files: \"" + files + "\"", "axes: \"+x -z +y\"", "skeleton: smpl24"};
}

inline std::string AmassFile(const fs::path& folder, const Seen& seen) {
  Place(folder / "walk_poses.npz", AmassBytes(Take(static_cast<int>(seen.size())), seen));
  std::vector<std::string> source = AmassSource("{take}_poses.npz");
  source.insert(source.end(), {"person: p", "label: \"\""});
  return Job(folder, "smpl24", source, kGiven);
}

/// The first frames of a recorded take at 120 Hz; numbers of frames without a person are passed over. Needs
/// MOCURATE_DATA.
inline std::string AmcFile(const fs::path& folder, const Seen& seen) {
  const fs::path recorded = fs::path(std::getenv("MOCURATE_DATA")) / "cmu/asf_amc";
  const std::string text = Contents(recorded / "01_01.amc");
  std::istringstream lines(text);
  std::string out, line;
  int frame = -1;  // of the recording; its numbers are lines of digits
  std::size_t number = 0;
  const auto seen_count = static_cast<int>(std::count(seen.begin(), seen.end(), true));
  while (std::getline(lines, line)) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (!line.empty() && line.find_first_not_of("0123456789") == std::string::npos) {
      if (++frame == seen_count) break;
      if (frame > 0) ++number;
      while (number < seen.size() && !seen[number]) ++number;
      line = std::to_string(number + 1);
    }
    out += line + "\n";
  }
  Place(folder / "01.asf", Contents(recorded / "01.asf"));
  Place(folder / "01_01.amc", out);
  return JobOf("cmu_amc", folder, "cmu31", {}, kGiven);
}

/// VIBE's track of a video of the studio; `frame_ids` pass over frames without a person.
inline VibeTrack TrackOfVibe(const Seen& seen) {
  const fs::path& studio = Studio("ntu_vibe", SteadyTracker({"actions=[hand_waving]", "subjects=1", "clips=1"}));
  VibeTrack track;
  for (const auto& entry : fs::directory_iterator(studio / "ntu13")) {
    if (entry.path().extension() != ".pkl") continue;
    const auto whole = ParseVibeTracks(Contents(entry.path()), "take.pkl");
    EXPECT_TRUE(whole) << whole.error().Message();
    if (!whole) continue;
    const VibeTrack& from = whole->at(0);
    track.id = 1;
    track.joints = from.joints;
    const int length = static_cast<int>(from.frames);
    for (int f = 0; f < static_cast<int>(seen.size()); ++f) {
      if (!seen[static_cast<std::size_t>(f)]) continue;
      ++track.frames;
      track.frame_ids.push_back(f);
      for (const auto field : {&VibeTrack::pose, &VibeTrack::joints3d, &VibeTrack::betas, &VibeTrack::original_camera,
                               &VibeTrack::predicted_camera, &VibeTrack::boxes}) {
        const auto width = static_cast<std::ptrdiff_t>((from.*field).size() / from.frames);
        const auto row = (from.*field).begin() + width * ToAndFro(f, length);
        (track.*field).insert((track.*field).end(), row, row + width);
      }
    }
  }
  return track;
}

inline std::string VibeBytes(const Seen& seen) {
  const auto bytes = EncodeVibeTracks({TrackOfVibe(seen)}, "take.pkl");
  EXPECT_TRUE(bytes) << bytes.error().Message();
  return bytes ? *bytes : std::string();
}

inline std::string VibeFile(const fs::path& folder, const Seen& seen) {
  Place(folder / "take.pkl", VibeBytes(seen));
  return Job(folder, "smpl24",
             {"format: vibe_tracks", "files: \"{take}.pkl\"", "skeleton: smpl24", "axes: \"+x -y -z\"", "rate: 30 Hz",
              "track: \"1\"", "person: p", "label: \"\""},
             kGiven);
}

/// An array (frames, 24, 3), NaN where no person is seen.
inline std::string ArrayBytes(const Motion& motion, const Seen& seen) {
  NpyArray array;
  array.shape = {static_cast<std::size_t>(motion.frame_count()), 24, 3};
  array.dtype = "<f4";
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int k = 0; k < 72; ++k) {
      array.values.push_back(seen[static_cast<std::size_t>(f)] ? motion.joints.xyz[static_cast<std::size_t>(72 * f + k)]
                                                               : std::nan(""));
    }
  }
  return WriteNpy(array);
}

inline std::vector<std::string> ArraySource(const std::string& files) {
  return {"format: npy", "files: \"" + files + "\"", "units: m", "axes: \"+x +y +z\"",
          "rate: 30 Hz", "skeleton: smpl24"};
}

inline std::string ArrayFile(const fs::path& folder, const Seen& seen) {
  Place(folder / "walk.npy", ArrayBytes(Take(static_cast<int>(seen.size())), seen));
  std::vector<std::string> source = ArraySource("{clip}.npy");
  source.insert(source.end(), {"person: p", "label: \"\""});
  return Job(folder, "smpl24", source);
}

// Files of a frame each.

/// How the cameras of a recording are numbered.
struct CameraNumbers {
  std::size_t camera = 1;  ///< in the order of their names
  int first = 0;           ///< number of its first file; the others begin at 0
  int late = 0;            ///< frames that it lacks at the beginning
};

inline const fs::path& KeypointStudio() {
  return Studio("openpose", {"actions=[walk]", "subjects=1", "clips=1", "keypoints.noise=1", "keypoints.miss=0",
                             "keypoints.wrong=0", "keypoints.bystander=0"});
}

/// Names of the studio's cameras.
inline std::vector<std::string> Cameras() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(KeypointStudio() / "openpose/walk_p01_r01")) {
    const std::string folder = entry.path().filename().string();
    names.push_back(folder.substr(0, folder.find("_json")));
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// The studio's cameras around one person; frames without a person list no people.
inline std::string OpenPoseFiles(const fs::path& folder, const Seen& seen, const CameraNumbers& numbers = {}) {
  const fs::path take = KeypointStudio() / "openpose/walk_p01_r01";
  const std::vector<std::string> cameras = Cameras();
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const std::string& camera = cameras[c];
    int length = 0;
    for (const auto& entry : fs::directory_iterator(take / (camera + "_json"))) length += entry.exists() ? 1 : 0;
    const bool other = c == numbers.camera;
    for (int f = other ? numbers.late : 0; f < static_cast<int>(seen.size()); ++f) {
      const std::string of = camera + "_json/" + camera + ".";
      Place(folder / "walk_p01_r01" / (of + Digits(f + (other ? numbers.first : 0), 4) + ".json"),
            seen[static_cast<std::size_t>(f)] ? Contents(take / (of + Digits(ToAndFro(f, length), 4) + ".json"))
                                              : WriteOpenPose(OpenPoseFrame()));
    }
  }
  fs::copy_file(KeypointStudio() / "openpose/calib.json", folder / "calib.json");
  return JobOf("studio_keypoints", folder, "smpl24", {"label: \"\""}, "fitting: {method: keypoints}\n");
}

inline std::string OpenPoseWhole(const fs::path& folder, const Seen& seen) { return OpenPoseFiles(folder, seen); }

/// Where a point of COCO-19 is, by the joints of SMPL.
inline Vector3d Coco19Point(const Motion& motion, int f, const std::string& name) {
  const auto at = [&](const char* joint) {
    return Vector3d(motion.joints.at(f, motion.skeleton->FindJoint(joint).value()));
  };
  const Vector3d side = (at("left_hip") - at("right_hip")).normalized();
  const Vector3d up = Vector3d::UnitY();
  const Vector3d ahead = side.cross(up).normalized();
  if (name == "mid_hip") return 0.5 * (at("left_hip") + at("right_hip"));
  if (name == "nose") return at("head") + 0.11 * ahead + 0.03 * up;
  if (name == "left_eye") return at("head") + 0.10 * ahead + 0.06 * up + 0.03 * side;
  if (name == "right_eye") return at("head") + 0.10 * ahead + 0.06 * up - 0.03 * side;
  if (name == "left_ear") return at("head") + 0.02 * ahead + 0.05 * up + 0.07 * side;
  if (name == "right_ear") return at("head") + 0.02 * ahead + 0.05 * up - 0.07 * side;
  return at(name.c_str());
}

/// CMU Panoptic: centimetres, y down; frames without a person list no bodies.
inline std::string PanopticFiles(const fs::path& folder, const Seen& seen) {
  const Motion motion = Take(static_cast<int>(seen.size()));
  for (int f = 0; f < motion.frame_count(); ++f) {
    nlohmann::json body = {{"id", 0}, {"joints19", nlohmann::json::array()}};
    for (const std::string& name : PanopticJointNames()) {
      const Vector3d at = 100.0 * Coco19Point(motion, f, name);
      for (const double value : {at.x(), -at.y(), -at.z(), 0.9}) body["joints19"].push_back(value);
    }
    nlohmann::json scene = {{"version", 0.7}, {"univTime", 1000.0 + 100.0 * f / 3.0}, {"fpsType", "hd_29_97"}};
    scene["bodies"] = nlohmann::json::array();
    if (seen[static_cast<std::size_t>(f)]) scene["bodies"].push_back(body);
    Place(folder / "walk" / ("body3DScene_" + Digits(f, 8) + ".json"), scene.dump());
  }
  return JobOf("panoptic", folder, "ntu14", {"rate: 30 Hz", "subjects: 1", "person: p"},
               "fitting: {method: joint_tracks, other_joints: exclude}\n");
}

/// PLY files of points along the bones, at 30 Hz; frames without a person have no file.
inline std::string CloudFiles(const fs::path& folder, const Seen& seen) {
  const Motion motion = Take(static_cast<int>(seen.size()));
  constexpr int kAlong = 8, kAround = 4;
  for (int f = 0; f < motion.frame_count(); ++f) {
    if (!seen[static_cast<std::size_t>(f)]) continue;
    std::string rows;
    int count = 0;
    for (int j = 0; j < motion.joint_count(); ++j) {
      const int parent = motion.skeleton->joints[static_cast<std::size_t>(j)].parent;
      if (parent < 0) continue;
      const Vector3d a = motion.joints.at(f, parent), b = motion.joints.at(f, j);
      for (int k = 0; k < kAlong; ++k) {
        for (int r = 0; r < kAround; ++r, ++count) {
          const double angle = 2.0 * M_PI * r / kAround;
          rows += Row(a + (b - a) * k / kAlong + 0.05 * Vector3d(std::cos(angle), 0.0, std::sin(angle))) + "\n";
        }
      }
    }
    Place(folder / "walk" / ("scan_" + std::to_string(f) + ".ply"),
          "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
              "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + rows);
  }
  return Job(folder, "smpl24",
             {"format: clouds", "files: \"{recording}/scan_{frame}.ply\"", "units: m", "axes: \"+x +y +z\"",
              "rate: 30 Hz", "person: p", "recording: \"{recording}\"", "label: \"\""},
             "fitting: {method: point_clouds, solver: banded}\n");
}

// Formats that are read, and that no variant above needs.

/// PHSPD's pose.txt: rows with the number of their frame; frames without a person have none. y down.
inline std::string PhspdFile(const fs::path& folder, const Seen& seen) {
  const Motion motion = Take(static_cast<int>(seen.size()));
  PhspdPose pose;
  for (int f = 0; f < motion.frame_count(); ++f) {
    if (!seen[static_cast<std::size_t>(f)]) continue;
    pose.frame.push_back(100 + f);
    for (int j = 0; j < kPhspdJoints; ++j) {
      const Vector3d at = motion.joints.at(f, j);
      pose.position_m.insert(pose.position_m.end(), {at.x(), -at.y(), -at.z()});
    }
  }
  Place(folder / "pose/subject01_group1_time1/pose.txt", WritePhspdPose(pose));
  return JobOf("phspd", folder, "smpl24", {"rate: 30 Hz"});
}

/// The joints as points of a C3D file in millimetres; those of frames without a person are not seen.
inline std::string C3dMarkers(const fs::path& folder, const Seen& seen) {
  const Motion motion = Take(static_cast<int>(seen.size()));
  C3dFile c3d;
  c3d.frames = motion.frame_count();
  c3d.rate_hz = motion.rate.hz();
  c3d.units = "mm";
  for (const Joint& joint : motion.skeleton->joints) c3d.points.push_back({joint.name, "", ""});
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) {
      const Vector3d at = 1000.0 * motion.joints.at(f, j);
      c3d.values.insert(c3d.values.end(), at.data(), at.data() + 3);
      c3d.residual.push_back(seen[static_cast<std::size_t>(f)] ? 0.0F : -1.0F);
    }
  }
  Place(folder / "takes/one.c3d", *WriteC3d(c3d, "one.c3d"));
  return Job(folder, "smpl24",
             {"format: c3d", "files: \"takes/{recording}.c3d\"", "person: one", "units: mm", "axes: \"+x +y +z\"",
              "label: \"\""});
}

/// The same as TRC; frames without a person have empty cells, or no row.
inline std::string TrcMarkers(const fs::path& folder, const Seen& seen, bool without_rows) {
  const Motion motion = Take(static_cast<int>(seen.size()));
  TrcFile trc;
  trc.rate_hz = motion.rate.hz();
  trc.units = "m";
  for (const Joint& joint : motion.skeleton->joints) trc.names.push_back(joint.name);
  for (int f = 0; f < motion.frame_count(); ++f) {
    const bool there = seen[static_cast<std::size_t>(f)];
    if (!there && without_rows) continue;
    trc.frame_number.push_back(f + 1);
    trc.time_s.push_back(motion.rate.FrameTime(f));
    for (int j = 0; j < motion.joint_count(); ++j) {
      const Vector3d at = there ? Vector3d(motion.joints.at(f, j)) : Vector3d::Constant(std::nan(""));
      trc.values.insert(trc.values.end(), at.data(), at.data() + 3);
    }
  }
  Place(folder / "takes/one.trc", WriteTrc(trc));
  return Job(folder, "smpl24",
             {"format: trc", "files: \"takes/{recording}.trc\"", "person: one", "units: m", "axes: \"+x +y +z\"",
              "label: \"\""});
}

/// Exponential maps of the CMU set; rows of frames without a person are damaged.
inline std::string ExpmapFile(const fs::path& folder, const Seen& seen) {
  ExpmapTable table;
  table.frames = static_cast<int>(seen.size());
  table.joints = 38;
  for (int f = 0; f < table.frames; ++f) {
    table.root.insert(table.root.end(), {0.1 * f, 17.0, 0.3 * f});
    for (int k = 0; k < table.joints; ++k) {
      const double swing = k == 0 ? 0.0 : 0.1 * std::sin(0.1 * f + k);
      table.rotation_rad.insert(table.rotation_rad.end(), {swing, 0.5 * swing, 0.2 * swing});
    }
  }
  std::string text = WriteExpmapTable(table);
  std::size_t row = 0;
  for (const bool whole : seen) {
    if (!whole) text.insert(row, "x");
    row = text.find('\n', row) + 1;
  }
  Place(folder / "train/walking/walking_1.txt", text);
  return JobOf("cmu_expmap", folder, "cmu31", {"rate: 30 Hz"}, kGiven);
}

/// VIBE's output of a video of UESTC; `frame_ids` pass over frames without a person.
inline std::string UestcFile(const fs::path& folder, const Seen& seen, const std::string& rule = "uestc_corrected") {
  Place(folder / "a0_d0_p001_c1_color/vibe_output.pkl", VibeBytes(seen));
  return JobOf("uestc_vibe", folder, "smpl24", {"people: {rule: " + rule + "}"}, kGiven);
}

/// ACTOR's pickle of HumanAct12, NaN where no person is seen. y down.
inline std::string HumanAct12File(const fs::path& folder, const Seen& seen) {
  const Motion motion = Take(static_cast<int>(seen.size()));
  const Quaterniond half_turn(0.0, 1.0, 0.0, 0.0);
  HumanAct12Clip clip;
  clip.frames = seen.size();
  clip.label = 1;
  for (int f = 0; f < motion.frame_count(); ++f) {
    const bool whole = seen[static_cast<std::size_t>(f)];
    for (int j = 0; j < 24; ++j) {
      const Quaterniond local = motion.rotation_at(f, j);
      const Vector3d vector = LogQuaternion(j == 0 ? half_turn * local : local);
      const Vector3d at = half_turn * Vector3d(motion.joints.at(f, j));
      for (int k = 0; k < 3; ++k) {
        clip.poses.push_back(whole ? vector[k] : std::nan(""));
        clip.joints.push_back(whole ? at[k] : std::nan(""));
      }
    }
  }
  const auto bytes = EncodeHumanAct12Pickle({clip}, "humanact12poses.pkl");
  EXPECT_TRUE(bytes) << bytes.error().Message();
  Place(folder / "humanact12poses.pkl", bytes ? *bytes : std::string());
  return JobOf("humanact12_poses", folder, "humanact12", {"rate: 30 Hz"}, kGiven);
}

/// A dataset of one clip; frames without a person are stored as inferred.
inline std::string StoredFile(const fs::path& folder, const Seen& seen) {
  Dataset set;
  set.created_by = "a test";
  Clip clip;
  clip.motion = Take(static_cast<int>(seen.size()));
  set.skeleton = clip.motion->skeleton;
  clip.rate = clip.motion->rate;
  clip.identity = {"made", "p", "take", "", "", "", 0, static_cast<int>(seen.size())};
  clip.label = "walk";
  set.labels = {"walk"};
  for (const bool whole : seen)
    clip.motion->state.insert(clip.motion->state.end(), set.skeleton->joints.size(),
                              whole ? JointState::kObserved : JointState::kInferred);
  set.clips.push_back(std::move(clip));
  fs::create_directories(folder);
  const Status written = WriteDataset(set, folder / "set.h5");
  EXPECT_TRUE(written) << written.error().Message();
  return Job(folder, "",
             {"format: motions", "container: set.h5", "axes: \"+x +y +z\"", "person: \"{person}\"",
              "files: \"{source}/{person}/{recording}#{begin}-{end}\"", "recording: \"{recording}\"", "label: \"\""},
             kGiven);
}

/// A person's size of depth in front of nothing, which differs a little in every frame.
inline std::string DepthBytes(int frame) {
  DepthImage image{64, 48, std::vector<std::uint16_t>(64 * 48, 0)};
  for (int v = 8; v < 44; ++v) {
    for (int u = 24; u < 40; ++u)
      image.values[static_cast<std::size_t>(64 * v + u)] = static_cast<std::uint16_t>(2500 + 3 * (u + frame) % 50);
  }
  const auto png = EncodePng(image);
  EXPECT_TRUE(png) << png.error().Message();
  return png ? *png : std::string();
}

/// Depth images of two cameras, without those of frames without a person.
inline std::string DepthViewFiles(const fs::path& folder, const Seen& seen) {
  nlohmann::json rig = {{"units", "metre"}, {"convention", "x_cam = R X_world + t, x right, y down, z forward"}};
  for (const char* camera : {"a", "b"}) {
    const double side = camera[0] == 'a' ? 1.0 : -1.0;
    rig["cameras"].push_back({{"name", camera},
                              {"size", {64, 48}},
                              {"K", {{60.0, 0.0, 32.0}, {0.0, 60.0, 24.0}, {0.0, 0.0, 1.0}}},
                              {"dist_k1k2p1p2k3", {0.0, 0.0, 0.0, 0.0, 0.0}},
                              {"R", {{side, 0.0, 0.0}, {0.0, -1.0, 0.0}, {0.0, 0.0, -side}}},
                              {"t", {0.0, 1.0, 2.5}}});
    for (std::size_t f = 0; f < seen.size(); ++f) {
      if (seen[f])
        Place(folder / "walk" / (std::string(camera) + "_" + Digits(static_cast<int>(f), 4) + ".png"),
              DepthBytes(static_cast<int>(f)));
    }
  }
  Place(folder / "calib.json", rig.dump());
  return Job(folder, "smpl24",
             {"format: depth_views", "files: \"{recording}/{camera}_{frame}.png\"", "calibration: [calib.json]",
              "axes: \"+x +y +z\"", "rate: 30 Hz", "person: p", "recording: \"{recording}\"", "label: \"\""});
}

/// The same with the JSON of a depth sequence, which states the number of frames.
inline std::string DepthSequenceFiles(const fs::path& folder, const Seen& seen) {
  nlohmann::json sequence = {{"fps", 30}, {"frames", seen.size()}, {"labels", nlohmann::json::array()}};
  for (const char* view : {"d1", "d2"}) {
    sequence["views"][view] = {{"R_p_to_d", {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}},
                               {"t_m", {view[1] == '1' ? 0.0 : 0.4, 0.0, 0.0}},
                               {"fx_fy_cx_cy", {60.0, 60.0, 32.0, 24.0}},
                               {"size", {64, 48}}};
    for (std::size_t f = 0; f < seen.size(); ++f) {
      if (seen[f])
        Place(folder / "depth" / (std::string(view) + "_" + Digits(static_cast<int>(f), 4) + ".png"),
              DepthBytes(static_cast<int>(f)));
    }
  }
  Place(folder / "seq_p.json", sequence.dump());
  return JobOf("rendered_seq", folder, "smpl24");
}

}  // namespace mocurate::variants
