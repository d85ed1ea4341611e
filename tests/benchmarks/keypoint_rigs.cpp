// bench_keypoint_rigs [CLIPS [SEED [OPTION=NUMBER ...]]]: recall of the audit for a fault in the rig of keypoint takes.
// The studio's people stand before four cameras (4 px of noise, 10 % missed, 3 % misplaced). Without options there is
// no fault. moved=0.12 moves the last camera (metres, with a small rotation) from the frame from=60 on. clock=0.08
// offsets the cameras' clocks by up to that many seconds. mirrored=1 mirrors the images of camera 1. rotated=1 gives
// each camera the next one's files. half=1 scales the keypoints of camera 1 by 0.5. exchanged=2 exchanges the files of
// cameras 0 and 2. sides=1 exchanges left and right in camera 1. all_mirrored=1 mirrors all. human36m=1 or phspd=1
// replace the ring of cameras=4. frames is the longest length of a clip. trials=1: extracts of frames=45 frames, one
// from every every=1 frames, of both Pose2Sim trials, whose third camera is misplaced. Prints reports by camera with
// confidence, joint errors, and the number of takes more than 0.1 m off that are neither refused nor suspect.
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>

#include "core/base/median.h"
#include "fitting/keypoint_fit.h"
#include "tests/benchmarks/clip_lines.h"
#include "tests/benchmarks/given_numbers.h"
#include "tests/benchmarks/options_without.h"
#include "tests/fitting/keypoint_faults.h"
#include "tests/fitting/keypoint_takes.h"
#include "tests/fitting/studio_views.h"

namespace mocurate {
namespace {

struct RigTake {
  std::string name;
  Evidence evidence;
  std::optional<Motion> truth;
};

/// Median distance of the joints from the truth, metres.
double ErrorOf(const SkeletonTracks& tracks, const Motion& truth) {
  std::vector<double> off;
  for (int f = 0; f < tracks.frames(); ++f) {
    for (int j = 0; j < tracks.joints(); ++j) {
      if (tracks.seen(f, j)) off.push_back((tracks.positions.at(f, j) - truth.joints.at(f, j)).norm());
    }
  }
  return MeanMedian(off);
}

std::vector<RigTake> TrialTakes(int frames, int every) {
  std::vector<RigTake> takes;
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) return takes;
  for (const char* trial : {"single", "two"}) {
    const Evidence whole = ReadPose2Sim(std::filesystem::path(data) / "pose2sim", trial);
    for (int begin = 0; begin + frames <= whole.keypoint_views[0].frames(); begin += every) {
      takes.push_back({trial + (" from " + std::to_string(begin)), FramesOf(whole, begin, begin + frames), {}});
    }
  }
  return takes;
}

std::vector<RigTake> StudioTakes(int clips, std::int64_t seed, std::map<std::string, double> given) {
  StudioOptions options = FourViews(seed);
  options.subjects = std::max(2, (clips + 11) / 12);
  if (given["human36m"] != 0.0) options.rig.kind = RigKind::kHuman36m;
  if (given["phspd"] != 0.0) options.rig.kind = RigKind::kPhspd;
  if (given["cameras"] > 0.0) options.rig.cameras = static_cast<std::int64_t>(given["cameras"]);
  options.rig.moved = given["moved"];
  options.rig.clock_offset_s = given["clock"];
  std::vector<RigTake> takes;
  for (StudioView& view : StudioViews(options, clips, static_cast<int>(given["from"]))) {
    Evidence evidence = std::move(view.evidence);
    const int frames = evidence.keypoint_views[0].frames();
    if (given["frames"] > 0.0) evidence = FramesOf(evidence, 0, std::min(frames, static_cast<int>(given["frames"])));
    if (given["mirrored"] != 0.0) Mirror(evidence.keypoint_views[1]);
    if (given["half"] != 0.0) Enlarge(evidence.keypoint_views[1], 0.5);
    if (given["rotated"] != 0.0) RotateFiles(evidence);
    if (given["sides"] != 0.0) ExchangeSides(evidence.keypoint_views[1], evidence.keypoint_names);
    if (given["exchanged"] > 0.0) ExchangeFiles(evidence, 0, static_cast<std::size_t>(given["exchanged"]));
    for (KeypointView& one_view : evidence.keypoint_views) {
      if (given["all_mirrored"] != 0.0) Mirror(one_view);
    }
    takes.push_back({view.name, std::move(evidence), std::move(view.truth)});
  }
  return takes;
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  std::map<std::string, double> given = GivenNumbers(argc, argv, 3);
  const int clips = argc > 1 ? std::atoi(argv[1]) : 60;
  const std::int64_t seed = argc > 2 ? std::atoll(argv[2]) : 4711;
  const auto number = [&](const char* name, double otherwise) { return given.count(name) ? given[name] : otherwise; };
  const std::vector<RigTake> takes =
      given["trials"] != 0.0 ? TrialTakes(static_cast<int>(number("frames", 45)), static_cast<int>(number("every", 1)))
                             : StudioTakes(clips, seed, given);
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const FittingOptions options = benchmarks::OptionsWithout();
  benchmarks::ClipLines lines(argc, argv);
  std::map<std::string, int> reported;
  std::vector<double> error_m;
  int wrong = 0;
  for (const RigTake& take : takes) {
    const auto found = TracksOnBody(take.evidence, *skeleton, skeleton, options.keypoints);
    if (!found) {
      std::fprintf(stderr, "%s\n    %s\n", take.name.c_str(), found.error().Message().c_str());
      ++reported["refused"];
      lines.Add(take.name, take.name, "rig", {{"refused", 1}, {"suspect", 0}, {"silently_wrong", 0}});
      continue;
    }
    const double off = take.truth ? ErrorOf(found->tracks, *take.truth) : 0.0;
    std::fprintf(stderr, "%s: %.1f mm%s\n", take.name.c_str(), 1e3 * off, found->report.suspect ? ", suspect" : "");
    error_m.push_back(off);
    wrong += off > 0.1 && !found->report.suspect ? 1 : 0;
    const bool suspect = found->report.suspect;
    lines.Add(take.name, take.name, "rig",
              {{"joint_mm", 1e3 * off},
               {"refused", 0},
               {"suspect", suspect ? 1 : 0},
               {"silently_wrong", off > 0.1 && !suspect ? 1 : 0}},
              benchmarks::OutcomeOf(found->report.faults));
    reported["suspect"] += found->report.suspect ? 1 : 0;
    std::map<std::string, int> of_take;
    for (const RigFault& fault : found->report.faults) {
      std::fprintf(stderr, "    %s %.1f: %s; %.4f\n", fault.code.c_str(), fault.value, fault.message.c_str(),
                   fault.confidence);
      const bool whole = fault.code != "view_swaps_sides" || fault.limb.empty();
      if (whole) of_take[fault.code + " " + fault.camera] = 1;
    }
    for (const auto& [what, once] : of_take) reported[what] += once;
  }
  std::printf("{\"name\": \"keypoint_rigs\", \"takes\": %zu, \"median_off_mm\": %.1f, \"wrong\": %d", takes.size(),
              1e3 * MeanMedian(error_m), wrong);
  for (const auto& [what, count] : reported) std::printf(", \"%s\": %d", what.c_str(), count);
  std::printf("}\n");
}
