#include "fitting/clouds/cloud_body.h"

#include <array>
#include <utility>

namespace mocurate {
namespace {

/// Mobility against hips, knees, shoulders and elbows (1): rough standard deviations of what people do, in radians.
constexpr std::array<std::pair<const char*, double>, 9> kMobility = {{{"spine1", 0.3},
                                                                      {"spine2", 0.3},
                                                                      {"spine3", 0.3},
                                                                      {"neck", 0.3},
                                                                      {"head", 0.3},
                                                                      {"collar", 0.25},
                                                                      {"ankle", 0.4},
                                                                      {"foot", 0.2},
                                                                      {"wrist", 0.4}}};

}  // namespace

std::vector<double> RestSpreads(const Skeleton& skeleton, double rest_spread) {
  std::vector<double> spreads(skeleton.joints.size(), rest_spread);
  for (const auto& [name, mobility] : kMobility) {
    for (const char* side : {"", "left_", "right_"}) {
      if (const auto joint = skeleton.FindJoint(std::string(side) + name)) spreads[*joint] = rest_spread * mobility;
    }
  }
  return spreads;
}

}  // namespace mocurate
