#include "ingest/synthetic/body_points.h"

#include "core/body/capsule_body.h"
#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

Vector3d MirroredOffset(const Vector3d& offset) { return {-offset.x(), offset.y(), offset.z()}; }

/// Points of one side from those of the left, all named without their side.
std::vector<BodyPlace> Side(const std::string& side, const std::vector<BodyPlace>& left) {
  std::vector<BodyPlace> places;
  for (const BodyPlace& place : left) {
    const Vector3d offset = side == "left" ? place.offset : MirroredOffset(place.offset);
    places.push_back({side + "_" + place.name, side + "_" + place.joint, offset});
  }
  return places;
}

void Append(const std::vector<BodyPlace>& more, std::vector<BodyPlace>& places) {
  places.insert(places.end(), more.begin(), more.end());
}

const Vector3d kNone = Vector3d::Zero();
const Vector3d kBetweenShoulders(0.0, 0.235, 0.02);  // of spine3
const Vector3d kNose(0.0, 0.035, 0.105);             // of the head, as all of the face
const Vector3d kEye(0.032, 0.070, 0.085);
const Vector3d kEar(0.074, 0.045, -0.005);
const Vector3d kHeadTop(0.0, 0.165, -0.01);
const Vector3d kHeel(0.0, -0.055, -0.050);      // of the ankle
const Vector3d kBigToe(-0.020, -0.005, 0.075);  // of the foot
const Vector3d kSmallToe(0.045, -0.008, 0.045);

std::vector<BodyPlace> OpenPoseArm(const std::string& side) {
  return Side(side, {{"shoulder", "shoulder", kNone}, {"elbow", "elbow", kNone}, {"wrist", "wrist", kNone}});
}

std::vector<BodyPlace> OpenPoseLeg(const std::string& side) {
  return Side(side, {{"hip", "hip", kNone}, {"knee", "knee", kNone}, {"ankle", "ankle", kNone}});
}

}  // namespace

const std::vector<BodyPlace>& Kinect25Places() {
  static const std::vector<BodyPlace> places = [] {
    std::vector<BodyPlace> all = {{"spine_base", "pelvis", kNone},
                                  {"spine_mid", "spine3", {0.0, -0.005, 0.022}},
                                  {"neck", "neck", kNone},
                                  {"head", "head", {0.0, 0.05, 0.0}}};
    for (const char* side : {"left", "right"}) {
      Append(Side(side, {{"shoulder", "shoulder", kNone},
                         {"elbow", "elbow", kNone},
                         {"wrist", "wrist", kNone},
                         {"hand", "hand", {-0.018, 0.0, 0.0}}}),
             all);
    }
    for (const char* side : {"left", "right"}) {
      Append(Side(side, {{"hip", "hip", kNone},
                         {"knee", "knee", kNone},
                         {"ankle", "ankle", kNone},
                         {"foot", "foot", {-0.006, 0.005, 0.056}}}),
             all);
    }
    all.push_back({"spine_shoulder", "spine3", {0.0, 0.249, 0.02}});
    for (const char* side : {"left", "right"}) {
      Append(Side(side, {{"hand_tip", "hand", {0.080, -0.036, 0.005}}, {"thumb", "hand", {-0.053, -0.016, 0.064}}}),
             all);
    }
    return all;
  }();
  return places;
}

const std::vector<BodyPlace>& KardPlaces() {
  static const std::vector<BodyPlace> places = [] {
    std::vector<BodyPlace> all = {{"head", "head", {0.0, 0.04, 0.0}}, {"neck", "spine3", {0.0, 0.21, 0.02}}};
    for (const char* side : {"right", "left"}) {
      Append(Side(side, {{"shoulder", "shoulder", {0.0, -0.02, 0.0}},
                         {"elbow", "elbow", kNone},
                         {"hand", "wrist", {0.03, 0.0, 0.0}}}),
             all);
    }
    all.push_back({"torso", "spine3", {0.0, -0.013, 0.02}});
    for (const char* side : {"right", "left"}) {
      Append(Side(side, {{"hip", "hip", kNone}, {"knee", "knee", kNone}, {"foot", "ankle", kNone}}), all);
    }
    return all;
  }();
  return places;
}

const std::vector<BodyPlace>& Cmu20Places() {
  static const std::vector<BodyPlace> places = [] {
    std::vector<BodyPlace> all = {{"pelvis", "pelvis", kNone},
                                  {"chest", "spine3", {0.0, 0.13, 0.0}},
                                  {"neck", "neck", {0.0, 0.02, 0.0}},
                                  {"head", "head", {0.0, 0.05, 0.03}}};
    for (const char* side : {"left", "right"}) {
      Append(OpenPoseArm(side), all);
      Append(Side(side, {{"hand", "hand", kNone}}), all);
    }
    for (const char* side : {"left", "right"}) {
      Append(OpenPoseLeg(side), all);
      Append(Side(side, {{"toe", "foot", {0.0, -0.005, 0.05}}}), all);
    }
    return all;
  }();
  return places;
}

const std::vector<BodyPlace>& Body25Places() {
  static const std::vector<BodyPlace> places = [] {
    std::vector<BodyPlace> all = {{"nose", "head", kNose}, {"neck", "spine3", kBetweenShoulders}};
    Append(OpenPoseArm("right"), all);
    Append(OpenPoseArm("left"), all);
    all.push_back({"mid_hip", "pelvis", {0.0, -0.008, -0.008}});
    Append(OpenPoseLeg("right"), all);
    Append(OpenPoseLeg("left"), all);
    all.push_back({"right_eye", "head", MirroredOffset(kEye)});
    all.push_back({"left_eye", "head", kEye});
    all.push_back({"right_ear", "head", MirroredOffset(kEar)});
    all.push_back({"left_ear", "head", kEar});
    for (const char* side : {"left", "right"}) {
      Append(Side(side, {{"big_toe", "foot", kBigToe}, {"small_toe", "foot", kSmallToe}, {"heel", "ankle", kHeel}}),
             all);
    }
    return all;
  }();
  return places;
}

const std::vector<BodyPlace>& Vibe49Places() {
  static const std::vector<BodyPlace> places = [] {
    std::vector<BodyPlace> all = Body25Places();
    const auto add = [&](const std::string& name, const std::string& joint, const Vector3d& offset) {
      all.push_back({name, joint, offset});
    };
    for (const char* joint :
         {"right_ankle", "right_knee", "right_hip", "left_hip", "left_knee", "left_ankle", "right_wrist", "right_elbow",
          "right_shoulder", "left_shoulder", "left_elbow", "left_wrist"}) {
      add(joint, joint, kNone);
    }
    add("neck", "neck", {0.0, -0.04, 0.0});
    add("head_top", "head", kHeadTop);
    add("mid_hip", "pelvis", kNone);
    add("thorax", "spine3", kBetweenShoulders);
    add("spine", "spine2", kNone);
    add("jaw", "head", {0.0, 0.0, 0.07});
    add("head", "head", {0.0, 0.10, 0.0});
    add("nose", "head", kNose);
    add("left_eye", "head", kEye);
    add("right_eye", "head", MirroredOffset(kEye));
    add("left_ear", "head", kEar);
    add("right_ear", "head", MirroredOffset(kEar));
    return all;
  }();
  return places;
}

std::vector<std::string> NamesOf(const std::vector<BodyPlace>& places) {
  std::vector<std::string> names;
  for (const BodyPlace& place : places) names.push_back(place.name);
  return names;
}

JointPositions PlacesOf(const Motion& motion, const std::vector<BodyPlace>& places) {
  const double scale = BodyScale(*motion.skeleton, motion.bone_length);
  std::vector<Vector3d> joints(static_cast<std::size_t>(motion.joint_count()));
  std::vector<Quaterniond> global(joints.size());
  JointPositions points(motion.frame_count(), static_cast<int>(places.size()));
  for (int f = 0; f < motion.frame_count(); ++f) {
    ForwardKinematics(*motion.skeleton, motion.root_translation[f], &motion.rotation_at(f, 0), motion.bone_length,
                      joints.data(), global.data());
    for (int k = 0; k < points.joints; ++k) {
      const int joint = motion.skeleton->FindJoint(places[k].joint).value_or(0);
      points.at(f, k) = joints[joint] + global[joint] * (scale * places[k].offset);
    }
  }
  return points;
}

}  // namespace mocurate
