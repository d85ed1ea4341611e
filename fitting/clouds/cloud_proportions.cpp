#include "fitting/clouds/cloud_proportions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/cloud_rig_audit.h"
#include "fitting/clouds/cloud_shape.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/joint_cloud_fit.h"

namespace mocurate {
namespace {

constexpr int kFramesOfClip = 9;          ///< frames per clip, evenly spaced (numerical)
constexpr std::size_t kPosedClouds = 16;  ///< clouds for a body with known poses, at most (numerical)
constexpr double kScaleOfTracks = 0.04;   ///< log scale; standard deviation of a size from tracks

Expected<std::vector<FusedCloud>> SomeCloudsOf(const Clip& clip, const PointCloudOptions& options) {
  DepthRigReport report;
  const Expected<Clip> audited = WithAuditedRig(clip, options.audit, report);
  if (!audited) return Forward(audited);
  return FuseClip(*audited, options, kFramesOfClip);
}

/// Clouds of clips one after another, and the errors of unusable clips.
struct CloudsOfClips {
  std::vector<FusedCloud> clouds;
  std::vector<std::size_t> clip;  ///< (clouds)
  std::vector<int> frame;         ///< (clouds) index in the clip
  std::vector<std::pair<std::size_t, Error>> nothing_from;
};

Expected<CloudsOfClips> SomeCloudsOf(const std::vector<Clip>& clips, const PointCloudOptions& options) {
  CloudsOfClips some;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    Expected<std::vector<FusedCloud>> of_clip = SomeCloudsOf(clips[i], options);
    if (!of_clip && EndsAll(of_clip.error().code)) return Forward(of_clip);
    if (!of_clip) {
      some.nothing_from.emplace_back(i, of_clip.error());
      continue;
    }
    const auto available = static_cast<int>(SurfaceTimes(clips[i].evidence).size());
    const auto count = static_cast<int>(of_clip->size());
    for (int k = 0; k < count; ++k) {
      some.clouds.push_back(std::move((*of_clip)[static_cast<std::size_t>(k)]));
      some.clip.push_back(i);
      some.frame.push_back(FrameOfFew(k, count, available));
    }
  }
  if (!clips.empty() && some.nothing_from.size() == clips.size())
    return InClip(some.nothing_from.front().second, clips.front());
  return some;
}

BodyFromClouds MeasuredBody(const ShapedPerson& person, const SkeletonPtr& skeleton) {
  BodyFromClouds body;
  body.scale = person.scale;
  body.skeleton = WithShape(skeleton, person.shape);
  body.bone_length = body.skeleton->RestBoneLengths();
  for (double& length : body.bone_length) length *= person.scale;
  return body;
}

}  // namespace

Expected<BodyFromClouds> MeasureBodyInClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                                             const PointCloudOptions& options) {
  Expected<CloudsOfClips> some = SomeCloudsOf(clips, options);
  if (!some) return Forward(some);
  const Expected<ShapedPerson> person = PersonFromClouds(std::move(some->clouds), skeleton, options);
  if (!person) return Forward(person);
  BodyFromClouds body = MeasuredBody(*person, skeleton);
  body.nothing_from = std::move(some->nothing_from);
  return body;
}

Expected<BodyFromClouds> MeasurePosedBody(const std::vector<Clip>& clips, const std::vector<Motion>& motions,
                                          double scale, const SkeletonPtr& skeleton, const PointCloudOptions& options) {
  Expected<CloudsOfClips> some = SomeCloudsOf(clips, options);
  if (!some) return Forward(some);
  const CapsuleBody capsules = CapsuleBody::Make(skeleton, scale);
  std::vector<PoseState> states;
  for (const Motion& motion : motions) states.push_back(StateOf(motion, capsules));
  std::vector<std::pair<std::size_t, std::size_t>> usable;  // (index of the clip, cloud): a few clouds are chosen over
                                                            // all clips
  for (std::size_t i = 0, of_clip = 0; i < some->clouds.size(); ++i) {
    of_clip = i > 0 && some->clip[i] == some->clip[i - 1] ? of_clip + 1 : 0;
    const bool is_posed = some->frame[i] < motions[some->clip[i]].frame_count();
    if (is_posed && some->clouds[i].size() >= kFewestPoints) usable.emplace_back(of_clip, i);
  }
  std::sort(usable.begin(), usable.end());
  ShapedPerson person;
  person.scale = scale;
  person.scale_sigma = kScaleOfTracks;
  std::vector<FusedCloud> clouds;
  const std::size_t count = std::min(usable.size(), kPosedClouds);
  double near = 0.0, all = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = usable[(2 * k + 1) * usable.size() / (2 * count)].second;
    const PoseState& state = states[some->clip[i]];
    person.poses.push_back(state.FrameParameters(some->frame[i]));
    near +=
        static_cast<double>(MatchPoints(capsules, state, some->frame[i], some->clouds[i], options.max_distance).size());
    all += some->clouds[i].size();
    clouds.push_back(std::move(some->clouds[i]));
  }
  if (near < kNearBodyShare * all || clouds.empty()) {
    return Fail(ErrorCode::kInconsistent,
                clouds.empty() ? "no depth image shows " + std::to_string(kFewestPoints) +
                                     " points of the person at the times of the other evidence"
                               : "only " + std::to_string(std::lround(100.0 * near / all)) +
                                     " % of the depth points lie near the body of the other evidence",
                clips.front().id(), "check that both are of one person, one clock and one world frame");
  }
  const Expected<ShapedPerson> shaped = FitShape(clouds, skeleton, std::move(person), options);
  if (!shaped) return Forward(shaped);
  BodyFromClouds body = MeasuredBody(*shaped, skeleton);
  body.nothing_from = std::move(some->nothing_from);
  return body;
}

void UseBody(const BodyFromClouds& in_clouds, SkeletonPtr& skeleton, std::vector<double>& bone_length) {
  auto own = std::make_shared<Skeleton>(*skeleton);
  own->shape = in_clouds.skeleton->shape;
  for (int j = 0; j < in_clouds.skeleton->joint_count(); ++j) {
    own->joints[j].rest_offset = in_clouds.skeleton->joints[j].rest_offset;
    bone_length[j] = in_clouds.bone_length[j];
  }
  skeleton = std::move(own);
}

}  // namespace mocurate
