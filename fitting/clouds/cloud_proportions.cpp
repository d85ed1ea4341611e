#include "fitting/clouds/cloud_proportions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "fitting/clouds/cloud_rig_audit.h"
#include "fitting/clouds/cloud_size.h"
#include "fitting/clouds/cloud_tracking.h"

namespace mocurate {
namespace {

constexpr int kFramesOfClip = 9;  ///< of each clip, evenly spread

}  // namespace

Expected<std::vector<double>> BoneLengthsFromClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                                                    const PointCloudOptions& options) {
  std::vector<FusedCloud> clouds;
  for (const Clip& clip : clips) {
    DepthRigReport report;
    const Expected<Clip> audited = WithAuditedRig(clip, options.audit, report);
    if (!audited) return Forward(audited);
    Expected<std::vector<FusedCloud>> of_clip = FuseClip(*audited, options, kFramesOfClip);
    if (!of_clip) return Forward(of_clip);
    clouds.insert(clouds.end(), std::make_move_iterator(of_clip->begin()), std::make_move_iterator(of_clip->end()));
  }
  const Expected<double> scale = ScaleFromClouds(std::move(clouds), skeleton, options);
  if (!scale) return Forward(scale);
  std::vector<double> lengths = skeleton->RestBoneLengths();
  for (double& length : lengths) length *= *scale;
  return lengths;
}

}  // namespace mocurate
