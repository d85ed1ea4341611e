#include "fitting/solver/rest_spreads.h"

#include <algorithm>
#include <array>
#include <string>
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

constexpr double kUsualSpread = 1.0;  ///< radians, of a joint of mobility 1

bool IsEverSeen(const SkeletonTracks& tracks, int joint) {
  for (int f = 0; f < tracks.frames(); ++f) {
    const std::size_t at =
        static_cast<std::size_t>(f) * static_cast<std::size_t>(tracks.joints()) + static_cast<std::size_t>(joint);
    const bool turned = !tracks.rotation_confidence.empty() && tracks.rotation_confidence[at] > 0.0;
    if (tracks.seen(f, joint) || turned) return true;
  }
  return false;
}

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

std::vector<double> RestSpreads(const SkeletonTracks& tracks, double rest_spread) {
  std::vector<double> spreads = RestSpreads(*tracks.skeleton, kUsualSpread);
  for (int j = 0; j < tracks.joints(); ++j) {
    spreads[j] = IsEverSeen(tracks, j) ? rest_spread : std::min(rest_spread, spreads[j]);
  }
  return spreads;
}

std::vector<bool> SwingingJoints(const Skeleton& skeleton) {
  const std::vector<double> mobility = RestSpreads(skeleton, 1.0);
  std::vector<bool> swings(mobility.size());
  for (std::size_t j = 0; j < mobility.size(); ++j)
    swings[j] = mobility[j] >= 1.0 && skeleton.joints[j].mirror != static_cast<int>(j);
  return swings;
}

}  // namespace mocurate
