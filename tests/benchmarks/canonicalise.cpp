// What the stage canon does to a clip between its files: resample from 30 to 20 Hz by time, find the moving part, cut
// it, face front. `batches` measures the windows that training draws. Arguments: clips | batches. `clips` corresponds
// to resample_numpy.py of the reference scripts, which does not trim: 50 clips of 120 frames, 24 joints.

#include <cstring>
#include <string>

#include "canon/frames/facing.h"
#include "canon/trim/trim.h"
#include "core/base/pi.h"
#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "core/motion/preparation.h"
#include "tests/benchmarks/json_line.h"

namespace {

using namespace mocurate;

constexpr int kClips = 50, kFrames = 120;

Clip SwingingClip(const SkeletonPtr& skeleton, int number) {
  Random random(static_cast<std::uint64_t>(number), "benchmark.clip");
  std::vector<Vector3d> root, axis(static_cast<std::size_t>(skeleton->joint_count()));
  for (Vector3d& one : axis) one = Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized();
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < kFrames; ++f) {
    const double phase = 2.0 * kPi * f / 40.0;
    root.emplace_back(0.02 * f, 0.9 + 0.02 * std::sin(phase), 0.01 * f);
    for (int j = 0; j < skeleton->joint_count(); ++j) {
      const Quaterniond swing = ExpQuaternion(0.4 * std::sin(phase + j) * axis[static_cast<std::size_t>(j)]);
      rotation.push_back(j == 0 ? ExpQuaternion(Vector3d(0, 0.7 * number, 0)) * swing : swing);
    }
  }
  Clip clip;
  clip.identity = {"benchmark", "p1", std::to_string(number), "", "", "", 0, kFrames};
  clip.rate = FrameRate{30, 1};
  clip.motion = MakeMotion(skeleton, clip.rate, root, rotation, skeleton->RestBoneLengths());
  return clip;
}

double Canonicalise(const Clip& clip, const TrimOptions& trim) {
  std::vector<Finding> findings;
  const Clip resampled = Resample(clip, FrameRate{20, 1});
  double check = 0.0;
  for (const KeptSpan& span : FindSpans(trim, resampled, findings)) {
    auto cut = Cut(resampled, span.begin, span.end);
    if (cut && FaceFront({}, *cut)) check += cut->motion->joints.at(0, 5).y();
  }
  return check;
}

}  // namespace

int main(int argc, char** argv) {
  const bool batches = argc > 1 && std::strcmp(argv[1], "batches") == 0;
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  std::vector<Clip> clips;
  for (int i = 0; i < kClips; ++i) clips.push_back(SwingingClip(skeleton, i));
  double check = 0.0;
  if (!batches) {
    TrimOptions trim;
    trim.rule = TrimRule::kMotionEnergy;
    benchmarks::Report("resample_numpy", kClips, "clips", 9, [&] {
      for (const Clip& clip : clips) check += Canonicalise(clip, trim);
    });
  } else {
    constexpr int kBatch = 128, kWindow = 60;
    Random random(1, "benchmark.batch");
    benchmarks::Report("random_batch", kBatch, "windows", 99, [&] {
      for (int b = 0; b < kBatch; ++b) {
        const JointPositions& joints = clips[random.Below(kClips)].motion->joints;
        const Window window = DrawWindow(joints.frames, kWindow, LastStart::kExcluded, random);
        check += PrepareWindow(joints, window, kWindow, true).back();
      }
    });
  }
  return check == 0.12345 ? 1 : 0;
}
