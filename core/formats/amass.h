#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/file_rules.h"

namespace mocurate {

/// One motion of AMASS. World z up; `translation` is not the pelvis (pelvis = translation + rest pelvis of the body
/// model).
struct Amass {
  /// kLegacy: `poses` and `mocap_framerate`. kSplit: `root_orient`, `pose_body`, ... and `mocap_frame_rate`.
  enum class Layout { kLegacy, kSplit };

  Layout layout = Layout::kLegacy;
  double rate_hz = 0.0;       ///< as in the file: 120, 100, 59.9999885559082, ...
  std::string gender;         ///< "male", "female", "neutral"; empty when not declared
  std::string surface_model;  ///< "smplx", ...; empty when not declared (legacy: SMPL+H)
  std::size_t frames = 0;
  /// Axis-angle, radians. 156: root 3, body 63, hands 90. 165: root 3, body 63, jaw 3, eyes 6, hands 90. 66 without
  /// hands, 72 of SMPL.
  std::size_t pose_columns = 0;
  std::vector<double> poses;          ///< frames x pose_columns
  std::vector<double> translation_m;  ///< frames x 3
  std::vector<double> betas;
  std::size_t markers = 0;        ///< in the file; not read
  std::vector<int> damaged;       ///< frames whose pose or place is not all numbers of a person; 0 there
  std::vector<Finding> findings;  ///< "not_a_number", one of those that follow each other, at most 200
};

/// AMASS .npz of both layouts. Members that hold Python objects are ignored. Errors kMalformed and kInconsistent name
/// the field; kUnsupported for a file without motion (shape.npz, *_stagei.npz). With DamagedRows::kReport a frame with
/// a number that is not finite or implausibly large is damaged; otherwise it is kMalformed.
Expected<Amass> ParseAmass(std::string_view bytes, const std::string& name, DamagedRows damaged = DamagedRows::kRefuse);

/// Without markers. Error kInconsistent: sizes that do not fit.
Expected<std::string> EncodeAmass(const Amass& amass, const std::string& name);

}  // namespace mocurate
