// bench_fit_clouds [CLIPS [FRAMES [SEED [FOLDER [OPTION=NUMBER ...]]]]]: fits studio clips of HumanAct12's 12 classes,
// ordered by person, at most FRAMES frames each, on one core. PHSPD's three depth cameras see them (512 x 424, a
// Kinect's errors); bodies are unknown to the fitter. Errors as in bench_studio_fits; frames/s from decoded images to a
// motion, and of decoding alone. Images are cached in FOLDER. Options: those of point_clouds by name, ceres, room,
// subjects; start (0: the facing is unknown); mix (1: also joint tracks of the same frames with 30 mm RMS of noise,
// alone and with the clouds); gap (number of frames without a person in the middle, and errors after them); stills (1:
// only the middle frame of each clip is known of its person); alone (1: only the clip itself is known of its person);
// views (bodies are fitted from all views, poses from this many, at least one); hidden (a joint's number: no view shows
// points within 0.2 m of it; prints its uncertainty).
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>

#include "fitting/clouds/cloud_proportions.h"
#include "fitting/clouds/cloud_tracking.h"
#include "fitting/clouds/fit_clouds.h"
#include "fitting/clouds/joint_cloud_fit.h"
#include "fitting/clouds/person_points.h"
#include "fitting/fit_outcome.h"
#include "fitting/proportions.h"
#include "tests/benchmarks/clip_lines.h"
#include "tests/benchmarks/given_numbers.h"
#include "tests/benchmarks/given_takes.h"
#include "tests/benchmarks/options_without.h"
#include "tests/fitting/cloud_takes.h"
#include "tests/fitting/fit_score.h"

namespace mocurate {
namespace {

constexpr int kFewPointsOfStill = 1000;

double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Spent {
  double decode = 0.0, fuse = 0.0, person = 0.0, fit = 0.0;
};

void Set(const std::string& name, double value, PointCloudOptions& options, CloudTakeOptions& takes) {
  if (name == "ceres") options.solver = value != 0.0 ? PoseSolver::kCeres : PoseSolver::kBanded;
  if (name == "voxel_size") options.voxel_size = value;
  if (name == "max_distance") options.max_distance = value;
  if (name == "iterations") options.iterations = static_cast<std::int64_t>(value);
  if (name == "rotation_process_noise") options.priors.rotation_noise = value;
  if (name == "velocity_process_noise") options.priors.position_noise = value;
  if (name == "rest_sigma") options.priors.rest = value;
  if (name == "huber_share") options.huber_share = value;
  if (name == "room") takes.room = value != 0.0;
  if (name == "stills") takes.stills = value != 0.0;
  if (name == "subjects") takes.subjects = static_cast<int>(value);
}

Expected<std::vector<FusedCloud>> Fuse(const std::vector<DepthView>& views, const PointCloudOptions& options,
                                       Spent& spent) {
  std::vector<FusedCloud> clouds;
  for (int f = 0; f < static_cast<int>(views[0].files.size()); ++f) {
    double begin = CpuSeconds();
    const auto images = ReadFrame(views, f);
    if (!images) return Forward(images);
    spent.decode += CpuSeconds() - begin;
    begin = CpuSeconds();
    const auto cloud = FuseImages(views, *images, options.voxel_size);
    if (!cloud) return Forward(cloud);
    spent.fuse += CpuSeconds() - begin;
    begin = CpuSeconds();
    const bool person = options.rules.on(FittingRule::kPersonPoints);
    clouds.push_back(person ? PersonPoints(*cloud, options.voxel_size) : *cloud);
    spent.person += CpuSeconds() - begin;
  }
  return clouds;
}

/// Removes the points within 0.2 m of the joint's true position.
void Hide(int joint, const Motion& truth, std::vector<FusedCloud>& clouds) {
  for (std::size_t f = 0; f < clouds.size(); ++f) {
    FusedCloud left = clouds[f];
    int kept = 0;
    for (int i = 0; i < clouds[f].size(); ++i) {
      if ((clouds[f].points.col(i) - truth.joints.at(static_cast<int>(f), joint)).norm() < 0.2) continue;
      left.points.col(kept) = clouds[f].points.col(i);
      left.normals.col(kept++) = clouds[f].normals.col(i);
    }
    left.points.conservativeResize(3, kept);
    left.normals.conservativeResize(3, kept);
    clouds[f] = std::move(left);
  }
}

/// Empties `hidden` frames in the middle. Returns the frame after them; 0 without a gap.
int HideMiddleFrames(int hidden, std::vector<FusedCloud>& clouds) {
  const auto frames = static_cast<int>(clouds.size());
  if (hidden <= 0 || 2 * hidden > frames) return 0;
  const int begin = (frames - hidden) / 2;
  std::fill(clouds.begin() + begin, clouds.begin() + begin + hidden, FusedCloud{});
  return begin + hidden;
}

/// Prints the joint's error, its stated deviation per axis, and the number of frames in which it is observed.
void ReportJoint(int joint, const FitResult& fit, const Motion& truth) {
  double error = 0.0, variance = 0.0;
  int observed = 0;
  const Motion& motion = fit.motion;
  for (int f = 0; f < motion.frame_count(); ++f) {
    const std::size_t at = static_cast<std::size_t>(f) * motion.joint_count() + static_cast<std::size_t>(joint);
    error += (motion.joints.at(f, joint) - truth.joints.at(f, joint)).squaredNorm() / 3.0;
    for (const int i : {0, 3, 5}) variance += motion.position_cov[6 * at + static_cast<std::size_t>(i)] / 3.0;
    observed += motion.state[at] == JointState::kObserved ? 1 : 0;
  }
  const double n = motion.frame_count();
  std::fprintf(stderr, "    %s: %.1f mm off per axis, %.1f stated, observed in %d of %.0f frames\n",
               motion.skeleton->joints[static_cast<std::size_t>(joint)].name.c_str(), 1e3 * std::sqrt(error / n),
               1e3 * std::sqrt(variance / n), observed, n);
}

/// Errors of joint tracks alone and of tracks with clouds.
struct MixScore {
  FitScore tracks, both;
  double surface_weight = 0.0;
  int clips = 0;
};

Status AddMix(const CloudTake& take, const std::vector<FusedCloud>& clouds, const Proportions& person,
              const PointCloudOptions& options, benchmarks::ClipLines& lines, MixScore& score) {
  const FittingOptions given = benchmarks::OptionsWithout();
  JointTrackOptions track_options = given.joint_tracks;
  track_options.solver = PoseSolver::kBanded;
  track_options.poses = true;
  const double begin = CpuSeconds();
  const auto tracks = RepairAndFit(OnBody(take.clip.tracks, person.skeleton), take.clip.truth.rate, person.bone_length,
                                   given.repair, track_options);
  if (!tracks) return Forward(tracks);
  const double tracks_end = CpuSeconds();
  const auto both = FitTracksAndClouds(*tracks, clouds, options);
  if (!both) return Forward(both);
  FitScore alone, joint;
  alone.Add(*tracks, take.clip), score.tracks.Add(*tracks, take.clip);
  joint.Add(*both, take.clip), score.both.Add(*both, take.clip);
  lines.Add(take.clip, "tracks", *tracks, tracks_end - begin);
  lines.Add(take.clip, "tracks_and_clouds", *both, CpuSeconds() - begin);
  score.surface_weight += *both->surface_weight;
  ++score.clips;
  std::fprintf(stderr, "    tracks %5.1f mm %4.1f deg, both %5.1f mm %4.1f deg, weight %.3f, residual %4.1f mm\n",
               alone.joint_mm(), alone.rotation_deg(), joint.joint_mm(), joint.rotation_deg(), *both->surface_weight,
               1e3 * both->residual_rms);
  return {};
}

/// As the stage proportions does for joints_and_clouds.
Status TakeBodyOfBoth(const std::vector<CloudTake>& takes, const SkeletonPtr& skeleton,
                      const PointCloudOptions& options, Proportions& person) {
  std::vector<Clip> clips;
  std::vector<Motion> motions;
  const FittingOptions given = benchmarks::OptionsWithout();
  JointTrackOptions track_options = given.joint_tracks;
  track_options.solver = PoseSolver::kBanded;
  for (const CloudTake& take : takes) {
    const auto fit = RepairAndFit(OnBody(take.clip.tracks, person.skeleton), take.clip.truth.rate, person.bone_length,
                                  given.repair, track_options);
    if (!fit) return Forward(fit);
    motions.push_back(fit->motion);
    clips.emplace_back();
    clips.back().evidence = take.evidence;
  }
  const auto body = MeasurePosedBody(clips, motions, person.scale, skeleton, options);
  if (!body) return Forward(body);
  UseBody(*body, person.skeleton, person.bone_length);
  return {};
}

/// Takes of one person each, or one take each.
std::vector<std::vector<CloudTake>> ByPerson(const std::vector<CloudTake>& takes, bool alone) {
  std::map<std::string, std::vector<CloudTake>> people;
  for (const CloudTake& take : takes) {
    people[std::to_string(take.clip.subject) + (alone ? take.clip.name : "")].push_back(take);
  }
  std::vector<std::vector<CloudTake>> by_person;
  for (auto& [name, of_person] : people) by_person.push_back(std::move(of_person));
  return by_person;
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  CloudTakeOptions wanted;
  PointCloudOptions options = benchmarks::OptionsWithout().point_clouds;
  options.solver = PoseSolver::kBanded;
  const std::filesystem::path folder = GivenTakes(argc, argv, "/tmp/bench_fit_clouds", wanted);
  std::map<std::string, double> given = GivenNumbers(argc, argv, 5);
  for (const auto& [name, value] : given) Set(name, value, options, wanted);
  const std::vector<CloudTake> takes = CloudTakes(wanted, folder);
  if (takes.empty()) return std::fprintf(stderr, "no body: set MOCURATE_DATA\n"), 2;
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  Spent spent;
  FitScore all;
  FitScore after_gap;
  MixScore mix;
  benchmarks::ClipLines lines(argc, argv);
  double points = 0.0, iterations = 0.0;
  for (const std::vector<CloudTake>& of_person : ByPerson(takes, wanted.stills || given["alone"] != 0.0)) {
    std::vector<Clip> clips;
    for (const CloudTake& take : of_person) {
      clips.emplace_back();
      clips.back().evidence = take.evidence;
    }
    const auto bones = MeasureBodyInClouds(clips, skeleton, options);
    if (!bones) return std::fprintf(stderr, "%s\n", bones.error().Message().c_str()), 1;
    std::vector<SkeletonTracks> tracks;
    for (const CloudTake& take : of_person) tracks.push_back(take.clip.tracks);
    Proportions person;
    if (given["mix"] != 0.0) {
      const auto estimated = EstimateProportions(tracks, skeleton, ProportionsOptions{});
      person = estimated;
      if (Status both = TakeBodyOfBoth(of_person, skeleton, options, person); !both)
        return std::fprintf(stderr, "%s\n", both.error().Message().c_str()), 1;
    }
    for (const CloudTake& take : of_person) {
      std::vector<DepthView> views = take.evidence.depth_views;
      if (given.count("views") != 0)
        views.resize(std::clamp<std::size_t>(static_cast<std::size_t>(given["views"]), 1, views.size()));
      auto clouds = Fuse(views, options, spent);
      if (!clouds) return std::fprintf(stderr, "%s\n", clouds.error().Message().c_str()), 1;
      for (const FusedCloud& cloud : *clouds) points += cloud.size();
      if (wanted.stills && (*clouds)[0].size() < kFewPointsOfStill) continue;  // the person left the cameras' view
      const bool facing_known = given.count("start") == 0 ? !wanted.stills : given["start"] != 0.0;
      if (facing_known) options.start.facing = take.reported_heading;
      const std::vector<FusedCloud> copies = given["mix"] != 0.0 ? *clouds : std::vector<FusedCloud>{};
      if (given.count("hidden") != 0) Hide(static_cast<int>(given["hidden"]), take.clip.truth, *clouds);
      const int first_after_gap = HideMiddleFrames(static_cast<int>(given["gap"]), *clouds);
      const double begin = CpuSeconds();
      const auto fit = FitFusedClouds(std::move(*clouds), {take.clip.truth.rate, take.clip.tracks.time_s},
                                      bones->skeleton, bones->bone_length, options);
      const double own_seconds = CpuSeconds() - begin;
      spent.fit += own_seconds;
      if (!fit) return std::fprintf(stderr, "%s\n", fit.error().Message().c_str()), 1;
      FitScore one;
      one.Add(*fit, take.clip);
      all.Add(*fit, take.clip);
      lines.Add(take.clip, "clouds", *fit, own_seconds);
      if (first_after_gap > 0) after_gap.Add(*fit, take.clip, first_after_gap, fit->motion.frame_count());
      iterations += fit->iterations;
      const double size = bones->bone_length[4] / take.clip.truth.bone_length[4];
      std::fprintf(
          stderr,
          "%-24s %s %3d frames %6.1f mm %5.1f deg, residual %4.1f mm, thigh %4.2f of the truth, %4.1f, %4.1f %%\n",
          take.clip.name.c_str(), take.seated ? "seated" : "stands", one.frames, one.joint_mm(), one.rotation_deg(),
          1e3 * fit->residual_rms, size, 1e2 * one.within_one(), 1e2 * one.within_two());
      if (!copies.empty()) {
        const Status mixed = AddMix(take, copies, person, options, lines, mix);
        if (!mixed) return std::fprintf(stderr, "%s\n", mixed.error().Message().c_str()), 1;
      }
      if (given.count("hidden") != 0) {
        const int hidden = static_cast<int>(given["hidden"]);
        ReportJoint(std::max(0, skeleton->joints[static_cast<std::size_t>(hidden)].parent), *fit, take.clip.truth);
        ReportJoint(hidden, *fit, take.clip.truth);
      }
      for (const Finding& finding : fit->findings) {
        std::fprintf(stderr, "    %s %.3g: %s\n", finding.code.c_str(), finding.value, finding.message.c_str());
      }
    }
  }
  std::fprintf(stderr, "joints (mm):");
  for (std::size_t j = 0; j < all.by_joint.size(); ++j) {
    std::fprintf(stderr, " %s %.1f", skeleton->joints[j].name.c_str(), all.by_joint[j] / all.frames * 1e3);
  }
  std::fprintf(stderr, "\n");
  if (after_gap.frames > 0) {
    std::printf("{\"name\": \"after_gap\", \"joint_mm\": %.2f, \"within_sigma\": %.3f, \"within_two\": %.3f}\n",
                after_gap.joint_mm(), after_gap.within_one(), after_gap.within_two());
  }
  const double n = all.frames;
  if (mix.clips > 0) {
    std::printf(
        "{\"name\": \"fit_tracks_and_clouds\", \"clips\": %d, \"tracks_mm\": %.2f, \"tracks_deg\": %.2f, "
        "\"tracks_within_sigma\": %.3f, \"tracks_within_two\": %.3f, \"both_mm\": %.2f, \"both_deg\": %.2f, "
        "\"both_within_sigma\": %.3f, \"both_within_two\": %.3f, \"trust\": %.3f}\n",
        mix.clips, mix.tracks.joint_mm(), mix.tracks.rotation_deg(), mix.tracks.within_one(), mix.tracks.within_two(),
        mix.both.joint_mm(), mix.both.rotation_deg(), mix.both.within_one(), mix.both.within_two(),
        mix.surface_weight / mix.clips);
  }
  std::printf(
      "{\"name\": \"fit_clouds\", \"clips\": %zu, \"frames\": %d, \"joint_mm\": %.2f, \"rotation_deg\": %.2f, "
      "\"within_sigma\": %.3f, \"within_two\": %.3f, \"points\": %.0f, \"matchings\": %.1f, \"decode_ms\": %.2f, "
      "\"fuse_ms\": %.2f, \"person_ms\": %.2f, \"fit_ms\": %.2f, \"frames_per_s\": %.1f, "
      "\"frames_per_s_with_decoding\": %.1f, \"threads\": 1}\n",
      takes.size(), all.frames, all.joint_mm(), all.rotation_deg(), all.whitened > 0 ? all.within_one() : 0.0,
      all.whitened > 0 ? all.within_two() : 0.0, points / n, iterations / n, 1e3 * spent.decode / n,
      1e3 * spent.fuse / n, 1e3 * spent.person / n, 1e3 * spent.fit / n, n / (spent.fuse + spent.person + spent.fit),
      n / (spent.decode + spent.fuse + spent.person + spent.fit));
}
