#include "eval/features/motion_input.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/geometry/axes.h"
#include "core/motion/preparation.h"
#include "train/recognisers/recogniser_input.h"

namespace mocurate {
namespace {

int FirstFrame(int frame_count, int frames, CropStart start, Random& random) {
  if (frame_count <= frames || start == CropStart::kFirst) return 0;
  const LastStart last = start == CropStart::kReleased ? LastStart::kExcluded : LastStart::kIncluded;
  return DrawWindow(frame_count, frames, last, random).start;
}

}  // namespace

Expected<InputRules> RulesOf(const ExtractorOptions& options) {
  const Expected<SkeletonPtr> skeleton = LoadSkeleton(options.skeleton);
  if (!skeleton) return Forward(skeleton);
  const Expected<AxisConvention> axes = AxisConvention::Parse(options.axes);
  if (!axes) return Forward(axes);
  return InputRules{options, *skeleton, axes->canonical_from_source.transpose() / options.metres_per_unit};
}

Expected<std::vector<int>> JointsFor(const Skeleton& network, const Skeleton& motion) {
  std::vector<int> joints;
  std::string missing;
  for (const Joint& wanted : network.joints) {
    std::optional<int> found = motion.FindJoint(wanted.name);
    for (std::size_t i = 0; !found && i < wanted.synonyms.size(); ++i) found = motion.FindJoint(wanted.synonyms[i]);
    joints.push_back(found.value_or(-1));
    if (!found) missing += (missing.empty() ? "" : ", ") + wanted.name;
  }
  if (missing.empty()) return joints;
  return Fail(ErrorCode::kInconsistent,
              "skeleton '" + motion.name + "' of the motions lacks " + missing + ", which the extractor reads",
              network.name,
              "score motions of skeleton '" + network.name + "', or fit them: mocurate fit --skeleton " + network.name);
}

Status CheckRotations(const Skeleton& network, const Motion& motion) {
  if (motion.joints_only()) {
    return Fail(ErrorCode::kInconsistent, "the motion has joints only, the extractor reads rotations", network.name,
                "fit it (mocurate fit), or use an extractor that reads joints");
  }
  const Skeleton& own = *motion.rest_pose();
  if (!SameTree(network, own)) {
    return Fail(ErrorCode::kInconsistent,
                "the motion is of skeleton '" + own.name + "', which has another tree and other rotations",
                network.name, "score motions of skeleton '" + network.name + "'");
  }
  if (const double apart = RestPosesApart(network, own); apart > kSameRestPose) {
    return Fail(ErrorCode::kInconsistent,
                "the motion's rotations refer to a rest pose " + RoundedText(apart, 2) + " rad apart", network.name,
                "fit the motions to the rest pose of skeleton '" + network.name + "'");
  }
  return {};
}

namespace {

int WriteRotations(const InputRules& rules, const std::vector<int>& joints, const Motion& motion, int begin,
                   float* values) {
  const int last = motion.frame_count() - 1;
  const Matrix3d turn = rules.unit_from_metres / std::cbrt(std::abs(rules.unit_from_metres.determinant()));
  for (int f = 0; f < rules.frames(); ++f) {
    const int frame = std::min(begin + f, last);
    for (std::size_t k = rules.root_rotation ? 0 : 1; k < joints.size(); ++k) {
      Matrix3d rotation = motion.rotation_at(frame, joints[k]).toRotationMatrix();
      if (k == 0) rotation = turn * rotation;
      for (const double value : Matrix6D(rotation, Rotation6D::kRows)) *values++ = static_cast<float>(value);
    }
  }
  return rules.frames();
}

}  // namespace

int WriteMotionInput(const InputRules& rules, const std::vector<int>& joints, const Motion& motion, RootRule root,
                     CropStart start, Random& random, float* values) {
  if (rules.options.values != ExtractorValues::kJoints) {
    return WriteRotations(rules, joints, motion, FirstFrame(motion.frame_count(), rules.frames(), start, random),
                          values);
  }
  const bool whole = rules.options.length == LengthRule::kResample;
  const JointPositions resampled = whole ? ResampledJoints(motion, rules.frames()) : JointPositions();
  const JointPositions& source = whole ? resampled : motion.joints;
  const int begin = FirstFrame(source.frames, rules.frames(), start, random);
  const int valid = std::min(rules.frames(), source.frames - begin);
  const bool repeats = rules.options.padding == PaddingRule::kRepeatLast;
  const auto place = [&](int frame, std::size_t k) -> Vector3d {
    return rules.unit_from_metres * Vector3d(source.at(begin + frame, joints[k]));
  };
  const Vector3d first_root = place(0, 0);
  for (int f = 0; f < rules.frames(); ++f) {
    const bool pad = f >= valid;
    const int read = std::min(f, valid - 1);
    Vector3d origin = Vector3d::Zero();
    if (root == RootRule::kFirstFrame) origin = first_root;
    if (root == RootRule::kEveryFrame) origin = place(read, 0);
    for (std::size_t k = 0; k < joints.size(); ++k) {
      Vector3d value = Vector3d::Zero();
      if (!pad || repeats) {
        value = place(read, k) - origin;
      } else if (rules.options.padding == PaddingRule::kZerosMinusRoot) {
        value = -origin;
      }
      for (int axis = 0; axis < 3; ++axis) *values++ = static_cast<float>(value[axis]);
    }
  }
  return rules.options.read_out == ReadOut::kLastValid ? valid : rules.frames();
}

}  // namespace mocurate
