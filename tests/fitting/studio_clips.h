#pragma once

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/store/body_file.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/script.h"
#include "ingest/synthetic/tracker.h"

namespace mocurate {

/// One of HumanAct12's actions, performed, and the output of a tracker of all 24 joints.
struct StudioClip {
  std::string name;
  int subject = 1;
  int action = 1;               ///< coarse class, 1 to 12
  Motion truth;                 ///< on the subject's own skeleton
  SkeletonTracks tracks;        ///< on smpl24, whose rest pose is not the subject's
  std::vector<bool> exchanged;  ///< (F*J) left and right are exchanged
};

/// Errors of tracks in addition to TrackerOptions.
struct StudioClipErrors {
  TrackerOptions tracker;
  double swapped_frames = 0.02;  ///< share of frames in which arms, legs or both are exchanged
  double swap_mean_frames = 3.0;

  /// 30 mm RMS, 5 % dropouts, 2 % outliers, 2 % swapped frames.
  static StudioClipErrors Stated() {
    StudioClipErrors errors;
    errors.tracker.swap_share = 0.0;  // once per take; the exchanges here are distributed over all frames
    return errors;
  }
};

/// Exchanges the sides of limbs for a few frames now and then: of arms, legs or both; of all joints or those from the
/// elbow or knee down.
inline void ExchangeSides(StudioClip& clip, const StudioClipErrors& errors, std::uint64_t seed) {
  Random random(seed, "studio clip exchange", clip.name);
  SkeletonTracks& tracks = clip.tracks;
  const Skeleton& skeleton = *tracks.skeleton;
  clip.exchanged.assign(tracks.confidence.size(), false);
  const double leaves = 1.0 / errors.swap_mean_frames;
  const double enters = leaves * errors.swapped_frames / (1.0 - errors.swapped_frames);
  bool swapped = false;
  std::uint64_t limbs = 0;  // arms, legs, both
  bool outer = false;
  for (int f = 0; f < tracks.frames(); ++f) {
    const bool was = swapped;
    swapped = swapped ? random.Uniform() >= leaves : random.Uniform() < enters;
    if (!swapped) continue;
    if (!was) {
      limbs = random.Below(3);
      outer = limbs < 2 && random.Uniform() < 0.5;
    }
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const int partner = skeleton.joints[j].mirror;
      if (partner <= j) continue;
      const std::string& name = skeleton.joints[j].name;
      const auto has = [&](const char* word) { return name.find(word) != std::string::npos; };
      const bool leg = has("hip") || has("knee") || has("ankle") || has("foot");
      if ((limbs == 0 && leg) || (limbs == 1 && !leg)) continue;
      if (outer && (has("hip") || has("collar") || has("shoulder"))) continue;
      const std::size_t at = static_cast<std::size_t>(f) * tracks.joints();
      const Vector3d left = tracks.positions.at(f, j);
      tracks.positions.at(f, j) = Vector3d(tracks.positions.at(f, partner));
      tracks.positions.at(f, partner) = left;
      std::swap(tracks.confidence[at + static_cast<std::size_t>(j)],
                tracks.confidence[at + static_cast<std::size_t>(partner)]);
      clip.exchanged[at + static_cast<std::size_t>(j)] = clip.exchanged[at + static_cast<std::size_t>(partner)] = true;
    }
  }
}

inline Script AtTwiceTheRate(Script script) {
  script.frames *= 2;
  for (ScriptedAction& action : script.actions) {
    action.begin *= 2;
    action.end *= 2;
  }
  return script;
}

/// Clips of `subjects` people in all 12 classes; with `variants` in all 34 variants. Bodies are shapes of body_cc0
/// (MOCURATE_DATA), or smpl24 with other proportions without it. 30 Hz, or 15 Hz.
inline std::vector<StudioClip> StudioClips(std::uint64_t seed, int subjects, bool variants,
                                           const StudioClipErrors& errors, double rate_hz = 30.0) {
  std::vector<StudioClip> clips;
  const auto skeleton = LoadSkeleton("smpl24");
  if (!skeleton) return clips;
  std::optional<BodyTemplate> body;
  if (const char* data = std::getenv("MOCURATE_DATA")) {
    if (auto read = ReadBodyTemplate(std::filesystem::path(data) / "body_cc0" / "body_cc0.h5")) body = std::move(*read);
  }
  StudioOptions options;
  options.seed = static_cast<std::int64_t>(seed);
  options.subjects = subjects;
  const auto actors = ActorsOf(options, subjects, body ? &*body : nullptr);
  if (!actors) return clips;
  std::vector<std::string> names;
  for (const Joint& joint : (*skeleton)->joints) names.push_back(joint.name);
  std::vector<std::vector<int>> taken(static_cast<std::size_t>(subjects) + 1, std::vector<int>(13, 0));
  for (const PlannedRecording& recording : PlanHumanAct12(options)) {
    const bool twice = rate_hz > 20.0;
    const Script script = twice ? AtTwiceTheRate(recording.script) : recording.script;
    const Actor& actor = (*actors)[static_cast<std::size_t>(recording.subject - 1)];
    const FrameRate rate{twice ? 30 : 15, 1};
    std::optional<Motion> motion;
    for (const CutClip& cut : recording.clips) {
      const std::string code = cut.variant->code;
      const int action = std::stoi(code.substr(0, 2));
      int& count = taken[static_cast<std::size_t>(recording.subject)][static_cast<std::size_t>(action)];
      if (count++ > 0 && !variants) continue;
      if (!motion) motion = PerformScript(script, actor.subject, actor.skeleton, rate);
      std::vector<int> frames;
      for (int f = (twice ? 2 : 1) * cut.first; f <= (twice ? 2 : 1) * cut.last && f < motion->frame_count(); ++f)
        frames.push_back(f);
      StudioClip clip;
      clip.name = "s" + std::to_string(seed) + "_p" + std::to_string(recording.subject) + "_a" + code + "_" +
                  std::to_string(cut.first);
      clip.subject = recording.subject;
      clip.action = action;
      clip.truth = SelectFrames(*motion, frames, RigidTransform{});
      const TrackedTake tracked =
          Track(clip.truth.joints, names, errors.tracker, static_cast<std::int64_t>(seed), clip.name);
      clip.tracks.skeleton = *skeleton;
      clip.tracks.positions = tracked.positions;
      for (const std::uint8_t there : tracked.seen) clip.tracks.confidence.push_back(there);
      for (int f = 0; f < clip.truth.frame_count(); ++f) clip.tracks.time_s.push_back(rate.FrameTime(f));
      if (errors.swapped_frames > 0.0) ExchangeSides(clip, errors, seed);
      clips.push_back(std::move(clip));
    }
  }
  return clips;
}

}  // namespace mocurate
