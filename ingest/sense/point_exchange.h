#pragma once

#include <optional>
#include <vector>

#include "ingest/sense/joint_orders.h"

namespace mocurate {

/// Two points of an order and how body-like the others are with them once these two change places.
struct PointExchange {
  int first = 0;
  int second = 0;
  BodyScore score;
};

/// The one that leaves the best score; nothing of fewer than two frames.
std::optional<PointExchange> BestExchange(const JointPositions& positions, const std::vector<double>& confidence,
                                          const std::vector<ObservedBone>& bones);

}  // namespace mocurate
