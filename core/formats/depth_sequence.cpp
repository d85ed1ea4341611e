#include "core/formats/depth_sequence.h"

#include <cmath>

#include "core/base/text.h"
#include "core/formats/json_place.h"

namespace mocurate {
namespace {

using nlohmann::json;

constexpr int kMaxFrames = 10'000'000;
constexpr int kMaxDepthSide = 65536;

std::string TextAt(const json& value, const char* key) {
  const auto found = value.find(key);
  return found != value.end() && found->is_string() ? found->get<std::string>() : std::string();
}

Expected<RigidTransform> Extrinsics(const JsonPlace& place) {
  const Expected<JsonPlace> rows = place.Key("R_p_to_d");
  if (!rows) return Forward(rows);
  const Expected<Matrix3d> rotation = rows->Rotation();
  if (!rotation) return Forward(rotation);
  const Expected<Vector3d> t = VectorAt(place, "t_m");
  if (!t) return Forward(t);
  return RigidTransform{Quaterniond(NearestRotation(*rotation)).normalized(), *t};
}

Expected<DepthSequenceView> ReadDepthView(const JsonPlace& place, const std::string& name, bool moment) {
  DepthSequenceView view;
  view.name = name;
  const Expected<RigidTransform> extrinsics = Extrinsics(place);
  if (!extrinsics) return Forward(extrinsics);
  view.camera_from_rig = *extrinsics;
  const Expected<std::vector<double>> intrinsics = NumbersAt(place, "fx_fy_cx_cy", 4);
  if (!intrinsics) return Forward(intrinsics);
  view.fx = (*intrinsics)[0], view.fy = (*intrinsics)[1], view.cx = (*intrinsics)[2], view.cy = (*intrinsics)[3];
  if (view.fx <= 0.0 || view.fy <= 0.0) return place.Bad("focal lengths must be positive");
  if (moment && !place.Has("size")) return view;
  const Expected<std::vector<double>> size = NumbersAt(place, "size", 2);
  if (!size) return Forward(size);
  for (const double side : *size) {
    if (side < 1 || side > kMaxDepthSide || side != std::floor(side))
      return place.Bad("the image size is not a width and a height");
  }
  view.width = static_cast<int>((*size)[0]);
  view.height = static_cast<int>((*size)[1]);
  return view;
}

Expected<std::vector<DepthSequenceLabel>> Labels(const JsonPlace& root, int frames) {
  std::vector<DepthSequenceLabel> labels;
  if (!root.value->contains("labels")) return labels;
  const Expected<JsonPlace> list = root.Key("labels");
  if (!list->value->is_array()) return list->Bad("a list is expected");
  for (std::size_t i = 0; i < list->value->size(); ++i) {
    const JsonPlace item = list->Item(i);
    if (!item.value->is_object()) return item.Bad("an object is expected");
    DepthSequenceLabel label;
    label.action = TextAt(*item.value, "action");
    if (label.action.empty()) {
      const Expected<JsonPlace> action = item.Key("action");
      return action ? action->Bad("a text is expected") : Forward(action);
    }
    const Expected<int> first = IntegerAt(item, "first", 0, frames - 1);
    if (!first) return Forward(first);
    const Expected<int> last = IntegerAt(item, "last", *first, frames - 1);
    if (!last) return Forward(last);
    label.first = *first, label.last = *last;
    labels.push_back(label);
  }
  return labels;
}

struct Document {
  json value;
  double fps = 0.0;
  int frames = 0;
};

Expected<Document> Open(std::string_view bytes, const std::string& name) {
  Document document;
  Expected<json> value = ParseLenientJson(bytes, name);
  if (!value) return Forward(value);
  document.value = std::move(*value);
  const JsonPlace root{&document.value, "", &name};
  document.frames = 1;
  if (document.value.is_object() && !root.Has("fps") && !root.Has("frames")) return document;
  const Expected<JsonPlace> fps = root.Key("fps");
  if (!fps) return Forward(fps);
  const Expected<double> rate = fps->Number();
  if (!rate) return Forward(rate);
  if (*rate < 1e-6 || *rate > 1e6) {
    return fps->Bad("the frame rate must be from 1e-6 to 1e6 Hz, not " + FormatDouble(*rate));
  }
  const Expected<int> frames = IntegerAt(root, "frames", 1, kMaxFrames);
  if (!frames) return Forward(frames);
  document.fps = *rate;
  document.frames = *frames;
  return document;
}

/// Appends one frame's translation_added, rotvec24 and joints_m.
Status ReadTruthFrame(const JsonPlace& frame, DepthSequenceTruth& truth) {
  const Expected<JsonPlace> translation = frame.Key("translation_added");
  if (!translation) return Forward(translation);
  const Expected<Vector3d> t = translation->Vector();
  if (!t) return Forward(t);
  truth.translation.push_back(*t);
  for (const auto& [key, target] : {std::pair{"rotvec24", &truth.rotation_vector}, {"joints_m", &truth.joint}}) {
    const Expected<JsonPlace> rows = frame.Key(key);
    if (!rows) return Forward(rows);
    if (!rows->value->is_array() || rows->value->empty()) return rows->Bad("rows of 3 numbers are expected");
    const int count = static_cast<int>(rows->value->size());
    if (truth.joints == 0) truth.joints = count;
    if (count != truth.joints) return rows->Bad(std::to_string(truth.joints) + " rows are expected");
    for (std::size_t j = 0; j < rows->value->size(); ++j) {
      const Expected<Vector3d> row = rows->Item(j).Vector();
      if (!row) return Forward(row);
      target->push_back(*row);
    }
  }
  return {};
}

}  // namespace

Expected<DepthSequence> ParseDepthSequence(std::string_view bytes, const std::string& name) {
  const Expected<Document> document = Open(bytes, name);
  if (!document) return Forward(document);
  const JsonPlace root{&document->value, "", &name};
  DepthSequence sequence;
  sequence.fps = document->fps;
  sequence.frames = document->frames;
  sequence.body = TextAt(document->value, "body");
  sequence.floor = TextAt(document->value, "floor");
  const Expected<JsonPlace> views = root.Key("views");
  if (!views) return Forward(views);
  if (!views->value->is_object() || views->value->empty()) return views->Bad("at least one view is expected");
  for (const auto& item : views->value->items()) {
    Expected<DepthSequenceView> view =
        ReadDepthView({&item.value(), views->path + "/" + item.key(), &name}, item.key(), sequence.fps == 0.0);
    if (!view) return Forward(view);
    sequence.views.push_back(std::move(*view));
  }
  Expected<std::vector<DepthSequenceLabel>> labels = Labels(root, sequence.frames);
  if (!labels) return Forward(labels);
  sequence.labels = std::move(*labels);
  return sequence;
}

Expected<DepthSequenceTruth> ParseDepthSequenceTruth(std::string_view bytes, const std::string& name) {
  const Expected<Document> document = Open(bytes, name);
  if (!document) return Forward(document);
  const JsonPlace root{&document->value, "", &name};
  const bool moment = document->fps == 0.0;
  const char* key = moment ? "rotvec24" : "frames_data";
  if (!document->value.contains(key)) {
    return Fail(ErrorCode::kNotFound, "the file has no truth (" + std::string(key) + ")", name);
  }
  DepthSequenceTruth truth;
  truth.fps = document->fps;
  truth.frames = document->frames;
  if (moment) {
    if (Status read = ReadTruthFrame(root, truth); !read) return Forward(read);
    return truth;
  }
  const Expected<JsonPlace> list = root.Key("frames_data");
  if (!list->value->is_array() || list->value->size() != static_cast<std::size_t>(document->frames)) {
    return Fail(ErrorCode::kInconsistent,
                "frames_data does not hold the " + std::to_string(document->frames) + " frames the file announces",
                name + ":" + list->path);
  }
  for (std::size_t f = 0; f < list->value->size(); ++f) {
    if (Status read = ReadTruthFrame(list->Item(f), truth); !read) return Forward(read);
  }
  return truth;
}

}  // namespace mocurate
