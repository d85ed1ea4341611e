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

/// Of joints that are not named.
constexpr double kBodyError = 0.0107;
constexpr std::array<std::pair<const char*, double>, 14> kBodyErrors = {{{"pelvis", 0.0138},
                                                                         {"spine1", 0.0062},
                                                                         {"spine2", 0.0049},
                                                                         {"spine3", 0.0044},
                                                                         {"neck", 0.0058},
                                                                         {"head", 0.0049},
                                                                         {"collar", 0.0049},
                                                                         {"hip", 0.0147},
                                                                         {"knee", 0.0098},
                                                                         {"ankle", 0.0111},
                                                                         {"foot", 0.0147},
                                                                         {"shoulder", 0.0107},
                                                                         {"wrist", 0.0111},
                                                                         {"hand", 0.0196}}};

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

std::vector<double> BodyErrors(const Skeleton& skeleton, double scale) {
  std::vector<double> errors(skeleton.joints.size(), scale * kBodyError);
  for (const auto& [name, error] : kBodyErrors) {
    for (const char* side : {"", "left_", "right_"}) {
      if (const auto joint = skeleton.FindJoint(std::string(side) + name)) errors[*joint] = scale * error;
    }
  }
  return errors;
}

}  // namespace mocurate
