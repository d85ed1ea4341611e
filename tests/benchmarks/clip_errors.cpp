// Precision and recall of the audit for mirrored clips, clips that freeze for a while, and clips with exchanged limbs.
// 2 % of each are planted in a dataset assumed correct, pooled over draws. Real errors of the set count against the
// audit.
//
//   bench_clip_errors DATASET.h5 [DRAWS]

#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>

#include "canon/audit/audit.h"
#include "core/base/random.h"
#include "core/quality/checks.h"

namespace {

using namespace mocurate;

void Plant(const std::string& code, Random& random, Motion& motion) {
  const int F = motion.frame_count(), J = motion.joint_count();
  const int length = std::min(F / 3, 10 + static_cast<int>(random.Below(20)));
  const int begin = 1 + static_cast<int>(random.Below(static_cast<std::uint64_t>(std::max(1, F - length - 1))));
  if (code == "mirrored") {
    for (int f = 0; f < F; ++f) {
      for (int j = 0; j < J; ++j) motion.joints.at(f, j).x() *= -1.0;
    }
  } else if (code == "frozen_frames") {
    for (int f = begin; f < begin + length; ++f) {
      for (int j = 0; j < J; ++j) motion.joints.at(f, j) = Vector3d(motion.joints.at(begin - 1, j));
    }
  } else {
    std::vector<std::string> names;
    for (const Joint& joint : motion.skeleton->joints) names.push_back(joint.name);
    const LimbPairs pairs = FindLimbPairs(names);
    const auto& limbs = random.Uniform() < 0.5 ? pairs.arms : pairs.legs;
    for (int f = begin; f < begin + length; ++f) {
      for (const auto& [left, right] : limbs) {
        const Vector3d kept = motion.joints.at(f, left);
        motion.joints.at(f, left) = Vector3d(motion.joints.at(f, right));
        motion.joints.at(f, right) = kept;
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_clip_errors DATASET.h5 [DRAWS]\n");
    return 2;
  }
  auto dataset = ReadDataset(argv[1]);
  if (!dataset) {
    std::fprintf(stderr, "%s\n", dataset.error().Message().c_str());
    return 3;
  }
  const int draws = argc > 2 ? std::atoi(argv[2]) : 5;
  const char* codes[] = {"mirrored", "frozen_frames", "swapped_sides"};
  std::map<std::string, double> planted, found, reported;
  for (int draw = 0; draw < draws; ++draw) {
    Dataset changed = *dataset;
    Random random(static_cast<std::uint64_t>(draw), "planted clip errors");
    std::map<std::string, std::set<std::string>> of_code;
    std::set<std::size_t> taken;
    for (const char* code : codes) {
      const std::size_t count = std::max<std::size_t>(1, changed.clips.size() / 50);
      while (of_code[code].size() < count) {
        const auto row = static_cast<std::size_t>(random.Below(changed.clips.size()));
        if (changed.clips[row].motion->frame_count() < 15 || !taken.insert(row).second) continue;
        Random own(static_cast<std::uint64_t>(draw), "plant", changed.clips[row].id());
        Plant(code, own, *changed.clips[row].motion);
        of_code[code].insert(changed.clips[row].id());
      }
    }
    std::map<std::string, std::set<std::string>> by_code;
    for (const AuditFinding& one : FindClipErrors(changed)) by_code[one.finding.code].insert(one.finding.clip);
    for (const char* code : codes) {
      planted[code] += static_cast<double>(of_code[code].size());
      reported[code] += static_cast<double>(by_code[code].size());
      for (const std::string& clip : by_code[code]) found[code] += of_code[code].count(clip) > 0 ? 1.0 : 0.0;
    }
  }
  std::printf("%s: %zu clips, %d draws\n", argv[1], dataset->clips.size(), draws);
  for (const char* code : codes) {
    std::printf("%-14s planted %4.0f, reported %4.0f, precision %.3f, recall %.3f\n", code, planted[code],
                reported[code], found[code] / std::max(1.0, reported[code]),
                found[code] / std::max(1.0, planted[code]));
  }
  return 0;
}
