#include "fitting/clouds/cloud_body.h"

#include <array>
#include <utility>

#include "fitting/costs/huber.h"
#include "fitting/uncertainty/frame_orientation.h"

namespace mocurate {
namespace {

/// m, standard deviation per axis of joints without an entry in kBodyErrors. Source: bench_fit_clouds
constexpr double kBodyError = 0.0044;
/// m, standard deviation per axis of joints on a body from clouds, left and right ones alike. Source: bench_fit_clouds
constexpr std::array<std::pair<const char*, double>, 14> kBodyErrors = {{{"pelvis", 0.0024},
                                                                         {"spine1", 0.0023},
                                                                         {"spine2", 0.0022},
                                                                         {"spine3", 0.0024},
                                                                         {"neck", 0.0028},
                                                                         {"head", 0.0020},
                                                                         {"collar", 0.0022},
                                                                         {"hip", 0.0030},
                                                                         {"knee", 0.0034},
                                                                         {"ankle", 0.0032},
                                                                         {"foot", 0.0045},
                                                                         {"shoulder", 0.0044},
                                                                         {"wrist", 0.0062},
                                                                         {"hand", 0.0112}}};

}  // namespace

std::vector<double> BodyErrors(const Skeleton& skeleton, double scale, const Rules& rules) {
  if (!rules.on(FittingRule::kBodyErrors)) return std::vector<double>(skeleton.joints.size(), 0.0);
  if (skeleton.shape == BodyShape{} && rules.on(FittingRule::kUnknownShape)) scale *= kUnknownShape;
  std::vector<double> errors(skeleton.joints.size(), scale * kBodyError);
  for (const auto& [name, error] : kBodyErrors) {
    for (const char* side : {"", "left_", "right_"}) {
      if (const auto joint = skeleton.FindJoint(std::string(side) + name)) errors[*joint] = scale * error;
    }
  }
  return errors;
}

std::vector<Vector3d> BodyRotations(const Skeleton& skeleton, const std::vector<double>& bone_length,
                                    const std::vector<double>& body_error) {
  std::vector<double> variance(body_error.size(), 0.0);
  for (std::size_t j = 1; j < variance.size(); ++j)
    variance[j] = Square(body_error[j]) + Square(body_error[skeleton.joints[j].parent]);
  std::vector<Vector3d> variances;
  for (const Matrix3d& covariance : FrameOrientationByBones(skeleton, bone_length, variance))
    variances.emplace_back(covariance.diagonal());
  return variances;
}

std::vector<Vector3d> BodyRotations(const Skeleton& skeleton, const std::vector<double>& bone_length,
                                    const std::vector<double>& body_error, const Rules& rules) {
  if (rules.on(FittingRule::kBodyRotations)) return BodyRotations(skeleton, bone_length, body_error);
  return std::vector<Vector3d>(skeleton.joints.size(), Vector3d::Zero());
}

}  // namespace mocurate
