#include "ingest/checks/keypoint_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
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

constexpr std::size_t kFewestBones = 8;
constexpr double kBodyLike = 0.5;        ///< mismatch of a body in any pose
constexpr double kSpreadOfBones = 0.35;  ///< scale of the differences of log lengths by pose and build
constexpr double kSureLayout = 0.9;

struct BodyBone {
  const char* from;
  const char* to;
  double length;  ///< share of stature (Drillis and Contini; the head's from the body mesh)
};

constexpr BodyBone kBodyBones[] = {
    {"left_shoulder", "left_elbow", 0.172},
    {"right_shoulder", "right_elbow", 0.172},
    {"left_elbow", "left_wrist", 0.146},
    {"right_elbow", "right_wrist", 0.146},
    {"left_hip", "left_knee", 0.245},
    {"right_hip", "right_knee", 0.245},
    {"left_knee", "left_ankle", 0.246},
    {"right_knee", "right_ankle", 0.246},
    {"left_shoulder", "right_shoulder", 0.2},
    {"left_hip", "right_hip", 0.11},
    {"left_shoulder", "left_hip", 0.288},
    {"right_shoulder", "right_hip", 0.288},
    {"neck", "left_shoulder", 0.11},
    {"neck", "right_shoulder", 0.11},
    {"neck", "mid_hip", 0.288},
    {"mid_hip", "left_hip", 0.06},
    {"mid_hip", "right_hip", 0.06},
    {"upper_neck", "head_top", 0.14},
    {"left_ankle", "left_big_toe", 0.11},
    {"right_ankle", "right_big_toe", 0.11},
    {"left_heel", "left_big_toe", 0.14},
    {"right_heel", "right_big_toe", 0.14},
    {"left_ankle", "left_heel", 0.045},
    {"right_ankle", "right_heel", 0.045},
    {"nose", "left_eye", 0.03},
    {"nose", "right_eye", 0.03},
    {"left_eye", "left_ear", 0.055},
    {"right_eye", "right_ear", 0.055},
};

std::optional<double> Mismatch(const OpenPosePerson& person, const KeypointLayout& layout) {
  std::vector<double> logs;
  for (const BodyBone& bone : kBodyBones) {
    const int from = layout.Find(bone.from);
    const int to = layout.Find(bone.to);
    if (from < 0 || to < 0) continue;
    const DetectedKeypoint& a = person.pose[static_cast<std::size_t>(from)];
    const DetectedKeypoint& b = person.pose[static_cast<std::size_t>(to)];
    if (!a.detected() || !b.detected()) continue;
    const double pixels = std::hypot(a.u_px - b.u_px, a.v_px - b.v_px);
    logs.push_back(std::log(std::max(pixels, 1.0) / bone.length));
  }
  if (logs.size() < kFewestBones) return std::nullopt;
  const double scale = Median(logs);
  double sum = 0.0;
  for (const double value : logs) sum += std::min(std::abs(value - scale), 2.0);
  return sum / static_cast<double>(logs.size());
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

std::vector<KeypointLayoutScore> ScoreKeypointLayouts(const std::vector<OpenPosePerson>& people) {
  std::map<std::size_t, std::size_t> counts;
  for (const OpenPosePerson& person : people) {
    if (!person.pose.empty()) ++counts[person.pose.size()];
  }
  std::vector<KeypointLayoutScore> scores;
  if (counts.size() != 1) return scores;
  for (const KeypointLayout& layout : KeypointLayouts()) {
    if (layout.points.size() != counts.begin()->first) continue;
    std::vector<double> mismatches;
    for (const OpenPosePerson& person : people) {
      if (person.pose.empty()) continue;
      if (const std::optional<double> mismatch = Mismatch(person, layout)) mismatches.push_back(*mismatch);
    }
    if (mismatches.empty()) continue;
    scores.push_back({layout.name, Median(mismatches), static_cast<int>(mismatches.size())});
  }
  std::stable_sort(scores.begin(), scores.end(),
                   [](const KeypointLayoutScore& a, const KeypointLayoutScore& b) { return a.mismatch < b.mismatch; });
  return scores;
}

Measured EstimateKeypointLayout(const std::vector<OpenPosePerson>& people) {
  const std::vector<KeypointLayoutScore> scores = ScoreKeypointLayouts(people);
  Measured layout;
  if (scores.empty()) {
    layout.evidence = "no known layout has as many points, or no person shows enough bones";
    return layout;
  }
  const KeypointLayoutScore& best = scores.front();
  // Each bone of one person is one observation; people of one capture are not independent.
  double others = 0.0;
  for (std::size_t i = 1; i < scores.size(); ++i) {
    others += std::exp(-(scores[i].mismatch - best.mismatch) * static_cast<double>(kFewestBones) / kSpreadOfBones);
  }
  const double fit = 1.0 / (1.0 + std::exp((best.mismatch - kBodyLike) / 0.04));
  layout.confidence = fit / (1.0 + others);
  for (const KeypointLayoutScore& score : scores) {
    const double percent = std::round(100.0 * (std::exp(score.mismatch) - 1.0));
    layout.evidence += (layout.evidence.empty() ? "" : "; ") + ("as " + score.layout) + " bones are off by " +
                       FormatDouble(percent) + " % on the average of " + std::to_string(score.people) + " people";
  }
  if (layout.confidence >= kSureLayout) layout.value = best.layout;
  return layout;
}

void PointsNotSeen::Add(const OpenPoseFrame& frame, const std::string& file) {
  for (const auto& [points, all] : {std::pair{frame.uncertain_points, &unsure_}, {frame.not_finite, &not_finite_}}) {
    if (points > 0 && all->points == 0) all->first_file = file;
    all->points += points;
  }
}

std::vector<Finding> PointsNotSeen::Findings() const {
  std::vector<Finding> findings;
  const auto add = [&](const char* code, const OfFiles& all, const char* one, const char* many) {
    if (all.points == 0) return;
    findings.push_back(MakeFinding(code, Severity::kWarning, static_cast<double>(all.points),
                                   Counted(all.points, "keypoint") + (all.points == 1 ? one : many) +
                                       ", the first in " + all.first_file + ": taken as not seen",
                                   FindingAction::kMissing));
  };
  add("uncertain_points", unsure_, " has coordinates and the confidence 0", " have coordinates and the confidence 0");
  add("keypoints_not_finite", not_finite_, " is NaN, Infinity or null", " are NaN, Infinity or null");
  return findings;
}

}  // namespace mocurate
