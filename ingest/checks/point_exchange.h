#pragma once

#include <optional>
#include <vector>

#include "ingest/inspect/joint_orders.h"

namespace mocurate {

/// Two points of an order and how body-like the others are with them once these two change places.
struct PointExchange {
  int first = 0;
  int second = 0;
  BodyScore score;
};

/// The one that leaves the best score; nothing of fewer than two frames.
std::optional<PointExchange> BestExchange(const JointPositions& positions, const std::vector<double>& confidence,
                                          const std::vector<RawBone>& bones);

/// Median length and robust relative spread of the distance between two points over the frames, as of ScoreBody; spread
/// 1 when they are hardly ever seen together.
struct PointDistance {
  double median = 0.0;
  double spread = 1.0;
};
PointDistance DistanceBetween(const JointPositions& positions, const std::vector<double>& confidence, int a, int b);

}  // namespace mocurate
