// Recall of the audit for repeated clips: variants of drawn clips, planted in a dataset under another person's name.
//
//   bench_leaks DATASET.h5 [COUNT]
//   bench_leaks DATASET.h5 write COUNT OUT.h5   writes that dataset, as joints only: for other programs to check
//   bench_leaks DATASET.h5 scale CLIPS      each clip of the set many times, every joint 5 to 8 cm away: prints the
//   time
//
// Prints the recall of each kind of variant, the number of reported pairs that were not planted (they may be real), and
// the time.

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>

#include "canon/audit/audit.h"
#include "core/base/random.h"
#include "core/base/text.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "core/quality/duplicates.h"

namespace {

using namespace mocurate;

/// Moved by 3 m and rotated, as in another camera's world.
void Move(Motion& motion, double yaw) {
  const Matrix3d turn = Eigen::AngleAxisd(yaw, Vector3d::UnitY()).toRotationMatrix();
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < motion.joint_count(); ++j) {
      motion.joints.at(f, j) = turn * Vector3d(motion.joints.at(f, j)) + Vector3d(3.0, 0.0, -1.0);
    }
  }
}

Clip Variant(const std::string& kind, Clip clip, Random& random) {
  const int F = clip.motion->frame_count();
  if (kind == "resampled") clip = Resample(clip, FrameRate{24, 1});
  if (kind == "mirrored") clip = Mirror(clip);
  const bool crops = kind.rfind("cropped", 0) == 0;
  if (crops) clip = *Cut(clip, F / 5, F - F / 5);
  if (kind == "cropped resampled") clip = Resample(clip, FrameRate{24, 1});
  Motion& motion = *clip.motion;
  if (kind == "noisy" || kind == "cropped noisy") {
    for (double& value : motion.joints.xyz) value += 0.002 * random.Normal();
  }
  Move(motion, random.Uniform(-3.0, 3.0));
  clip.identity.person = "planted " + kind;
  return clip;
}

Dataset JointsOnly(Dataset dataset) {
  dataset.joints_only = true;
  dataset.splits.clear();
  dataset.findings.clear();
  for (Clip& clip : dataset.clips) clip.motion = MakeJointsOnly(dataset.skeleton, clip.rate, clip.motion->joints);
  std::sort(dataset.clips.begin(), dataset.clips.end(), [](const Clip& a, const Clip& b) { return a.id() < b.id(); });
  return dataset;
}

double SecondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// "0.1 0.5 1.2 mm": median, 95th percentile and maximum. Only frames in which poses identify a clip count.
std::string Quantiles(std::vector<double> values) {
  if (values.empty()) return "none";
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return FormatDouble(
        std::round(100.0 * values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))]) / 100.0);
  };
  return at(0.5) + " " + at(0.95) + " " + at(1.0) + " mm";
}

/// Measures the search among `clips` clips that differ from each other, one in memory at a time.
void TimeScale(const Dataset& dataset, std::size_t clips) {
  Motion motion;
  const auto motion_at = [&](std::size_t i) {
    motion = *dataset.clips[i % dataset.clips.size()].motion;
    Random random(1, "scale", std::to_string(i));
    for (int j = 1; j < motion.joint_count(); ++j) {
      const Vector3d direction(random.Normal(), random.Normal(), random.Normal());
      const Vector3d offset = direction.normalized() * random.Uniform(0.05, 0.08);
      for (int f = 0; f < motion.frame_count(); ++f) motion.joints.at(f, j) += offset;
    }
    return &motion;
  };
  const auto begin = std::chrono::steady_clock::now();
  const std::size_t pairs = FindDuplicates(clips, motion_at).size();
  struct rusage use {};
  getrusage(RUSAGE_SELF, &use);
  std::printf("%zu clips: %zu pairs, %.1f s; %.2f GB at most\n", clips, pairs, SecondsSince(begin),
              static_cast<double>(use.ru_maxrss) * 1024.0 / 1e9);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_leaks DATASET.h5 [COUNT]\n");
    return 2;
  }
  auto dataset = ReadDataset(argv[1]);
  if (!dataset) {
    std::fprintf(stderr, "%s\n", dataset.error().Message().c_str());
    return 3;
  }
  const std::string what = argc > 3 ? argv[2] : "";
  if (what == "scale") {
    TimeScale(*dataset, static_cast<std::size_t>(std::atoi(argv[3])));
    return 0;
  }
  const auto own = dataset->clips.size();
  const char* count_text = what == "write" ? argv[3] : argc > 2 ? argv[2] : "100";
  const auto count = std::min<std::size_t>(static_cast<std::size_t>(std::atoi(count_text)), own);
  const char* kinds[] = {"copied", "mirrored", "resampled", "cropped", "noisy", "cropped noisy", "cropped resampled"};
  std::map<std::string, std::string> planted;  // variant -> clip
  for (const char* kind : kinds) {
    Random random(1, "leaks", kind);
    std::set<std::size_t> drawn;
    while (drawn.size() < count) {
      const auto row = static_cast<std::size_t>(random.Below(own));
      if (!drawn.insert(row).second) continue;
      Clip variant = Variant(kind, dataset->clips[row], random);
      planted[variant.id()] = dataset->clips[row].id();
      dataset->clips.push_back(std::move(variant));
    }
  }
  if (what == "write" && argc > 4) {
    const Status written = WriteDataset(JointsOnly(std::move(*dataset)), argv[4]);
    if (!written) std::fprintf(stderr, "%s\n", written.error().Message().c_str());
    return written ? 0 : 74;
  }
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<AuditFinding> findings = FindRepeatedClips(*dataset);
  const double seconds = SecondsSince(begin);
  std::map<std::string, std::set<std::string>> found;  // variants by kind
  std::map<std::string, std::vector<double>> apart;    // millimetres, by kind
  for (const AuditFinding& one : findings) {
    const std::string &a = one.finding.clip, &b = one.suggested;
    const auto variant = planted.count(a) > 0 ? planted.find(a) : planted.find(b);
    const std::string& other = variant == planted.end() ? a : variant->first == a ? b : a;
    if (variant != planted.end() && variant->second == other) {
      const std::size_t at = variant->first.find("planted ") + 8;
      const std::string kind = variant->first.substr(at, variant->first.find('/', at) - at);
      found[kind].insert(variant->first);
      apart[kind].push_back(1000.0 * one.finding.value);
    } else if (planted.count(a) == 0 && planted.count(b) == 0) {
      apart[""].push_back(1000.0 * one.finding.value);
    }
  }
  std::printf("%s: %zu clips, %zu variants of each kind\n", argv[1], own, count);
  if (std::getenv("MISSED") != nullptr) {
    for (const auto& [variant, clip] : planted) {
      bool any = false;
      for (const auto& [kind, ids] : found) any = any || ids.count(variant) > 0;
      if (!any) std::printf("missed %s\n", variant.c_str());
    }
  }
  for (const char* kind : kinds) {
    std::printf("%-18s recall %.3f, %s\n", kind, static_cast<double>(found[kind].size()) / static_cast<double>(count),
                Quantiles(apart[kind]).c_str());
  }
  std::printf("pairs that were not planted: %zu, %s; %.2f s\n", apart[""].size(), Quantiles(apart[""]).c_str(),
              seconds);
  return 0;
}
