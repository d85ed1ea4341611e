#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/camera.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/options.h"

namespace mocurate {

/// Text for messages: "depth views", and the option for wrong files.
struct RigKind {
  std::string views;
  std::string option;
};

/// Share [0, 1] of the samples of views `a` and `b` that are equal; negative when neither has any.
using Similarity = std::function<Expected<double>(std::size_t a, std::size_t b)>;

/// Groups of two and more cameras with one pose in their calibrations, whatever their lenses: indices, increasing.
std::vector<std::vector<std::size_t>> CamerasInOnePlace(const std::vector<Camera>& cameras);

/// Code of cameras with one pose in their calibrations.
inline constexpr const char* kOnePlace = "cameras_in_one_place";

/// One "cameras_in_one_place" per group (value: share of equal samples), not corrected. Views of a group that are equal
/// are one view given twice. Error kInconsistent where views of a group differ and `action` is kCorrect, because
/// different images cannot come from one pose. Errors of `alike`.
Expected<std::vector<RigFault>> FaultsOfSharedPlaces(const std::vector<Camera>& cameras, const Similarity& alike,
                                                     AuditAction action, const RigKind& kind);

/// Whether one of the faults reports different views with one pose.
bool PlacesAreCopied(const std::vector<RigFault>& faults);

}  // namespace mocurate
