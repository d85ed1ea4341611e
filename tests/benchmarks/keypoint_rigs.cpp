// bench_keypoint_rigs [CLIPS [SEED [OPTION=NUMBER ...]]]: takes of keypoints with a fault in the rig that the audit has
// to find. The studio's people before four cameras (4 px, 10 % missed, 3 % elsewhere), with nothing wrong, or
// moved=0.12 (the last camera, metres, and turned a little, from the frame from=60 on), clock=0.08 (cameras' clocks off
// by up to so many seconds), mirrored=1 (the images of camera 1), rotated=1 (each camera has the next one's files),
// half=1 (keypoints of camera 1 at half the size of its images), exchanged=2 (cameras 0 and 2 have each other's files),
// sides=1 (camera 1 calls left right throughout), all_mirrored=1, human36m=1 or phspd=1 (their rigs instead of a ring
// of cameras=4), frames (of a clip, at most). trials=1: extracts of frames=45 frames, one beginning every every=1
// frames, of both Pose2Sim trials, whose third camera alone stands elsewhere. What is told: how often, of which camera,
// how sure; how far joints are off; how many takes are more than 0.1 m off and neither refused nor doubtful.
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>

#include "core/base/median.h"
#include "fitting/keypoint_fit.h"
#include "tests/benchmarks/given_numbers.h"
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
    for (KeypointView& seen : evidence.keypoint_views) {
      if (given["all_mirrored"] != 0.0) Mirror(seen);
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
  std::map<std::string, int> told;
  std::vector<double> error_m;
  int wrong = 0;
  for (const RigTake& take : takes) {
    const auto found = TracksOnBody(take.evidence, *skeleton, skeleton, {});
    if (!found) {
      std::fprintf(stderr, "%s\n    %s\n", take.name.c_str(), found.error().Message().c_str());
      ++told["refused"];
      continue;
    }
    const double off = take.truth ? ErrorOf(found->tracks, *take.truth) : 0.0;
    std::fprintf(stderr, "%s: %.1f mm%s\n", take.name.c_str(), 1e3 * off, found->report.doubtful ? ", doubtful" : "");
    error_m.push_back(off);
    wrong += off > 0.1 && !found->report.doubtful ? 1 : 0;
    told["doubtful"] += found->report.doubtful ? 1 : 0;
    std::map<std::string, int> of_take;
    for (const RigFault& fault : found->report.faults) {
      std::fprintf(stderr, "    %s %.1f: %s; %.4f\n", fault.code.c_str(), fault.value, fault.message.c_str(),
                   fault.confidence);
      const bool whole = fault.code != "view_swaps_sides" || fault.limb.empty();
      if (whole) of_take[fault.code + " " + fault.camera] = 1;
    }
    for (const auto& [what, once] : of_take) told[what] += once;
  }
  std::printf("{\"name\": \"keypoint_rigs\", \"takes\": %zu, \"median_off_mm\": %.1f, \"wrong\": %d", takes.size(),
              1e3 * MeanMedian(error_m), wrong);
  for (const auto& [what, count] : told) std::printf(", \"%s\": %d", what.c_str(), count);
  std::printf("}\n");
}
