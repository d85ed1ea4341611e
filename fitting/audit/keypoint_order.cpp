#include "fitting/audit/keypoint_order.h"

#include <algorithm>
#include <cmath>

#include "fitting/association/body_shape.h"
#include "fitting/audit/rig_samples.h"
#include "fitting/evidence/detector_points.h"

namespace mocurate {
namespace {

constexpr int kFramesOfOrder = 40;  ///< frames to compare (numerical)
constexpr int kLengthsToJudge = 6;  ///< known lengths that an order must have
constexpr int kMinFramePoints = 8;  ///< fewest observed points of a frame
/// Log ratio, absolute, mean over a person's lengths: at most, from noisy single frames.
constexpr double kPlausibleLogRatio = 0.25;

constexpr double kOfAPerson = 0.2;     ///< log ratio, likewise, from the medians of a take
constexpr double kUnevenSides = 0.35;  ///< log ratio, absolute, of a left limb to the right one, at most

using Names = std::vector<std::string>;

Names Joined(const std::vector<Names>& parts) {
  Names all;
  for (const Names& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// Evenly spaced frames with enough observed points.
std::vector<int> FramesWithPerson(const JointPositions& points, const std::vector<double>& confidence) {
  std::vector<int> all;
  for (int f = 0; f < points.frames; ++f) {
    const auto first = confidence.begin() + static_cast<std::ptrdiff_t>(f) * points.joints;
    const auto seen = std::count_if(first, first + points.joints, [](double known) { return known > 0.0; });
    if (seen >= kMinFramePoints) all.push_back(f);
  }
  std::vector<int> frames;
  const std::size_t step = std::max<std::size_t>(1, all.size() / kFramesOfOrder);
  for (std::size_t i = 0; i < all.size(); i += step) frames.push_back(all[i]);
  return frames;
}

/// Mean |log ratio| to the skeleton's proportions in each of `frames`; 1 for too few known lengths.
std::vector<double> Departures(const JointPositions& points, const std::vector<double>& confidence,
                               const std::vector<KnownLength>& lengths, const std::vector<int>& frames) {
  std::vector<double> departures;
  for (const int f : frames) {
    std::vector<double> measured;
    for (const KnownLength& length : lengths) {
      const std::size_t first = static_cast<std::size_t>(f) * points.joints;
      const bool known = confidence[first + length.from] > 0.0 && confidence[first + length.to] > 0.0;
      measured.push_back(known ? (points.at(f, length.from) - points.at(f, length.to)).norm() : 0.0);
    }
    const ShapeMatch shape = CompareShape(measured, lengths);
    departures.push_back(shape.lengths >= kLengthsToJudge ? shape.mismatch : 1.0);
  }
  return departures;
}

/// Whether the names are of one length on both sides: "left_hip to left_knee" and "right_hip to right_knee".
bool AreSides(std::string a, const std::string& b) {
  for (std::size_t at = a.find("left_"); at != std::string::npos; at = a.find("left_", at)) a.replace(at, 5, "right_");
  return a == b;
}

/// Whether the median lengths are plausible: near the skeleton's proportions, and equal on both sides.
bool HasLengthsOfPerson(const JointPositions& points, const std::vector<double>& confidence,
                        const std::vector<KnownLength>& lengths, const std::vector<int>& frames) {
  const std::vector<double> medians = MedianLengths(points, confidence, lengths, frames);
  if (CompareShape(medians, lengths).mismatch > kOfAPerson) return false;
  for (std::size_t a = 0; a < lengths.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (medians[a] <= 0.0 || medians[b] <= 0.0 ||
          !(AreSides(lengths[a].name, lengths[b].name) || AreSides(lengths[b].name, lengths[a].name)))
        continue;
      if (std::abs(std::log(medians[a] / medians[b])) > kUnevenSides) return false;
    }
  }
  return true;
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 1.0 : sum / static_cast<double>(values.size());
}

}  // namespace

const std::vector<KeypointOrder>& KnownOrders() {
  static const Names coco = {"nose",          "left_eye",       "right_eye",  "left_ear",    "right_ear",
                             "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_wrist",
                             "right_wrist",   "left_hip",       "right_hip",  "left_knee",   "right_knee",
                             "left_ankle",    "right_ankle"};
  static const Names arms = {"nose",        "neck",          "right_shoulder", "right_elbow",
                             "right_wrist", "left_shoulder", "left_elbow",     "left_wrist"};
  static const Names legs = {"right_hip", "right_knee", "right_ankle", "left_hip", "left_knee", "left_ankle"};
  static const Names face = {"right_eye", "left_eye", "right_ear", "left_ear"};
  static const Names feet = {"left_big_toe",  "left_small_toe",  "left_heel",
                             "right_big_toe", "right_small_toe", "right_heel"};
  static const std::vector<KeypointOrder> orders = {{"BODY_25", Joined({arms, {"mid_hip"}, legs, face, feet})},
                                                    {"BODY_25B", Joined({coco, {"upper_neck", "head_top"}, feet})},
                                                    {"COCO_17", coco},
                                                    {"COCO_18", Joined({arms, legs, face})}};
  return orders;
}

std::optional<OrderFound> FindKeypointOrder(const JointPositions& points, const std::vector<double>& confidence,
                                            const std::vector<std::string>& names, const Skeleton& skeleton) {
  const auto keypoints = static_cast<std::size_t>(points.joints);
  std::size_t used = 0;  // keypoints observed in any frame
  for (std::size_t i = 0; i < confidence.size(); ++i) {
    if (confidence[i] > 0.0) used = std::max(used, i % keypoints + 1);
  }
  OrderFound best;
  const std::vector<int> frames = FramesWithPerson(points, confidence);
  const std::vector<double> given =
      Departures(points, confidence, KnownLengths(DetectorNames(names), skeleton), frames);
  best.given = Mean(given);
  best.found = 1.0;
  std::vector<std::vector<double>> all;
  std::size_t chosen = 0;
  for (const KeypointOrder& order : KnownOrders()) {
    if (order.points.size() < used) continue;
    OrderFound candidate{order.name, order.points, best.given, 0.0, 0.0};
    candidate.names.resize(std::min(order.points.size(), keypoints));
    for (std::size_t k = candidate.names.size(); k < keypoints; ++k) {
      candidate.names.push_back("unknown_" + std::to_string(k - order.points.size()));
    }
    all.push_back(Departures(points, confidence, KnownLengths(DetectorNames(candidate.names), skeleton), frames));
    candidate.found = Mean(all.back());
    if (candidate.found >= best.found) continue;  // of equal orders the first counts
    best = candidate;
    chosen = all.size() - 1;
  }
  if (best.name.empty() || best.found > kPlausibleLogRatio || best.found >= best.given) return {};
  if (!HasLengthsOfPerson(points, confidence, KnownLengths(DetectorNames(best.names), skeleton), frames)) return {};
  const std::vector<double> held_out = HeldOutCosts(all, FirstAndSecondHalf(given.size()));
  best.confidence = Confidence(given, held_out);
  for (std::size_t i = 0; i < all.size(); ++i) {
    // An order with the same joints at the same indices is no alternative.
    if (i != chosen && all[i] != all[chosen]) {
      best.confidence = std::min(best.confidence, Confidence(all[i], held_out));
    }
  }
  return best;
}

}  // namespace mocurate
