// Faults of long generated motions: sliding feet, self-penetration, cycles, uprightness and height per step.
//
//   bench_long_motions MOTIONS.h5 [FITTED.h5] [--mirrored] [--cycles run,jog]
//
// MOTIONS.h5: a Dataset or MotionSet whose clips have segments; segments labelled "transition" lie between actions. A
// clip is a chain and its k-th action is step k; a clip without segments is one action. FITTED.h5: the same clips after
// `mocurate fit MOTIONS.h5 --contacts -o FITTED.h5`. Prints Markdown. Run it on recorded motions too: values that are
// high there come from the actions or the measure.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "canon/trim/body_description.h"
#include "canon/trim/trim.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/motion/operations.h"
#include "core/quality/contacts.h"
#include "core/quality/measures.h"
#include "core/store/store.h"
#include "tests/body/self_penetration.h"

namespace mocurate {
namespace {

constexpr const char* kTransition = "transition";
constexpr int kLeastFrames = 4;          // of a segment; shorter ones are not measured
constexpr double kLeastCycleS = 1.5;     // FindCycles detects periods of up to 1 / 1.8 of it
constexpr double kLeastMovement = 0.03;  // m, of the joint that moves most, about its mean position in the body
constexpr double kLowFootShare = 0.05;   // of a segment's frames whose lowest foot is below its floor

/// Mean of numbers with its standard error.
struct Mean {
  double count = 0.0, sum = 0.0, squares = 0.0;

  void Add(double value) {
    count += 1.0;
    sum += value;
    squares += value * value;
  }
  double mean() const { return count > 0.0 ? sum / count : 0.0; }
  double standard_error() const {
    return count > 1.0 ? std::sqrt(std::max(0.0, squares - sum * mean()) / (count - 1.0) / count) : 0.0;
  }
};

/// A labelled segment of a chain. `step` counts the actions of the chain from 1; 0: a transition.
struct LabelledSegment {
  std::string label;
  int step = 0;
  Motion motion;
};
using Chain = std::vector<LabelledSegment>;
/// The segments of each clip, ordered by their first frame, without those below kLeastFrames.
std::vector<Chain> ChainsOf(const std::vector<Clip>& clips) {
  std::vector<Chain> chains;
  for (const Clip& clip : clips) {
    std::vector<Segment> segments = clip.segments;
    if (segments.empty()) segments.push_back({0.0, clip.motion->duration(), clip.label, "", ""});
    std::stable_sort(segments.begin(), segments.end(),
                     [](const Segment& a, const Segment& b) { return a.begin_s < b.begin_s; });
    const double hz = clip.motion->rate.hz();
    Chain chain;
    int step = 0;
    for (const Segment& segment : segments) {
      const int number = segment.label == kTransition ? 0 : ++step;
      const int begin = std::max(0, static_cast<int>(std::lround(segment.begin_s * hz)));
      const int end = std::min(clip.motion->frame_count(), static_cast<int>(std::lround(segment.end_s * hz)));
      if (end - begin < kLeastFrames) continue;
      chain.push_back({segment.label, number, *Cut(clip, begin, end)->motion});
    }
    chains.push_back(std::move(chain));
  }
  return chains;
}

/// Feet and self-penetration of the segments of one label.
struct LabelFigures {
  Mean skate, share, depth;
};

std::map<std::string, LabelFigures> FiguresOf(const std::vector<Chain>& chains, std::map<std::string, int>& deepest) {
  std::map<std::string, LabelFigures> figures;
  for (const Chain& chain : chains) {
    for (const LabelledSegment& segment : chain) {
      const double skate = MeasureMotion(segment.motion).foot_skate;
      const auto measured = MeasureSelfPenetration(segment.motion);
      for (const std::string& label : {segment.label, std::string("all actions")}) {
        if (segment.step == 0 && label != kTransition) continue;
        figures[label].skate.Add(skate);
        if (!measured) continue;
        figures[label].share.Add(measured->penetrating_share);
        figures[label].depth.Add(measured->mean_depth);
      }
      for (std::size_t f = 0; measured && f < measured->depth.size(); ++f) {
        if (measured->depth[f] <= SelfPenetrationOptions().threshold) continue;
        const auto& [a, b] = measured->joints[f];
        const std::vector<Joint>& joints = segment.motion.skeleton->joints;
        const int first = std::min(a, b), second = std::max(a, b);
        ++deepest[joints[static_cast<std::size_t>(first)].name + " - " + joints[static_cast<std::size_t>(second)].name];
      }
    }
  }
  return figures;
}

void LabelTable(const std::vector<Chain>& chains, const std::vector<Chain>& fitted) {
  std::printf(
      "\nSelf-penetration: share of frames deeper than %g m, and mean depth over all frames. Means over the segments%s."
      "\n\n",
      SelfPenetrationOptions().threshold, fitted.empty() ? "" : "; before -> after the fit");
  std::printf("| label | segments | foot skate, m/s | penetrating share | mean depth, mm |\n|---|---|---|---|---|\n");
  std::map<std::string, int> deepest, deepest_fitted;
  const auto before = FiguresOf(chains, deepest);
  auto after = FiguresOf(fitted, deepest_fitted);
  for (const auto& [label, figures] : before) {
    char text[32];
    const auto arrow = [&](double value, int digits) {
      std::snprintf(text, sizeof text, " -> %.*f", digits, value);
      return std::string(fitted.empty() ? "" : text);
    };
    const LabelFigures& other = after[label];
    std::printf("| %s | %.0f%s | %.3f%s | %.3f%s | %.1f%s |\n", label.c_str(), figures.skate.count,
                arrow(other.skate.count, 0).c_str(), figures.skate.mean(), arrow(other.skate.mean(), 3).c_str(),
                figures.share.mean(), arrow(other.share.mean(), 3).c_str(), 1e3 * figures.depth.mean(),
                arrow(1e3 * other.depth.mean(), 1).c_str());
  }
  std::multimap<int, std::string, std::greater<>> pairs;
  for (const auto& [names, frames] : deepest) pairs.emplace(frames, names);
  std::printf("\n| joints of the parts deeper than that in the first file | frames |\n|---|---|\n");
  int rows = 0;
  for (const auto& [frames, names] : pairs) {
    if (rows++ < 8) std::printf("| %s | %d |\n", names.c_str(), frames);
  }
}

/// RMS movement (m) of the joint that moves most, in the body's own frame. A body carried along without moving has no
/// cycle, although its rounding errors repeat.
double OwnMovement(const Motion& motion) {
  const SampleMatrix pose = DescribeBody(motion, 25.0, 0.05).pose;
  const Eigen::RowVectorXd squares = (pose.rowwise() - pose.colwise().mean()).colwise().squaredNorm() / pose.rows();
  return std::sqrt(
      Eigen::Map<const Eigen::Matrix3Xd>(squares.data(), 3, squares.size() / 3).colwise().sum().maxCoeff());
}

void CycleTable(const std::vector<Chain>& chains, const std::vector<std::string>& labels) {
  std::printf("\nSegments of at least %g s with a cycle (FindCycles: at least two repetitions).\n\n", kLeastCycleS);
  std::printf("| label | segments | long enough | with a cycle | share | period, s (median) | 10 %% to 90 %% |\n%s",
              "|---|---|---|---|---|---|---|\n");
  for (const std::string& label : labels) {
    int segments = 0, long_enough = 0;
    std::vector<double> periods;
    for (const Chain& chain : chains) {
      for (const LabelledSegment& segment : chain) {
        if (segment.label != label) continue;
        ++segments;
        if (segment.motion.duration() < kLeastCycleS) continue;
        ++long_enough;
        const std::vector<KeptSpan> repetitions = FindCycles({}, segment.motion);
        if (repetitions.size() < 2 || OwnMovement(segment.motion) < kLeastMovement) continue;
        periods.push_back(segment.motion.rate.FrameTime(repetitions.back().end - repetitions.front().begin) /
                          static_cast<double>(repetitions.size()));
      }
    }
    std::sort(periods.begin(), periods.end());
    const auto at = [&](double share) {
      return periods.empty() ? 0.0 : periods[static_cast<std::size_t>(share * static_cast<double>(periods.size() - 1))];
    };
    std::printf("| %s | %d | %d | %zu | %.2f | %.2f | %.2f to %.2f |\n", label.c_str(), segments, long_enough,
                periods.size(), long_enough > 0 ? static_cast<double>(periods.size()) / long_enough : 0.0, at(0.5),
                at(0.1), at(0.9));
  }
}

/// Posture of the trunk in a segment: mean over the frames of the unit direction from the hips to the neck.
struct Posture {
  Vector3d up = Vector3d::Zero();  ///< in the world; its x and z are the sine of the lean
  double left = 0.0, front = 0.0;  ///< its horizontal components to the left and front of the hips
  double foot = 0.0;               ///< m, height of the lowest foot joint, its 5th percentile
  double tilt() const { return std::atan2(std::hypot(up.x(), up.z()), up.y()) * kDegrees; }
};

/// Empty for a skeleton without hips, legs or neck.
std::optional<Posture> PostureOf(const Motion& motion) {
  const Skeleton& skeleton = *motion.skeleton;
  const auto hips = skeleton.Hips();
  const std::optional<int> neck = skeleton.FindJoint("neck");
  const std::vector<int> feet = FootJoints(skeleton);
  if (!hips || feet.empty() || !neck) return std::nullopt;
  Posture posture;
  std::vector<double> heights;
  for (int f = 0; f < motion.frame_count(); ++f) {
    const auto at = [&](int joint) { return Vector3d(motion.joints.at(f, joint)); };
    const Vector3d bottom = 0.5 * (at((*hips)[0]) + at((*hips)[1]));
    const Vector3d up = (at(*neck) - bottom).normalized() / motion.frame_count();
    Vector3d left = at((*hips)[0]) - at((*hips)[1]);
    left.y() = 0.0;
    left.normalize();
    posture.up += up;
    posture.left += up.dot(left);
    posture.front += up.dot(left.cross(Vector3d::UnitY()));
    double lowest = at(feet[0]).y();
    for (const int foot : feet) lowest = std::min(lowest, at(foot).y());
    heights.push_back(lowest);
  }
  std::sort(heights.begin(), heights.end());
  posture.foot = heights[static_cast<std::size_t>(kLowFootShare * static_cast<double>(heights.size() - 1))];
  return posture;
}

struct Step {
  Mean tilt, x, z, left, front, foot;
};

/// Prints one row per step; means over the chains that have it.
void DriftTable(const char* title, const std::vector<Chain>& chains) {
  std::map<int, Step> steps;
  for (const Chain& chain : chains) {
    std::optional<double> first_foot;
    for (const LabelledSegment& segment : chain) {
      const std::optional<Posture> posture = segment.step > 0 ? PostureOf(segment.motion) : std::nullopt;
      if (!posture) continue;
      if (segment.step == 1) first_foot = posture->foot;
      Step& step = steps[segment.step];
      step.tilt.Add(posture->tilt());
      step.x.Add(posture->up.x());
      step.z.Add(posture->up.z());
      step.left.Add(posture->left);
      step.front.Add(posture->front);
      if (first_foot) step.foot.Add(posture->foot - *first_foot);
    }
  }
  std::printf(
      "\n%s: tilt of the trunk (hips to neck) from world up; its horizontal components in the world (x, z) and of the "
      "hips "
      "(left, "
      "front), 1 = lying; height of the lowest foot over that of the chain's first action. Mean +- standard error.\n\n",
      title);
  std::printf("| step | chains | tilt, deg | lean x | lean z | lean left | lean front | foot, mm |\n%s",
              "|---|---|---|---|---|---|---|---|\n");
  for (const auto& [number, step] : steps) {
    std::printf("| %d | %.0f | %.2f +- %.2f |", number, step.tilt.count, step.tilt.mean(), step.tilt.standard_error());
    for (const Mean* lean : {&step.x, &step.z, &step.left, &step.front}) {
      std::printf(" %+.4f +- %.4f |", lean->mean(), lean->standard_error());
    }
    std::printf(" %+.1f +- %.1f |\n", 1e3 * step.foot.mean(), 1e3 * step.foot.standard_error());
  }
}

int Run(int argc, char** argv) {
  std::vector<std::string> files, cycles = {"run", "jog"};
  bool mirrored = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--mirrored") {
      mirrored = true;
    } else if (word == "--cycles" && i + 1 < argc) {
      const auto names = SplitText(argv[++i], ',');
      cycles.assign(names.begin(), names.end());
    } else {
      files.push_back(word);
    }
  }
  if (files.empty() || files.size() > 2) {
    std::fprintf(stderr, "usage: bench_long_motions MOTIONS.h5 [FITTED.h5] [--mirrored] [--cycles run,jog]\n");
    return 2;
  }
  std::vector<std::vector<Clip>> sets(2);
  for (std::size_t i = 0; i < files.size(); ++i) {
    auto set = ReadDataset(files[i]);
    if (!set) {
      std::fprintf(stderr, "%s\n", set.error().Message().c_str());
      return 3;
    }
    for (Clip& clip : set->clips) {
      if (clip.motion && clip.motion->frame_count() > 0) sets[i].push_back(std::move(clip));
    }
  }
  const std::vector<Chain> chains = ChainsOf(sets[0]);
  LabelTable(chains, ChainsOf(sets[1]));
  CycleTable(chains, cycles);
  DriftTable("As they are", chains);
  if (mirrored) {
    for (Clip& clip : sets[0]) clip = Mirror(clip);
    DriftTable("Mirrored", ChainsOf(sets[0]));
  }
  return 0;
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) { return mocurate::Run(argc, argv); }
