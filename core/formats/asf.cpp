#include "core/formats/asf.h"

#include <cmath>
#include <limits>

#include "core/base/text.h"

namespace mocurate {
namespace {

std::string AcclaimText(double value) {
  if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
  return FormatDouble(value);
}

std::string AcclaimText(const Vector3d& v) {
  return AcclaimText(v.x()) + " " + AcclaimText(v.y()) + " " + AcclaimText(v.z());
}

std::string Upper(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

void AppendBone(std::string& text, const AsfBone& bone) {
  text += "  begin\n    id " + std::to_string(bone.id) + "\n    name " + bone.name + "\n    direction " +
          AcclaimText(bone.direction) + "\n    length " + AcclaimText(bone.length) + "\n    axis " +
          AcclaimText(bone.axis.angles) + " " + bone.axis.order + "\n";
  if (!bone.dof.empty()) {
    text += "    dof";
    for (const AcclaimChannel channel : bone.dof) text += std::string(" ") + Name(channel);
    text += "\n";
  }
  for (std::size_t i = 0; i < bone.limits.size(); ++i) {
    text += i == 0 ? "    limits (" : "           (";
    text += AcclaimText(bone.limits[i].least) + " " + AcclaimText(bone.limits[i].most) + ")\n";
  }
  for (const std::string& line : bone.other) text += "    " + line + "\n";
  text += "  end\n";
}

/// One line per parent, children in the order of the bones.
void AppendHierarchy(std::string& text, const Asf& asf) {
  std::vector<std::string> children(asf.bones.size() + 1);  // the root's first
  for (const AsfBone& bone : asf.bones) children[static_cast<std::size_t>(bone.parent) + 1] += " " + bone.name;
  text += ":hierarchy\n  begin\n";
  if (!children[0].empty()) text += "    root" + children[0] + "\n";
  for (const int bone : asf.Order()) {
    const std::string& names = children[static_cast<std::size_t>(bone) + 1];
    if (!names.empty()) text += "    " + asf.bones[static_cast<std::size_t>(bone)].name + names + "\n";
  }
  text += "  end\n";
}

}  // namespace

bool operator==(const AcclaimAxis& a, const AcclaimAxis& b) { return a.angles == b.angles && a.order == b.order; }

const char* Name(AcclaimChannel channel) {
  constexpr const char* kNames[] = {"tx", "ty", "tz", "rx", "ry", "rz", "l"};
  return kNames[static_cast<int>(channel)];
}

int Asf::Find(std::string_view bone) const {
  for (std::size_t i = 0; i < bones.size(); ++i) {
    if (bones[i].name == bone) return static_cast<int>(i);
  }
  return -1;
}

std::vector<int> Asf::Order() const {
  std::vector<std::vector<int>> children(bones.size() + 1);
  for (std::size_t i = 0; i < bones.size(); ++i) {
    children[static_cast<std::size_t>(bones[i].parent) + 1].push_back(static_cast<int>(i));
  }
  std::vector<int> order = children[0];
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::vector<int>& next = children[static_cast<std::size_t>(order[i]) + 1];
    order.insert(order.end(), next.begin(), next.end());
  }
  return order;
}

double Asf::RadiansPerUnit() const { return degrees ? 3.14159265358979323846 / 180.0 : 1.0; }

std::string WriteAsf(const Asf& asf) {
  std::string text;
  if (!asf.version.empty()) text += ":version " + asf.version + "\n";
  if (!asf.name.empty()) text += ":name " + asf.name + "\n";
  text += ":units\n  mass " + AcclaimText(asf.mass_unit) + "\n  length " + AcclaimText(asf.length_unit) + "\n  angle " +
          (asf.degrees ? "deg" : "rad") + "\n";
  if (!asf.documentation.empty()) text += ":documentation\n";
  for (const std::string& line : asf.documentation) text += "  " + line + "\n";
  text += ":root\n  order";
  for (const AcclaimChannel channel : asf.root_order) text += " " + Upper(Name(channel));
  text += "\n  axis " + asf.root_axis + "\n  position " + AcclaimText(asf.root_position) + "\n  orientation " +
          AcclaimText(asf.root_orientation) + "\n:bonedata\n";
  for (const AsfBone& bone : asf.bones) AppendBone(text, bone);
  AppendHierarchy(text, asf);
  return text;
}

Vector3d AsfOffset(const AsfBone& bone) {
  const double norm = bone.direction.norm();
  return norm > 0.0 ? Vector3d(bone.direction * (bone.length / norm)) : Vector3d(Vector3d::Zero());
}

Matrix3d AcclaimMatrix(const AcclaimAxis& axis, double radians_per_unit) {
  Matrix3d matrix = Matrix3d::Identity();
  for (std::size_t i = 0; i < axis.order.size() && i < 3; ++i) {
    const double angle = axis.angles[static_cast<int>(i)] * radians_per_unit;
    matrix = Eigen::AngleAxisd(angle, Vector3d::Unit(axis.order[i] - 'X')).toRotationMatrix() * matrix;
  }
  return matrix;
}

}  // namespace mocurate
