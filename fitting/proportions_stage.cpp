#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/body/capsule_body.h"
#include "core/store/store.h"
#include "fitting/audit/rig_corrections.h"
#include "fitting/clouds/cloud_proportions.h"
#include "fitting/clouds/joint_cloud_fit.h"
#include "fitting/evidence/detector_points.h"
#include "fitting/evidence/motion_tracks.h"
#include "fitting/fit_outcome.h"
#include "fitting/keypoint_fit.h"
#include "fitting/proportions.h"
#include "fitting/solver/body_size.h"
#include "fitting/solver/marker_body.h"
#include "fitting/stages.h"

namespace mocurate {
namespace {

/// A warning about a clip.
Finding AboutClip(const std::string& clip, const char* code, double value, std::string message,
                  FindingAction action = FindingAction::kExcluded) {
  Finding finding = MakeFinding(code, Severity::kWarning, value, std::move(message), action);
  finding.clip = clip;
  return finding;
}

Finding NothingFrom(const Clip& clip, const Error& error) {
  return AboutClip(clip.id(), "no_proportions_from_clip", 0.0, error.Message());
}

constexpr double kSizesApart = 0.08;  ///< of the logarithm of a size; beyond, tracks and clouds show different bodies
constexpr double kMaxShapeDeviation = 3.0;  ///< standard deviations of a component; one person in 37 has more of ten

/// A person's clips and their ids.
struct PersonClips {
  std::vector<SkeletonTracks> tracks;
  std::vector<std::string> ids;
};

/// Excludes clips of another size than the person's, with a finding each.
void ExcludeOtherSizes(PersonClips& clips, std::vector<Finding>& findings) {
  std::vector<double> sizes;
  for (const SkeletonTracks& clip : clips.tracks) sizes.push_back(SizeAgainst(clip, clip.skeleton->RestBoneLengths()));
  const std::vector<bool> of_it = HasPersonsSize(sizes);
  PersonClips kept;
  for (std::size_t i = 0; i < of_it.size(); ++i) {
    if (of_it[i]) {
      kept.tracks.push_back(std::move(clips.tracks[i]));
      kept.ids.push_back(clips.ids[i]);
      continue;
    }
    findings.push_back(
        AboutClip(clips.ids[i], "another_size", sizes[i],
                  "the clip's bones are " + RoundedText(sizes[i], 3) +
                      " times the rest skeleton's and contradict the person's other clips; check the clip's unit and "
                      "person"));
  }
  clips = std::move(kept);
}

/// Measures the person's size on the clouds of their clips; a finding for each clip that has none.
Status MeasureSizeOfClouds(const std::vector<Clip>& clips, const SkeletonPtr& skeleton,
                           const PointCloudOptions& options, Proportions& person, std::vector<Finding>& findings) {
  Expected<BodyFromClouds> body = MeasureBodyInClouds(clips, skeleton, options);
  if (!body) return Forward(body);
  for (const auto& [clip, error] : body->nothing_from) findings.push_back(NothingFrom(clips[clip], error));
  person.scale = body->scale;
  person.skeleton = body->skeleton;
  person.bone_length = RoundedLengths(std::move(body->bone_length));
  return {};
}

/// Measures bones and body shape on the clouds, in poses fitted to the tracks. Without usable clouds, or where they
/// show another size, the tracks' body stays, with a finding.
Status MeasureBodyOfBoth(const std::vector<Clip>& clips, const PersonClips& seen, const SkeletonPtr& skeleton,
                         const ProportionsOptions& options, Proportions& person, std::vector<Finding>& findings) {
  if (options.point_clouds.height) return {};
  JointTrackOptions quick = options.joint_tracks;
  quick.uncertainty = false;
  quick.solver = PoseSolver::kBanded;
  std::vector<Motion> motions;
  std::vector<Clip> posed;
  for (std::size_t i = 0; i < seen.tracks.size(); ++i) {
    const auto clip =
        std::find_if(clips.begin(), clips.end(), [&](const Clip& candidate) { return candidate.id() == seen.ids[i]; });
    if (clip == clips.end() || SurfaceTimes(clip->evidence).empty()) continue;
    const SkeletonTracks tracks = OnBody(seen.tracks[i], person.skeleton);
    const std::vector<double>& depth_s = SurfaceTimes(clip->evidence);
    if (Status one = CheckOneClock(tracks.time_s, depth_s, clip->rate.FrameTime(1), clip->id()); !one) {
      findings.push_back(NothingFrom(*clip, one.error()));
      continue;
    }
    const Expected<FitResult> fit = RepairAndFit(tracks, clip->rate, person.bone_length, RepairOptions{}, quick);
    if (!fit && EndsAll(fit.error().code)) return Forward(fit);
    if (!fit) {
      findings.push_back(NothingFrom(*clip, fit.error()));
      continue;
    }
    motions.push_back(WithoutDetectorPoints(fit->motion, skeleton));
    posed.push_back(*clip);
  }
  if (posed.empty()) return {};
  const Expected<BodyFromClouds> body = MeasurePosedBody(posed, motions, person.scale, skeleton, options.point_clouds);
  if (!body && EndsAll(body.error().code)) return Forward(body);
  if (!body) {
    findings.push_back(NothingFrom(posed.front(), body.error()));
    return {};
  }
  for (const auto& [clip, error] : body->nothing_from) findings.push_back(NothingFrom(posed[clip], error));
  const double ratio = body->scale / person.scale;
  double unusual = 0.0;
  for (const double component : body->skeleton->shape) unusual = std::max(unusual, std::abs(component));
  if (std::abs(std::log(ratio)) > kSizesApart || unusual > kMaxShapeDeviation) {
    findings.push_back(AboutClip(posed.front().id(), "modalities_differ_in_size", ratio,
                                 "the body in the depth views is " + RoundedText(ratio, 3) +
                                     " times as large as the tracks', its body shape up to " + RoundedText(unusual, 2) +
                                     " standard deviations from the mean; the tracks' body is kept. Check depth_unit, "
                                     "cameras and the joint names of the tracks",
                                 FindingAction::kKept));
    return {};
  }
  UseBody(*body, person.skeleton, person.bone_length);
  person.bone_length = RoundedLengths(std::move(person.bone_length));
  person.scale = body->scale;
  return {};
}

}  // namespace

Expected<StageOutcome> ProportionsStage(const StageRequest& request) {
  Expected<ProportionsOptions> options = OptionsFromJson<ProportionsOptions>(request.options, "proportions");
  if (!options) return Forward(options);
  if (const StageInput* rig = RigInput(request)) options->keypoints.rig = rig->path;
  const Expected<SkeletonPtr> skeleton = LoadSkeleton(options->skeleton);
  if (!skeleton) return Forward(skeleton);

  std::map<std::string, const StageInput*> inputs;
  std::vector<std::string> names;
  for (const StageInput& input : request.inputs) {
    if (input.role != "evidence" || !inputs.emplace(input.name, &input).second) continue;
    names.push_back(input.name);
  }
  StageOutcome outcome;
  PersonClips clips;
  std::vector<Clip> cloud_clips;
  std::vector<Clip> keypoint_clips;
  std::vector<Clip> tracked_clips;
  std::set<std::string> points;
  SkeletonPtr tracked = *skeleton;
  std::vector<std::string> ids;
  std::optional<RigFile> rig;
  if (!options->keypoints.rig.empty()) {
    Expected<RigFile> read = ReadRigFile(options->keypoints.rig);
    if (!read) return Forward(read);
    rig = *std::move(read);
  }
  for (const std::string& name : ChooseProportionClips(names)) {
    Expected<Clip> clip = ReadEvidence(inputs[name]->path);
    if (!clip) return Forward(clip);
    ids.push_back(clip->id());
    if (options->method == FitMethod::kPointClouds) {
      ResolveDepthFiles(request, clip->evidence);
      cloud_clips.push_back(std::move(*clip));
      continue;
    }
    if (options->method == FitMethod::kKeypoints || options->method == FitMethod::kKeypointsAndClouds) {
      ResolveDepthFiles(request, clip->evidence);
      for (const std::string& point : DetectorNames(clip->evidence.keypoint_names)) points.insert(point);
      if (const Status fits = rig ? CheckRigFits(clip->evidence, *rig) : Status(); !fits) return Forward(fits);
      keypoint_clips.push_back(std::move(*clip));
      continue;
    }
    if (options->method != FitMethod::kJointTracks && options->method != FitMethod::kJointsAndClouds) continue;
    if (clips.tracks.empty())
      tracked = WithTrackerPoints(*skeleton, *clip);  // all clips of a person have the same source
    Expected<SkeletonTracks> tracks = TracksOfClip(*clip, tracked, options->other_joints);
    if (tracks) {
      clips.tracks.push_back(std::move(*tracks));
      clips.ids.push_back(clip->id());
      if (options->method != FitMethod::kJointsAndClouds) continue;
      ResolveDepthFiles(request, clip->evidence);
      tracked_clips.push_back(std::move(*clip));
      continue;
    }
    outcome.findings.push_back(NothingFrom(*clip, tracks.error()));
  }
  // One body for all clips, with the points of any clip.
  const SkeletonPtr body = WithDetectorPoints(tracked, {points.begin(), points.end()});
  for (const Clip& clip : keypoint_clips) {
    Expected<BodyTracks> found = TracksOnBody(clip.evidence, **skeleton, body, options->keypoints);
    if (found) {
      clips.tracks.push_back(std::move(found->tracks));
      clips.ids.push_back(clip.id());
    } else {
      outcome.findings.push_back(NothingFrom(clip, found.error()));
    }
  }
  ExcludeOtherSizes(clips, outcome.findings);
  if (clips.tracks.empty() && options->method == FitMethod::kKeypointsAndClouds) {
    for (Clip& clip : keypoint_clips) {
      if (!clip.evidence.depth_views.empty()) cloud_clips.push_back(std::move(clip));
    }
  }
  Proportions person = EstimateProportions(clips.tracks, cloud_clips.empty() ? body : *skeleton, *options);
  if (!clips.tracks.empty() && clips.tracks.front().least_sigma > 0.0) {
    Expected<MarkerBody> worn = LearnMarkerBody(clips.tracks, options->joint_tracks);
    if (!worn) return Forward(worn);
    person.skeleton = worn->skeleton;
    person.bone_length = RoundedLengths(std::move(worn->bone_length));
    person.scale = worn->scale;
    person.place_sigma = std::move(worn->place_sigma);
  }
  if (!cloud_clips.empty()) {
    const Status sized = MeasureSizeOfClouds(cloud_clips, *skeleton, options->point_clouds, person, outcome.findings);
    if (!sized) return Forward(sized);
  }
  if (HasTemplateShape(**skeleton) && !clips.tracks.empty()) {
    const std::vector<Clip>& with_depth =
        options->method == FitMethod::kKeypointsAndClouds ? keypoint_clips : tracked_clips;
    const Status both = MeasureBodyOfBoth(with_depth, clips, *skeleton, *options, person, outcome.findings);
    if (!both) return Forward(both);
  }
  person.person = request.item;
  person.clips = std::move(ids);
  nlohmann::json json = ProportionsJson(person, *body);
  if (Status written = WriteFile(request.output, json.dump(2) + "\n"); !written) return Forward(written);
  outcome.summary = std::move(json);
  outcome.summary.erase("clips");
  outcome.summary["clips"] = person.clips.size();
  return outcome;
}

}  // namespace mocurate
