#include "ingest/checks/joint_order_checks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"
#include "ingest/inspect/joint_orders.h"

namespace mocurate {
namespace {

constexpr int kMinGuessedFrames = 8;          // fewer tell no spread of lengths
constexpr double kHeadBelow = -0.2;           // cosine of trunk and head
constexpr double kMuchBetterExchanged = 0.6;  // of the score, with two points exchanged
constexpr double kClearlyBetter =
    0.06;  // that it falls by; of recorded clips (KARD, Florence3D, MSR, UTKinect) by 0.055 at most, to 0.7

/// Median cosine between the directions from hips to shoulders and from shoulders to head; nothing where the points are
/// not there or seen together in too few frames.
std::optional<double> HeadOverShoulders(const RawClip& clip) {
  const BodyLandmarks& p = clip.points;
  const int wanted[] = {p.head, p.hip[0], p.hip[1], p.shoulder[0], p.shoulder[1]};
  if (std::any_of(std::begin(wanted), std::end(wanted), [](int point) { return point < 0; })) return std::nullopt;
  std::vector<double> cosines;
  for (int f = 0; f < clip.positions.frames; ++f) {
    const auto seen = [&](int point) {
      const std::size_t at = static_cast<std::size_t>(f) * static_cast<std::size_t>(clip.positions.joints) +
                             static_cast<std::size_t>(point);
      return clip.confidence.empty() || clip.confidence[at] > 0.0;
    };
    if (!std::all_of(std::begin(wanted), std::end(wanted), seen)) continue;
    const auto at = [&](int point) { return Vector3d(clip.positions.at(f, point)); };
    const Vector3d shoulders = 0.5 * (at(p.shoulder[0]) + at(p.shoulder[1]));
    const Vector3d trunk = shoulders - 0.5 * (at(p.hip[0]) + at(p.hip[1])), head = at(p.head) - shoulders;
    if (trunk.norm() > 0.0 && head.norm() > 0.0) cosines.push_back(trunk.dot(head) / (trunk.norm() * head.norm()));
  }
  if (static_cast<int>(cosines.size()) < kMinGuessedFrames) return std::nullopt;
  return Median(cosines);
}

std::string TenthsOfPercent(double share) { return FormatDouble(std::round(1000.0 * share) / 10.0) + " %"; }

}  // namespace

std::optional<std::string> CheckJointOrder(const RawClip& clip, const BodyScore& score,
                                           const std::vector<RawBone>& bones) {
  if (clip.frames < kMinGuessedFrames) return std::nullopt;
  if (const auto head = HeadOverShoulders(clip); head && *head < kHeadBelow) {
    return "the head would lie below the shoulders, on the side of the hips (cosine " + Digits(*head) +
           " in the median frame)";
  }
  const std::optional<PointExchange> exchange = BestExchange(clip.positions, clip.confidence, bones);
  if (!exchange) return std::nullopt;
  const double total = exchange->score.total();
  if (total > kMuchBetterExchanged * score.total() || total > score.total() - kClearlyBetter) return std::nullopt;
  const auto name = [&](int point) { return "'" + clip.names[static_cast<std::size_t>(point)] + "'"; };
  return "with " + name(exchange->first) + " and " + name(exchange->second) +
         " exchanged bones change their length by " + TenthsOfPercent(exchange->score.spread) +
         " and proportions are off by " + TenthsOfPercent(exchange->score.proportion) + ", as they are named by " +
         TenthsOfPercent(score.spread) + " and " + TenthsOfPercent(score.proportion);
}

}  // namespace mocurate
