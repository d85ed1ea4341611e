#include "canon/trim/rest_posture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace mocurate {
namespace {

constexpr double kSlow = 0.6;             // m/s of the fastest joint: above a tracker's noise, below strides
constexpr double kStill = 0.4;            // m/s, scale of stillness for slow movement
constexpr double kMomentGapS = 0.5;       // between two still moments
constexpr double kMomentS = 0.6;          // maximum counted time of one moment
constexpr double kLeastRestS = 0.6;       // minimum score of a rest posture
constexpr double kLeastRestShare = 0.06;  // minimum share of the time away from it
constexpr int kCandidates = 300;
constexpr double kPostureScale = 0.1;    // metres
constexpr double kMovementScale = 0.15;  // m/s

/// A slow sample that represents `weight_s` seconds of its moment.
struct StillSample {
  Eigen::Index sample = 0;
  std::size_t moment = 0;
  double weight_s = 0.0;
};

std::vector<StillSample> StillSamples(const BodyDescription& body) {
  std::vector<Eigen::Index> slow;
  for (Eigen::Index s = 0; s < body.samples(); ++s) {
    if (body.movement(s) < kSlow) slow.push_back(s);
  }
  const std::size_t every = std::max<std::size_t>(1, slow.size() / kCandidates);
  std::vector<StillSample> still;
  std::size_t moment = 0;
  for (std::size_t i = 0; i < slow.size(); ++i) {
    if (i > 0 && static_cast<double>(slow[i] - slow[i - 1]) > kMomentGapS * body.rate_hz) ++moment;
    const double speed = body.movement(slow[i]) / kStill;
    const double weight_s = std::exp(-0.5 * speed * speed) * static_cast<double>(every) / body.rate_hz;
    if (i % every == 0) still.push_back({slow[i], moment, weight_s});
  }
  return still;
}

}  // namespace

std::optional<Eigen::RowVectorXd> RestPosture(const BodyDescription& body) {
  const std::vector<StillSample> still = StillSamples(body);
  const double duration_s = static_cast<double>(body.samples()) / body.rate_hz;
  std::optional<Eigen::RowVectorXd> posture;
  double most = 0.0;
  for (const StillSample& candidate : still) {
    double score = 0.0, near_s = 0.0, moment_s = 0.0;
    for (std::size_t i = 0; i < still.size(); ++i) {
      const double off = PoseDistance(body.pose.row(candidate.sample), body.pose.row(still[i].sample)) / kPostureScale;
      moment_s += still[i].weight_s * std::exp(-0.5 * off * off);
      if (i + 1 < still.size() && still[i + 1].moment == still[i].moment) continue;
      score += std::min(moment_s, kMomentS);
      near_s += moment_s;
      moment_s = 0.0;
    }
    if (score <= most) continue;
    most = score;
    const bool rests = score >= kLeastRestS && score >= kLeastRestShare * (duration_s - near_s);
    posture = rests ? std::optional<Eigen::RowVectorXd>(body.pose.row(candidate.sample)) : std::nullopt;
  }
  return posture;
}

Unrest MeasureUnrest(const BodyDescription& body) {
  const auto posture = RestPosture(body);
  Unrest unrest;
  unrest.rests = posture.has_value();
  unrest.value.setConstant(body.samples(), std::numeric_limits<double>::max());
  for (Eigen::Index s = 0; posture && s < body.samples(); ++s) {
    unrest.value(s) =
        std::hypot(PoseDistance(body.pose.row(s), *posture) / kPostureScale, body.movement(s) / kMovementScale);
  }
  return unrest;
}

}  // namespace mocurate
