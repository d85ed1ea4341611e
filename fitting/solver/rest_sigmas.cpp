#include "fitting/solver/rest_sigmas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace mocurate {
namespace {

/// Factor on the standard deviation of hips, knees, shoulders and elbows. Of trunk, neck, head, collars and wrists:
/// root mean square per axis about a clip's mean posture in the 1,020 clips of Bandai-Namco's motions, where the trunk
/// has two joints.
constexpr std::array<std::pair<const char*, double>, 9> kMobility = {{{"spine1", 0.12},
                                                                      {"spine2", 0.12},
                                                                      {"spine3", 0.12},
                                                                      {"neck", 0.12},
                                                                      {"head", 0.12},
                                                                      {"collar", 0.06},
                                                                      {"ankle", 0.3},
                                                                      {"foot", 0.2},
                                                                      {"wrist", 0.25}}};

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
