// bench_studio_fits [SEED [SUBJECTS [all|one [HZ [OPTION=NUMBER ...]]]]]: fits studio clips of all 12 classes and
// compares with the truth. One clip per class and person, or all 34 variants; bodies are unknown to the fitter. Noise
// of 30 mm RMS, 5 % dropouts, 2 % outliers, 2 % swapped frames by default. gap=SECONDS removes the person from the
// middle of each clip (negative: throughout) and prints errors and coverage there. limb=1 removes only the right arm
// below the shoulder; limb=2 the left leg below the hip. unseen=1: the trackers have no spine above the pelvis, neck,
// collars, hands and feet; prints errors of those. kard=1: the tracker is OpenNI's, as KARD writes it; prints errors of
// neck, head and wrists, for which it lists other points. kard=2: the same, mapped by name alone.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include <Eigen/Cholesky>

#include "core/motion/kinematics.h"
#include "fitting/evidence/detector_points.h"
#include "fitting/evidence/motion_tracks.h"
#include "fitting/fit_outcome.h"
#include "fitting/proportions.h"
#include "ingest/synthetic/body_points.h"
#include "tests/benchmarks/clip_lines.h"
#include "tests/benchmarks/given_numbers.h"
#include "tests/benchmarks/options_without.h"
#include "tests/fitting/fit_score.h"
#include "tests/fitting/studio_clips.h"

namespace mocurate {
namespace {

void Set(const std::string& name, double value, JointTrackOptions& options, RepairOptions& repair,
         StudioClipErrors& errors) {
  if (name == "rotation_process_noise") options.priors.rotation_noise = value;
  if (name == "velocity_process_noise") options.priors.position_noise = value;
  if (name == "rest_sigma") options.priors.rest = value;
  if (name == "contact_process_noise")
    options.contact_process_noise = value > 0.0 ? std::optional<double>(value) : std::nullopt;
  if (name == "huber_share") options.huber_share = value;
  if (name == "walk_refits") options.steps = StepsWithRefits(static_cast<int>(value));
  if (name == "ceres") options.solver = value != 0.0 ? PoseSolver::kCeres : PoseSolver::kBanded;
  if (name == "repair_swaps") repair.swaps = value != 0.0;
  if (name == "swap_margin") repair.swap_margin = value;
  if (name == "uncertainty") options.uncertainty = value != 0.0;
  if (name == "noise") errors.tracker.noise = value;
  if (name == "dropout") errors.tracker.dropout_share = value;
  if (name == "outlier") errors.tracker.outlier_share = value;
  if (name == "frozen") errors.tracker.frozen_share = value;
  if (name == "wander") errors.tracker.wander = value;
  if (name == "wander_frames") errors.tracker.wander_frames = value;
  if (name == "swapped") errors.swapped_frames = value;
  if (name == "swap_mean") errors.swap_mean_frames = value;
}

/// Joints of the right arm below the shoulder, or of the left leg below the hip.
std::vector<bool> OfLimb(const Skeleton& skeleton, bool arm) {
  std::vector<bool> of_limb;
  for (const Joint& joint : skeleton.joints) {
    bool found = false;
    for (const char* name : {"elbow", "wrist", "hand"})
      found = found || (arm && joint.name == "right_" + std::string(name));
    for (const char* name : {"knee", "ankle", "foot"})
      found = found || (!arm && joint.name == "left_" + std::string(name));
    of_limb.push_back(found);
  }
  return of_limb;
}

/// Hides these joints (empty: all) in the middle of the clip, unless that is most of it; negative seconds: throughout.
/// Returns frames [begin, end).
std::pair<int, int> HideMiddle(double seconds, const std::vector<bool>& joints, StudioClip& clip) {
  const int frames = clip.truth.frame_count();
  const int hidden = seconds < 0.0 ? frames : static_cast<int>(std::lround(seconds * clip.truth.rate.hz()));
  if (seconds > 0.0 && 2 * hidden > frames) return {0, 0};
  const int begin = (frames - hidden) / 2;
  for (int f = begin; f < begin + hidden; ++f) {
    for (int j = 0; j < clip.tracks.joints(); ++j) {
      if (joints.empty() || joints[static_cast<std::size_t>(j)])
        clip.tracks.confidence[static_cast<std::size_t>(f) * clip.tracks.joints() + j] = 0.0;
    }
  }
  return {begin, begin + hidden};
}

/// Joints that a tracker of few joints does not have.
std::vector<bool> Unknown(const Skeleton& skeleton) {
  std::vector<bool> unknown;
  for (const Joint& joint : skeleton.joints) {
    bool found = false;
    for (const char* name : {"spine", "neck", "collar", "hand", "foot"})
      found = found || joint.name.find(name) != std::string::npos;
    unknown.push_back(found);
  }
  return unknown;
}

void HideJoints(const std::vector<bool>& joints, StudioClip& clip) {
  for (std::size_t i = 0; i < clip.tracks.confidence.size(); ++i) {
    if (joints[i % joints.size()]) clip.tracks.confidence[i] = 0.0;
  }
}

/// Joints for which OpenNI's tracker lists another point.
std::vector<bool> Displaced(const Skeleton& skeleton) {
  std::vector<bool> displaced;
  for (const Joint& joint : skeleton.joints) {
    bool found = joint.name == "neck" || joint.name == "head";
    displaced.push_back(found || joint.name.find("wrist") != std::string::npos);
  }
  return displaced;
}

/// Replaces the tracks by those of OpenNI's tracker.
void TrackAsKard(const StudioClipErrors& errors, std::uint64_t seed, bool placed, StudioClip& clip) {
  Clip source;
  if (placed) source.provenance[kSourceSkeleton] = "openni15";
  const std::vector<std::string> names = NamesOf(KardPlaces());
  const TrackedTake tracked =
      Track(PlacesOf(clip.truth, KardPlaces()), names, errors.tracker, static_cast<std::int64_t>(seed), clip.name);
  JointTracks tracks;
  tracks.names = names;
  tracks.time_s = clip.tracks.time_s;
  tracks.positions = tracked.positions;
  for (const std::uint8_t there : tracked.seen) tracks.confidence.push_back(there);
  source.evidence.tracks = std::move(tracks);
  const auto mapped = TracksOfClip(source, WithTrackerPoints(clip.tracks.skeleton, source), OtherJoints::kLeaveOut);
  if (!mapped) std::fprintf(stderr, "%s\n", mapped.error().Message().c_str()), std::exit(1);
  clip.tracks = *mapped;
  clip.exchanged.clear();
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  const auto seed = static_cast<std::uint64_t>(argc > 1 ? std::atoll(argv[1]) : 101);
  const int subjects = argc > 2 ? std::atoi(argv[2]) : 5;
  const bool variants = argc > 3 && std::string(argv[3]) == "all";
  const double rate_hz = argc > 4 ? std::atof(argv[4]) : 30.0;
  const FittingOptions given = benchmarks::OptionsWithout();
  JointTrackOptions options = given.joint_tracks;
  options.solver = PoseSolver::kBanded;
  RepairOptions repair = given.repair;
  StudioClipErrors errors = StudioClipErrors::Stated();
  bool true_bones = false;
  double gap_s = 0.0;
  int limb = 0;
  bool few_joints = false;
  int kard = 0;
  for (const auto& [name, value] : GivenNumbers(argc, argv, 5)) {
    if (name == "true_bones") true_bones = true;
    if (name == "gap") gap_s = value;
    if (name == "limb") limb = static_cast<int>(value);
    if (name == "kard") kard = static_cast<int>(value);
    if (name == "unseen") few_joints = value != 0.0;
    Set(name, value, options, repair, errors);
  }
  std::vector<StudioClip> clips = StudioClips(seed, subjects, variants, errors, rate_hz);
  for (StudioClip& clip : clips) {
    if (kard > 0) TrackAsKard(errors, seed, kard == 1, clip);
  }
  std::map<const StudioClip*, std::pair<int, int>> gaps;
  FitScore all;
  FitScore hidden;
  if (limb > 0) hidden.only = OfLimb(**LoadSkeleton("smpl24"), limb == 1);
  for (StudioClip& clip : clips) gaps[&clip] = HideMiddle(gap_s, hidden.only, clip);
  FitScore unobserved;
  unobserved.only = kard > 0 ? Displaced(**LoadSkeleton("smpl24")) : Unknown(**LoadSkeleton("smpl24"));
  if (few_joints) {
    for (StudioClip& clip : clips) HideJoints(unobserved.only, clip);
  }
  std::map<int, FitScore> of_class;
  benchmarks::ClipLines lines(argc, argv);
  double seconds = 0.0;
  double sigma = 0.0;
  SwapScore swaps;
  for (int person = 1; person <= subjects; ++person) {
    std::vector<SkeletonTracks> tracks;
    for (const StudioClip& clip : clips) {
      if (clip.subject == person && tracks.size() < 30) tracks.push_back(clip.tracks);
    }
    if (tracks.empty()) continue;
    const auto bones = EstimateProportions(tracks, tracks[0].skeleton, ProportionsOptions{});
    for (const StudioClip& clip : clips) {
      if (clip.subject != person) continue;
      const auto start = std::chrono::steady_clock::now();
      auto fit = RepairAndFit(OnBody(clip.tracks, bones.skeleton), clip.truth.rate,
                              true_bones ? clip.truth.bone_length : bones.bone_length, repair, options);
      const double own_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      seconds += own_seconds;
      if (!fit) return std::fprintf(stderr, "%s\n", fit.error().Message().c_str()), 1;
      if (kard == 1) {
        const SkeletonPtr body = fit->motion.skeleton;
        fit->motion = WithoutDetectorPoints(fit->motion, WithoutTrackerPoints(body));
      }
      all.Add(*fit, clip);
      lines.Add(clip, "tracks", *fit, own_seconds);
      if (few_joints || kard > 0) unobserved.Add(*fit, clip);
      if (gap_s != 0.0) hidden.Add(*fit, clip, gaps[&clip].first, gaps[&clip].second);
      of_class[clip.action].Add(*fit, clip);
      swaps.Add(*fit, clip);
      sigma += fit->noise_sigma / static_cast<double>(clips.size());
      if (std::getenv("CLIPS") != nullptr) {
        FitScore one;
        one.Add(*fit, clip);
        std::printf("%-28s %5d frames %6.1f mm %5.1f deg\n", clip.name.c_str(), clip.truth.frame_count(),
                    one.joint_mm(), one.rotation_deg());
        for (const Finding& finding : fit->findings) {
          if (finding.code == kOutliersRejected) continue;
          std::printf("    %s frames %d to %d: %s (%.1f)\n", finding.code.c_str(), finding.frame_begin,
                      finding.frame_end, finding.message.c_str(), finding.value);
        }
      }
    }
  }
  for (const auto& [action, score] : of_class) {
    std::printf("class %2d: joints %5.1f mm, rotations %4.1f deg\n", action, score.joint_mm(), score.rotation_deg());
  }
  std::printf("joints (mm):");
  for (std::size_t j = 0; j < all.by_joint.size(); ++j)
    std::printf(" %s %.1f", clips[0].tracks.skeleton->joints[j].name.c_str(), all.by_joint[j] / all.frames * 1e3);
  std::printf("\n");
  std::printf("exchanged samples: %d, corrected %d; others exchanged by mistake: %d\n", swaps.exchanged_samples,
              swaps.corrected, swaps.mistaken);
  std::printf(
      "%zu clips, %d frames: joints %.2f mm (observed %.2f, hidden or wrong %.2f), rotations %.2f deg (full %.2f, "
      "bones "
      "%.2f), within sigma %.1f %%, 2 sigma %.1f %%, noise %.1f mm, %.0f frames/s\n",
      clips.size(), all.frames, all.joint_mm(), all.seen_mm(), all.hidden_mm(), all.rotation_deg(), all.full_deg(),
      all.bone_deg(), 100.0 * all.within_one(), 100.0 * all.within_two(), 1e3 * sigma, all.frames / seconds);
  if (few_joints || kard > 0) {
    std::printf("%s: joints %.1f mm, within sigma %.1f %%, 2 sigma %.1f %%\n", kard > 0 ? "other points" : "unobserved",
                unobserved.joint_mm(), 100.0 * unobserved.within_one(), 100.0 * unobserved.within_two());
  }
  if (hidden.frames == 0) return 0;
  std::printf("in gaps of %.2f s: joints %.1f mm, within sigma %.1f %%, 2 sigma %.1f %%\n", gap_s, hidden.joint_mm(),
              100.0 * hidden.within_one(), 100.0 * hidden.within_two());
}
