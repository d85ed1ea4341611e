// bench_recovered_rotations SOURCE SKELETON [NOISE_MM [CLIPS]]: fits the joints of a set that records rotations
// (hdm05), with NOISE_MM of white noise and unknown bones, and compares with the recorded motion. Prints a row of
// docs/refitted_sets.md. bench_recovered_rotations cad60: compares rotations fitted to positions alone with those that
// OpenNI's tracker wrote into the same files.
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/formats/joint_table.h"
#include "core/motion/kinematics.h"
#include "eval/metrics/fit_error.h"
#include "fitting/fit_outcome.h"
#include "fitting/proportions.h"
#include "tests/benchmarks/real_people.h"

namespace mocurate {
namespace {

constexpr double kDegrees = 180.0 / 3.14159265358979323846;

/// Fits positions alone; the recorded rotations are the reference.
JointTrackOptions Banded() {
  JointTrackOptions options;
  options.solver = PoseSolver::kBanded;
  options.recorded_rotations = false;
  return options;
}

Proportions BonesOf(const std::vector<RealClip>& clips) {
  std::vector<SkeletonTracks> all;
  for (std::size_t i = 0; i < clips.size() && i < 30; ++i) all.push_back(clips[i].tracks);
  return EstimateProportions(all, clips.front().tracks.skeleton, ProportionsOptions{});
}

/// Local rotations about the axes that the fit marks as observed (at least nine tenths of the prior's variance
/// removed).
struct AxisErrors {
  std::vector<double> degrees;
  double axes = 0.0;  ///< number of all axes

  void Add(const Motion& fitted, const Motion& truth) {
    for (int f = 0; f < truth.frame_count(); ++f) {
      for (int j = 0; j < truth.joint_count(); ++j) {
        const Vector3d apart = LogQuaternion(fitted.rotation_at(f, j).conjugate() * truth.rotation_at(f, j));
        const std::size_t first = 3 * (static_cast<std::size_t>(f) * truth.joint_count() + j);
        for (int i = 0; i < 3; ++i) {
          axes += 1.0;
          if (fitted.rotation_observed[first + i] > 0.9F) degrees.push_back(kDegrees * std::abs(apart[i]));
        }
      }
    }
  }
};

int Recovered(const std::string& source, const SkeletonPtr& skeleton, double noise_mm, std::size_t count) {
  FitError sum;
  double noisy = 0.0;
  Calibration calibration;
  int clips_done = 0;
  AxisErrors axes;
  for (const auto& [person, clips] : ReadPeople(source, skeleton, count, 1e-3 * noise_mm)) {
    const auto bones = BonesOf(clips);
    for (const RealClip& clip : clips) {
      if (!clip.given) continue;
      auto fit =
          RepairAndFit(OnBody(clip.tracks, bones.skeleton), clip.rate, bones.bone_length, RepairOptions{}, Banded());
      if (!fit) continue;
      Clip fitted;
      fitted.motion = std::move(fit->motion);
      const auto error = CompareWithTruth(fitted, Evidence(), *clip.given);
      if (!error) return std::fprintf(stderr, "%s\n", error.error().Message().c_str()), 1;
      ++clips_done;
      axes.Add(*fitted.motion, *clip.given);
      sum.frames += error->frames;
      sum.joint_mm += error->frames * error->joint_mm;
      sum.bone_direction_deg += error->frames * error->bone_direction_deg;
      calibration.Append(error->sigma.All().positions.calibration);
      double off = 0.0;
      for (int f = 0; f < clip.tracks.frames(); ++f) {
        for (int j = 0; j < clip.tracks.joints(); ++j)
          off += (clip.tracks.positions.at(f, j) - clip.given->joints.at(f, j)).norm() / clip.tracks.joints();
      }
      noisy += 1e3 * off;
    }
  }
  if (clips_done == 0) return std::fprintf(stderr, "no clip was fitted\n"), 1;
  const double n = sum.frames;
  const double mean = std::accumulate(axes.degrees.begin(), axes.degrees.end(), 0.0) / axes.degrees.size();
  std::printf("| %s | %.0f | %d | %d | %.1f | %.1f | %.1f | %.1f, %.1f | %.0f | %.1f, %.1f |\n", source.c_str(),
              noise_mm, clips_done, sum.frames, noisy / n, sum.joint_mm / n, sum.bone_direction_deg / n, mean,
              MeanMedian(axes.degrees), 100.0 * axes.degrees.size() / axes.axes,
              100.0 * calibration.within_one_sigma().value_or(0.0),
              100.0 * calibration.within_two_sigma().value_or(0.0));
  return 0;
}

/// One joint of CAD-60: angles between the fitted world rotation and the recorded one.
struct Angles {
  std::vector<Quaterniond> fitted, recorded;
  std::vector<double> bone;  ///< between the fitted bone below the joint and the recorded rotation's
};

/// The rotation r that best aligns recorded * r with fitted on average, for frames of a joint that differ by
/// convention.
Quaterniond Offset(const Angles& angles) {
  Matrix3d sum = Matrix3d::Zero();
  for (std::size_t i = 0; i < angles.fitted.size(); ++i)
    sum += (angles.recorded[i].conjugate() * angles.fitted[i]).toRotationMatrix();
  const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3d sign(1.0, 1.0, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  const Matrix3d nearest = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  return Quaterniond(nearest);
}

int Cad60(const SkeletonPtr& skeleton) {
  static const char* const kJoints[] = {"head",       "neck",           "torso",       "left_shoulder",
                                        "left_elbow", "right_shoulder", "right_elbow", "left_hip",
                                        "left_knee",  "right_hip",      "right_knee"};
  static const char* const kBelow[] = {"",           "head",        "neck",        "left_elbow",
                                       "left_wrist", "right_elbow", "right_wrist", "left_knee",
                                       "left_ankle", "right_knee",  "right_ankle"};
  std::vector<Angles> angles(11);
  const Matrix3d axes = Vector3d(-1.0, 1.0, -1.0).asDiagonal();
  for (const auto& [person, clips] : ReadPeople("cad60", skeleton, 100)) {
    const auto bones = BonesOf(clips);
    for (const RealClip& clip : clips) {
      const auto fit =
          RepairAndFit(OnBody(clip.tracks, bones.skeleton), clip.rate, bones.bone_length, RepairOptions{}, Banded());
      const std::string recording = clip.id.substr(clip.id.rfind('/') + 1, 10);
      const auto bytes = ReadFile(std::filesystem::path(TestData()) / "kinect" / "cad60" / (recording + ".txt"));
      if (!fit || !bytes) return std::fprintf(stderr, "%s: no fit or no file\n", clip.id.c_str()), 1;
      JointTableLayout layout;
      layout.end_word = "END";
      const auto table = ParseJointTable(*bytes, layout, recording);
      if (!table) return std::fprintf(stderr, "%s\n", table.error().Message().c_str()), 1;
      const Motion& motion = fit->motion;
      for (int f = 0; f < motion.frame_count(); ++f) {
        std::vector<Vector3d> joints(motion.joint_count());
        std::vector<Quaterniond> world(motion.joint_count());
        ForwardKinematics(*motion.skeleton, motion.root_translation[f], &motion.rotation_at(f, 0), motion.bone_length,
                          joints.data(), world.data());
        for (int k = 0; k < 11; ++k) {
          const int column = 1 + 14 * k;
          if (!(table->at(f, 0, column + 9) > 0.0)) continue;  // zero confidence
          Matrix3d recorded;
          for (int i = 0; i < 9; ++i) recorded(i / 3, i % 3) = table->at(f, 0, column + i);
          recorded = axes * recorded * axes;
          const int joint = *skeleton->FindJoint(kJoints[k]);
          angles[k].fitted.push_back(world[joint]);
          angles[k].recorded.emplace_back(recorded);
          if (kBelow[k][0] == '\0') continue;
          const int child = *skeleton->FindJoint(kBelow[k]);
          const Vector3d bone = joints[child] - joints[joint];
          const Vector3d recorded_bone = recorded * skeleton->joints[child].rest_offset;
          angles[k].bone.push_back(kDegrees * std::atan2(bone.cross(recorded_bone).norm(), bone.dot(recorded_bone)));
        }
      }
    }
  }
  std::printf(
      "| joint | frames | bone, median | whole rotation, median | convention's offset | median after the offset | p95 "
      "|\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  for (int k = 0; k < 11; ++k) {
    if (angles[k].fitted.empty()) continue;
    const Quaterniond offset = Offset(angles[k]);
    std::vector<double> whole, turned;
    for (std::size_t i = 0; i < angles[k].fitted.size(); ++i) {
      whole.push_back(kDegrees * AngleBetween(angles[k].fitted[i], angles[k].recorded[i]));
      turned.push_back(kDegrees * AngleBetween(angles[k].fitted[i], angles[k].recorded[i] * offset));
    }
    const std::size_t count = turned.size();
    std::vector<double> bone = angles[k].bone;
    const double middle = MeanMedian(turned);
    std::sort(turned.begin(), turned.end());
    std::printf("| %s | %zu | %s | %.1f | %.1f | %.1f | %.1f |\n", kJoints[k], count,
                bone.empty() ? "-" : RoundedText(MeanMedian(bone)).c_str(), MeanMedian(whole),
                kDegrees * AngleBetween(offset, Quaterniond::Identity()), middle, turned[count * 95 / 100]);
  }
  return 0;
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  const bool cad60 = argc > 1 && std::string(argv[1]) == "cad60";
  if (argc < 3 && !cad60) {
    return std::fprintf(stderr, "bench_recovered_rotations SOURCE SKELETON [NOISE_MM [CLIPS]] | cad60\n"), 2;
  }
  const auto skeleton = LoadSkeleton(argc > 2 ? argv[2] : "openni16");
  if (!skeleton) return std::fprintf(stderr, "%s\n", skeleton.error().Message().c_str()), 1;
  if (cad60) return Cad60(*skeleton);
  return Recovered(argv[1], *skeleton, argc > 3 ? std::atof(argv[3]) : 30.0, argc > 4 ? std::atoi(argv[4]) : 1000);
}
