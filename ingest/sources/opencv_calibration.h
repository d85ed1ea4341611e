#pragma once

#include <string>

#include "core/formats/calibration.h"

namespace mocurate {

/// Calibrations that OpenCV's FileStorage wrote, YAML or XML. Errors kMalformed and kInconsistent with the node's name.

/// EasyMocap: `names`, K_n and dist_n (4 or 5) of intri.yml; Rot_n or R_n (rotation vector; both: they must agree), T_n
/// of extri.yml. Cameras of the extrinsic file in its order; the intrinsic one may hold more. H_n and W_n or the image
/// size are optional. What R and T mean is left to evidence.
Expected<Calibration> ReadOpenCvRig(const std::string& intrinsic_bytes, const std::string& extrinsic_bytes,
                                    const std::string& intrinsic_name, const std::string& extrinsic_name);

/// One view per file, nodes `intrinsic` (3 x 3), `R` (3 x 3), `t` (3), as RGB-D turntable sets have them.
Expected<CalibratedView> ReadOpenCvView(const std::string& bytes, const std::string& name);

}  // namespace mocurate
