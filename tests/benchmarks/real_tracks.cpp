// bench_real_tracks SOURCE SKELETON [CLIPS [walk_refits=N]]: joint tracks of a recorded set before and after the fit,
// as one row of a table. Columns: standard deviation of bone lengths, residual, frames with repairs, rejected samples,
// jerk. The last two are the accuracy of a nearest neighbour among other persons' clips, from raw and from fitted
// joints.
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/quality/measures.h"
#include "fitting/fit_outcome.h"
#include "fitting/fit_result.h"
#include "fitting/proportions.h"
#include "tests/benchmarks/real_people.h"

namespace mocurate {
namespace {

constexpr int kFeatureFrames = 30;

/// Joints over time as a feature vector: resampled to 30 frames, relative to the first frame's middle, rotated to one
/// facing.
struct Example {
  std::string person;
  std::string label;
  std::vector<double> raw;
  std::vector<double> fitted;
};

std::vector<double> Features(const JointPositions& joints, const std::vector<bool>& used, const Skeleton& skeleton) {
  Vector3d middle = Vector3d::Zero();
  double count = 0.0;
  for (int j = 0; j < joints.joints; ++j) {
    if (!used[j]) continue;
    middle += joints.at(0, j);
    count += 1.0;
  }
  middle /= count;
  Vector3d across = Vector3d::UnitX();
  for (const auto& sides : {skeleton.Hips(), skeleton.Shoulders()}) {
    if (!sides || !used[(*sides)[0]] || !used[(*sides)[1]]) continue;
    across = joints.at(0, (*sides)[0]) - joints.at(0, (*sides)[1]);
    break;
  }
  const double yaw = std::atan2(across.z(), across.x());
  const Quaterniond turn(Eigen::AngleAxisd(yaw, Vector3d::UnitY()));
  std::vector<double> features;
  for (int i = 0; i < kFeatureFrames; ++i) {
    const double at = static_cast<double>(i) * (joints.frames - 1) / (kFeatureFrames - 1);
    const int before = std::min(static_cast<int>(at), std::max(joints.frames - 2, 0));
    const int after = std::min(before + 1, joints.frames - 1);
    for (int j = 0; j < joints.joints; ++j) {
      if (!used[j]) continue;
      const Vector3d place = (1.0 - (at - before)) * joints.at(before, j) + (at - before) * joints.at(after, j);
      const Vector3d turned = turn * (place - middle);
      features.insert(features.end(), turned.data(), turned.data() + 3);
    }
  }
  return features;
}

/// Observed samples, linearly interpolated between them.
JointPositions Filled(const SkeletonTracks& tracks) {
  JointPositions filled = tracks.positions;
  for (int j = 0; j < tracks.joints(); ++j) {
    int last = -1;
    for (int f = 0; f < tracks.frames(); ++f) {
      if (!tracks.seen(f, j)) continue;
      for (int g = last + 1; g < f; ++g) {
        const double a = last < 0 ? 1.0 : static_cast<double>(g - last) / (f - last);
        filled.at(g, j) = (1.0 - a) * tracks.positions.at(std::max(last, 0), j) + a * tracks.positions.at(f, j);
      }
      last = f;
    }
    for (int g = last + 1; last >= 0 && g < tracks.frames(); ++g) filled.at(g, j) = Vector3d(filled.at(last, j));
  }
  return filled;
}

double Accuracy(const std::vector<Example>& examples, std::vector<double> Example::*features) {
  int right = 0;
  for (const Example& one : examples) {
    double nearest = 1e300;
    bool same = false;
    for (const Example& other : examples) {
      if (other.person == one.person) continue;
      double distance = 0.0;
      for (std::size_t i = 0; i < (one.*features).size(); ++i)
        distance += std::pow((one.*features)[i] - (other.*features)[i], 2);
      if (distance >= nearest) continue;
      nearest = distance;
      same = other.label == one.label;
    }
    right += same ? 1 : 0;
  }
  return examples.empty() ? 0.0 : static_cast<double>(right) / static_cast<double>(examples.size());
}

struct Row {
  int clips = 0;
  double frames = 0.0, samples = 0.0;
  double bone_sigma_before = 0.0, bone_sigma_after = 0.0;  // sums over clips, mm
  double jerk_before = 0.0, jerk_after = 0.0;
  double square = 0.0;
  double repaired = 0.0, swapped = 0.0, outliers = 0.0;
  std::vector<Example> examples;
};

void Add(const RealClip& clip, const std::string& person, const FitResult& fit, Row& row) {
  const Skeleton& skeleton = *clip.tracks.skeleton;
  const auto before = MeasureJoints(skeleton, clip.tracks.positions, clip.tracks.confidence, clip.tracks.time_s);
  const auto after = MeasureMotion(fit.motion);
  ++row.clips;
  row.frames += clip.tracks.frames();
  row.bone_sigma_before += before.bone_spread_mm;
  row.bone_sigma_after += after.bone_spread_mm;
  row.jerk_before += before.jerk;
  row.jerk_after += after.jerk;
  row.square += fit.residual_rms * fit.residual_rms * clip.tracks.frames();
  std::vector<bool> repaired(static_cast<std::size_t>(clip.tracks.frames()), false);
  std::vector<bool> swapped = repaired;
  for (const Finding& finding : fit.findings) {
    if (finding.code == kOutliersRejected) row.outliers += finding.value;
    if (finding.code == kOutliersRejected || finding.code == kSamplesContradicted ||
        finding.code == kFramesWithoutEvidence)
      continue;
    if (std::getenv("REPAIRS") != nullptr) {
      std::printf("%s %s [%d, %d): %s (%.1f)\n", clip.id.c_str(), finding.code.c_str(), finding.frame_begin,
                  finding.frame_end, finding.message.c_str(), finding.value);
    }
    std::fill(repaired.begin() + finding.frame_begin, repaired.begin() + finding.frame_end, true);
    if (finding.code == "swapped_sides")
      std::fill(swapped.begin() + finding.frame_begin, swapped.begin() + finding.frame_end, true);
  }
  row.repaired += static_cast<double>(std::count(repaired.begin(), repaired.end(), true));
  row.swapped += static_cast<double>(std::count(swapped.begin(), swapped.end(), true));
  for (const double confidence : clip.tracks.confidence) row.samples += confidence > 0.0 ? 1.0 : 0.0;
  const std::vector<bool> used = clip.tracks.JointObservations();
  row.examples.push_back(
      {person, clip.label, Features(Filled(clip.tracks), used, skeleton), Features(fit.motion.joints, used, skeleton)});
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  if (argc < 3) return std::fprintf(stderr, "bench_real_tracks SOURCE SKELETON [CLIPS [walk_refits=N]]\n"), 2;
  const auto skeleton = LoadSkeleton(argv[2]);
  if (!skeleton) return std::fprintf(stderr, "%s\n", skeleton.error().Message().c_str()), 1;
  JointTrackOptions options;
  options.solver = PoseSolver::kBanded;
  options.uncertainty = false;
  if (argc > 4) options.steps = StepsWithRefits(std::atoi(argv[4] + std::string("walk_refits=").size()));
  Row row;
  for (auto& [person, clips] : ReadPeople(argv[1], *skeleton, argc > 3 ? std::atoi(argv[3]) : 60)) {
    std::vector<SkeletonTracks> all;
    for (std::size_t i = 0; i < clips.size() && i < 30; ++i) all.push_back(clips[i].tracks);
    const auto bones = EstimateProportions(all, clips.front().tracks.skeleton, ProportionsOptions{});
    for (RealClip& clip : clips) clip.tracks = OnBody(std::move(clip.tracks), bones.skeleton);
    for (const RealClip& clip : clips) {
      const auto fit = RepairAndFit(clip.tracks, clip.rate, bones.bone_length, RepairOptions{}, options);
      if (fit) Add(clip, person, *fit, row);
    }
  }
  if (row.clips == 0) return std::fprintf(stderr, "no clip was fitted\n"), 1;
  std::printf("| %s | %d | %.0f | %.1f | %.1f | %.1f | %.2f | %.2f | %.2f | %.0f | %.0f | %.3f | %.3f |\n", argv[1],
              row.clips, row.frames, row.bone_sigma_before / row.clips, row.bone_sigma_after / row.clips,
              1e3 * std::sqrt(row.square / row.frames), 100.0 * row.repaired / row.frames,
              100.0 * row.swapped / row.frames, 100.0 * row.outliers / row.samples, row.jerk_before / row.clips,
              row.jerk_after / row.clips, Accuracy(row.examples, &Example::raw),
              Accuracy(row.examples, &Example::fitted));
}
