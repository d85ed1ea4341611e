#include "core/formats/openpose.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/json_place.h"

namespace mocurate {
namespace {

using Points = std::vector<DetectedKeypoint>;

struct PointList {
  const char* key;
  Points OpenPosePerson::*points;
};
constexpr PointList kLists[] = {{"pose_keypoints_2d", &OpenPosePerson::pose},
                                {"face_keypoints_2d", &OpenPosePerson::face},
                                {"hand_left_keypoints_2d", &OpenPosePerson::hand_left},
                                {"hand_right_keypoints_2d", &OpenPosePerson::hand_right}};

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

/// A number, or a list of one.
Expected<int> PersonId(const JsonPlace& place) {
  constexpr int kMost = 2'000'000'000;
  if (!place.value->is_array()) return place.Integer(-1, kMost);
  if (place.value->size() != 1) return place.Bad("one person id is expected");
  return place.Item(0).Integer(-1, kMost);
}

Expected<OpenPosePerson> ParsePerson(const JsonPlace& place, OpenPoseFrame& frame) {
  OpenPosePerson person;
  if (place.Has("person_id")) {
    const Expected<int> id = PersonId(*place.Key("person_id"));
    if (!id) return Forward(id);
    person.person_id = *id;
  }
  if (const Expected<JsonPlace> pose = place.Key(kLists[0].key); !pose) return Forward(pose);
  for (const PointList& list : kLists) {
    if (!place.Has(list.key)) continue;
    Expected<Points> points = ParsePoints(*place.Key(list.key), frame);
    if (!points) return Forward(points);
    person.*list.points = std::move(*points);
  }
  return person;
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

bool operator==(const DetectedKeypoint& a, const DetectedKeypoint& b) {
  return a.u_px == b.u_px && a.v_px == b.v_px && a.confidence == b.confidence;
}

bool operator==(const OpenPosePerson& a, const OpenPosePerson& b) {
  return a.person_id == b.person_id && a.pose == b.pose && a.face == b.face && a.hand_left == b.hand_left &&
         a.hand_right == b.hand_right;
}

bool operator==(const OpenPoseFrame& a, const OpenPoseFrame& b) {
  return a.version == b.version && a.people == b.people;
}

Expected<OpenPoseFrame> ParseOpenPose(std::string_view bytes, const std::string& name) {
  const Expected<nlohmann::json> document = ParseLenientJson(bytes, name);
  if (!document) return Forward(document);
  const JsonPlace root{&*document, "", &name};
  OpenPoseFrame frame;
  if (root.Has("version")) {
    const Expected<double> version = NumberAt(root, "version");
    if (!version) return Forward(version);
    frame.version = *version;
  }
  const Expected<JsonPlace> people = root.Key("people");
  if (!people) return Forward(people);
  if (!people->value->is_array()) return people->Bad("a list of people is expected");
  for (std::size_t i = 0; i < people->value->size(); ++i) {
    Expected<OpenPosePerson> person = ParsePerson(people->Item(i), frame);
    if (!person) return Forward(person);
    frame.people.push_back(std::move(*person));
  }
  return frame;
}

std::string WriteOpenPose(const OpenPoseFrame& frame) {
  std::string text = "{\"version\":" + FormatDouble(frame.version) + ",\"people\":[";
  for (std::size_t i = 0; i < frame.people.size(); ++i) {
    const OpenPosePerson& person = frame.people[i];
    text += (i > 0 ? ",{" : "{") + ("\"person_id\":[" + std::to_string(person.person_id) + "]");
    for (const PointList& list : kLists) {
      text += ",\"" + std::string(list.key) + "\":[";
      const Points& points = person.*list.points;
      for (std::size_t k = 0; k < points.size(); ++k) {
        if (k > 0) text += ',';
        text += FormatDouble(points[k].u_px) + "," + FormatDouble(points[k].v_px) + "," +
                FormatDouble(points[k].confidence);
      }
      text += ']';
    }
    for (const char* key : {"pose", "face", "hand_left", "hand_right"}) {
      text += ",\"" + std::string(key) + "_keypoints_3d\":[]";
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
