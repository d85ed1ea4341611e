#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Beyond this factor a clip's bones are not those of its person: another unit, or somebody else.
inline constexpr double kAnotherSize = 2.0;

/// Median ratio of what a clip shows of bones (10 cm and more) to `bone_length` (J, metres); 0 without any.
double SizeAgainst(const SkeletonTracks& clip, const std::vector<double>& bone_length);

/// Of a person's clips (sizes against the rest skeleton, 0: not told) those that are of the person's size: of a
/// person's size at all (0.35 to 2 times the rest skeleton) where any is, then that of most clips, then the one nearest
/// to the rest skeleton's; and all within kAnotherSize of it. What is not told is of it.
std::vector<bool> OfThePersonsSize(const std::vector<double>& sizes);

/// How a clip's bones compare with the person's: error kInconsistent beyond kAnotherSize, with the factor and the unit
/// that would explain it; a finding "size_differs" (warning; value: the factor) beyond 8 %; else none.
Expected<std::optional<Finding>> CheckSize(const SkeletonTracks& clip, const std::vector<double>& bone_length,
                                           const std::string& where);

/// Error kInconsistent where the tracks show nobody: all joints of every frame lie in one point (within 2 cm), or, in
/// nearly all other frames (ten at least), in one plane to 1/200 of their extent: 2-D points, whose depth nobody
/// measured.
Status CheckBody(const SkeletonTracks& clip, const std::string& where);

}  // namespace mocurate
