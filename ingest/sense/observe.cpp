#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/bvh.h"
#include "core/formats/depth_sequence.h"
#include "core/formats/npy.h"
#include "ingest/sense/observed_clip.h"

namespace mocurate {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr int kMostFrames = 256;  // of a BVH file: forward kinematics of more tells nothing new

/// A name without what exporters put before it, without case and separators: "mixamorig:LeftUpLeg" -> "leftupleg".
std::string PlainName(const std::string& name) {
  std::string plain;
  for (const char c : name.substr(name.rfind(':') == std::string::npos ? 0 : name.rfind(':') + 1)) {
    if (c >= 'A' && c <= 'Z')
      plain += static_cast<char>(c - 'A' + 'a');
    else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
      plain += c;
  }
  return plain;
}

/// 0 left, 1 right, -1 neither; `rest` is the name without its side.
int SideOf(const std::string& name, std::string& rest) {
  const std::string plain = PlainName(name);
  rest = plain;
  for (int side = 0; side < 2; ++side) {
    const std::string word = side == 0 ? "left" : "right";
    if (const std::size_t at = plain.find(word); at != std::string::npos) {
      rest.erase(at, word.size());
      return side;
    }
  }
  if (plain.empty()) return -1;
  const bool marked_end = name.size() > 2 && (name[name.size() - 2] == '_' || name[name.size() - 2] == '.');
  for (int side = 0; side < 2; ++side) {
    const char letter = side == 0 ? 'l' : 'r';
    if (marked_end && plain.back() == letter) {
      rest.pop_back();
      return side;
    }
    const bool camel = name.size() > 1 && name[0] == (side == 0 ? 'L' : 'R') && name[1] >= 'A' && name[1] <= 'Z';
    if (plain[0] == letter && (camel || (name.size() > 1 && name[1] == '_'))) {
      rest.erase(0, 1);
      return side;
    }
  }
  return -1;
}

bool Contains(const std::string& text, const std::vector<const char*>& words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

/// Knees, elbows and head by name, their neighbours by the tree: exporters agree on the former only.
HandednessPoints PointsOfTree(const Bvh& bvh) {
  HandednessPoints points;
  const auto child = [&](int joint) {
    for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
      if (bvh.joints[j].parent == joint) return static_cast<int>(j);
    }
    return -1;
  };
  for (std::size_t j = 0; j < bvh.joints.size(); ++j) {
    std::string rest;
    const int side = SideOf(bvh.joints[j].name, rest);
    const int joint = static_cast<int>(j);
    if (side < 0) {
      if (points.head < 0 && Contains(rest, {"head"})) points.head = joint;
      continue;
    }
    const bool knee = rest == "leg" || Contains(rest, {"knee", "shin", "calf", "lowerleg", "lowleg"});
    const bool elbow = Contains(rest, {"elbow", "forearm", "lowerarm", "lowarm"});
    if (knee && points.knee[side] < 0) {
      points.knee[side] = joint;
      points.hip[side] = bvh.joints[j].parent;
      points.ankle[side] = child(joint);
      if (points.ankle[side] >= 0) points.toe[side] = child(points.ankle[side]);
    }
    if (elbow && points.wrist[side] < 0) {
      points.shoulder[side] = bvh.joints[j].parent;
      points.wrist[side] = child(joint);
    }
  }
  return points;
}

Expected<std::vector<ObservedClip>> ObserveDepthSequence(std::string_view bytes, const std::string& name) {
  const auto sequence = ParseDepthSequence(bytes, name);
  if (!sequence) return Forward(sequence);
  ObservedClip clip;
  clip.format = "depth_sequence";
  clip.frames = sequence->frames;
  clip.rate_hz = sequence->fps;
  clip.skeleton_evidence = std::to_string(sequence->views.size()) + " depth views, no joints";
  clip.layout_evidence = std::to_string(sequence->views.size()) + " views, " + std::to_string(sequence->labels.size()) +
                         " annotated segments";
  clip.units = "m";
  clip.up = "-y";
  clip.handedness = "right";
  return std::vector<ObservedClip>{std::move(clip)};
}

}  // namespace

FileKind KindOf(std::string_view bytes) {
  if (bytes.substr(0, 6) == "\x93NUMPY") return FileKind::kNpy;
  if (bytes.substr(0, 3) == kByteOrderMark) bytes.remove_prefix(3);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n\f\v");
  if (first == std::string_view::npos) return FileKind::kEmpty;
  bytes.remove_prefix(first);
  if (bytes.substr(0, 9) == "HIERARCHY") return FileKind::kBvh;
  if (bytes[0] == '{') return FileKind::kJson;
  // A table: only numbers in the first lines.
  const std::string_view head = bytes.substr(0, 4096);
  const std::size_t end = head.size() < bytes.size() ? head.find_last_of(" \t\r\n,") : head.size();
  int numbers = 0;
  for (const std::string_view line :
       SplitText(head.substr(0, end == std::string_view::npos ? head.size() : end), '\n')) {
    for (const std::string_view part : SplitText(line, ',')) {
      for (const std::string_view word : SplitBlanks(Trim(part))) {
        if (Trim(word).empty()) continue;
        if (!ParseDouble(Trim(word))) return numbers >= 3 ? FileKind::kNumbers : FileKind::kUnknown;
        ++numbers;
      }
    }
  }
  return numbers >= 3 ? FileKind::kNumbers : FileKind::kUnknown;
}

std::string_view FormatName(FileKind kind) {
  switch (kind) {
    case FileKind::kBvh:
      return "bvh";
    case FileKind::kNpy:
      return "npy";
    case FileKind::kJson:
      return "depth_sequence";
    case FileKind::kNumbers:
      return "joint_table";
    case FileKind::kEmpty:
    case FileKind::kUnknown:
      break;
  }
  return "unknown";
}

Expected<std::vector<ObservedClip>> ObserveBvh(std::string_view bytes, const std::string& name) {
  const Expected<Bvh> bvh = ParseBvh(bytes, name);
  if (!bvh) return Forward(bvh);
  ObservedClip clip;
  clip.format = "bvh";
  clip.frames = bvh->frames;
  clip.joints = static_cast<int>(bvh->joints.size());
  clip.rate_hz = std::round(bvh->hz() * 1000.0) / 1000.0;
  for (const BvhJoint& joint : bvh->joints) clip.names.push_back(joint.name);
  const int step = std::max(1, bvh->frames / kMostFrames);
  std::vector<int> frames;
  for (int f = 0; f < bvh->frames; f += step) frames.push_back(f);
  clip.positions = JointPositions(static_cast<int>(frames.size()), clip.joints);
  std::vector<Vector3d> positions;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    BvhForward(*bvh, frames[i], positions);
    for (int j = 0; j < clip.joints; ++j) clip.positions.at(static_cast<int>(i), j) = positions[j];
  }
  clip.points = PointsOfTree(*bvh);
  clip.skeleton = "own tree of " + std::to_string(clip.joints) + " joints";
  clip.skeleton_from = "declared";
  clip.skeleton_confidence = 1.0;
  clip.skeleton_evidence = "HIERARCHY with ROOT " + clip.names[0];
  for (const char* known : {"bandai22", "cmu31", "smpl24"}) {
    const auto skeleton = LoadSkeleton(known);
    if (!skeleton || (*skeleton)->joint_count() != clip.joints) continue;
    const bool same = std::all_of(clip.names.begin(), clip.names.end(),
                                  [&](const std::string& joint) { return (*skeleton)->FindJoint(joint).has_value(); });
    if (same) clip.skeleton = known;
  }
  clip.layout_evidence = "header of the file";
  return std::vector<ObservedClip>{std::move(clip)};
}

Expected<std::vector<ObservedClip>> ObserveNpy(std::string_view bytes, const std::string& name,
                                               const std::optional<SourceOptions>& source) {
  const Expected<NpyArray> array = ParseNpy(bytes, name);
  if (!array) return Forward(array);
  std::string shape;
  for (const std::size_t size : array->shape) shape += (shape.empty() ? "(" : ", ") + std::to_string(size);
  shape += ")";
  std::vector<std::size_t> sizes = array->shape;
  if (sizes.size() >= 3 && sizes.back() == 3) {
    sizes.pop_back();
    sizes.back() *= 3;
  }
  const bool batch = sizes.size() == 3;
  const bool motion =
      (sizes.size() == 2 || batch) && sizes.back() % 3 == 0 && sizes.back() >= 9 && !array->values.empty();
  if (!motion) {
    return Fail(ErrorCode::kUnsupported, "an array of shape " + shape + " is no sequence of joint positions", name,
                "wanted: (frames, joints, 3), (frames, joints * 3), or a batch of them");
  }
  const std::size_t clips = batch ? sizes[0] : 1;
  const auto frames = static_cast<int>(sizes[sizes.size() - 2]);
  const auto joints = static_cast<int>(sizes.back() / 3);
  std::vector<ObservedClip> observed;
  for (std::size_t c = 0; c < clips; ++c) {
    ObservedClip clip;
    clip.id = batch ? "[" + std::to_string(c) + "]" : "";
    clip.format = "npy";
    clip.frames = frames;
    clip.joints = joints;
    clip.positions = JointPositions(frames, joints);
    clip.confidence.assign(static_cast<std::size_t>(frames) * joints, 1.0);
    for (std::size_t i = 0; i < clip.positions.xyz.size(); ++i) {
      const double value = array->values[c * clip.positions.xyz.size() + i];
      clip.positions.xyz[i] = std::isfinite(value) ? value : 0.0;
      if (!std::isfinite(value)) clip.confidence[i / 3] = 0.0;
    }
    clip.layout_evidence = "shape " + shape + " of " + array->dtype;
    if (source && source->format == SourceFormat::kNpy)
      DeclareOrder(*source, clip);
    else if (!RecogniseOrder(clip))
      DoubtPositions(clip);
    observed.push_back(std::move(clip));
  }
  return observed;
}

Expected<std::vector<ObservedClip>> ObserveFile(std::string_view bytes, const std::string& name,
                                                const std::optional<SourceOptions>& source) {
  switch (KindOf(bytes)) {
    case FileKind::kBvh:
      return ObserveBvh(bytes, name);
    case FileKind::kNpy:
      return ObserveNpy(bytes, name, source);
    case FileKind::kNumbers:
      return ObserveTable(bytes, name, source);
    case FileKind::kJson:
      return ObserveDepthSequence(bytes, name);
    case FileKind::kEmpty:
      return Fail(ErrorCode::kMalformed, "the file is empty", name, "was it copied whole?");
    case FileKind::kUnknown:
      break;
  }
  return Fail(ErrorCode::kUnsupported, "the content is none of the known formats", name,
              "known are BVH, .npy, tables of numbers, and the JSON of a depth sequence");
}

}  // namespace mocurate
