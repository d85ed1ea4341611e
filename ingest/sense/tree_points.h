#pragma once

#include <string>
#include <vector>

#include "core/quality/handedness.h"

namespace mocurate {

/// The points of a tree with names that nobody declared: knees, elbows and head by name, their neighbours by the tree,
/// as exporters agree on the former only. Sides by "left" and "right" or a lone L and R ("LeftLeg", "lShin", "Hand_R").
HandednessPoints PointsOfTree(const std::vector<std::string>& names, const std::vector<int>& parents);

}  // namespace mocurate
