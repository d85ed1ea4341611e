#include "fitting/solver/rest_sigmas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace mocurate {
namespace {

/// Factor on the standard deviation of hips, knees, shoulders and elbows.
constexpr std::array<std::pair<const char*, double>, 9> kMobility = {{{"spine1", 0.3},
                                                                      {"spine2", 0.3},
                                                                      {"spine3", 0.3},
                                                                      {"neck", 0.3},
                                                                      {"head", 0.3},
                                                                      {"collar", 0.25},
                                                                      {"ankle", 0.4},
                                                                      {"foot", 0.2},
                                                                      {"wrist", 0.4}}};

bool IsEverObserved(const SkeletonTracks& tracks, int joint) {
  for (int f = 0; f < tracks.frames(); ++f) {
    const std::size_t at =
        static_cast<std::size_t>(f) * static_cast<std::size_t>(tracks.joints()) + static_cast<std::size_t>(joint);
    const bool turned = !tracks.rotation_confidence.empty() && tracks.rotation_confidence[at] > 0.0;
    if (tracks.seen(f, joint) || turned) return true;
  }
  return false;
}

}  // namespace

std::vector<double> RestPoseSigmas(const Skeleton& skeleton, double rest_sigma) {
  std::vector<double> sigmas(skeleton.joints.size(), rest_sigma);
  for (const auto& [name, mobility] : kMobility) {
    for (const char* side : {"", "left_", "right_"}) {
      if (const auto joint = skeleton.FindJoint(std::string(side) + name)) sigmas[*joint] = rest_sigma * mobility;
    }
  }
  return sigmas;
}

std::vector<double> RestPoseSigmas(const SkeletonTracks& tracks, double rest_sigma) {
  std::vector<double> sigmas = RestPoseSigmas(*tracks.skeleton, kTypicalSigma);
  for (int j = 0; j < tracks.joints(); ++j) {
    sigmas[j] = IsEverObserved(tracks, j) ? rest_sigma : std::min(rest_sigma, sigmas[j]);
  }
  return sigmas;
}

double RestShareOfStep(double rest, double step) {
  return rest > 0.0 && step > 0.0 ? 0.5 * std::tanh(0.5 * std::asinh(0.5 * rest / step)) : kRestAtAnEnd;
}

std::vector<bool> SwingingJoints(const Skeleton& skeleton) {
  const std::vector<double> mobility = RestPoseSigmas(skeleton, 1.0);
  std::vector<bool> swings(mobility.size());
  for (std::size_t j = 0; j < mobility.size(); ++j)
    swings[j] = mobility[j] >= 1.0 && skeleton.joints[j].mirror != static_cast<int>(j);
  return swings;
}

}  // namespace mocurate
