#pragma once

#include "core/geometry/camera.h"
#include "core/pipeline/stage.h"

namespace mocurate {

/// Width and height of a 16-bit grey PNG into the camera; the pixels are not decoded. Errors kMalformed for another
/// image, kUnreadable.
Status SetImageSize(const StageInput& input, Camera& camera);

}  // namespace mocurate
