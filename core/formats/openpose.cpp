#include "core/formats/openpose.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/formats/json_place.h"

namespace mocurate {
namespace {

using Points = std::vector<DetectedKeypoint>;

constexpr const char* kPose = "pose_keypoints_2d";

/// Whether the point at `first` is to be skipped: one of its numbers is not finite. Counted unless its confidence is 0.
bool HasMissingNumbers(const nlohmann::json& list, std::size_t first, OpenPoseFrame& frame) {
  if (!IsNonFinite(list[first]) && !IsNonFinite(list[first + 1]) && !IsNonFinite(list[first + 2])) return false;
  const nlohmann::json& confidence = list[first + 2];
  frame.not_finite += confidence.is_number() && confidence.get<double>() == 0.0 ? 0 : 1;
  return true;
}

/// Counts the points that have coordinates, but no confidence, and those with a missing number.
Expected<Points> ParsePoints(const JsonPlace& place, OpenPoseFrame& frame) {
  if (!place.value->is_array()) return place.Bad("a list of numbers is expected");
  const std::size_t count = place.value->size();
  if (count % 3 != 0) return place.Bad(std::to_string(count) + " numbers are not triples u, v, confidence");
  Points points;
  for (std::size_t i = 0; i < count; i += 3) {
    DetectedKeypoint point;
    if (HasMissingNumbers(*place.value, i, frame)) {
      points.push_back(point);
      continue;
    }
    double* const numbers[] = {&point.u_px, &point.v_px, &point.confidence};
    for (std::size_t k = 0; k < 3; ++k) {
      const Expected<double> number = place.Item(i + k).Number();
      if (!number) return Forward(number);
      *numbers[k] = *number;
    }
    if (point.confidence < 0.0) {
      return place.Item(i + 2).Bad("a confidence is at least 0, not " + FormatDouble(point.confidence));
    }
    if (point.confidence == 0.0 && (point.u_px != 0.0 || point.v_px != 0.0)) {
      point = {};
      ++frame.uncertain_points;
    }
    points.push_back(point);
  }
  return points;
}

const std::vector<std::string> kCoco17 = {"nose",          "left_eye",       "right_eye",  "left_ear",    "right_ear",
                                          "left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_wrist",
                                          "right_wrist",   "left_hip",       "right_hip",  "left_knee",   "right_knee",
                                          "left_ankle",    "right_ankle"};
const std::vector<std::string> kFeet = {"left_big_toe",  "left_small_toe",  "left_heel",
                                        "right_big_toe", "right_small_toe", "right_heel"};
const std::vector<std::string> kNeckArms = {"nose",        "neck",          "right_shoulder", "right_elbow",
                                            "right_wrist", "left_shoulder", "left_elbow",     "left_wrist"};
const std::vector<std::string> kLegs = {"right_hip", "right_knee", "right_ankle",
                                        "left_hip",  "left_knee",  "left_ankle"};
const std::vector<std::string> kFace = {"right_eye", "left_eye", "right_ear", "left_ear"};

std::vector<std::string> Joined(std::initializer_list<std::vector<std::string>> parts) {
  std::vector<std::string> all;
  for (const std::vector<std::string>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

Expected<OpenPoseFrame> ParseOpenPose(std::string_view bytes, const std::string& name) {
  const Expected<nlohmann::json> document = ParseLenientJson(bytes, name);
  if (!document) return Forward(document);
  const JsonPlace root{&*document, "", &name};
  OpenPoseFrame frame;
  const Expected<JsonPlace> people = root.Key("people");
  if (!people) return Forward(people);
  if (!people->value->is_array()) return people->Bad("a list of people is expected");
  for (std::size_t i = 0; i < people->value->size(); ++i) {
    const Expected<JsonPlace> pose = people->Item(i).Key(kPose);
    if (!pose) return Forward(pose);
    Expected<Points> points = ParsePoints(*pose, frame);
    if (!points) return Forward(points);
    frame.people.push_back({std::move(*points)});
  }
  return frame;
}

std::string WriteOpenPose(const OpenPoseFrame& frame) {
  std::string text = "{\"version\":1.3,\"people\":[";
  for (std::size_t i = 0; i < frame.people.size(); ++i) {
    text += (i > 0 ? ",{" : "{") + ("\"person_id\":[-1],\"" + std::string(kPose)) + "\":[";
    const Points& points = frame.people[i].pose;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (k > 0) text += ',';
      text +=
          FormatDouble(points[k].u_px) + "," + FormatDouble(points[k].v_px) + "," + FormatDouble(points[k].confidence);
    }
    text += ']';
    for (const char* key :
         {"face_keypoints_2d", "hand_left_keypoints_2d", "hand_right_keypoints_2d", "pose_keypoints_3d",
          "face_keypoints_3d", "hand_left_keypoints_3d", "hand_right_keypoints_3d"}) {
      text += ",\"" + std::string(key) + "\":[]";
    }
    text += '}';
  }
  return text + "]}";
}

int KeypointLayout::Find(std::string_view point) const {
  const auto found = std::find(points.begin(), points.end(), point);
  return found == points.end() ? -1 : static_cast<int>(found - points.begin());
}

const std::vector<KeypointLayout>& KeypointLayouts() {
  static const std::vector<KeypointLayout> layouts = {
      {"BODY_25", Joined({kNeckArms, {"mid_hip"}, kLegs, kFace, kFeet})},
      {"BODY_25B", Joined({kCoco17, {"upper_neck", "head_top"}, kFeet})},
      {"COCO_17", kCoco17},
      {"COCO_18", Joined({kNeckArms, kLegs, kFace})}};
  return layouts;
}

}  // namespace mocurate
