#include "core/formats/panoptic_bodies.h"

#include "core/base/text.h"
#include "core/formats/json_place.h"

namespace mocurate {
namespace {

constexpr int kMostIds = 2'000'000'000;

Expected<PanopticBody> ParseBody(const JsonPlace& place) {
  PanopticBody body;
  const Expected<int> id = IntegerAt(place, "id", -1, kMostIds);
  if (!id) return Forward(id);
  body.id = *id;
  const std::size_t joints = place.Has("joints19") || !place.Has("joints15") ? 19 : 15;
  const std::string key = "joints" + std::to_string(joints);
  const Expected<std::vector<double>> numbers = NumbersAt(place, key, 4 * joints);
  if (!numbers) return Forward(numbers);
  for (std::size_t j = 0; j < joints; ++j) {
    const double* joint = numbers->data() + 4 * j;
    if (joint[3] < 0.0 ? joint[3] != -1.0 : joint[3] > 1.0) {
      return place.Key(key)->Item(4 * j + 3).Bad("a confidence is -1 or from 0 to 1, not " + FormatDouble(joint[3]));
    }
    body.position_cm.emplace_back(joint[0], joint[1], joint[2]);
    body.confidence.push_back(joint[3]);
  }
  return body;
}

}  // namespace

const std::vector<std::string>& PanopticJointNames() {
  static const std::vector<std::string> names = {
      "neck",        "nose",       "mid_hip",        "left_shoulder", "left_elbow",  "left_wrist", "left_hip",
      "left_knee",   "left_ankle", "right_shoulder", "right_elbow",   "right_wrist", "right_hip",  "right_knee",
      "right_ankle", "left_eye",   "left_ear",       "right_eye",     "right_ear"};
  return names;
}

Expected<PanopticBodies> ParsePanopticBodies(std::string_view bytes, const std::string& name) {
  const Expected<nlohmann::json> document = ParseLenientJson(bytes, name);
  if (!document) return Forward(document);
  const JsonPlace root{&*document, "", &name};
  PanopticBodies scene;
  for (const auto& [key, target] : {std::pair{"version", &scene.version}, {"univTime", &scene.time_ms}}) {
    const Expected<double> number = NumberAt(root, key);
    if (!number) return Forward(number);
    *target = *number;
  }
  if (root.Has("fpsType")) {
    Expected<std::string> text = root.Key("fpsType")->Text();
    if (!text) return Forward(text);
    scene.fps_type = std::move(*text);
  }
  const Expected<JsonPlace> bodies = root.Key("bodies");
  if (!bodies) return Forward(bodies);
  if (!bodies->value->is_array()) return bodies->Bad("a list of bodies is expected");
  for (std::size_t i = 0; i < bodies->value->size(); ++i) {
    Expected<PanopticBody> body = ParseBody(bodies->Item(i));
    if (!body) return Forward(body);
    scene.bodies.push_back(std::move(*body));
  }
  return scene;
}

}  // namespace mocurate
