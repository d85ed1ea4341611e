// bench_template_shape [CLIPS [FRAMES [SEED [FOLDER]]]]: errors of the body template's capsules
// (core/body/capsule_body.cpp) against people of known poses, bones and shapes. Uses every fifth frame of
// bench_fit_clouds' studio clips. Prints per capsule the change of its ends in the joint's frame and of its radius:
// millimetres at the template's size, left side, mean and deviation over people. Also prints the distances of points
// before and after. A mean that persists over several seeds is a correction of the template; then run
// scripts/body_shapes.py.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <vector>

#include "core/body/capsule_body.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/cloud_shape.h"
#include "fitting/clouds/joint_cloud_fit.h"
#include "fitting/clouds/person_points.h"
#include "tests/benchmarks/given_takes.h"
#include "tests/fitting/cloud_takes.h"

namespace mocurate {
namespace {

constexpr int kEvery = 5;              ///< frames
constexpr double kReach = 0.15;        ///< m, largest distance of points from their capsule
constexpr double kOffsetError = 5e-4;  ///< m, standard deviation of rest offsets about the components
constexpr int kRounds = 4;

std::vector<Vector3d> Offsets(const Skeleton& skeleton, const std::vector<double>& bone_length) {
  std::vector<Vector3d> offsets;
  for (int j = 0; j < skeleton.joint_count(); ++j)
    offsets.emplace_back(bone_length[j] * skeleton.joints[j].rest_offset.stableNormalized());
  return offsets;
}

/// The shape whose bones are nearest to a person's.
BodyShape ShapeOfBones(const SkeletonPtr& skeleton, const Motion& truth) {
  const std::vector<Vector3d> wanted = Offsets(*truth.skeleton, truth.bone_length);
  BodyShape shape{};
  double scale = BodyScale(*skeleton, truth.bone_length);
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXd rows(3 * skeleton->joint_count(), 1 + kShapeComponents);
    Eigen::VectorXd left(rows.rows());
    for (int j = 0; j < skeleton->joint_count(); ++j) {
      const std::string& name = skeleton->joints[j].name;
      const Vector3d offset = skeleton->joints[j].rest_offset + OffsetChange(name, shape);
      rows.block<3, 1>(3 * j, 0) = offset;
      for (int k = 0; k < kShapeComponents; ++k) {
        BodyShape one{};
        one[k] = 1.0;
        rows.block<3, 1>(3 * j, 1 + k) = scale * OffsetChange(name, one);
      }
      left.segment<3>(3 * j) = wanted[j] - scale * offset;
    }
    Eigen::MatrixXd information = rows.transpose() * rows / (kOffsetError * kOffsetError);
    Eigen::VectorXd right = rows.transpose() * left / (kOffsetError * kOffsetError);
    for (int k = 0; k < kShapeComponents; ++k) {
      information(1 + k, 1 + k) += 1.0;
      right[1 + k] -= shape[k];
    }
    const Eigen::VectorXd step = information.ldlt().solve(right);
    scale += step[0];
    for (int k = 0; k < kShapeComponents; ++k) shape[k] += step[1 + k];
  }
  return shape;
}

/// Some clouds of a person and the poses in them.
struct PosedClouds {
  std::vector<FusedCloud> clouds;
  std::vector<std::vector<double>> poses;
};

/// RMS distance of points by capsule, mm. (capsules)
std::vector<double> Distances(const CapsuleBody& body, const PoseState& state, const std::vector<FusedCloud>& clouds) {
  std::vector<double> squares(body.capsules.size(), 0.0), count(body.capsules.size(), 0.0);
  for (int f = 0; f < state.frames(); ++f) {
    for (const CloudMatch& match : MatchPoints(body, state, f, clouds[f], kReach)) {
      squares[match.capsule] += match.distance * match.distance;
      count[match.capsule] += 1.0;
    }
  }
  for (std::size_t c = 0; c < squares.size(); ++c) squares[c] = 1e3 * std::sqrt(squares[c] / std::max(1.0, count[c]));
  return squares;
}

/// Seven changes of a capsule, then the distances before and after.
using CapsuleNumbers = std::vector<double>;

std::vector<CapsuleNumbers> ChangesOf(const Motion& truth, const SkeletonPtr& skeleton, const PosedClouds& posed) {
  auto own = std::make_shared<Skeleton>(*truth.skeleton);
  own->shape = ShapeOfBones(skeleton, truth);
  const double scale = BodyScale(*skeleton, truth.bone_length);
  CapsuleBody body = CapsuleBody::Make(own, scale);
  PoseState state(*own, static_cast<int>(posed.clouds.size()), truth.bone_length,
                  std::vector<bool>(own->joints.size(), true));
  std::vector<int> frames;
  for (int f = 0; f < state.frames(); ++f) {
    state.SetFrameParameters(f, posed.poses[f]);
    frames.push_back(f);
  }
  state.Update(0, state.frames(), false);
  const std::vector<double> before = Distances(body, state, posed.clouds);
  const CapsuleBody given = body;
  FitCapsuleOffsets(posed.clouds, state, frames, kReach, std::vector<double>(own->joints.size(), 0.0), body);
  const std::vector<double> after = Distances(body, state, posed.clouds);
  std::vector<CapsuleNumbers> changes;
  for (std::size_t c = 0; c < body.capsules.size(); ++c) {
    const Vector3d begin = 1e3 / scale * (body.capsules[c].begin_offset - given.capsules[c].begin_offset);
    const Vector3d end = 1e3 / scale * (body.capsules[c].end_offset - given.capsules[c].end_offset);
    const double radius = 1e3 / scale * (body.capsules[c].radius - given.capsules[c].radius);
    changes.push_back({begin.x(), begin.y(), begin.z(), end.x(), end.y(), end.z(), radius, before[c], after[c]});
  }
  return changes;
}

void Print(const CapsuleBody& body, const std::vector<std::vector<CapsuleNumbers>>& people) {
  const auto count = static_cast<double>(people.size());
  for (std::size_t c = 0; c < body.capsules.size(); ++c) {
    const BodyCapsule& capsule = body.capsules[c];
    if (capsule.mirror < static_cast<int>(c)) continue;
    std::printf("%-14s %-14s", body.skeleton->joints[capsule.frame].name.c_str(),
                body.skeleton->joints[capsule.end_joint].name.c_str());
    for (std::size_t i = 0; i < people[0][c].size(); ++i) {
      double sum = 0.0, squares = 0.0;
      for (const auto& person : people) {
        sum += person[c][i] / count;
        squares += person[c][i] * person[c][i] / count;
      }
      const double deviation = std::sqrt(std::max(0.0, squares - sum * sum));
      std::printf(i == 7 ? " | %.1f" : " %.1f(%.1f)", sum, deviation);
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  CloudTakeOptions wanted;
  wanted.frames = 30;
  const std::filesystem::path folder = GivenTakes(argc, argv, "/tmp/bench_template_shape", wanted);
  const std::vector<CloudTake> takes = CloudTakes(wanted, folder);
  if (takes.empty()) return std::fprintf(stderr, "no body: set MOCURATE_DATA\n"), 2;
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const CapsuleBody body = CapsuleBody::Make(skeleton, 1.0);
  const PointCloudOptions options;
  std::map<int, PosedClouds> of_person;
  std::map<int, const Motion*> truth;
  for (const CloudTake& take : takes) {
    const PoseState state = StateOf(take.clip.truth, body);
    PosedClouds& posed = of_person[take.clip.subject];
    truth[take.clip.subject] = &take.clip.truth;
    const auto frames = static_cast<int>(take.evidence.depth_views[0].files.size());
    for (int f = 0; f < frames; f += kEvery) {
      const auto cloud = FuseViews(take.evidence.depth_views, f, options.voxel_size);
      if (!cloud) return std::fprintf(stderr, "%s\n", cloud.error().Message().c_str()), 1;
      posed.clouds.push_back(PersonPoints(*cloud, options.voxel_size));
      posed.poses.push_back(state.FrameParameters(f));
    }
  }
  std::vector<std::vector<CapsuleNumbers>> people;
  for (const auto& [subject, posed] : of_person) people.push_back(ChangesOf(*truth[subject], skeleton, posed));
  Print(body, people);
}
