#include "fitting/clouds/cloud_proportions.h"

#include <iterator>
#include <utility>

#include "fitting/clouds/cloud_tracking.h"

namespace mocurate {
namespace {

constexpr int kFrames = 9;  ///< of each clip, evenly spread

}  // namespace

Expected<std::vector<double>> BoneLengthsFromClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                                                    const PointCloudOptions& options) {
  std::vector<FusedCloud> clouds;
  for (const Clip& clip : clips) {
    Expected<std::vector<FusedCloud>> of_clip = FuseClip(clip, options, kFrames);
    if (!of_clip) return Forward(of_clip);
    clouds.insert(clouds.end(), std::make_move_iterator(of_clip->begin()), std::make_move_iterator(of_clip->end()));
  }
  const double scale = ScaleFromHeight(skeleton, clouds, options.voxel_size);
  std::vector<double> lengths = skeleton->RestBoneLengths();
  for (double& length : lengths) length *= scale;
  return lengths;
}

}  // namespace mocurate
