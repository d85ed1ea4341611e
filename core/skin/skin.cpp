#include "core/skin/skin.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/base/file.h"
#include "core/base/pi.h"
#include "core/base/random.h"
#include "core/base/text.h"
#include "core/formats/smpl_model.h"
#include "core/store/body_file.h"

namespace mocurate {
namespace {

/// A body by its own joints.
struct Body : Skin {
  std::vector<std::string> joint_names;
  std::vector<int> parents;
};

constexpr std::size_t kMostShapes = 10;  // as SMPL is used; its files hold up to 300

/// Range of people's coefficients of a named direction of the CC0 body. 1 is a full variant: -1 is the man and +1 the
/// woman of the first direction, and 1 of "child" a child.
std::pair<double, double> RangeOf(const std::string& name, bool first) {
  if (first) return {-1.0, 1.0};
  if (name.find("child") != std::string::npos) return {0.0, 0.0};
  return {-0.1, 0.5};
}

/// Joints of SMPL and SMPL-H, in the order of their files; those of the hands have no name.
constexpr const char* kSmplJoints[] = {"pelvis",     "left_hip",      "right_hip",      "spine1",      "left_knee",
                                       "right_knee", "spine2",        "left_ankle",     "right_ankle", "spine3",
                                       "left_foot",  "right_foot",    "neck",           "left_collar", "right_collar",
                                       "head",       "left_shoulder", "right_shoulder", "left_elbow",  "right_elbow",
                                       "left_wrist", "right_wrist"};

Expected<Body> BodyOfTemplate(const std::filesystem::path& file) {
  const Expected<BodyTemplate> read = ReadBodyTemplate(file);
  if (!read) return Forward(read);
  Body body;
  static_cast<RestBody&>(body) = read->rest;
  body.name = "body_cc0";
  body.joint_names = read->joint_names;
  body.parents = read->parents;
  const auto J = static_cast<std::size_t>(read->joint_count());
  body.weights.assign(body.vertices.size() * J, 0.0);
  for (std::size_t v = 0; v < body.vertices.size(); ++v) {
    for (std::size_t k = 0; k < 4; ++k) {
      body.weights[v * J + static_cast<std::size_t>(read->weight_joints[v][k])] += read->weights[v][k];
    }
  }
  body.faces = read->faces;
  for (std::size_t k = 0; k < std::min(kMostShapes, read->shape_names.size()); ++k) {
    const auto [low, high] = RangeOf(read->shape_names[k], k == 0);
    const RestBody& direction = read->shape_directions[k];
    body.shapes.push_back({direction, read->shape_names[k], low, high});
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
  Body body;
  body.name = model->joints == 24 ? "SMPL" : model->joints == 52 ? "SMPL-H" : "SMPL-X";
  body.parents = model->parents;
  body.weights = std::move(model->weights);
  body.pose_blending = std::move(model->posedirs);
  for (std::size_t j = 0; j < model->joints; ++j) {
    body.joint_names.emplace_back(j < std::size(kSmplJoints)       ? kSmplJoints[j]
                                  : model->joints == 24 && j == 22 ? "left_hand"
                                  : model->joints == 24 && j == 23 ? "right_hand"
                                                                   : "");
  }
  for (std::size_t v = 0; v < model->vertices; ++v) {
    body.vertices.emplace_back(model->v_template[3 * v], model->v_template[3 * v + 1], model->v_template[3 * v + 2]);
  }
  const auto joints_of = [&](const std::vector<Vector3d>& vertices) {
    std::vector<Vector3d> joints(model->joints, Vector3d::Zero());
    for (std::size_t j = 0; j < model->joints; ++j) {
      for (std::size_t v = 0; v < model->vertices; ++v) {
        joints[j] += model->joint_regressor[j * model->vertices + v] * vertices[v];
      }
    }
    return joints;
  };
  body.joints = joints_of(body.vertices);
  for (std::size_t f = 0; f + 2 < model->faces.size(); f += 3) {
    const auto corner = [&](std::size_t k) { return static_cast<int>(model->faces[f + k]); };
    body.faces.push_back({corner(0), corner(1), corner(2)});
  }
  constexpr double kTwoDeviations = 2.0;  // coefficients are in standard deviations
  for (std::size_t k = 0; k < std::min(kMostShapes, model->shapes); ++k) {
    ShapeDirection direction{{}, "shape " + std::to_string(k), -kTwoDeviations, kTwoDeviations};
    for (std::size_t v = 0; v < model->vertices; ++v) {
      const double* of_vertex = model->shapedirs.data() + 3 * v * model->shapes + k;
      direction.vertices.emplace_back(of_vertex[0], of_vertex[model->shapes], of_vertex[2 * model->shapes]);
    }
    direction.joints = joints_of(direction.vertices);
    body.shapes.push_back(std::move(direction));
  }
  return body;
}

/// For each joint of the body the skeleton's, or that of its nearest ancestor that the skeleton has.
Expected<std::vector<int>> JointsOf(const Body& body, const Skeleton& skeleton, const std::string& where) {
  std::vector<int> joint_of(body.joint_names.size(), -1);
  for (std::size_t b = 0; b < joint_of.size(); ++b) {
    const auto found = body.joint_names[b].empty() ? std::nullopt : skeleton.FindJoint(body.joint_names[b]);
    if (!found && !body.joint_names[b].empty() && b < std::size(kSmplJoints)) {
      return Fail(ErrorCode::kInconsistent,
                  "skeleton '" + skeleton.name + "' has no joint '" + body.joint_names[b] +
                      "', which the skin of the body needs",
                  where, "motions of skeleton 'smpl24' move this body; a training without it has vertex_weight: 0");
    }
    const int parent = body.parents[b];
    joint_of[b] = found ? *found : parent < 0 ? 0 : joint_of[static_cast<std::size_t>(parent)];
    if (!found || parent < 0) continue;
    if (skeleton.joints[static_cast<std::size_t>(joint_of[b])].parent != joint_of[static_cast<std::size_t>(parent)]) {
      return Fail(ErrorCode::kInconsistent,
                  "joint '" + body.joint_names[b] + "' has another parent in skeleton '" + skeleton.name + "'", where,
                  "motions of skeleton 'smpl24' move this body; a training without it has vertex_weight: 0");
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

/// Positions, or displacements, of the skeleton's joints from those of the body. A joint that the body does not have is
/// at its rest offset from its parent, or moves with it.
std::vector<Vector3d> OverSkeleton(const std::vector<Vector3d>& of_body, const std::vector<int>& joint_of,
                                   const Skeleton& skeleton, bool places) {
  std::vector<Vector3d> joints(skeleton.joints.size(), Vector3d::Zero());
  std::vector<bool> known(joints.size(), false);
  for (std::size_t b = 0; b < of_body.size(); ++b) {  // parents come first: an ancestor's position is not overwritten
    const auto j = static_cast<std::size_t>(joint_of[b]);
    if (!known[j]) joints[j] = of_body[b];
    known[j] = true;
  }
  for (std::size_t j = 1; j < joints.size(); ++j) {
    if (known[j]) continue;
    const auto parent = static_cast<std::size_t>(skeleton.joints[j].parent);
    joints[j] = joints[parent] + (places ? skeleton.joints[j].rest_offset : Vector3d::Zero());
  }
  return joints;
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
  skin.faces = body->faces;
  skin.joints = OverSkeleton(body->joints, *joint_of, skeleton, true);
  for (const ShapeDirection& direction : body->shapes) {
    skin.shapes.push_back(direction);
    skin.shapes.back().joints = OverSkeleton(direction.joints, *joint_of, skeleton, false);
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

bool IsOfOneGender(const std::filesystem::path& file) {
  std::string name = file.filename().string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name.find("male") != std::string::npos || name.find("model_f") != std::string::npos ||
         name.find("model_m") != std::string::npos;  // "female" holds "male"
}

std::vector<double> DrawShape(const Skin& skin, std::uint64_t seed, int index) {
  Random random(seed, "body shape", std::to_string(index));
  std::vector<double> coefficients;
  for (const ShapeDirection& direction : skin.shapes) {
    coefficients.push_back(direction.low + random.Uniform() * (direction.high - direction.low));
  }
  return coefficients;
}

Skin Shaped(const Skin& skin, const std::vector<double>& coefficients) {
  Skin shaped = skin;
  for (std::size_t k = 0; k < std::min(coefficients.size(), skin.shapes.size()); ++k) {
    AddShape(coefficients[k], skin.shapes[k], shaped);
  }
  return shaped;
}

std::vector<Vector3d> PosedVertices(const Skin& skin, const Skeleton& skeleton, const Quaterniond* rotation,
                                    const Vector3d& root) {
  const std::size_t J = skin.joints.size(), V = skin.vertices.size();
  const PosedJoints posed = PoseJoints(
      skin.joints, [&](std::size_t j) { return skeleton.joints[j].parent; }, rotation, root);
  std::vector<Vector3d> moved(J);  // of a vertex at the origin
  Eigen::VectorXd blend(static_cast<Eigen::Index>(9 * (J - 1)));
  for (std::size_t j = 0; j < J; ++j) {
    const Matrix3d own = rotation[j].toRotationMatrix();
    moved[j] = posed.position[j] - posed.rotation[j] * skin.joints[j];
    for (int k = 0; k < 9 && j > 0; ++k) {
      blend[static_cast<Eigen::Index>(9 * (j - 1)) + k] = own(k / 3, k % 3) - (k % 4 == 0 ? 1.0 : 0.0);
    }
  }
  using Blending = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::VectorXd offset;
  if (!skin.pose_blending.empty()) {
    offset =
        Eigen::Map<const Blending>(skin.pose_blending.data(), static_cast<Eigen::Index>(3 * V), blend.size()) * blend;
  }
  std::vector<Vector3d> vertices(V, Vector3d::Zero());
  for (std::size_t v = 0; v < V; ++v) {
    Vector3d rest = skin.vertices[v];
    if (offset.size() > 0) rest += offset.segment<3>(static_cast<Eigen::Index>(3 * v));
    for (std::size_t j = 0; j < J; ++j) {
      const double weight = skin.weights[v * J + j];
      if (weight != 0.0) vertices[v] += weight * (posed.rotation[j] * rest + moved[j]);
    }
  }
  return vertices;
}

}  // namespace mocurate
