#include "fitting/clouds/cloud_proportions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "fitting/clouds/cloud_rig_audit.h"
#include "fitting/clouds/cloud_size.h"
#include "fitting/clouds/cloud_tracking.h"

namespace mocurate {
namespace {

constexpr int kFramesOfClip = 9;  ///< of each clip, evenly spread

Expected<std::vector<FusedCloud>> SomeCloudsOf(const Clip& clip, const PointCloudOptions& options) {
  DepthRigReport report;
  const Expected<Clip> audited = WithAuditedRig(clip, options.audit, report);
  if (!audited) return Forward(audited);
  return FuseClip(*audited, options, kFramesOfClip);
}

/// Errors that say nothing about the clip.
bool EndsAll(ErrorCode code) { return code == ErrorCode::kInterrupted || code == ErrorCode::kInternal; }

}  // namespace

Expected<BodyFromClouds> MeasureBodyInClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                                             const PointCloudOptions& options) {
  BodyFromClouds body;
  std::vector<FusedCloud> clouds;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    Expected<std::vector<FusedCloud>> of_clip = SomeCloudsOf(clips[i], options);
    if (!of_clip && EndsAll(of_clip.error().code)) return Forward(of_clip);
    if (!of_clip) {
      body.nothing_from.emplace_back(i, of_clip.error());
      continue;
    }
    clouds.insert(clouds.end(), std::make_move_iterator(of_clip->begin()), std::make_move_iterator(of_clip->end()));
  }
  if (!clips.empty() && body.nothing_from.size() == clips.size()) {
    Error error = body.nothing_from.front().second;
    error.where = clips.front().id() + (error.where.empty() ? "" : ": " + error.where);
    return tl::unexpected<Error>(std::move(error));
  }
  const Expected<double> scale = ScaleFromClouds(std::move(clouds), skeleton, options);
  if (!scale) return Forward(scale);
  body.scale = *scale;
  body.bone_length = skeleton->RestBoneLengths();
  for (double& length : body.bone_length) length *= *scale;
  return body;
}

}  // namespace mocurate
