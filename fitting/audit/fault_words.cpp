#include "fitting/audit/fault_words.h"

#include <cmath>

#include "core/base/pi.h"
#include "core/base/text.h"

namespace mocurate {

RigFault ClockOff(const std::string& camera, double later_s, std::optional<double> sigma_s, double worse) {
  RigFault fault;
  fault.code = "camera_clock_off";
  fault.camera = camera;
  fault.value = 1e3 * later_s;
  fault.message = "camera " + camera + ": clock offset " + (fault.value > 0.0 ? "+" : "-") +
                  RoundedText(std::abs(fault.value), 3) + " ms relative to the other cameras";
  if (sigma_s) fault.message += " (standard deviation " + RoundedText(1e3 * *sigma_s, 2) + " ms)";
  fault.message += "; without it, the cost is " + RoundedText(100.0 * worse, 2) + " % higher";
  return fault;
}

RigFault SidesExchanged(const std::string& camera, int frames, double margin) {
  RigFault fault;
  fault.code = "view_swaps_sides";
  fault.camera = camera;
  fault.frame_end = frames;
  fault.value = margin;
  fault.message = "camera " + camera + " exchanges left and right in all " + Counted(frames, "frame");
  return fault;
}

RigFault CameraMoved(const Camera& was, const Camera& is, const std::string& reference, int begin, int end,
                     int frames) {
  RigFault fault;
  fault.code = "camera_moved";
  fault.camera = was.name;
  fault.value = 1e3 * (is.Centre() - was.Centre()).norm();
  const double angle = is.camera_from_world.rotation.angularDistance(was.camera_from_world.rotation);
  fault.message = "camera " + was.name + " stands " + RoundedText(fault.value, 3) + " mm and " +
                  RoundedText(kDegrees * angle, 2) + " degrees from the pose of " + reference;
  if (begin == 0 && end == frames) return fault;
  fault.frame_begin = begin;
  fault.frame_end = end;
  fault.message += begin == 0 ? " until frame " + std::to_string(end) : " from frame " + std::to_string(begin) + " on";
  return fault;
}

}  // namespace mocurate
