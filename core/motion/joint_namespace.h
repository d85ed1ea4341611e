#pragma once

#include <string>
#include <vector>

#include "core/motion/skeleton.h"

namespace mocurate {

/// Names of one skeleton's joints without what an exporter put before all of them: "mixamorig:Hips", "mixamorigHips",
/// "Character1_Hips", "Armature|Hips" and "Bip01 L Thigh" become "Hips" and "L Thigh". What stands before the last ':'
/// or '|' goes; then what all but the root, and at least 5, begin with, up to a separator or to where every name goes
/// on with a capital letter. No name becomes empty, and no two that differ become the same.
std::vector<std::string> WithoutNamespace(std::vector<std::string> names);

/// The same names where the skeleton knows each of them as it stands, else without their namespace.
std::vector<std::string> NamesIn(const Skeleton& skeleton, const std::vector<std::string>& names);

}  // namespace mocurate
