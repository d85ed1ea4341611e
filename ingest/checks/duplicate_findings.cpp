#include "ingest/checks/duplicate_findings.h"

#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

std::string SpanText(int begin, int end) { return std::to_string(begin) + "-" + std::to_string(end); }

}  // namespace

DuplicateLimits DuplicateLimitsOf(const CheckOptions& options) {
  return {options.Limit("duplicate", "distance"), static_cast<int>(options.Limit("shared_frames", "frames"))};
}

Finding DuplicateFinding(const Duplicate& pair, const std::string& first_name, const MotionSignature& first,
                         const MotionSignature& second) {
  const int frames = static_cast<int>(second.poses.size());
  const bool equal = pair.shared > 0 && pair.shared == frames && first.poses.size() == second.poses.size();
  Finding finding;
  if (!pair.whole) {
    finding = FrameFinding("shared_frames", pair.second_begin, pair.second_end, "", pair.shared,
                           std::to_string(pair.shared) + " of " + std::to_string(frames) + " frames are those of '" +
                               first_name + "' (" + SpanText(pair.second_begin, pair.second_end) + " here, " +
                               SpanText(pair.frame_begin, pair.frame_end) + " there)");
  } else if (pair.mirrored) {
    finding = FrameFinding("mirrored_duplicate", 0, 0, "", pair.distance,
                           "the mirror image of '" + first_name + "' (" + Digits(pair.distance) + " m apart)");
  } else if (equal) {
    finding =
        FrameFinding("duplicate", 0, 0, "", 0.0, "the same, frame for frame, as '" + first_name + "' (0 m apart)");
  } else {
    finding = FrameFinding("near_duplicate", 0, 0, "", pair.distance,
                           "the same motion as '" + first_name + "' (" + Digits(pair.distance) + " m apart)");
  }
  return finding;
}

}  // namespace mocurate
