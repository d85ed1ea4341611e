#pragma once

#include <string>
#include <vector>

#include "core/motion/skeleton.h"

namespace mocurate {

/// Names of one skeleton's joints without the exporter's common prefix: "mixamorig:Hips", "mixamorigHips",
/// "Character1_Hips", "Armature|Hips" and "Bip01 L Thigh" become "Hips" and "L Thigh". Everything before the last ':'
/// or '|' is removed. Then the common prefix of all names but the root's, and of at least 5, is removed, up to a
/// separator or to a capital letter in every name. No name becomes empty, and different names stay different.
std::vector<std::string> WithoutNamespace(std::vector<std::string> names);

/// The same names where the skeleton knows each of them, else without their namespace.
std::vector<std::string> NamesIn(const Skeleton& skeleton, const std::vector<std::string>& names);

}  // namespace mocurate
