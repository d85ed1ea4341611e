#include "train/layers/skin.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/base/file.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/formats/smpl_model.h"
#include "core/store/body_file.h"

namespace mocurate {
namespace {

/// A body by its own joints.
struct Body {
  std::string name;
  std::vector<std::string> joint_names;
  std::vector<int> parents;
  std::vector<Vector3d> vertices, joints;
  std::vector<double> weights;        // (V,joints)
  std::vector<double> pose_blending;  // (3V, 9(joints - 1))
};

/// Joints of SMPL and SMPL-H, in the order of their files; those of the hands have no name.
constexpr const char* kSmplJoints[] = {"pelvis",     "left_hip",      "right_hip",      "spine1",      "left_knee",
                                       "right_knee", "spine2",        "left_ankle",     "right_ankle", "spine3",
                                       "left_foot",  "right_foot",    "neck",           "left_collar", "right_collar",
                                       "head",       "left_shoulder", "right_shoulder", "left_elbow",  "right_elbow",
                                       "left_wrist", "right_wrist"};

Expected<Body> BodyOfTemplate(const std::filesystem::path& file) {
  const Expected<BodyTemplate> read = ReadBodyTemplate(file);
  if (!read) return Forward(read);
  Body body{"body_cc0", read->joint_names, read->parents, read->rest.vertices, read->rest.joints, {}, {}};
  const auto J = static_cast<std::size_t>(read->joint_count());
  body.weights.assign(body.vertices.size() * J, 0.0);
  for (std::size_t v = 0; v < body.vertices.size(); ++v) {
    for (std::size_t k = 0; k < 4; ++k) {
      body.weights[v * J + static_cast<std::size_t>(read->weight_joints[v][k])] += read->weights[v][k];
    }
  }
  return body;
}

Expected<Body> BodyOfSmpl(const std::filesystem::path& file) {
  const Expected<std::string> bytes = ReadFile(file);
  if (!bytes) return Forward(bytes);
  Expected<SmplModel> model = ParseSmplModel(*bytes, DisplayPath(file));
  if (!model) return Forward(model);
  if (model->joints != 24 && model->joints != 52 && model->joints != 55) {
    return Fail(ErrorCode::kInconsistent, "the body has " + std::to_string(model->joints) + " joints",
                DisplayPath(file), "SMPL has 24, SMPL-H 52, SMPL-X 55");
  }
  std::string name = file.filename().string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  const bool gender = name.find("male") != std::string::npos || name.find("model_f") != std::string::npos ||
                      name.find("model_m") != std::string::npos;  // "female" holds "male"
  if (gender) {
    return Fail(ErrorCode::kInconsistent, "the body is of one gender, the losses are on the neutral one",
                DisplayPath(file), "give SMPL_NEUTRAL.pkl");
  }
  Body body{model->joints == 24   ? "SMPL"
            : model->joints == 52 ? "SMPL-H"
                                  : "SMPL-X",
            {},
            model->parents,
            {},
            {},
            std::move(model->weights),
            std::move(model->posedirs)};
  for (std::size_t j = 0; j < model->joints; ++j) {
    body.joint_names.emplace_back(j < std::size(kSmplJoints)       ? kSmplJoints[j]
                                  : model->joints == 24 && j == 22 ? "left_hand"
                                  : model->joints == 24 && j == 23 ? "right_hand"
                                                                   : "");
  }
  for (std::size_t v = 0; v < model->vertices; ++v) {
    body.vertices.emplace_back(model->v_template[3 * v], model->v_template[3 * v + 1], model->v_template[3 * v + 2]);
  }
  for (std::size_t j = 0; j < model->joints; ++j) {
    Vector3d joint = Vector3d::Zero();
    for (std::size_t v = 0; v < model->vertices; ++v) {
      joint += model->joint_regressor[j * model->vertices + v] * body.vertices[v];
    }
    body.joints.push_back(joint);
  }
  return body;
}

/// For each joint of the body the skeleton's, or that of its nearest ancestor that the skeleton has.
Expected<std::vector<int>> JointsOf(const Body& body, const Skeleton& skeleton, const std::string& where) {
  std::vector<int> joint_of(body.joint_names.size(), -1);
  std::vector<bool> own(body.joint_names.size(), false);
  for (std::size_t b = 0; b < joint_of.size(); ++b) {
    const auto found = body.joint_names[b].empty() ? std::nullopt : skeleton.FindJoint(body.joint_names[b]);
    own[b] = found.has_value();
    if (!found && !body.joint_names[b].empty() && b < std::size(kSmplJoints)) {
      return Fail(
          ErrorCode::kInconsistent,
          "skeleton '" + skeleton.name + "' has no joint '" + body.joint_names[b] + "', which the body moves by", where,
          "train on a dataset of skeleton 'smpl24', or set vertex_weight: 0");
    }
    const int parent = body.parents[b];
    joint_of[b] = found ? *found : parent < 0 ? 0 : joint_of[static_cast<std::size_t>(parent)];
    if (!own[b] || parent < 0) continue;
    if (skeleton.joints[static_cast<std::size_t>(joint_of[b])].parent != joint_of[static_cast<std::size_t>(parent)]) {
      return Fail(ErrorCode::kInconsistent,
                  "joint '" + body.joint_names[b] + "' hangs on another joint in skeleton '" + skeleton.name + "'",
                  where, "train on a dataset of skeleton 'smpl24', or set vertex_weight: 0");
    }
  }
  return joint_of;
}

/// Rotations are counted from the rest pose: that of the body must be the skeleton's.
Status CheckRestPose(const Skin& skin, const Skeleton& skeleton, const std::string& where) {
  constexpr double kFarthest = 35.0 * kPi / 180.0;  // SMPL's and body_cc0's bones differ by up to 25 degrees
  constexpr double kShortest = 0.05;                // metres; shorter bones have no stable direction
  for (std::size_t j = 1; j < skeleton.joints.size(); ++j) {
    const auto parent = static_cast<std::size_t>(skeleton.joints[j].parent);
    const Vector3d own = skeleton.joints[j].rest_offset, other = skin.joints[j] - skin.joints[parent];
    if (own.norm() < kShortest || other.norm() < kShortest) continue;
    const double angle = std::acos(std::clamp(own.dot(other) / (own.norm() * other.norm()), -1.0, 1.0));
    if (angle <= kFarthest) continue;
    return Fail(ErrorCode::kInconsistent,
                "the bone to '" + skeleton.joints[j].name + "' points " + RoundedText(angle * 180.0 / kPi, 3) +
                    " degrees off the body's in the rest pose",
                where, "the body's T-pose must be the skeleton's rest pose");
  }
  return {};
}

}  // namespace

Expected<Skin> ReadSkin(const std::filesystem::path& file, const Skeleton& skeleton) {
  const Expected<Body> body = file.extension() == ".h5" ? BodyOfTemplate(file) : BodyOfSmpl(file);
  if (!body) return Forward(body);
  const std::string where = DisplayPath(file);
  const Expected<std::vector<int>> joint_of = JointsOf(*body, skeleton, where);
  if (!joint_of) return Forward(joint_of);
  const std::size_t V = body->vertices.size(), J = skeleton.joints.size(), bodies = body->joint_names.size();
  Skin skin;
  skin.name = body->name;
  skin.vertices = body->vertices;
  skin.joints.assign(J, Vector3d::Zero());
  std::vector<bool> known(J, false);
  for (std::size_t b = 0; b < bodies; ++b) {  // parents stand first: an ancestor's place is not overwritten
    const auto j = static_cast<std::size_t>((*joint_of)[b]);
    if (!known[j]) skin.joints[j] = body->joints[b];
    known[j] = true;
  }
  for (std::size_t j = 1; j < J; ++j) {
    const auto parent = static_cast<std::size_t>(skeleton.joints[j].parent);
    if (!known[j]) skin.joints[j] = skin.joints[parent] + skeleton.joints[j].rest_offset;
  }
  skin.weights.assign(V * J, 0.0);
  for (std::size_t v = 0; v < V; ++v) {
    for (std::size_t b = 0; b < bodies; ++b) {
      skin.weights[v * J + static_cast<std::size_t>((*joint_of)[b])] += body->weights[v * bodies + b];
    }
  }
  if (Status rest = CheckRestPose(skin, skeleton, where); !rest) return Forward(rest);
  if (body->pose_blending.empty()) return skin;
  const std::size_t columns = 9 * (bodies - 1);
  skin.pose_blending.assign(3 * V * 9 * (J - 1), 0.0);
  for (std::size_t b = 1; b < bodies; ++b) {  // a joint that moves with its parent has R = I: it adds nothing
    const auto found = body->joint_names[b].empty() ? std::nullopt : skeleton.FindJoint(body->joint_names[b]);
    if (!found || *found == 0) continue;
    for (std::size_t row = 0; row < 3 * V; ++row) {
      for (std::size_t k = 0; k < 9; ++k) {
        skin.pose_blending[row * 9 * (J - 1) + 9 * (static_cast<std::size_t>(*found) - 1) + k] =
            body->pose_blending[row * columns + 9 * (b - 1) + k];
      }
    }
  }
  return skin;
}

}  // namespace mocurate
