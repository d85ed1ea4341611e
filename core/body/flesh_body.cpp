#include "core/body/flesh_body.h"

#include <array>
#include <cmath>
#include <string>
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

/// Cross-sections of the trunk are as wide and as deep as those of the template mesh (mean of the male and the female
/// body) at their heights; ends of head, hands and feet reach its landmarks.
const std::vector<TemplateCapsule>& Template() {
  static const std::vector<TemplateCapsule> capsules = {
      {"pelvis", "pelvis", {-0.065, -0.02, 0.001}, {0.065, -0.02, 0.001}, 0.102},
      {"spine1", "spine1", {-0.05, -0.025, 0.057}, {0.05, -0.025, 0.057}, 0.1},
      {"spine2", "spine2", {-0.045, 0.017, 0.059}, {0.045, 0.017, 0.059}, 0.087},
      {"spine3", "spine3", {-0.045, 0.05, 0.055}, {0.045, 0.05, 0.055}, 0.096},
      {"spine3", "spine3", {-0.08, 0.15, 0.044}, {0.08, 0.15, 0.044}, 0.101},
      {"spine3", "spine3", {-0.07, 0.223, 0.029}, {0.07, 0.223, 0.029}, 0.09},
      {"neck", "head", {0.0, 0.0, 0.016}, {0.0, 0.0, -0.02}, 0.058},
      {"head", "head", {0.0, -0.01, 0.015}, {0.0, 0.06, 0.002}, 0.086},
      {"?_hip", "?_hip", {0.0, -0.03, 0.005}, {-0.005, -0.12, 0.012}, 0.088},
      {"?_ankle", "?_ankle", {0.0, -0.04, -0.015}, {0.0, -0.04, -0.02}, 0.031},
  };
  return capsules;
}

/// Ends of bone capsules moved off the joints: calves lie behind their bones, fingers and toes beyond the last joint.
struct MovedBone {
  const char* end_joint;
  Vector3d begin_offset;
  Vector3d end_offset;
  double radius;
};

const std::vector<MovedBone>& MovedBones() {
  static const std::vector<MovedBone> bones = {
      {"?_knee", {-0.005, -0.05, 0.02}, {-0.005, 0.0, 0.012}, 0.07},
      {"?_ankle", {0.007, -0.02, -0.022}, {0.004, 0.035, -0.014}, 0.048},
      {"?_foot", {0.0, -0.02, 0.015}, {0.002, 0.018, 0.025}, 0.031},
      {"?_shoulder", {0.0, -0.01, -0.004}, {0.0, -0.006, -0.003}, 0.064},
      {"?_elbow", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.044},
      {"?_wrist", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.033},
      {"?_hand", {0.0, -0.004, 0.006}, {0.055, -0.004, 0.006}, 0.032},
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

bool HasTemplateJoints(const Skeleton& skeleton) {
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

void AddBones(const Skeleton& skeleton, bool has_template, FleshBody& body) {
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const Joint& joint = skeleton.joints[j];
    bool is_wanted = joint.radius > 0.0;
    for (const char* replaced : kReplacedBones) is_wanted = is_wanted && !(has_template && joint.name == replaced);
    if (!is_wanted) continue;
    FleshCapsule capsule;
    capsule.frame = joint.parent;
    capsule.end_joint = j;
    capsule.radius = joint.radius;
    for (const MovedBone& bone : MovedBones()) {
      for (const bool right : {false, true}) {
        if (!has_template || joint.name != Sided(bone.end_joint, right)) continue;
        capsule.begin_offset = Mirrored(bone.begin_offset, right);
        capsule.end_offset = Mirrored(bone.end_offset, right);
        capsule.radius = bone.radius;
      }
    }
    body.capsules.push_back(capsule);
  }
}

void AddTemplate(const Skeleton& skeleton, FleshBody& body) {
  for (const TemplateCapsule& part : Template()) {
    const bool is_sided = part.frame[0] == '?';
    for (const bool right : {false, true}) {
      if (right && !is_sided) continue;
      FleshCapsule capsule;
      capsule.frame = Find(skeleton, Sided(part.frame, right));
      capsule.end_joint = Find(skeleton, Sided(part.end_joint, right));
      capsule.begin_offset = Mirrored(part.begin_offset, right);
      capsule.end_offset = Mirrored(part.end_offset, right);
      capsule.radius = part.radius;
      body.capsules.push_back(capsule);
    }
  }
}

void PairMirrors(const Skeleton& skeleton, std::vector<FleshCapsule>& capsules) {
  for (std::size_t i = 0; i < capsules.size(); ++i) {
    capsules[i].mirror = static_cast<int>(i);
    for (std::size_t k = 0; k < capsules.size(); ++k) {
      if (k == i || skeleton.joints[capsules[i].frame].mirror != capsules[k].frame) continue;
      if (capsules[i].frame == capsules[k].frame) continue;
      if (skeleton.joints[capsules[i].end_joint].mirror == capsules[k].end_joint)
        capsules[i].mirror = static_cast<int>(k);
    }
  }
}

}  // namespace

FleshBody FleshBody::Make(SkeletonPtr skeleton, double scale, double radius_scale) {
  FleshBody body;
  const bool has_template = HasTemplateJoints(*skeleton);
  AddBones(*skeleton, has_template, body);
  if (has_template) AddTemplate(*skeleton, body);
  PairMirrors(*skeleton, body.capsules);
  for (FleshCapsule& capsule : body.capsules) {
    capsule.begin_offset *= scale;
    capsule.end_offset *= scale;
    capsule.radius *= scale * radius_scale;
  }
  body.skeleton = std::move(skeleton);
  return body;
}

std::vector<bool> FleshBody::MovingJoints() const {
  std::vector<bool> moving(skeleton->joints.size(), false);
  moving[0] = true;
  for (const FleshCapsule& capsule : capsules) {
    for (int j = capsule.frame; j >= 0; j = skeleton->joints[j].parent) moving[j] = true;
  }
  return moving;
}

CapsuleEnds EndsOf(const FleshCapsule& capsule, const Matrix3d& world_from_frame, const Vector3d& frame_joint,
                   const Vector3d& end_joint) {
  return {frame_joint + world_from_frame * capsule.begin_offset, end_joint + world_from_frame * capsule.end_offset};
}

std::vector<PosedCapsule> PosedCapsules(const FleshBody& body, const Vector3d* joints,
                                        const Quaterniond* world_from_joint) {
  std::vector<PosedCapsule> posed;
  for (const FleshCapsule& capsule : body.capsules) {
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

std::string RadiiText(const FleshBody& body) {
  std::string text;
  for (const FleshCapsule& capsule : body.capsules) {
    if (!text.empty()) text += ' ';
    text += FormatDouble(std::round(capsule.radius * 1e4) / 1e4);
  }
  return text;
}

std::optional<FleshBody> BodyFromRadii(SkeletonPtr skeleton, const std::vector<double>& bone_length,
                                       const std::string& radii) {
  const double scale = BodyScale(*skeleton, bone_length);
  FleshBody body = FleshBody::Make(std::move(skeleton), scale, 1.0);
  const std::vector<std::string_view> words = SplitBlanks(radii);
  if (words.size() != body.capsules.size()) return std::nullopt;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::optional<double> radius = ParseDouble(words[i]);
    if (!radius || !(*radius > 0.0)) return std::nullopt;
    body.capsules[i].radius = *radius;
  }
  return body;
}

}  // namespace mocurate
