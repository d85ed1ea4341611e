#include "fitting/clouds/cloud_terms.h"

#include <algorithm>
#include <utility>

#include "fitting/solver/rest_sigmas.h"

namespace mocurate {
namespace {

constexpr double kBodyPatch = 0.05;  ///< m; closer points share the error of the capsule body

}  // namespace

double PatchShare(const FusedCloud& cloud, const PointCloudOptions& options) {
  return options.rules.on(FittingRule::kPatchShare) ? std::min(1.0, cloud.spacing / kBodyPatch) : 1.0;
}

std::vector<JointPrior> PriorsInClouds(const Skeleton& skeleton, const PoseGaussian* pose,
                                       const PointCloudOptions& options) {
  const std::vector<double> sigmas = RestPoseSigmas(skeleton, options.priors.rest);
  std::vector<JointPrior> priors(sigmas.size());
  for (std::size_t j = 1; j < sigmas.size(); ++j) {
    const auto& limits = skeleton.joints[j].limits;
    const bool limited = limits && (options.priors.all_joints || sigmas[j] >= options.priors.rest);
    priors[j] = {1.0 / Square(sigmas[j]), limited ? &*limits : nullptr, nullptr};
  }
  for (std::size_t k = 0; pose != nullptr && k < pose->joints.size(); ++k) {
    JointPrior& prior = priors[static_cast<std::size_t>(pose->joints[k])];
    prior = {std::max(0.0, prior.rest - pose->rest[k]), nullptr, nullptr};
  }
  return priors;
}

StepTerm StepInClouds(int joints, double seconds, const PointCloudOptions& options) {
  const auto number = static_cast<std::size_t>(joints);
  const double move = 1.0 / (Square(options.priors.position_noise) * seconds);
  StepTerm step{std::vector<double>(number, 1.0 / (Square(options.priors.rotation_noise) * seconds)),
                std::vector<double>(number, options.priors.all_joints ? move : 0.0)};
  step.move.front() = move;
  return step;
}

PoseTerms CloudTerms(const CapsuleBody& body, const PointCloudOptions& options) {
  PoseTerms terms;
  terms.body = &body;
  terms.huber = HuberSigmas(options.huber_share, 3);
  terms.limit = 1.0 / options.priors.limit;
  return terms;
}

FrameTerms TermsOfFit(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                      std::vector<CloudMatch> matches, double sigma, const PointCloudOptions& options) {
  const double share = fit.point_weight * PatchShare(cloud, options);
  FrameTerms terms;
  terms.frame = fit.frame;
  terms.points = fit.joints;
  terms.surface = {&cloud.points, std::move(matches), share / sigma, share * HuberSigmas(options.huber_share, 1)};
  terms.pose = fit.pose;
  terms.priors = PriorsInClouds(*body.skeleton, fit.pose, options);
  const int joints = body.skeleton->joint_count();
  for (const FixedNeighbourFrame& held : fit.held)
    terms.fixed.push_back({fit.frame + held.step, StepInClouds(joints, held.seconds, options)});
  return terms;
}

}  // namespace mocurate
