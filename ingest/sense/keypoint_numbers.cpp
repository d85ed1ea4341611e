#include "ingest/sense/keypoint_numbers.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/text.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr std::size_t kFewestKeypoints = 10;
constexpr double kInTheCorner_px = 2.0;  // nobody is seen as small as that
constexpr double kMostConfidence = 1.5;  // peaks of heat maps reach a little beyond 1

Finding Doubt(const char* code, double value, std::string message) {
  Finding finding = FrameFinding(code, 0, 0, "", std::round(value * 1e4) / 1e4, std::move(message));
  finding.severity = Severity::kError;
  return finding;
}

}  // namespace

std::vector<Finding> DoubtKeypointNumbers(const std::vector<OpenPosePerson>& people) {
  double farthest = 0.0, least = 0.0;
  std::vector<double> confidence;
  for (const OpenPosePerson& person : people) {
    for (const DetectedKeypoint& point : person.pose) {
      if (!point.detected()) continue;
      farthest = std::max({farthest, std::abs(point.u_px), std::abs(point.v_px)});
      least = std::min({least, point.u_px, point.v_px});
      confidence.push_back(point.confidence);
    }
  }
  std::vector<Finding> findings;
  if (confidence.size() < kFewestKeypoints) return findings;
  if (farthest < kInTheCorner_px) {
    findings.push_back(Doubt("keypoints_not_pixels", farthest,
                             "no keypoint is farther than " + Digits(farthest) +
                                 " from the corner of its image: they are shares of its size (" +
                                 (least < 0.0 ? "-1 to 1" : "0 to 1") +
                                 "), no pixels; multiply them by width and height, or write them anew (OpenPose: "
                                 "--keypoint_scale 0)"));
  }
  std::sort(confidence.begin(), confidence.end());
  if (confidence[confidence.size() / 2] > kMostConfidence) {
    findings.push_back(Doubt("confidence_range", confidence.back(),
                             "confidences reach " + Digits(confidence.back()) + ", half of them are more than " +
                                 Digits(confidence[confidence.size() / 2]) +
                                 ": they are to be 0 to 1; divide them, per cent by 100"));
  }
  return findings;
}

}  // namespace mocurate
