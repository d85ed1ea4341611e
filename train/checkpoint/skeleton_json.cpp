#include "train/checkpoint/skeleton_json.h"

#include <utility>

namespace mocurate {
namespace {

nlohmann::json ToJson(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Vector3d FromJson(const nlohmann::json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Skeleton Parse(const nlohmann::json& json) {
  Skeleton skeleton;
  skeleton.name = json.at("name").get<std::string>();
  for (const nlohmann::json& item : json.at("joints")) {
    Joint joint;
    joint.name = item.at("name").get<std::string>();
    joint.parent = item.at("parent").get<int>();
    joint.rest_offset = FromJson(item.at("rest_offset"));
    joint.mirror = item.at("mirror").get<int>();
    joint.synonyms = item.at("synonyms").get<std::vector<std::string>>();
    joint.radius = item.at("radius").get<double>();
    if (item.contains("limits")) {
      joint.limits = JointLimits{FromJson(item.at("limits").at(0)), FromJson(item.at("limits").at(1))};
    }
    skeleton.joints.push_back(std::move(joint));
  }
  for (const nlohmann::json& item : json.at("landmarks")) {
    skeleton.landmarks.push_back(
        {item.at("name").get<std::string>(), item.at("joint").get<int>(), FromJson(item.at("offset"))});
  }
  if (json.contains("lie")) {
    LieChains lie;
    lie.chains = json.at("lie").at("chains").get<std::vector<std::vector<int>>>();
    for (const nlohmann::json& offset : json.at("lie").at("raw_offsets")) lie.raw_offsets.push_back(FromJson(offset));
    skeleton.lie = std::move(lie);
  }
  return skeleton;
}

}  // namespace

nlohmann::json SkeletonToJson(const Skeleton& skeleton) {
  nlohmann::json json = {
      {"name", skeleton.name}, {"joints", nlohmann::json::array()}, {"landmarks", nlohmann::json::array()}};
  for (const Joint& joint : skeleton.joints) {
    nlohmann::json item = {
        {"name", joint.name},     {"parent", joint.parent},     {"rest_offset", ToJson(joint.rest_offset)},
        {"mirror", joint.mirror}, {"synonyms", joint.synonyms}, {"radius", joint.radius}};
    if (joint.limits) item["limits"] = {ToJson(joint.limits->min), ToJson(joint.limits->max)};
    json["joints"].push_back(std::move(item));
  }
  for (const Landmark& landmark : skeleton.landmarks) {
    json["landmarks"].push_back(
        {{"name", landmark.name}, {"joint", landmark.joint}, {"offset", ToJson(landmark.offset)}});
  }
  if (skeleton.lie) {
    nlohmann::json offsets = nlohmann::json::array();
    for (const Vector3d& offset : skeleton.lie->raw_offsets) offsets.push_back(ToJson(offset));
    json["lie"] = {{"chains", skeleton.lie->chains}, {"raw_offsets", std::move(offsets)}};
  }
  return json;
}

Expected<SkeletonPtr> SkeletonFromJson(const nlohmann::json& json, const std::string& where) {
  Skeleton skeleton;
  try {
    skeleton = Parse(json);
  } catch (const nlohmann::json::exception& error) {
    return Fail(ErrorCode::kMalformed, std::string("the skeleton cannot be read: ") + error.what(), where);
  }
  if (Status check = skeleton.Check(); !check) return Forward(check);
  return std::make_shared<const Skeleton>(std::move(skeleton));
}

}  // namespace mocurate
