#pragma once

#include <cstddef>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Whether the poses of a file of `bytes` bytes, a position and a rotation of every joint in every frame, stay within
/// MostUnpacked: a joint without numbers costs a file nothing, and each frame of it 56 bytes. Error kMalformed.
Status CheckPoseMemory(std::size_t joints, std::size_t frames, std::size_t bytes, const std::string& name);

}  // namespace mocurate
