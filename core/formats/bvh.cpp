#include "core/formats/bvh.h"

#include <algorithm>
#include <array>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180.0;
constexpr std::array<const char*, 6> kChannelNames = {"Xposition", "Yposition", "Zposition",
                                                      "Xrotation", "Yrotation", "Zrotation"};

void AppendVector(std::string& text, const Vector3d& v) {
  text += "OFFSET " + FormatDouble(v.x()) + " " + FormatDouble(v.y()) + " " + FormatDouble(v.z()) + "\n";
}

void AppendJoint(std::string& text, const Bvh& bvh, const std::vector<std::vector<int>>& children, int joint,
                 int depth) {
  const BvhJoint& j = bvh.joints[joint];
  const std::string indent(static_cast<std::size_t>(depth) * 2, ' ');
  text += indent + (j.parent < 0 ? "ROOT " : "JOINT ") + j.name + "\n" + indent + "{\n" + indent + "  ";
  AppendVector(text, j.offset);
  text += indent + "  CHANNELS " + std::to_string(j.channels.size());
  for (const BvhChannel channel : j.channels) text += std::string(" ") + kChannelNames[static_cast<int>(channel)];
  text += "\n";
  for (const int child : children[joint]) AppendJoint(text, bvh, children, child, depth + 1);
  if (j.has_end_site) {
    text += indent + "  End Site\n" + indent + "  {\n" + indent + "    ";
    AppendVector(text, j.end_site);
    text += indent + "  }\n";
  }
  text += indent + "}\n";
}

}  // namespace

bool BvhJoint::HasPosition() const { return std::any_of(channels.begin(), channels.end(), IsPosition); }

std::string WriteBvh(const Bvh& bvh) {
  std::vector<std::vector<int>> children(bvh.joints.size());
  for (std::size_t j = 1; j < bvh.joints.size(); ++j) children[bvh.joints[j].parent].push_back(static_cast<int>(j));
  std::string text = "HIERARCHY\n";
  AppendJoint(text, bvh, children, 0, 0);
  text += "MOTION\nFrames: " + std::to_string(bvh.frames) + "\nFrame Time: " + FormatDouble(bvh.frame_time_s) + "\n";
  text.reserve(text.size() + bvh.values.size() * 12);
  for (std::size_t i = 0; i < bvh.values.size(); ++i) {
    text += FormatDouble(bvh.values[i]);
    text += (i + 1) % static_cast<std::size_t>(bvh.channel_count) == 0 ? '\n' : ' ';
  }
  return text;
}

Vector3d BvhLocalPosition(const Bvh& bvh, int frame, int joint) {
  const BvhJoint& j = bvh.joints[joint];
  Vector3d position = j.offset;
  for (std::size_t c = 0; c < j.channels.size(); ++c) {
    if (IsPosition(j.channels[c])) {
      position[static_cast<int>(j.channels[c])] = bvh.value(frame, j.first_channel + static_cast<int>(c));
    }
  }
  return position;
}

Matrix3d BvhLocalRotation(const Bvh& bvh, int frame, int joint) {
  const BvhJoint& j = bvh.joints[joint];
  Matrix3d rotation = Matrix3d::Identity();
  for (std::size_t c = 0; c < j.channels.size(); ++c) {
    if (IsPosition(j.channels[c])) continue;
    const int axis = static_cast<int>(j.channels[c]) - 3;
    const double angle = bvh.value(frame, j.first_channel + static_cast<int>(c)) * kRadiansPerDegree;
    rotation = rotation * Eigen::AngleAxisd(angle, Vector3d::Unit(axis)).toRotationMatrix();
  }
  return rotation;
}

void BvhForward(const Bvh& bvh, int frame, std::vector<Vector3d>& positions, std::vector<Matrix3d>* global) {
  const int count = static_cast<int>(bvh.joints.size());
  std::vector<Matrix3d> own;
  std::vector<Matrix3d>& rotations = global != nullptr ? *global : own;
  rotations.resize(count);
  positions.resize(count);
  for (int j = 0; j < count; ++j) {
    const int parent = bvh.joints[j].parent;
    const Vector3d local = BvhLocalPosition(bvh, frame, j);
    const Matrix3d rotation = BvhLocalRotation(bvh, frame, j);
    positions[j] = parent < 0 ? local : Vector3d(positions[parent] + rotations[parent] * local);
    rotations[j] = parent < 0 ? rotation : Matrix3d(rotations[parent] * rotation);
  }
}

}  // namespace mocurate
