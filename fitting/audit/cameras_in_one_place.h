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

/// Views of a rig in words: "depth views" and the option that says what becomes of wrong files.
struct RigKind {
  std::string views;
  std::string option;
};

/// Share [0, 1] of what views `a` and `b` see that both see alike; negative where neither sees anything.
using Similarity = std::function<Expected<double>(std::size_t a, std::size_t b)>;

/// Groups of two and more cameras that their calibrations have in one place, looking the same way, whatever their
/// lenses: indices, increasing.
std::vector<std::vector<std::size_t>> CamerasInOnePlace(const std::vector<Camera>& cameras);

/// "cameras_in_one_place" (share that is alike) of each group, uncorrected: no two cameras stand in one place. Views
/// that are alike are one view given twice. Error kInconsistent where views of a group differ and `action` is
/// kCorrect: different images do not come from one pose. Errors of `alike`.
Expected<std::vector<RigFault>> FaultsOfSharedPlaces(const std::vector<Camera>& cameras, const Similarity& alike,
                                                     AuditAction action, const RigKind& kind);

/// Whether one of the faults is of cameras in one place whose views differ.
bool PlacesAreCopied(const std::vector<RigFault>& faults);

}  // namespace mocurate
