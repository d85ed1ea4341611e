#pragma once

#include <string>
#include <vector>

namespace mocurate {

/// The skeleton of configs/skeletons/ to fit tracks of these joints with: one that has them all, each once, and its
/// root between the hips. "smpl24" where it does; else the one of fewest joints; empty where none does. "" and "-" are
/// no joints.
std::string FittedSkeleton(const std::vector<std::string>& joints);

}  // namespace mocurate
