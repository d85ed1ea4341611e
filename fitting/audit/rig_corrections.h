#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/audit/keypoint_files.h"
#include "fitting/options.h"
#include "fitting/rig_file.h"

namespace mocurate {

/// How the keypoints of a camera are read.
struct FileCorrection {
  std::size_t source = 0;  ///< view whose files they are in
  bool mirrored = false;
  bool sides_exchanged = false;
  double pixel_scale = 1.0;
};

/// (views) all hypotheses, one applied after the other.
std::vector<FileCorrection> JoinedCorrections(const std::vector<RigHypotheses>& applied, std::size_t views);

/// The keypoints with the corrections of an audited rig: files, images, sides, clocks, poses and intrinsics. Error
/// kInconsistent, with the place in the rig's file, for a camera that the rig lacks, another image size, and a camera
/// whose files the evidence lacks.
Expected<Evidence> WithRig(Evidence evidence, const RigFile& rig);

/// The errors of WithRig.
Status CheckRigFits(const Evidence& evidence, const RigFile& rig);

/// WithRig of `options.rig`; without one the evidence as given.
Expected<Evidence> WithRigOf(Evidence evidence, const KeypointFitOptions& options);

/// Options of the audit of a rig, which with an audited rig only reports.
KeypointFitOptions ForAuditOfRig(KeypointFitOptions options);

}  // namespace mocurate
