#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/formats/calibration.h"

namespace mocurate {

/// A Qualisys Track Manager calibration (.qca.txt, XML). The file's numbers are 1/64 px; its camera axes are x right, y
/// up, z backward: R = diag(1, -1, -1) Rq. The unit is millimetres, and x y z is the camera's centre. Error
/// kMalformed with "name:line" of the camera and the attribute.
Expected<Calibration> ParseQualisys(std::string_view bytes, const std::string& name);

}  // namespace mocurate
