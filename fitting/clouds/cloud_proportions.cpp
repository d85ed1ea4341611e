#include "fitting/clouds/cloud_proportions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/solver/bone_lengths.h"

namespace mocurate {
namespace {

constexpr std::size_t kClips = 2;
constexpr int kFrames = 10;              ///< of each clip, evenly spread
constexpr int kRounds = 3;               ///< of bones and radii in turn
constexpr double kLargestSpread = 0.06;  ///< of a bone against the body's size, as a share of its length
constexpr double kThinning = 1.6;        ///< voxels are larger here than in the fit

/// The chosen frames alone, with the poses they were tracked in.
struct Sample {
  std::vector<FusedCloud> clouds;
  PoseState state;
};

Sample Choose(CloudTrack& track, const std::vector<double>& bone_length) {
  std::vector<int> chosen;
  const int frames = track.state.frames();
  const int count = std::min(kFrames, frames);
  for (int i = 0; i < count; ++i) {
    const int f = count > 1 ? static_cast<int>(static_cast<long>(i) * (frames - 1) / (count - 1)) : 0;
    if (track.outcomes[f].iterations > 0) chosen.push_back(f);
  }
  Sample sample{{}, PoseState(*track.body.skeleton, static_cast<int>(chosen.size()), bone_length,
                              track.body.MovingJoints())};
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    sample.clouds.push_back(track.clouds[chosen[i]]);
    const double* from = track.state.translation(chosen[i]);
    std::copy(from, track.state.rotation(chosen[i], track.state.joints() - 1) + 3,
              sample.state.translation(static_cast<int>(i)));
  }
  return sample;
}

Expected<std::vector<double>> BonesOfClip(const Clip& clip, const SkeletonPtr& skeleton,
                                          const PointCloudOptions& options) {
  Expected<std::vector<FusedCloud>> clouds = FuseClip(clip, options);
  if (!clouds) return Forward(clouds);
  const double scale = ScaleFromHeight(*skeleton, *clouds);
  std::vector<double> prior = skeleton->RestBoneLengths();
  std::vector<double> spread;
  for (double& length : prior) {
    length *= scale;
    spread.push_back(kLargestSpread * length + 1e-4);
  }
  auto track = TrackClouds(std::move(*clouds), skeleton, prior, 1.0 / clip.rate.hz(), options);
  if (!track) return Forward(track);
  Sample sample = Choose(*track, prior);
  std::vector<double> bones = prior;
  for (int round = 0; round < kRounds; ++round) {
    const auto fit = FitCloudBones(track->body, sample.clouds, sample.state, prior, spread, options);
    if (!fit) return Forward(fit);
    for (int j = 0; j < skeleton->joint_count(); ++j) bones[j] = *sample.state.bone(j);
    MakeSymmetric(*skeleton, std::vector<double>(bones.size(), 1.0), bones);
    for (int j = 0; j < skeleton->joint_count(); ++j) *sample.state.bone(j) = bones[j];
    sample.state.Update(0, sample.state.frames(), false);
    CalibrateRadii(sample.clouds, sample.state, 0, sample.state.frames(), options.max_distance, track->body);
  }
  return bones;
}

}  // namespace

Expected<std::vector<double>> BoneLengthsFromClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                                                    const PointCloudOptions& options) {
  if (clips.empty()) return skeleton->RestBoneLengths();
  PointCloudOptions coarse = options;
  coarse.voxel_size *= kThinning;
  std::vector<double> mean(skeleton->joints.size(), 0.0);
  const std::size_t count = std::min(kClips, clips.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Expected<std::vector<double>> bones = BonesOfClip(clips[i], skeleton, coarse);
    if (!bones) return Forward(bones);
    for (std::size_t j = 0; j < mean.size(); ++j) mean[j] += (*bones)[j] / static_cast<double>(count);
  }
  return mean;
}

}  // namespace mocurate
