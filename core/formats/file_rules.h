#pragma once

#include <cstddef>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// What a reader does about a damaged row: refuse the file, or mark what the row holds as missing, in its place, and
/// report it.
enum class DamagedRows { kRefuse, kReport };

/// Beyond any coordinate, angle, time or count of a person, in any unit; products of a few of them are still finite.
inline constexpr double kLargestNumber = 1e30;

/// Beyond any coordinate of a scan: a person in nanometres is 2e9 tall, and in millimetres 1e10 from the earth's
/// centre.
inline constexpr double kLargestCoordinate = 1e12;
inline constexpr const char* kCoordinateHint =
    "coordinates reach to 1e12 in any unit: correct or remove the point, or export the file again";

/// The error of a header count that differs from the data, kInconsistent with Reason::kCount: "Frames announces 12,
/// the file holds 10". With `at_most`, `found` is what the bytes allow, not what was counted; the message states it.
tl::unexpected<Error> CountContradiction(const std::string& count, double announced, double found,
                                         const std::string& where, bool at_most = false);

/// Whether the poses of a file of `bytes` bytes, a position and a rotation of every joint in every frame, stay within
/// MostUnpacked: a joint without numbers costs a file nothing, and each frame of it 56 bytes. Error kMalformed.
Status CheckPoseMemory(std::size_t joints, std::size_t frames, std::size_t bytes, const std::string& name);

}  // namespace mocurate
