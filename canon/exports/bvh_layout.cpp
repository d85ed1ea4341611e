// The layout bvh: root position and rotations of every joint, with the person's own bone lengths, in centimetres.

#include <cmath>

#include "canon/exports/clip_names.h"
#include "canon/exports/written_set.h"
#include "core/base/pi.h"
#include "core/formats/bvh.h"

namespace mocurate {
namespace {

constexpr const char* kNotInBvhNames = " {}";
constexpr double kCentimetresPerMetre = 100.0;
constexpr double kEndSiteShare = 0.5;  ///< length of an End Site relative to the bone that ends at the leaf

/// Six decimals: 1e-6 degrees, 1e-8 m.
double Rounded(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }

Vector3d RoundedOffset(const Vector3d& metres) {
  return (kCentimetresPerMetre * metres).unaryExpr([](double v) { return Rounded(v); });
}

/// Joints in the order of the file's hierarchy: each before its children, depth first.
std::vector<int> OrderOfBranches(const Skeleton& skeleton) {
  const std::vector<std::vector<int>> children = skeleton.Children();
  std::vector<int> order, open = {0};
  while (!open.empty()) {
    const int joint = open.back();
    open.pop_back();
    order.push_back(joint);
    open.insert(open.end(), children[joint].rbegin(), children[joint].rend());
  }
  return order;
}

/// The tree of a motion with this person's bone lengths.
std::vector<BvhJoint> TreeOf(const Motion& motion, const std::vector<int>& order) {
  using Channel = BvhChannel;
  const Skeleton& skeleton = *motion.skeleton;
  const std::vector<std::vector<int>> children = skeleton.Children();
  const std::vector<std::string> names = JointNamesForFile(skeleton, kNotInBvhNames);
  std::vector<int> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<int>(k);
  std::vector<BvhJoint> tree;
  int channel = 0;
  for (const int j : order) {
    const Joint& joint = skeleton.joints[j];
    const Vector3d bone = motion.bone_length.empty() || j == 0
                              ? joint.rest_offset
                              : Vector3d(motion.bone_length[j] * joint.rest_offset.stableNormalized());
    BvhJoint own;
    own.name = names[static_cast<std::size_t>(j)];
    own.parent = joint.parent < 0 ? -1 : place[joint.parent];
    own.offset = j == 0 ? Vector3d(Vector3d::Zero()) : RoundedOffset(bone);
    own.channels = {Channel::kZRotation, Channel::kXRotation, Channel::kYRotation};
    if (j == 0) {
      own.channels.insert(own.channels.begin(), {Channel::kXPosition, Channel::kYPosition, Channel::kZPosition});
    }
    own.first_channel = channel;
    channel += static_cast<int>(own.channels.size());
    own.has_end_site = children[j].empty();
    if (own.has_end_site) own.end_site = RoundedOffset(kEndSiteShare * bone);
    tree.push_back(std::move(own));
  }
  return tree;
}

/// The same angle, shifted by whole rotations to be nearest to the previous one.
double NearestTurn(double degrees, double before) { return degrees + 360.0 * std::round((before - degrees) / 360.0); }

Expected<std::string> BvhOfClip(const Clip& clip, const ExportSet&) {
  const Motion& motion = *clip.motion;
  if (motion.joints_only()) {
    return Fail(ErrorCode::kInconsistent, "the motion has joints alone, no rotations", clip.id(),
                "`mocurate fit` estimates rotations");
  }
  static const EulerOrder kOrder = *EulerOrder::Parse("ZXY");
  const std::vector<int> order = OrderOfBranches(*motion.skeleton);
  Bvh bvh;
  bvh.joints = TreeOf(motion, order);
  bvh.channel_count = 3 + 3 * static_cast<int>(order.size());
  bvh.frames = motion.frame_count();
  bvh.frame_time_s = motion.rate.FrameTime(1);
  std::vector<Vector3d> before(order.size(), Vector3d::Zero());
  for (int f = 0; f < bvh.frames; ++f) {
    const Vector3d root = RoundedOffset(motion.root_translation[f]);
    bvh.values.insert(bvh.values.end(), root.data(), root.data() + 3);
    for (std::size_t k = 0; k < order.size(); ++k) {
      const Matrix3d rotation = motion.rotation_at(f, order[k]).toRotationMatrix();
      Vector3d angles = EulerFromMatrix(rotation, kOrder) * (180.0 / kPi);
      for (int axis = 0; axis < 3 && f > 0; ++axis) angles[axis] = NearestTurn(angles[axis], before[k][axis]);
      before[k] = angles;
      for (int axis = 0; axis < 3; ++axis) bvh.values.push_back(Rounded(angles[axis]));
    }
  }
  return WriteBvh(bvh);
}

std::vector<std::pair<std::string, std::string>> DeclareBvh(const ExportSet&, const FrameRate&) {
  return {{"format", "bvh"}, {"units", "cm"}};
}

}  // namespace

std::unique_ptr<LayoutWriter> MakeBvhLayout(const ExportSet& set) {
  LabelledFolder folder{"bvh", ".bvh", BvhOfClip, DeclareBvh};
  folder.holds_rate = true;
  folder.declares_rate = false;
  folder.holds_tree = true;
  folder.not_in_joint_names = kNotInBvhNames;
  return MakeLabelledFolder(set, folder);
}

}  // namespace mocurate
