#include <cstddef>
#include <cstdint>

#include "core/formats/camera_files.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto calibration = mocurate::ParseCalibration(bytes, "fuzz");
  if (!calibration) return 0;
  for (const mocurate::CalibratedView& view : calibration->views) {
    (void)mocurate::CameraOf(view, mocurate::PoseReading::kCentre, 0.01);
  }
  return 0;
}
