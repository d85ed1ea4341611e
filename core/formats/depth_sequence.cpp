#include "core/formats/depth_sequence.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/text.h"

namespace mocurate {
namespace {

using nlohmann::json;

constexpr int kMaxFrames = 10'000'000;
constexpr int kMaxSide = 65536;

/// A JSON value with the path that leads to it, for messages.
struct Place {
  const json* value = nullptr;
  std::string path;
  const std::string* file = nullptr;

  tl::unexpected<Error> Bad(const std::string& rule) const {
    return Fail(ErrorCode::kMalformed, rule, *file + ":" + path);
  }
  Expected<Place> Key(const std::string& key) const {
    if (!value->is_object() || !value->contains(key)) {
      return Fail(ErrorCode::kMalformed, "the key '" + key + "' is missing", *file + ":" + path);
    }
    return Place{&(*value)[key], path + "/" + key, file};
  }
  Place Item(std::size_t i) const { return {&(*value)[i], path + "/" + std::to_string(i), file}; }

  Expected<double> Number() const {
    if (!value->is_number()) return Bad("a number is expected");
    const double number = value->get<double>();
    if (!std::isfinite(number)) return Bad("a finite number is expected");
    return number;
  }
  Expected<int> Integer(int min, int max) const {
    const Expected<double> number = Number();
    if (!number) return Forward(number);
    if (*number < min || *number > max || *number != std::floor(*number)) {
      return Bad("a whole number from " + std::to_string(min) + " to " + std::to_string(max) + " is expected, not " +
                 FormatDouble(*number));
    }
    return static_cast<int>(*number);
  }
  Expected<std::vector<double>> Numbers(std::size_t count) const {
    if (!value->is_array() || value->size() != count) return Bad(std::to_string(count) + " numbers are expected");
    std::vector<double> numbers;
    for (std::size_t i = 0; i < count; ++i) {
      const Expected<double> number = Item(i).Number();
      if (!number) return Forward(number);
      numbers.push_back(*number);
    }
    return numbers;
  }
  Expected<Vector3d> Vector() const {
    const Expected<std::vector<double>> numbers = Numbers(3);
    if (!numbers) return Forward(numbers);
    return Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
  }
};

Expected<std::vector<double>> NumbersAt(const Place& place, const std::string& key, std::size_t count) {
  const Expected<Place> at = place.Key(key);
  if (!at) return Forward(at);
  return at->Numbers(count);
}

Expected<int> IntegerAt(const Place& place, const std::string& key, int min, int max) {
  const Expected<Place> at = place.Key(key);
  if (!at) return Forward(at);
  return at->Integer(min, max);
}

std::string TextAt(const json& value, const char* key) {
  const auto found = value.find(key);
  return found != value.end() && found->is_string() ? found->get<std::string>() : std::string();
}

Expected<RigidTransform> Extrinsics(const Place& place) {
  const Expected<Place> rows = place.Key("R_p_to_d");
  if (!rows) return Forward(rows);
  if (!rows->value->is_array() || rows->value->size() != 3) return rows->Bad("3 rows of 3 numbers are expected");
  Matrix3d rotation;
  for (std::size_t r = 0; r < 3; ++r) {
    const Expected<Vector3d> row = rows->Item(r).Vector();
    if (!row) return Forward(row);
    rotation.row(static_cast<int>(r)) = row->transpose();
  }
  const double deviation = (rotation * rotation.transpose() - Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(deviation < 1e-3) || rotation.determinant() <= 0.0) {
    return Fail(ErrorCode::kInconsistent,
                "the matrix is no rotation (deviation " + FormatDouble(deviation) + ", determinant " +
                    FormatDouble(rotation.determinant()) + ")",
                *place.file + ":" + rows->path);
  }
  const Expected<Place> translation = place.Key("t_m");
  if (!translation) return Forward(translation);
  const Expected<Vector3d> t = translation->Vector();
  if (!t) return Forward(t);
  return RigidTransform{Quaterniond(NearestRotation(rotation)).normalized(), *t};
}

Expected<DepthSequenceView> View(const Place& place, const std::string& name) {
  DepthSequenceView view;
  view.name = name;
  const Expected<RigidTransform> extrinsics = Extrinsics(place);
  if (!extrinsics) return Forward(extrinsics);
  view.camera_from_rig = *extrinsics;
  const Expected<std::vector<double>> intrinsics = NumbersAt(place, "fx_fy_cx_cy", 4);
  if (!intrinsics) return Forward(intrinsics);
  view.fx = (*intrinsics)[0], view.fy = (*intrinsics)[1], view.cx = (*intrinsics)[2], view.cy = (*intrinsics)[3];
  if (view.fx <= 0.0 || view.fy <= 0.0) return place.Bad("focal lengths must be positive");
  const Expected<std::vector<double>> size = NumbersAt(place, "size", 2);
  if (!size) return Forward(size);
  for (const double side : *size) {
    if (side < 1 || side > kMaxSide || side != std::floor(side)) return place.Bad("the image size is no pair of sizes");
  }
  view.width = static_cast<int>((*size)[0]);
  view.height = static_cast<int>((*size)[1]);
  return view;
}

Expected<std::vector<DepthSequenceLabel>> Labels(const Place& root, int frames) {
  std::vector<DepthSequenceLabel> labels;
  if (!root.value->contains("labels")) return labels;
  const Expected<Place> list = root.Key("labels");
  if (!list->value->is_array()) return list->Bad("a list is expected");
  for (std::size_t i = 0; i < list->value->size(); ++i) {
    const Place item = list->Item(i);
    if (!item.value->is_object()) return item.Bad("an object is expected");
    DepthSequenceLabel label;
    label.action = TextAt(*item.value, "action");
    if (label.action.empty()) return item.Bad("'action' must be a text");
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
  if (Trim(bytes).empty()) return Fail(ErrorCode::kMalformed, "the file is empty", name);
  document.value = json::parse(bytes.begin(), bytes.end(), nullptr, false);
  if (document.value.is_discarded()) return Fail(ErrorCode::kMalformed, "the file is not valid JSON", name);
  const Place root{&document.value, "", &name};
  const Expected<Place> fps = root.Key("fps");
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

}  // namespace

Expected<DepthSequence> ParseDepthSequence(std::string_view bytes, const std::string& name) {
  const Expected<Document> document = Open(bytes, name);
  if (!document) return Forward(document);
  const Place root{&document->value, "", &name};
  DepthSequence sequence;
  sequence.fps = document->fps;
  sequence.frames = document->frames;
  sequence.body = TextAt(document->value, "body");
  sequence.floor = TextAt(document->value, "floor");
  const Expected<Place> views = root.Key("views");
  if (!views) return Forward(views);
  if (!views->value->is_object() || views->value->empty()) return views->Bad("at least one view is expected");
  for (const auto& item : views->value->items()) {
    Expected<DepthSequenceView> view = View({&item.value(), views->path + "/" + item.key(), &name}, item.key());
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
  const Place root{&document->value, "", &name};
  if (!document->value.contains("frames_data")) {
    return Fail(ErrorCode::kNotFound, "the file carries no truth (frames_data)", name);
  }
  const Expected<Place> list = root.Key("frames_data");
  if (!list->value->is_array() || list->value->size() != static_cast<std::size_t>(document->frames)) {
    return Fail(ErrorCode::kInconsistent,
                "frames_data does not hold the " + std::to_string(document->frames) + " frames the file announces",
                name + ":" + list->path);
  }
  DepthSequenceTruth truth;
  truth.fps = document->fps;
  truth.frames = document->frames;
  for (std::size_t f = 0; f < list->value->size(); ++f) {
    const Place frame = list->Item(f);
    const Expected<Place> translation = frame.Key("translation_added");
    if (!translation) return Forward(translation);
    const Expected<Vector3d> t = translation->Vector();
    if (!t) return Forward(t);
    truth.translation.push_back(*t);
    for (const auto& [key, target] : {std::pair{"rotvec24", &truth.rotation_vector}, {"joints_m", &truth.joint}}) {
      const Expected<Place> rows = frame.Key(key);
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
  }
  return truth;
}

}  // namespace mocurate
