#pragma once

#include <vector>

#include "fitting/clouds/capsule_fit.h"
#include "fitting/options.h"
#include "fitting/terms/terms.h"

namespace mocurate {

/// Neighbouring points share the error of the body, so that a patch of them counts as one observation. Square root of a
/// point's share in its patch, by the surface that it stands for; 1 where the rule is off.
double PatchShare(const FusedCloud& cloud, const PointCloudOptions& options);

/// (J) Priors of a depth fit. Limits only of joints as mobile as limbs (RestPoseSigmas): for the others the rest pose
/// suffices, and a search that cannot pass through a twisted trunk misses orientations (of 24 stills two more were off
/// by 0.25 m). Of joints whose rotation `pose` knows, the rest pose counts as far as it is not in that already; their
/// limits are in it.
std::vector<JointPrior> PriorsInClouds(const Skeleton& skeleton, const PoseGaussian* pose,
                                       const PointCloudOptions& options);

/// Process noise of a depth fit over a time.
StepTerm StepInClouds(int joints, double seconds, const PointCloudOptions& options);

/// Terms without frames of a depth fit, which has no hinges.
PoseTerms CloudTerms(const CapsuleBody& body, const PointCloudOptions& options);

/// Terms of a frame that is fitted: matched points, weighted with `sigma` (m, of a point's distance), what else the fit
/// is given, and priors.
FrameTerms TermsOfFit(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                      std::vector<CloudMatch> matches, double sigma, const PointCloudOptions& options);

}  // namespace mocurate
