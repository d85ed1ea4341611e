#include "ingest/checks/keypoint_checks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"
#include "ingest/inspect/inspection.h"

namespace mocurate {
namespace {

constexpr std::size_t kFewestKeypoints = 10;
constexpr double kInTheCorner_px = 2.0;  // smaller than any person in an image
constexpr double kTimesFarther = 20.0;   // a point of a person at the edge is up to 4 times as far as nine in ten
constexpr double kMostConfidence = 1.5;  // peaks of heat maps reach a little beyond 1

Finding SuspectFinding(const char* code, double value, std::string message) {
  return MakeFinding(code, Severity::kError, FourDecimals(value), std::move(message));
}

/// A number of each detected point.
template <class Number>
std::vector<double> OfDetected(const std::vector<ImagePoses>& frames, const Number& number) {
  std::vector<double> numbers;
  for (const ImagePoses& people : frames) {
    for (const auto& pose : people) {
      for (const DetectedKeypoint& point : pose) {
        if (point.detected()) numbers.push_back(number(point));
      }
    }
  }
  return numbers;
}

/// Points whose number is more than `most` are not detected from then on; `finding` tells the first with what it
/// `says`.
template <class Number, class Says>
std::optional<Finding> Exclude(Finding finding, const std::vector<std::string>& names, std::vector<ImagePoses>& frames,
                               double most, const Number& number, const Says& says) {
  std::size_t count = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (std::size_t p = 0; p < frames[f].size(); ++p) {
      for (std::size_t k = 0; k < frames[f][p].size(); ++k) {
        DetectedKeypoint& point = frames[f][p][k];
        if (!point.detected() || !(number(point) > most)) continue;
        if (count++ == 0) {
          finding.frame_begin = static_cast<int>(f);
          finding.message = names[f] + ":/people/" + std::to_string(p) + "/pose_keypoints_2d: point " +
                            std::to_string(k) + " " + says(point);
        }
        finding.frame_end = static_cast<int>(f) + 1;
        finding.value = std::max(finding.value, number(point));
        point.confidence = 0.0;
      }
    }
  }
  if (count == 0) return std::nullopt;
  if (count > 1) finding.message += "; " + Counted(static_cast<long long>(count - 1), "more point");
  finding.message += "; taken as not seen";
  finding.action = FindingAction::kMissing;
  return finding;
}

}  // namespace

std::vector<Finding> CheckKeypointNumbers(const std::vector<OpenPosePerson>& people) {
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
    findings.push_back(SuspectFinding(
        "keypoints_not_pixels", farthest,
        "no keypoint is farther than " + Digits(farthest) +
            " from the corner of its image: they are relative to its size (" + (least < 0.0 ? "-1 to 1" : "0 to 1") +
            "), no pixels; multiply them by width and height, or write them anew (OpenPose: "
            "--keypoint_scale 0)"));
  }
  std::sort(confidence.begin(), confidence.end());
  if (confidence[confidence.size() / 2] > kMostConfidence) {
    findings.push_back(SuspectFinding("confidence_range", confidence.back(),
                                      "confidences reach " + Digits(confidence.back()) +
                                          ", half of them are more than " + Digits(confidence[confidence.size() / 2]) +
                                          ": they are to be 0 to 1; divide them, per cent by 100"));
  }
  return findings;
}

std::optional<Finding> ExcludeFarKeypoints(const std::vector<std::string>& names, std::vector<ImagePoses>& frames) {
  const auto far = [](const DetectedKeypoint& point) { return std::max(std::abs(point.u_px), std::abs(point.v_px)); };
  std::vector<double> distances = OfDetected(frames, far);
  if (distances.size() < kFewestKeypoints) return std::nullopt;
  const auto nine_in_ten = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() * 9 / 10);
  std::nth_element(distances.begin(), nine_in_ten, distances.end());
  const double most = kTimesFarther * std::max(*nine_in_ten, kInTheCorner_px);
  const auto says = [&](const DetectedKeypoint& point) {
    return "is at " + FormatDouble(point.u_px) + " " + FormatDouble(point.v_px) +
           " px, nine in ten of the camera's points within " + Digits(most / kTimesFarther) + ": outside any image";
  };
  return Exclude(MakeFinding("keypoint_far", Severity::kWarning, 0.0, ""), names, frames, most, far, says);
}

std::optional<Finding> ExcludeImplausibleConfidences(const std::vector<std::string>& names,
                                                     std::vector<ImagePoses>& frames) {
  const auto sure = [](const DetectedKeypoint& point) { return point.confidence; };
  std::vector<double> confidences = OfDetected(frames, sure);
  if (confidences.size() < kFewestKeypoints) return std::nullopt;
  if (Median(std::move(confidences)) > kMostConfidence) return std::nullopt;  // all are of another range
  const auto says = [](const DetectedKeypoint& point) {
    return "has the confidence " + FormatDouble(point.confidence) + ", which is to be 0 to 1";
  };
  return Exclude(MakeFinding("confidence_range", Severity::kWarning, 0.0, ""), names, frames, kMostConfidence, sure,
                 says);
}

}  // namespace mocurate
