#include <algorithm>
#include <cmath>

#include "core/base/file.h"
#include "core/formats/depth_sequence.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"
#include "ingest/formats/driver.h"
#include "ingest/item_facts.h"
#include "ingest/sources/source_file.h"
#include "ingest/stages.h"
#include "ingest/synthetic/studio.h"

namespace mocurate {
namespace {

constexpr double kJointTolerance = 1e-4;  // metres between given joints and kinematics: files round to micrometres

/// The truth's own body: the tree of `skeleton` with rest offsets that reproduce the given joints.
Expected<SkeletonPtr> BodyOf(const DepthSequenceTruth& truth, const Skeleton& skeleton, const std::string& name) {
  auto body = std::make_shared<Skeleton>(skeleton);
  std::vector<Vector3d> sum(skeleton.joints.size(), Vector3d::Zero());
  for (int f = 0; f < truth.frames; ++f) {
    std::vector<Matrix3d> global(skeleton.joints.size());
    const std::size_t first = static_cast<std::size_t>(f) * truth.joints;
    for (int j = 0; j < truth.joints; ++j) {
      const int parent = skeleton.joints[j].parent;
      global[j] = ExpMatrix(truth.rotation_vector[first + j]);
      if (parent < 0) continue;
      sum[j] += global[parent].transpose() * (truth.joint[first + j] - truth.joint[first + parent]);
      global[j] = global[parent] * global[j];
    }
  }
  for (int j = 1; j < truth.joints; ++j) body->joints[j].rest_offset = sum[j] / truth.frames;
  if (Status ok = body->Check(); !ok) return Fail(ErrorCode::kInconsistent, ok.error().what, name);
  return SkeletonPtr(body);
}

Status CompareJoints(const DepthSequenceTruth& truth, const Motion& motion, const Matrix3d& world_from_rig,
                     const std::string& name) {
  for (int f = 0; f < truth.frames; ++f) {
    for (int j = 0; j < truth.joints; ++j) {
      const Vector3d given = world_from_rig * truth.joint[static_cast<std::size_t>(f) * truth.joints + j];
      if ((motion.joints.at(f, j) - given).norm() <= kJointTolerance) continue;
      return Fail(ErrorCode::kInconsistent,
                  "rotvec24 and joints_m contradict each other in frame " + std::to_string(f) + ", joint " +
                      motion.skeleton->joints[j].name,
                  name, "the truth of this file cannot be used");
    }
  }
  return {};
}

Expected<Motion> TruthMotion(const DepthSequenceTruth& truth, const SkeletonPtr& skeleton,
                             const Matrix3d& world_from_rig, const std::string& name) {
  if (skeleton->joint_count() != truth.joints) {
    return Fail(ErrorCode::kInconsistent,
                "the truth has " + std::to_string(truth.joints) + " joints, skeleton '" + skeleton->name + "' has " +
                    std::to_string(skeleton->joint_count()),
                name);
  }
  const Expected<SkeletonPtr> body = BodyOf(truth, *skeleton, name);
  if (!body) return Forward(body);
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < truth.frames; ++f) {
    const std::size_t first = static_cast<std::size_t>(f) * truth.joints;
    root.push_back(world_from_rig * truth.joint[first]);
    for (int j = 0; j < truth.joints; ++j) {
      Quaterniond q = ExpQuaternion(truth.rotation_vector[first + j]);
      if (j == 0) q = Quaterniond(world_from_rig) * q;
      rotation.push_back(q.normalized());
    }
  }
  for (int j = 0; j < truth.joints; ++j) {
    MakeSignContinuous(rotation.data() + j, static_cast<std::size_t>(truth.frames),
                       static_cast<std::size_t>(truth.joints));
  }
  Motion motion = MakeMotion(*body, truth.fps > 0.0 ? FrameRate::FromHz(truth.fps) : FrameRate{1, 1}, std::move(root),
                             std::move(rotation), {});
  if (Status ok = CompareJoints(truth, motion, world_from_rig, name); !ok) return Forward(ok);
  return motion;
}

Expected<StageOutcome> StudioTruth(const StageRequest& request) {
  const auto options = OptionsFromJson<SyntheticOptions>(request.options.at("synthetic"));
  if (!options) return Forward(options);
  const Expected<Truth> truth = SyntheticTruth(*options);
  if (!truth) return Forward(truth);
  if (Status written = WriteTruth(*truth, request.output); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {{"clips", truth->motion.size()}};
  return outcome;
}

}  // namespace

Expected<StageOutcome> TruthStage(const StageRequest& request) {
  if (request.options.contains("synthetic")) return StudioTruth(request);
  nlohmann::json declared = request.options;
  if (const auto facts = TakeFacts(declared); !facts) return Forward(facts);
  const Expected<SourceOptions> source = OptionsFromJson<SourceOptions>(declared);
  if (!source) return Forward(source);
  const auto input = std::find_if(request.inputs.begin(), request.inputs.end(),
                                  [](const StageInput& candidate) { return candidate.role == "source"; });
  if (input == request.inputs.end()) return Fail(ErrorCode::kInternal, "no input with the role 'source'", request.item);
  if (!DriverOf(source->format).has_truth) {
    return Fail(ErrorCode::kUnsupported, "sources of this format carry no truth", input->name);
  }
  const Expected<NamedFile> named = ReadName(*source, input->name);
  if (!named) return Forward(named);
  const Expected<AxisConvention> axes = AxisConvention::Parse(source->axes);
  if (!axes) return Forward(axes);
  const Expected<SkeletonPtr> skeleton = LoadSkeleton(source->skeleton.empty() ? "smpl24" : source->skeleton);
  if (!skeleton) return Forward(skeleton);
  const Expected<std::string> bytes = ReadFile(input->path);
  if (!bytes) return Forward(bytes);
  const Expected<DepthSequenceTruth> parsed = ParseDepthSequenceTruth(*bytes, input->name);
  if (!parsed) return Forward(parsed);
  Expected<Motion> motion = TruthMotion(*parsed, *skeleton, axes->canonical_from_source, input->name);
  if (!motion) return Forward(motion);

  ClipIdentity identity = named->identity;
  identity.end_frame = parsed->frames;
  StageOutcome outcome;
  outcome.summary = {{"clip", identity.id()}, {"frames", parsed->frames}, {"joints", parsed->joints}};
  Truth truth;
  truth.motion.emplace(identity.id(), std::move(*motion));
  if (Status written = WriteTruth(truth, request.output); !written) return Forward(written);
  return outcome;
}

}  // namespace mocurate
