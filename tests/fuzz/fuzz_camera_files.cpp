#include <cstddef>
#include <cstdint>

#include "core/formats/camera_files.h"

/// One file of any dialect, or for OpenCV one or two files separated by a zero byte.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const auto calibration = mocurate::ParseCalibration(bytes, "fuzz");
  if (calibration) {
    for (const mocurate::CalibratedView& view : calibration->views) {
      (void)mocurate::CameraOf(view, mocurate::PoseConvention::kCentre, 0.01);
    }
  }
  std::vector<std::pair<std::string, std::string>> storages;
  const std::size_t zero = bytes.find('\0');
  storages.emplace_back("intri", bytes.substr(0, zero));
  if (zero != std::string::npos) storages.emplace_back("extri", bytes.substr(zero + 1));
  (void)mocurate::ParseOpenCvCalibration(storages);
  return 0;
}
