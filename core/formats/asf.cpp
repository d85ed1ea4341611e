#include "core/formats/asf.h"

namespace mocurate {

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
