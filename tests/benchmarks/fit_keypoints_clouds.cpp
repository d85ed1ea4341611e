// bench_fit_keypoints_clouds [CLIPS [FRAMES [SEED [FOLDER [OPTION=NUMBER ...]]]]]: fits studio clips of HumanAct12's 12
// classes, seen by PHSPD's three depth cameras and by colour cameras beside them. Depth images have a Kinect's errors,
// BODY_25 keypoints a detector's; bodies are unknown to the fitter. Prints joint and rotation error and coverage of
// keypoints alone, depth alone (facing known within 45 degrees) and both. Images are cached in FOLDER. Options: views,
// noise (px), miss, wrong (shares), ring (1: a ring of `views` cameras instead of PHSPD's), late (s), off (m),
// subjects.
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>

#include "fitting/clouds/cloud_proportions.h"
#include "fitting/clouds/fit_clouds.h"
#include "fitting/evidence/detector_points.h"
#include "fitting/keypoint_cloud_fit.h"
#include "fitting/keypoint_fit.h"
#include "fitting/proportions.h"
#include "tests/benchmarks/clip_lines.h"
#include "tests/benchmarks/given_numbers.h"
#include "tests/benchmarks/given_takes.h"
#include "tests/benchmarks/options_without.h"
#include "tests/fitting/fit_score.h"
#include "tests/fitting/mixed_takes.h"

namespace mocurate {
namespace {

struct Scores {
  FitScore keypoints, clouds, both;
  double seconds_keypoints = 0.0, seconds_clouds = 0.0, seconds_both = 0.0;
  int findings = 0;
};

double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void Print(const char* name, const FitScore& score, double seconds) {
  std::printf(
      "{\"name\": \"%s\", \"frames\": %d, \"joint_mm\": %.2f, \"rotation_deg\": %.2f, \"within_sigma\": %.3f, "
      "\"within_two\": %.3f, \"frames_per_s_with_decoding\": %.1f}\n",
      name, score.frames, score.joint_mm(), score.rotation_deg(), score.within_one(), score.within_two(),
      score.frames / seconds);
}

Status Fit(const CloudTake& take, const SkeletonPtr& skeleton, const SkeletonPtr& body, std::vector<double> bones,
           const BodyFromClouds& in_clouds, FittingOptions options, benchmarks::ClipLines& lines, Scores& scores) {
  Clip clip;
  clip.identity.recording = take.clip.name;
  clip.rate = take.clip.truth.rate;
  clip.evidence = take.evidence;
  options.point_clouds.start.facing = take.reported_heading;
  double begin = CpuSeconds();
  FitScore k, c, b;
  if (clip.evidence.keypoint_views.size() > 1) {  // one view has no fit of keypoints alone
    const auto keypoints = FitKeypoints(clip.evidence, clip.rate, skeleton, body, bones, options);
    if (!keypoints) return Forward(keypoints);
    const double of_keypoints = CpuSeconds() - begin;
    scores.seconds_keypoints += of_keypoints;
    lines.Add(take.clip, "keypoints", *keypoints, of_keypoints);
    k.Add(*keypoints, take.clip), scores.keypoints.Add(*keypoints, take.clip);
  }
  begin = CpuSeconds();
  const auto clouds = FitClouds(clip, in_clouds.skeleton, in_clouds.bone_length, options.point_clouds);
  if (!clouds) return Forward(clouds);
  const double of_clouds = CpuSeconds() - begin;
  scores.seconds_clouds += of_clouds;
  begin = CpuSeconds();
  SkeletonPtr own = body;
  UseBody(in_clouds, own, bones);  // as the stage proportions does
  const auto both = FitKeypointsAndClouds(clip, skeleton, own, bones, options);
  if (!both) return Forward(both);
  const double of_both = CpuSeconds() - begin;
  scores.seconds_both += of_both;
  lines.Add(take.clip, "clouds", *clouds, of_clouds);
  lines.Add(take.clip, "keypoints_and_clouds", *both, of_both);
  c.Add(*clouds, take.clip), scores.clouds.Add(*clouds, take.clip);
  b.Add(*both, take.clip), scores.both.Add(*both, take.clip);
  std::fprintf(stderr,
               "%-24s keypoints %5.1f mm %4.1f deg, clouds %5.1f mm %4.1f deg, both %5.1f mm %4.1f deg, weight %.3f\n",
               take.clip.name.c_str(), k.joint_mm(), k.rotation_deg(), c.joint_mm(), c.rotation_deg(), b.joint_mm(),
               b.rotation_deg(), both->surface_weight.value_or(0.0));
  for (const Finding& finding : both->findings) {
    if (finding.severity == Severity::kInfo) continue;
    std::fprintf(stderr, "    %s %.3g: %s\n", finding.code.c_str(), finding.value, finding.message.c_str());
    ++scores.findings;
  }
  return {};
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  CloudTakeOptions wanted;
  MixedTakeOptions mixed;
  mixed.rig.kind = RigKind::kPhspd;
  const std::filesystem::path folder = GivenTakes(argc, argv, "/tmp/bench_fit_keypoints_clouds", wanted);
  for (const auto& [name, value] : GivenNumbers(argc, argv, 5)) {
    if (name == "views") mixed.views = static_cast<int>(value);
    if (name == "noise") mixed.keypoints.noise = value;
    if (name == "miss") mixed.keypoints.miss_share = value;
    if (name == "wrong") mixed.keypoints.wrong_share = value;
    if (name == "ring") mixed.rig.kind = value != 0.0 ? RigKind::kRing : RigKind::kPhspd;
    if (name == "late") mixed.later_s = value;
    if (name == "off") mixed.world_off.translation = value / std::sqrt(3.0) * Vector3d::Ones();
    if (name == "subjects") wanted.subjects = static_cast<int>(value);
  }
  mixed.rig.cameras = mixed.views;
  std::vector<CloudTake> takes = CloudTakes(wanted, folder);
  if (takes.empty()) return std::fprintf(stderr, "no body: set MOCURATE_DATA\n"), 2;
  const auto shape = ReadBodyTemplate(std::filesystem::path(std::getenv("MOCURATE_DATA")) / "body_cc0/body_cc0.h5");
  const std::vector<Actor> actors = ActorsOfTakes(wanted, *shape);
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  FittingOptions options = benchmarks::OptionsWithout();
  options.joint_tracks.solver = PoseSolver::kBanded;
  options.point_clouds.solver = PoseSolver::kBanded;
  Scores scores;
  benchmarks::ClipLines lines(argc, argv);
  for (int person = 1; person <= wanted.subjects; ++person) {
    std::vector<Clip> clips;
    std::vector<SkeletonTracks> tracks;
    SkeletonPtr body;
    for (CloudTake& take : takes) {
      if (take.clip.subject != person) continue;
      AddKeypointViews(mixed, actors[static_cast<std::size_t>(person - 1)], static_cast<std::int64_t>(wanted.seed),
                       take);
      clips.emplace_back();
      clips.back().evidence = take.evidence;
      body = WithDetectorPoints(skeleton, DetectorNames(take.evidence.keypoint_names));
      auto found = TracksOnBody(take.evidence, *skeleton, body, options.keypoints);
      if (found) tracks.push_back(std::move(found->tracks));
    }
    if (clips.empty()) continue;
    const auto cloud_bones = MeasureBodyInClouds(clips, skeleton, options.point_clouds);
    if (!cloud_bones) return std::fprintf(stderr, "%s\n", cloud_bones.error().Message().c_str()), 1;
    const auto proportions = EstimateProportions(tracks, body, ProportionsOptions{});
    double off_keypoints = 0.0, off_clouds = 0.0, joints = 0.0;
    for (const CloudTake& take : takes) {
      if (take.clip.subject != person) continue;
      if (joints == 0.0) {
        for (std::size_t j = 1; j < cloud_bones->bone_length.size(); ++j, joints += 1.0) {
          off_keypoints += std::abs(proportions.bone_length[j] - take.clip.truth.bone_length[j]);
          off_clouds += std::abs(cloud_bones->bone_length[j] - take.clip.truth.bone_length[j]);
        }
        std::fprintf(stderr, "person %d: bones off %.1f mm by keypoints, %.1f mm by clouds\n", person,
                     1e3 * off_keypoints / joints, 1e3 * off_clouds / joints);
      }
      const Status fitted = Fit(take, skeleton, body, proportions.bone_length, *cloud_bones, options, lines, scores);
      if (!fitted) std::fprintf(stderr, "%s: %s\n", take.clip.name.c_str(), fitted.error().Message().c_str());
    }
  }
  if (scores.keypoints.frames > 0) Print("keypoints", scores.keypoints, scores.seconds_keypoints);
  Print("clouds", scores.clouds, scores.seconds_clouds);
  Print("keypoints_and_clouds", scores.both, scores.seconds_both);
}
