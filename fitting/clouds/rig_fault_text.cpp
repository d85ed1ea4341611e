#include "fitting/clouds/rig_fault_text.h"

#include <cmath>
#include <cstdlib>

#include "core/base/pi.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kMovedAlongSight = 0.95;  ///< share of a move along the line of sight, from which wrong depths explain
                                           ///< it as well
constexpr double kStraight = 0.05;         ///< rad; a depth offset does not explain larger rotations

}  // namespace

RigFault ExchangedFiles(const std::vector<std::string>& cameras, const FileExchange& exchange) {
  RigFault fault;
  fault.code = "cameras_exchanged";
  fault.value = exchange.exchanged;
  fault.confidence = exchange.confidence;
  std::string pairs;
  for (std::size_t v = 0; v < exchange.source.size(); ++v) {
    if (exchange.source[v] == v) continue;
    fault.camera += (fault.camera.empty() ? "" : ", ") + cameras[v];
    pairs += (pairs.empty() ? "" : ", ") + cameras[v] + " in those of " + cameras[exchange.source[v]];
  }
  fault.message =
      exchange.unique
          ? "the files of depth cameras are exchanged: images of " + pairs + "; so " +
                RoundedText(100.0 * exchange.exchanged, 2) + " % of their points contradict the others, as given " +
                RoundedText(100.0 * exchange.loss, 2) + " %"
          : "the files of depth cameras are exchanged, but which ones is ambiguous: the rig is symmetric, and "
            "more than one exchange explains the views";
  return fault;
}

RigFault DepthClockOff(const std::string& camera, double off_ms, int frames) {
  RigFault fault;
  fault.code = "camera_clock_off";
  fault.camera = camera;
  fault.value = off_ms;
  fault.message = "depth camera " + camera + ": clock offset " + (off_ms > 0.0 ? "+" : "-") +
                  RoundedText(std::abs(off_ms), 3) + " ms relative to the other cameras; its nearest image is " +
                  Counted(std::abs(frames), "frame") + (frames > 0 ? " later" : " earlier");
  return fault;
}

RigFault DepthsOff(const std::string& camera, const WrongDepths& wrong) {
  RigFault fault;
  fault.code = "camera_depths_off";
  fault.camera = camera;
  fault.value = 1e3 * wrong.too_long;
  fault.message = "depths of camera " + camera + " are " + RoundedText(std::abs(fault.value), 2) + " mm too " +
                  (fault.value > 0.0 ? "long" : "short") + " at the person (by an offset, or a factor of " +
                  RoundedText(1.0 / wrong.factor, 3) + ")";
  return fault;
}

RigFault LengthsMisread(const MisreadLengths& misread) {
  RigFault fault;
  fault.code = "calibration_unit";
  fault.value = misread.depth != 1.0 ? misread.depth : misread.places;
  fault.confidence = 1.0;
  fault.confidence_of = ConfidenceOf::kModel;
  fault.corrected = true;
  fault.message = WordsOf(misread);
  return fault;
}

RigFault FaultOfAll(const std::vector<std::string>& cameras, const CommonFault& common, const ObservedRig& rig) {
  RigFault fault;
  for (const std::string& camera : cameras) fault.camera += (fault.camera.empty() ? "" : ", ") + camera;
  if (common.mirrored) {
    fault.code = "view_mirrored";
    fault.value = common.loss_after;
    fault.message = "images of all depth cameras are mirrored (x counts from the right)";
  } else {
    double distance = 0.0;
    for (const DepthView& view : rig.views)
      distance += (rig.centre - view.camera.Centre()).norm() / static_cast<double>(rig.views.size());
    fault.code = "camera_depths_off";
    fault.value = 1e3 * distance * (1.0 - common.factor);
    fault.message = "depths of all cameras are too " + std::string(common.factor < 1.0 ? "long" : "short") +
                    " by a factor of " + RoundedText(1.0 / common.factor, 3) + ", " +
                    RoundedText(std::abs(fault.value), 2) + " mm at the person";
  }
  fault.message += "; after a correction, " + RoundedText(100.0 * common.loss_after, 2) +
                   " % of their points contradict the others, as given " + RoundedText(100.0 * common.loss, 2) + " %";
  return fault;
}

RigFault CameraMoved(const Camera& was, const Camera& is, const Vector3d& centre) {
  const CameraMoveAt move = MoveBetween(was, is, centre);
  const Vector3d way = is.Centre() - was.Centre();
  RigFault fault;
  fault.code = "camera_moved";
  fault.camera = was.name;
  fault.value = 1e3 * way.norm();
  fault.message = "depth camera " + was.name + " stands " + RoundedText(fault.value, 3) + " mm and " +
                  RoundedText(kDegrees * move.turn, 2) +
                  " degrees from its calibrated pose, which moves the person by " + RoundedText(1e3 * move.shift, 3) +
                  " mm";
  const double along = way.dot((centre - was.Centre()).normalized());
  if (std::abs(along) >= kMovedAlongSight * way.norm() && move.turn < kStraight) {
    fault.message += std::string("; the move is along its line of sight: instead, its depths may be too ") +
                     (along > 0.0 ? "short" : "long");
  }
  return fault;
}

}  // namespace mocurate
