#include "core/body/capsule_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "core/base/text.h"

namespace mocurate {
namespace {

/// A capsule of the template: joint names with '?' for "left" and "right"; offsets of the left side. Metres.
struct TemplateCapsule {
  const char* frame;
  const char* end_joint;
  Vector3d begin_offset;
  Vector3d end_offset;
  double radius;
};

/// Bones whose own capsule is replaced by the template's.
const std::array<const char*, 9> kReplacedBones = {"spine1",       "spine2",   "spine3",    "neck", "left_collar",
                                                   "right_collar", "left_hip", "right_hip", "head"};

/// Capsules of the CC0 template (mean of the male and the female body): initialised with its cross-sections at rest,
/// then fitted to the points of posed people (`bench_template_shape`).
const std::vector<TemplateCapsule>& Template() {
  static const std::vector<TemplateCapsule> capsules = {
      {"pelvis", "pelvis", {-0.0662, -0.0112, 0.0039}, {0.0662, -0.0112, 0.0039}, 0.1017},
      {"spine1", "spine1", {-0.0477, -0.0176, 0.0593}, {0.0477, -0.0176, 0.0593}, 0.1014},
      {"spine2", "spine2", {-0.0405, 0.0125, 0.0593}, {0.0405, 0.0125, 0.0593}, 0.0897},
      {"spine3", "spine3", {-0.0389, 0.0437, 0.0573}, {0.0389, 0.0437, 0.0573}, 0.098},
      {"spine3", "spine3", {-0.0636, 0.1349, 0.0527}, {0.0636, 0.1349, 0.0527}, 0.0994},
      {"spine3", "spine3", {-0.0768, 0.2161, 0.0271}, {0.0768, 0.2161, 0.0271}, 0.0927},
      {"neck", "head", {0, -0.0005, 0.0166}, {0, 0.0011, -0.0143}, 0.0547},
      {"?_ankle", "?_ankle", {0.0039, -0.0386, -0.0138}, {0.0032, -0.0375, -0.0176}, 0.0298},
      {"head", "head", {0, 0.0534, -0.0075}, {0, 0.0643, 0.0103}, 0.0789},
      {"head", "head", {0, -0.0079, 0.0385}, {0, 0.0524, 0.0393}, 0.0659},
      {"?_hip", "?_hip", {-0.0138, -0.0239, 0.0217}, {-0.0068, -0.2009, 0.0305}, 0.0828},
      {"?_knee", "?_knee", {0.0087, -0.0373, -0.0182}, {0.0105, -0.1938, -0.024}, 0.0538},
      {"?_ankle", "?_ankle", {0.012, -0.031, 0.0206}, {0.0179, -0.0552, 0.133}, 0.0261},
      {"?_shoulder", "?_shoulder", {-0.0004, -0.0203, 0.005}, {0.0187, -0.0117, 0.0002}, 0.0567},
      {"?_elbow", "?_elbow", {-0.0178, 0.002, 0.0095}, {0.0945, -0.0013, 0.0018}, 0.0363},
      {"?_wrist", "?_wrist", {0.0001, -0.0033, -0.0032}, {0.097, -0.0205, -0.0218}, 0.0188},
      {"?_wrist", "?_wrist", {0.0288, -0.0001, 0.031}, {0.0854, -0.0224, 0.0774}, 0.0127},
      {"?_wrist", "?_wrist", {0.1026, -0.0096, 0.0233}, {0.1577, -0.0282, 0.0208}, 0.0186},
      {"?_wrist", "?_wrist", {0.1011, -0.0123, -0.0152}, {0.1522, -0.0298, -0.0113}, 0.0168},
  };
  return capsules;
}

/// Capsules of bones whose ends lie off the joints; those of limbs are the lower part, above it is one of Template().
struct MovedBone {
  const char* end_joint;
  Vector3d begin_offset;
  Vector3d end_offset;
  double radius;
};

const std::vector<MovedBone>& MovedBones() {
  static const std::vector<MovedBone> bones = {
      {"?_knee", {-0.0046, -0.1681, 0.0481}, {-0.0064, 0.0343, 0}, 0.0616},
      {"?_ankle", {0.0105, -0.2455, -0.011}, {0.0075, 0.0454, -0.0062}, 0.0356},
      {"?_foot", {0.0035, -0.0088, 0.0117}, {-0.0147, -0.0023, 0.029}, 0.0292},
      {"?_shoulder", {-0.0023, -0.0128, -0.0001}, {-0.0017, -0.0201, -0.0065}, 0.0626},
      {"?_elbow", {0.0562, 0.0006, -0.0011}, {-0.0303, -0.0014, 0.0043}, 0.0408},
      {"?_wrist", {0.1287, -0.001, 0.0024}, {-0.0216, -0.0007, -0.0014}, 0.0272},
      {"?_hand", {0.0165, 0.001, 0.011}, {-0.0149, -0.0042, 0.0182}, 0.0217},
  };
  return bones;
}

/// The side's own joint name.
std::string Sided(const char* name, bool right) {
  std::string text = name;
  if (const std::size_t at = text.find('?'); at != std::string::npos) text.replace(at, 1, right ? "right" : "left");
  return text;
}

Vector3d Mirrored(const Vector3d& offset, bool right) {
  return right ? Vector3d(-offset.x(), offset.y(), offset.z()) : offset;
}

/// Own names only: the template's offsets hold for SMPL's joints, not for what other skeletons call by these words.
int Find(const Skeleton& skeleton, const std::string& name) {
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (skeleton.joints[j].name == name) return j;
  }
  return -1;
}

void AddBones(const Skeleton& skeleton, bool has_template, CapsuleBody& body) {
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const Joint& joint = skeleton.joints[j];
    bool is_wanted = joint.radius > 0.0;
    for (const char* replaced : kReplacedBones) is_wanted = is_wanted && !(has_template && joint.name == replaced);
    if (!is_wanted) continue;
    BodyCapsule capsule;
    capsule.frame = joint.parent;
    capsule.end_joint = j;
    capsule.radius = joint.radius;
    for (std::size_t i = 0; has_template && i < MovedBones().size(); ++i) {
      const MovedBone& bone = MovedBones()[i];
      const CapsuleChange change = ChangeOfBone(i, skeleton.shape);
      for (const bool right : {false, true}) {
        if (joint.name != Sided(bone.end_joint, right)) continue;
        capsule.begin_offset = Mirrored(bone.begin_offset + change.begin, right);
        capsule.end_offset = Mirrored(bone.end_offset + change.end, right);
        capsule.radius = bone.radius + change.radius;
      }
    }
    body.capsules.push_back(capsule);
  }
}

void AddTemplate(const Skeleton& skeleton, CapsuleBody& body) {
  for (std::size_t i = 0; i < Template().size(); ++i) {
    const TemplateCapsule& part = Template()[i];
    const CapsuleChange change = ChangeOfPart(i, skeleton.shape);
    const bool is_sided = part.frame[0] == '?';
    for (const bool right : {false, true}) {
      if (right && !is_sided) continue;
      BodyCapsule capsule;
      capsule.frame = Find(skeleton, Sided(part.frame, right));
      capsule.end_joint = Find(skeleton, Sided(part.end_joint, right));
      capsule.begin_offset = Mirrored(part.begin_offset + change.begin, right);
      capsule.end_offset = Mirrored(part.end_offset + change.end, right);
      capsule.radius = part.radius + change.radius;
      body.capsules.push_back(capsule);
    }
  }
}

void PairMirrors(const Skeleton& skeleton, std::vector<BodyCapsule>& capsules) {
  for (std::size_t i = 0; i < capsules.size(); ++i) {
    const BodyCapsule& one = capsules[i];
    capsules[i].mirror = static_cast<int>(i);
    for (std::size_t k = 0; k < capsules.size(); ++k) {
      const BodyCapsule& other = capsules[k];
      if (one.frame == other.frame || skeleton.joints[one.frame].mirror != other.frame) continue;
      if (skeleton.joints[one.end_joint].mirror != other.end_joint) continue;
      if (other.begin_offset == Mirrored(one.begin_offset, true) &&
          other.end_offset == Mirrored(one.end_offset, true)) {
        capsules[i].mirror = static_cast<int>(k);
      }
    }
  }
}

}  // namespace

bool HasTemplateShape(const Skeleton& skeleton) {
  for (const bool right : {false, true}) {
    for (const TemplateCapsule& capsule : Template()) {
      if (Find(skeleton, Sided(capsule.frame, right)) < 0 || Find(skeleton, Sided(capsule.end_joint, right)) < 0) {
        return false;
      }
    }
    for (const MovedBone& bone : MovedBones()) {
      if (Find(skeleton, Sided(bone.end_joint, right)) < 0) return false;
    }
  }
  return true;
}

CapsuleBody CapsuleBody::Make(SkeletonPtr skeleton, double scale) {
  CapsuleBody body;
  const bool has_template = HasTemplateShape(*skeleton);
  AddBones(*skeleton, has_template, body);
  if (has_template) AddTemplate(*skeleton, body);
  PairMirrors(*skeleton, body.capsules);
  for (BodyCapsule& capsule : body.capsules) {
    capsule.begin_offset *= scale;
    capsule.end_offset *= scale;
    capsule.radius *= scale;
  }
  body.skeleton = std::move(skeleton);
  return body;
}

std::vector<bool> CapsuleBody::MovingJoints() const {
  std::vector<bool> moving(skeleton->joints.size(), false);
  moving[0] = true;
  for (const BodyCapsule& capsule : capsules) {
    for (int j = capsule.frame; j >= 0; j = skeleton->joints[j].parent) moving[j] = true;
  }
  return moving;
}

CapsuleEnds EndsOf(const BodyCapsule& capsule, const Matrix3d& world_from_frame, const Vector3d& frame_joint,
                   const Vector3d& end_joint) {
  return {frame_joint + world_from_frame * capsule.begin_offset, end_joint + world_from_frame * capsule.end_offset};
}

std::vector<PosedCapsule> PosedCapsules(const CapsuleBody& body, const Vector3d* joints,
                                        const Quaterniond* world_from_joint) {
  std::vector<PosedCapsule> posed;
  for (const BodyCapsule& capsule : body.capsules) {
    const CapsuleEnds ends = EndsOf(capsule, world_from_joint[capsule.frame].toRotationMatrix(), joints[capsule.frame],
                                    joints[capsule.end_joint]);
    posed.push_back({ends.begin, ends.end, capsule.radius});
  }
  return posed;
}

double BodyScale(const Skeleton& skeleton, const std::vector<double>& bone_length) {
  const std::vector<double> rest = skeleton.RestBoneLengths();
  double length = 0.0;
  double rest_length = 0.0;
  for (std::size_t j = 0; j < rest.size() && j < bone_length.size(); ++j) {
    length += bone_length[j];
    rest_length += rest[j];
  }
  return length > 0.0 && rest_length > 0.0 ? length / rest_length : 1.0;
}

std::string RadiiText(const CapsuleBody& body) {
  std::string text;
  const auto append = [&](double value, double per_unit) {
    if (!text.empty()) text += ' ';
    text += FormatDouble(std::round(value * per_unit) / per_unit + 0.0);  // no -0
  };
  for (const BodyCapsule& capsule : body.capsules) append(capsule.radius, 1e4);
  if (body.skeleton->shape == BodyShape{}) return text;
  for (const double component : body.skeleton->shape) append(component, 1e3);
  return text;
}

std::optional<CapsuleBody> BodyFromRadii(SkeletonPtr skeleton, const std::vector<double>& bone_length,
                                         const std::string& radii) {
  std::vector<double> numbers;
  for (const std::string_view word : SplitBlanks(radii)) {
    const std::optional<double> number = ParseDouble(word);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers.push_back(*number);
  }
  const double scale = BodyScale(*skeleton, bone_length);
  const std::size_t capsules = CapsuleBody::Make(skeleton, scale).capsules.size();
  if (numbers.size() != capsules && numbers.size() != capsules + kShapeComponents) return std::nullopt;
  if (numbers.size() > capsules) {
    auto own = std::make_shared<Skeleton>(*skeleton);
    std::copy(numbers.begin() + static_cast<std::ptrdiff_t>(capsules), numbers.end(), own->shape.begin());
    skeleton = std::move(own);
  }
  CapsuleBody body = CapsuleBody::Make(std::move(skeleton), scale);
  for (std::size_t i = 0; i < capsules; ++i) {
    if (!(numbers[i] > 0.0)) return std::nullopt;
    body.capsules[i].radius = numbers[i];
  }
  return body;
}

}  // namespace mocurate
