#include "fitting/proportions.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/motion/kinematics.h"
#include "core/motion/limbs.h"
#include "fitting/association/body_shape.h"
#include "fitting/solver/bone_lengths.h"
#include "fitting/solver/rest_directions.h"

namespace mocurate {
namespace {

constexpr double kLengthRounding = 1e-4;  ///< m; bone lengths are stored as multiples of it (numerical)

/// Size of the person over the rest skeleton's; 1 where the artifact does not have it.
double ScaleFromJson(const nlohmann::json& json) {
  const auto found = json.find("scale");
  if (found == json.end() || !found->is_number()) return 1.0;
  const auto scale = found->get<double>();
  return scale > 0.1 && scale < 10.0 ? scale : 1.0;
}

}  // namespace

Proportions EstimateProportions(const std::vector<SkeletonTracks>& clips, const SkeletonPtr& skeleton,
                                const ProportionsOptions& options) {
  const BoneEstimate medians = EstimateBoneLengths(clips, *skeleton, options.symmetric);
  Proportions person;
  person.skeleton = options.own_directions ? WithOwnDirections(clips, skeleton, medians, options.symmetric) : skeleton;
  person.bone_length = RoundedLengths(medians.length);
  person.samples = medians.samples;
  person.bone_sigma = medians.sigma;
  person.scale = medians.scale;
  for (const SkeletonTracks& clip : clips) person.frames += clip.frames();
  return person;
}

std::vector<double> RoundedLengths(std::vector<double> lengths) {
  for (double& length : lengths) length = std::round(length / kLengthRounding) * kLengthRounding;
  return lengths;
}

namespace {

constexpr double kLargestCapsule = 20.0;   ///< standard deviations; largest component of a body shape that is read
constexpr double kNoStandingPlace = 0.25;  ///< share of head to toes; rest poses of people who stand or sit are taller

/// Length along the bones from the end of a leg over the root to the head, metres: the longest path from the root to a
/// joint of the legs (to any joint without known legs), and the longest to a joint on the midline.
double HeadToToes(const Skeleton& skeleton, const std::vector<double>& bone_length) {
  std::vector<double> way(skeleton.joints.size(), 0.0);
  const Limbs limbs = LimbsOf(skeleton);
  double longest = 0.0, leg = 0.0, middle = 0.0;
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    way[j] = way[skeleton.joints[j].parent] + bone_length[j];
    longest = std::max(longest, way[j]);
    if (skeleton.joints[j].mirror == j) middle = std::max(middle, way[j]);
    for (const Limb& limb : limbs.leg) {
      if (j == limb.end || j == limb.tip) leg = std::max(leg, way[j]);
    }
  }
  return (leg > 0.0 ? leg : longest) + middle;
}

}  // namespace

double Stature(const Skeleton& skeleton, const std::vector<double>& bone_length) {
  const std::vector<Quaterniond> rest(skeleton.joints.size(), Quaterniond::Identity());
  std::vector<Vector3d> joints(skeleton.joints.size());
  ForwardKinematics(skeleton, Vector3d::Zero(), rest.data(), bone_length, joints.data());
  double low = 0.0;
  double high = 0.0;
  for (const Vector3d& joint : joints) {
    low = std::min(low, joint.y());
    high = std::max(high, joint.y());
  }
  const double along = HeadToToes(skeleton, bone_length);
  return high - low < kNoStandingPlace * along ? along : high - low;
}

nlohmann::json ProportionsJson(const Proportions& person, const Skeleton& rest) {
  // Decimal fractions: the nearest double of k / 10 prints as short text.
  const auto tenths_of_mm = [](double metres) { return std::round(metres * 1e4); };
  nlohmann::json lengths = nlohmann::json::object();
  nlohmann::json samples = nlohmann::json::object();
  nlohmann::json sigmas = nlohmann::json::object();
  nlohmann::json directions = nlohmann::json::object();
  for (int j = 1; j < person.skeleton->joint_count(); ++j) {
    const std::string& name = person.skeleton->joints[j].name;
    lengths[name] = tenths_of_mm(person.bone_length[j]) / 1e4;
    samples[name] = person.samples[j];
    sigmas[name] = tenths_of_mm(person.bone_sigma[j]) / 1e1;
    const Vector3d& offset = person.skeleton->joints[j].rest_offset;
    if (offset == rest.joints[j].rest_offset) continue;
    const Vector3d direction = offset.normalized();
    directions[name] = {tenths_of_mm(direction.x()) / 1e4, tenths_of_mm(direction.y()) / 1e4,
                        tenths_of_mm(direction.z()) / 1e4};
  }
  nlohmann::json body_shape = nlohmann::json::array();
  for (const double component : person.skeleton->shape) {
    if (person.skeleton->shape != BodyShape{}) body_shape.push_back(std::round(component * 1e3) / 1e3 + 0.0);
  }
  nlohmann::json json = {{"person", person.person},
                         {"body_shape", body_shape},
                         {"skeleton", person.skeleton->name},
                         {"bone_length_m", lengths},
                         {"rest_direction", directions},
                         {"samples", samples},
                         {"bone_spread_mm", sigmas},
                         {"clips", person.clips},
                         {"frames", person.frames},
                         {"scale", std::round(person.scale * 1e4) / 1e4},
                         {"stature_m", tenths_of_mm(Stature(*person.skeleton, person.bone_length)) / 1e4}};
  for (std::size_t j = 0; j < person.place_sigma.size(); ++j) {
    if (person.place_sigma[j] > 0.0)
      json["place_sigma_mm"][person.skeleton->joints[j].name] = tenths_of_mm(person.place_sigma[j]) / 1e1;
  }
  return json;
}

namespace {

/// Sets rest offsets to the directions in the artifact.
Status TakeDirections(const nlohmann::json& directions, Skeleton& skeleton, const std::string& where) {
  for (const auto& [name, direction] : directions.items()) {
    const auto joint = skeleton.FindJoint(name);
    Vector3d offset = Vector3d::Zero();
    bool numbers = direction.is_array() && direction.size() == 3;
    for (std::size_t k = 0; numbers && k < 3; ++k) {
      numbers = direction[k].is_number();
      if (numbers) offset[static_cast<Eigen::Index>(k)] = direction[k].get<double>();
    }
    if (!joint || !numbers || !(std::abs(offset.norm() - 1.0) < 1e-3)) {
      return Fail(ErrorCode::kMalformed,
                  direction.dump() + " is not a direction of the bone that ends at '" + name + "'", where,
                  "run the stage proportions again");
    }
    Vector3d& rest = skeleton.joints[*joint].rest_offset;
    rest = RoundedDirection(offset.normalized() * rest.norm());
  }
  return {};
}

Status TakeShape(const nlohmann::json& body_shape, Skeleton& skeleton, const std::string& where) {
  bool numbers = body_shape.is_array() && (body_shape.empty() || body_shape.size() == skeleton.shape.size());
  for (std::size_t k = 0; numbers && k < body_shape.size(); ++k) {
    numbers = body_shape[k].is_number() && std::abs(body_shape[k].get<double>()) <= kLargestCapsule;
    if (numbers) skeleton.shape[k] = body_shape[k].get<double>();
  }
  if (numbers) return {};
  return Fail(ErrorCode::kMalformed,
              "'body_shape' " + body_shape.dump() + " is not " + std::to_string(kShapeComponents) +
                  " numbers, deviations from -20 to 20",
              where, "run the stage proportions again");
}

/// An impossible bone length, most often from another unit.
tl::unexpected<Error> NoLength(const nlohmann::json& json, double length, const std::string& joint,
                               const std::string& where) {
  const auto found = json.find("scale");
  const double scale = found != json.end() && found->is_number() ? found->get<double>() : 1.0;
  const auto unit = FindUnit(scale);
  return Fail(ErrorCode::kInconsistent,
              "the bone that ends at '" + joint + "' is " + RoundedText(length, 3) +
                  " m long; the scale of all bones is " + RoundedText(scale, 3) + " times the skeleton's" +
                  (unit ? ": it looks like " + unit->text : std::string()),
              where, "check ingest.source.units, e.g. --set ingest.source.units=cm");
}

Expected<std::vector<double>> BoneLengthsFromJson(const nlohmann::json& json, const Skeleton& skeleton,
                                                  const std::string& where) {
  if (!json.is_object() || !json.contains("skeleton") || !json["skeleton"].is_string() ||
      !json.contains("bone_length_m") || !json["bone_length_m"].is_object()) {
    return Fail(ErrorCode::kMalformed, "the artifact has no 'skeleton' or no 'bone_length_m'", where,
                "run the stage proportions again");
  }
  const std::string& name = json["skeleton"].get_ref<const std::string&>();
  if (name != skeleton.name) {
    return Fail(ErrorCode::kInconsistent,
                "the proportions are of skeleton '" + name + "', the fit uses '" + skeleton.name + "'", where,
                "give both stages the same skeleton");
  }
  std::vector<double> lengths(skeleton.joints.size(), 0.0);
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const auto found = json["bone_length_m"].find(skeleton.joints[j].name);
    if (found == json["bone_length_m"].end() && skeleton.joints[j].landmark) {
      lengths[j] = skeleton.joints[j].rest_offset.norm() * ScaleFromJson(json);
      continue;
    }
    if (found == json["bone_length_m"].end() || !found->is_number()) {
      return Fail(ErrorCode::kInconsistent,
                  "no length is given for the bone that ends at '" + skeleton.joints[j].name + "'", where);
    }
    lengths[j] = found->get<double>();
    if (!(lengths[j] >= 0.0 && lengths[j] < 10.0)) {
      return NoLength(json, lengths[j], skeleton.joints[j].name, where);
    }
  }
  return lengths;
}

}  // namespace

Expected<PersonBody> BodyFromJson(const nlohmann::json& json, const SkeletonPtr& skeleton, const std::string& where) {
  Expected<std::vector<double>> lengths = BoneLengthsFromJson(json, *skeleton, where);
  if (!lengths) return Forward(lengths);
  auto own = std::make_shared<Skeleton>(*skeleton);
  const auto directions = json.find("rest_direction");
  if (directions != json.end() && directions->is_object()) {
    if (Status taken = TakeDirections(*directions, *own, where); !taken) return Forward(taken);
  }
  const auto body_shape = json.find("body_shape");
  if (body_shape != json.end()) {
    if (Status taken = TakeShape(*body_shape, *own, where); !taken) return Forward(taken);
  }
  std::vector<double> place_sigma;
  if (const auto stated = json.find("place_sigma_mm"); stated != json.end() && stated->is_object()) {
    place_sigma.assign(skeleton->joints.size(), 0.0);
    for (std::size_t j = 0; j < place_sigma.size(); ++j) {
      const auto one = stated->find(skeleton->joints[j].name);
      if (one != stated->end() && one->is_number()) place_sigma[j] = std::clamp(1e-3 * one->get<double>(), 0.0, 1.0);
    }
  }
  const bool is_same = own->shape == skeleton->shape && (directions == json.end() || directions->empty());
  return PersonBody{is_same ? skeleton : SkeletonPtr(std::move(own)), *std::move(lengths), std::move(place_sigma)};
}

}  // namespace mocurate
