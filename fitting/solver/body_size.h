#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "fitting/evidence/skeleton_tracks.h"

namespace mocurate {

/// Factor beyond which a clip's bones are not its person's: another unit, or another person.
inline constexpr double kAnotherSize = 2.0;

/// Median ratio of observed bone lengths (10 cm and more) to `bone_length` (J, metres); 0 without any.
double SizeAgainst(const SkeletonTracks& clip, const std::vector<double>& bone_length);

/// Which of a person's clips (sizes over the rest skeleton's, 0: unknown) have the person's size. The size is that of a
/// human (0.35 to 2 times the rest skeleton) where any clip has one, then that of most clips, then the one nearest to
/// the rest skeleton's. Clips within kAnotherSize of it, and those of unknown size, have it.
std::vector<bool> HasPersonsSize(const std::vector<double>& sizes);

/// Compares a clip's bones with the person's: error kInconsistent beyond kAnotherSize, with the factor and the unit
/// that would explain it; finding "size_differs" (warning; value: the factor) beyond 8 %; else empty.
Expected<std::optional<Finding>> CheckSize(const SkeletonTracks& clip, const std::vector<double>& bone_length,
                                           const std::string& where);

/// Error kInconsistent where the tracks do not show a person: all joints of every frame lie in one point (within 2 cm),
/// or, in nearly all other frames (ten at least), in one plane to 1/200 of their extent (2-D points without depth).
Status CheckBody(const SkeletonTracks& clip, const std::string& where);

}  // namespace mocurate
