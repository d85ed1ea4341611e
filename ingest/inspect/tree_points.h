#pragma once

#include <string>
#include <vector>

#include "core/motion/skeleton.h"
#include "core/quality/handedness.h"

namespace mocurate {

/// The points of a tree with undeclared names: knees, elbows and head by name, their neighbours by the tree,
/// as exporters agree on the former only. Sides by "left" and "right" or a lone L and R ("LeftLeg", "lShin", "Hand_R").
BodyLandmarks PointsOfTree(const std::vector<std::string>& names, const std::vector<int>& parents);

/// The points of a skeleton: by the names that all skeletons share, or, in a tree of a file's own, by what its names
/// look like.
BodyLandmarks PointsOfBody(const Skeleton& skeleton);
/// Of tracks with these names: joints of `skeleton` (may be null) by any of their names. Detectors' layouts have no
/// head; their nose is taken.
BodyLandmarks PointsOfBody(const std::vector<std::string>& names, const Skeleton* skeleton);

}  // namespace mocurate
