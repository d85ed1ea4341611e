#include "ingest/inspect/keypoint_layout_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "core/base/median.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

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

void PointsOfFiles::Add(int of_file, const std::string& file) {
  if (of_file > 0 && points == 0) first_file = file;
  points += of_file;
}

std::string UnsurePointsWords(const PointsOfFiles& unsure) {
  return Counted(unsure.points, "keypoint") + (unsure.points == 1 ? " has" : " have") +
         " coordinates and the confidence 0, the first in " + unsure.first_file + ": taken as not seen";
}

std::string NotFiniteWords(const PointsOfFiles& not_finite) {
  return Counted(not_finite.points, "keypoint") + (not_finite.points == 1 ? " is" : " are") +
         " NaN, Infinity or null, the first in " + not_finite.first_file + ": taken as not seen";
}

}  // namespace mocurate
