#include "core/formats/amc.h"

#include <algorithm>

namespace mocurate {
namespace {

/// Numbers of a bone in a frame, as dof name them.
struct Dof {
  AcclaimAxis turn;
  Vector3d shift = Vector3d::Zero();
  bool shifted[3] = {false, false, false};
  double stretch = 0.0;
};

Dof DofOf(const std::vector<AcclaimChannel>& channels, const Amc& amc, int frame, std::string_view name) {
  Dof dof;
  dof.turn.order.clear();
  const int bone = amc.Find(name);
  if (bone < 0 || !amc.has(frame, bone)) return dof;
  const AmcBone& row = amc.bones[static_cast<std::size_t>(bone)];
  const int count = std::min(row.channels, static_cast<int>(channels.size()));
  for (int i = 0; i < count; ++i) {
    const double value = amc.value(frame, row.first_channel + i);
    const AcclaimChannel channel = channels[static_cast<std::size_t>(i)];
    if (IsRotation(channel)) {
      dof.turn.angles[static_cast<int>(dof.turn.order.size())] = value;
      dof.turn.order += static_cast<char>('X' + (static_cast<int>(channel) - static_cast<int>(AcclaimChannel::kRx)));
    } else if (IsTranslation(channel)) {
      dof.shift[static_cast<int>(channel)] = value;
      dof.shifted[static_cast<int>(channel)] = true;
    } else {
      dof.stretch = value;
    }
  }
  return dof;
}

double Radians(const Asf& asf, const Amc& amc) {
  if (!amc.degrees) return asf.RadiansPerUnit();
  return *amc.degrees ? 3.14159265358979323846 / 180.0 : 1.0;
}

Matrix3d Turned(const AcclaimAxis& axis, const Asf& asf, const Dof& dof, const Amc& amc) {
  const Matrix3d c = AcclaimMatrix(axis, asf.RadiansPerUnit());
  return c * AcclaimMatrix(dof.turn, Radians(asf, amc)) * c.transpose();
}

}  // namespace

int Amc::Find(std::string_view bone) const {
  for (std::size_t i = 0; i < bones.size(); ++i) {
    if (bones[i].name == bone) return static_cast<int>(i);
  }
  return -1;
}

Matrix3d AcclaimLocalRotation(const Asf& asf, const Amc& amc, int frame, int bone) {
  const AsfBone& b = asf.bones[static_cast<std::size_t>(bone)];
  return Turned(b.axis, asf, DofOf(b.dof, amc, frame, b.name), amc);
}

void AcclaimForward(const Asf& asf, const Amc& amc, int frame, std::vector<Vector3d>& ends, Vector3d* root,
                    std::vector<Matrix3d>* global) {
  const Dof of_root = DofOf(asf.root_order, amc, frame, "root");
  Vector3d place = asf.root_position;
  for (int i = 0; i < 3; ++i) {
    if (of_root.shifted[i]) place[i] = of_root.shift[i];
  }
  if (root != nullptr) *root = place;
  const Matrix3d world_from_root = Turned({asf.root_orientation, asf.root_axis}, asf, of_root, amc);
  std::vector<Matrix3d> own;
  std::vector<Matrix3d>& rotations = global != nullptr ? *global : own;
  rotations.resize(asf.bones.size());
  ends.resize(asf.bones.size());
  for (const int index : asf.Order()) {
    const std::size_t i = static_cast<std::size_t>(index);
    const AsfBone& bone = asf.bones[i];
    const std::size_t parent = static_cast<std::size_t>(std::max(bone.parent, 0));
    const Dof dof = DofOf(bone.dof, amc, frame, bone.name);
    rotations[i] = (bone.parent < 0 ? world_from_root : rotations[parent]) * Turned(bone.axis, asf, dof, amc);
    Vector3d offset = AsfOffset(bone);
    if (dof.stretch != 0.0 && bone.length > 0.0) offset *= 1.0 + dof.stretch / bone.length;
    if (dof.shift != Vector3d::Zero()) offset += AcclaimMatrix(bone.axis, asf.RadiansPerUnit()) * dof.shift;
    ends[i] = (bone.parent < 0 ? place : ends[parent]) + rotations[i] * offset;
  }
}

}  // namespace mocurate
