#pragma once

#include <cmath>
#include <string>

#include "core/base/text.h"
#include "core/formats/amc.h"
#include "core/formats/asf.h"

namespace mocurate {

inline bool operator==(const AcclaimAxis& a, const AcclaimAxis& b) {
  return a.angles == b.angles && a.order == b.order;
}

inline std::string AcclaimText(double value) {
  if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
  return FormatDouble(value);
}

inline std::string AcclaimText(const Vector3d& v) {
  return AcclaimText(v.x()) + " " + AcclaimText(v.y()) + " " + AcclaimText(v.z());
}

inline std::string Upper(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

inline void AppendBone(std::string& text, const AsfBone& bone) {
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
  text += "  end\n";
}

/// One line per parent, children in the order of the bones.
inline void AppendHierarchy(std::string& text, const Asf& asf) {
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

inline std::string WriteAsf(const Asf& asf) {
  std::string text;
  text += ":version 1.10\n:name a\n:units\n  mass 1\n  length " + AcclaimText(asf.length_unit) + "\n  angle " +
          (asf.degrees ? "deg" : "rad") + "\n:documentation\n  text\n";
  text += ":root\n  order";
  for (const AcclaimChannel channel : asf.root_order) text += " " + Upper(Name(channel));
  text += "\n  axis " + asf.root_axis + "\n  position " + AcclaimText(asf.root_position) + "\n  orientation " +
          AcclaimText(asf.root_orientation) + "\n:bonedata\n";
  for (const AsfBone& bone : asf.bones) AppendBone(text, bone);
  AppendHierarchy(text, asf);
  return text;
}

inline std::string WriteAmc(const Amc& amc) {
  std::string text;
  text.reserve(amc.values.size() * 10);
  text += ":FULLY-SPECIFIED\n";
  if (amc.degrees) text += *amc.degrees ? ":DEGREES\n" : ":RADIANS\n";
  if (amc.hz) text += ":SAMPLES-PER-SECOND " + FormatDouble(*amc.hz) + "\n";
  for (int frame = 0; frame < amc.frames; ++frame) {
    text += std::to_string(amc.frame_numbers[static_cast<std::size_t>(frame)]) + "\n";
    for (std::size_t bone = 0; bone < amc.bones.size(); ++bone) {
      if (!amc.has(frame, static_cast<int>(bone))) continue;
      const AmcBone& row = amc.bones[bone];
      text += row.name;
      for (int i = 0; i < row.channels; ++i) text += " " + FormatDouble(amc.value(frame, row.first_channel + i));
      text += "\n";
    }
  }
  return text;
}

}  // namespace mocurate
