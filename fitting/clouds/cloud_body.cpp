#include "fitting/clouds/cloud_body.h"

#include <array>
#include <utility>

#include "fitting/costs/huber.h"
#include "fitting/uncertainty/frame_spread.h"

namespace mocurate {
namespace {

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

std::vector<double> BodyErrors(const Skeleton& skeleton, double scale) {
  std::vector<double> errors(skeleton.joints.size(), scale * kBodyError);
  for (const auto& [name, error] : kBodyErrors) {
    for (const char* side : {"", "left_", "right_"}) {
      if (const auto joint = skeleton.FindJoint(std::string(side) + name)) errors[*joint] = scale * error;
    }
  }
  return errors;
}

std::vector<Vector3d> BodyTurns(const Skeleton& skeleton, const std::vector<double>& bone_length,
                                const std::vector<double>& body_error) {
  std::vector<double> variance(body_error.size(), 0.0);
  for (std::size_t j = 1; j < variance.size(); ++j)
    variance[j] = Square(body_error[j]) + Square(body_error[skeleton.joints[j].parent]);
  std::vector<Vector3d> turns;
  for (const Matrix3d& turn : TurnsByBones(skeleton, bone_length, variance)) turns.emplace_back(turn.diagonal());
  return turns;
}

}  // namespace mocurate
