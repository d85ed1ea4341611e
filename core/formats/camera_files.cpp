#include "core/formats/camera_files.h"

#include <toml++/toml.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "core/formats/json_place.h"

namespace mocurate {
namespace {

using nlohmann::json;

constexpr int kMaxCameraSide = 100'000;
constexpr double kFarthest = 1e9;
constexpr int kMaxTomlDepth = 16;
constexpr int kMostTomlDots = 64;

Status SetSize(const JsonPlace& place, const std::string& key, CalibratedView& view) {
  const Expected<JsonPlace> size = place.Key(key);
  if (!size) return Forward(size);
  const Expected<std::vector<double>> sides = size->Numbers(2);
  if (!sides) return Forward(sides);
  for (std::size_t i = 0; i < 2; ++i) {
    const Expected<int> side = size->Item(i).Integer(1, kMaxCameraSide);
    if (!side) return Forward(side);
    (i == 0 ? view.width : view.height) = *side;
  }
  return {};
}

Status SetMatrix(const JsonPlace& place, const std::string& key, CalibratedView& view) {
  const Expected<std::vector<double>> matrix = TableAt(place, key, 3, 3);
  if (!matrix) return Forward(matrix);
  const std::string fault = SetIntrinsics(*matrix, view);
  return fault.empty() ? Status() : place.Key(key)->Bad(fault);
}

/// k1 k2 p1 p2 and, if there, k3.
Status SetDistortion(const JsonPlace& place, const std::string& key, CalibratedView& view) {
  const Expected<JsonPlace> list = place.Key(key);
  if (!list) return Forward(list);
  if (!list->value->is_array() || list->value->size() < 4 || list->value->size() > 5) {
    return list->Bad("4 or 5 numbers are expected (k1 k2 p1 p2 k3)");
  }
  const Expected<std::vector<double>> k = list->Numbers(list->value->size());
  if (!k) return Forward(k);
  view.distortion = {(*k)[0], (*k)[1], (*k)[2], (*k)[3], k->size() > 4 ? (*k)[4] : 0.0};
  return {};
}

Status CheckPlace(const JsonPlace& place, const std::string& key, const CalibratedView& view) {
  if (view.translation.cwiseAbs().maxCoeff() <= kFarthest) return {};
  return place.Key(key)->Bad("the camera is implausibly far away (at most 1e9 units)");
}

/// R as a matrix and a translation of 3 numbers, or 3 rows of one.
Status SetPose(const JsonPlace& place, const std::string& rotation, const std::string& translation,
               CalibratedView& view) {
  const Expected<JsonPlace> r = place.Key(rotation);
  if (!r) return Forward(r);
  const Expected<Matrix3d> matrix = r->Rotation();
  if (!matrix) return Forward(matrix);
  const Expected<std::vector<double>> t = TableAt(place, translation, 3, 1);
  if (!t) return Forward(t);
  view.rotation = *matrix;
  view.translation = Vector3d((*t)[0], (*t)[1], (*t)[2]);
  return CheckPlace(place, translation, view);
}

Status SetText(const JsonPlace& place, const std::string& key, std::string& to) {
  const Expected<JsonPlace> at = place.Key(key);
  if (!at) return Forward(at);
  Expected<std::string> text = at->Text();
  if (!text) return Forward(text);
  to = std::move(*text);
  return {};
}

Status TomlCamera(const JsonPlace& place, CalibratedView& view) {
  if (Status status = SetText(place, "name", view.name); !status) return status;
  if (Status status = SetSize(place, "size", view); !status) return status;
  if (Status status = SetMatrix(place, "matrix", view); !status) return status;
  if (Status status = SetDistortion(place, "distortions", view); !status) return status;
  const Expected<Vector3d> rotation = VectorAt(place, "rotation");
  if (!rotation) return Forward(rotation);
  view.rotation = ExpMatrix(*rotation);
  const Expected<Vector3d> translation = VectorAt(place, "translation");
  if (!translation) return Forward(translation);
  view.translation = *translation;
  if (Status status = CheckPlace(place, "translation", view); !status) return status;
  if (!place.Has("fisheye")) return {};
  const JsonPlace fisheye = *place.Key("fisheye");
  if (!fisheye.value->is_boolean()) return fisheye.Bad("true or false is expected");
  if (!fisheye.value->get<bool>()) return {};
  return Fail(ErrorCode::kUnsupported, "fisheye lenses are not supported", fisheye.Where());
}

Status PlainCamera(const JsonPlace& place, CalibratedView& view) {
  if (Status status = SetText(place, "name", view.name); !status) return status;
  if (Status status = SetSize(place, "size", view); !status) return status;
  if (Status status = SetMatrix(place, "K", view); !status) return status;
  if (Status status = SetDistortion(place, "dist_k1k2p1p2k3", view); !status) return status;
  return SetPose(place, "R", "t", view);
}

Status CampusCamera(const JsonPlace& place, CalibratedView& view) {
  for (const auto& [key, target] : {std::pair{"fx", &view.fx}, {"fy", &view.fy}, {"cx", &view.cx}, {"cy", &view.cy}}) {
    const Expected<double> number = NumberAt(place, key);
    if (!number) return Forward(number);
    *target = *number;
  }
  if (!(view.fx > 0.0))
    return place.Key("fx")->Bad("the focal lengths must be positive", "write pixels, or remove the camera");
  if (!(view.fy > 0.0))
    return place.Key("fy")->Bad("the focal lengths must be positive", "write pixels, or remove the camera");
  const Expected<std::vector<double>> k = TableAt(place, "k", 3, 1);
  if (!k) return Forward(k);
  const Expected<std::vector<double>> p = TableAt(place, "p", 2, 1);
  if (!p) return Forward(p);
  view.distortion = {(*k)[0], (*k)[1], (*p)[0], (*p)[1], (*k)[2]};
  return SetPose(place, "R", "T", view);
}

Status PanopticCamera(const JsonPlace& place, CalibratedView& view) {
  if (Status status = SetText(place, "name", view.name); !status) return status;
  if (Status status = SetText(place, "type", view.kind); !status) return status;
  if (Status status = SetSize(place, "resolution", view); !status) return status;
  if (Status status = SetMatrix(place, "K", view); !status) return status;
  if (Status status = SetDistortion(place, "distCoef", view); !status) return status;
  return SetPose(place, "R", "t", view);
}

/// Reads each place with `read`, the name being the last key; `keyed`: by key instead of by number.
template <class Read>
Status AddViews(const JsonPlace& list, bool keyed, Read read, Calibration& calibration) {
  const bool right = keyed ? list.value->is_object() : list.value->is_array();
  if (!right || list.value->empty()) return list.Bad("at least one camera is expected");
  for (const auto& item : list.value->items()) {
    const JsonPlace place{&item.value(), list.path + "/" + item.key(), list.file};
    if (keyed && (item.key() == "metadata" || item.key() == "capture")) continue;
    if (!place.value->is_object()) return place.Bad("a camera is expected");
    CalibratedView view;
    if (keyed) view.name = item.key();
    if (Status status = read(place, view); !status) return status;
    calibration.views.push_back(std::move(view));
  }
  return calibration.views.empty() ? list.Bad("at least one camera is expected") : Status();
}

/// Dates, and values nested deeper than any calibration's, become null.
json JsonOfToml(const toml::node& node, int depth) {
  return node.visit([&](const auto& value) -> json {
    using Node = std::decay_t<decltype(value)>;
    if constexpr (toml::is_table<Node>) {
      json object = json::object();
      if (depth == kMaxTomlDepth) return nullptr;
      for (const auto& [key, child] : value) object[std::string(key.str())] = JsonOfToml(child, depth + 1);
      return object;
    } else if constexpr (toml::is_array<Node>) {
      json array = json::array();
      if (depth == kMaxTomlDepth) return nullptr;
      for (const toml::node& child : value) array.push_back(JsonOfToml(child, depth + 1));
      return array;
    } else if constexpr (toml::is_chronological<Node>) {
      return nullptr;
    } else {
      return *value;
    }
  });
}

Expected<json> ParseToml(std::string_view bytes, const std::string& name) {
  bytes = WithoutByteOrderMark(bytes);
  if (Trim(bytes).empty()) return EmptyFile(name);
  int number = 0;
  for (const std::string_view line : SplitText(bytes, '\n')) {
    ++number;
    // A key a.b.c nests tables, and toml++ walks over them by recursion.
    if (std::count(line.begin(), line.end(), '.') <= kMostTomlDots) continue;
    return Fail(ErrorCode::kMalformed, "a line has more than " + std::to_string(kMostTomlDots) + " dots",
                name + ":" + std::to_string(number));
  }
  try {
    return JsonOfToml(toml::parse(bytes), 0);
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    return Fail(ErrorCode::kMalformed, "the file is not TOML: " + std::string(error.description()),
                name + ":" + std::to_string(at.line) + ":" + std::to_string(at.column));
  }
}

Status Human36mView(const JsonPlace& root, const std::string& subject, const JsonPlace& extrinsic,
                    const std::string& id, Calibration& calibration) {
  // mmpose, tools/dataset/preprocess_h36m.py
  constexpr std::array<std::pair<std::string_view, int>, 4> kHeights = {
      {{"54138969", 1002}, {"55011271", 1000}, {"58860488", 1000}, {"60457274", 1002}}};
  CalibratedView view;
  view.name = id;
  view.world = subject;
  for (const auto& [known, height] : kHeights) {
    if (known == id) view.width = 1000, view.height = height;
  }
  const Expected<JsonPlace> intrinsics = root.Key("intrinsics");
  if (!intrinsics) return Forward(intrinsics);
  const Expected<JsonPlace> own = intrinsics->Key(id);
  if (!own) return Forward(own);
  if (Status status = SetMatrix(*own, "calibration_matrix", view); !status) return status;
  if (Status status = SetDistortion(*own, "distortion", view); !status) return status;
  if (Status status = SetPose(extrinsic, "R", "t", view); !status) return status;
  calibration.views.push_back(std::move(view));
  return {};
}

Status ReadPose2Sim(const JsonPlace& root, Calibration& calibration) {
  calibration.dialect = "pose2sim_toml";
  calibration.reading = PoseConvention::kWorldToCamera;
  calibration.metres_per_unit = 1.0;
  return AddViews(root, true, TomlCamera, calibration);
}

Status ReadPlainCameras(const JsonPlace& root, Calibration& calibration) {
  calibration.dialect = "plain_json";
  for (const char* key : {"units", "convention", "cameras"}) {
    if (const Expected<JsonPlace> at = root.Key(key); !at) return Forward(at);
  }
  const Expected<std::string> units = root.Key("units")->Text();
  if (!units) return Forward(units);
  const Expected<std::string> convention = root.Key("convention")->Text();
  if (!convention) return Forward(convention);
  if (*units == "metre" || *units == "m") calibration.metres_per_unit = 1.0;
  if (*units == "centimetre" || *units == "cm") calibration.metres_per_unit = 0.01;
  if (*units == "millimetre" || *units == "mm") calibration.metres_per_unit = 0.001;
  if (calibration.metres_per_unit == 0.0) return root.Key("units")->Bad("metre, centimetre or millimetre is expected");
  if (convention->rfind("x_cam = R X_world + t", 0) != 0) {
    return root.Key("convention")->Bad("'x_cam = R X_world + t' is expected");
  }
  calibration.reading = PoseConvention::kWorldToCamera;
  return AddViews(*root.Key("cameras"), false, PlainCamera, calibration);
}

Status ReadHuman36m(const JsonPlace& root, Calibration& calibration) {
  calibration.dialect = "human36m";
  const Expected<JsonPlace> subjects = root.Key("extrinsics");
  if (!subjects) return Forward(subjects);
  if (!subjects->value->is_object() || subjects->value->empty()) return subjects->Bad("a subject is expected");
  for (const auto& subject : subjects->value->items()) {
    const JsonPlace cameras{&subject.value(), subjects->path + "/" + subject.key(), root.file};
    if (!cameras.value->is_object() || cameras.value->empty()) return cameras.Bad("at least one camera is expected");
    for (const auto& camera : cameras.value->items()) {
      const JsonPlace place{&camera.value(), cameras.path + "/" + camera.key(), root.file};
      Status status = Human36mView(root, subject.key(), place, camera.key(), calibration);
      if (!status) return status;
    }
  }
  return {};
}

Status ReadCampusShelf(const JsonPlace& root, Calibration& calibration) {
  calibration.dialect = "campus_shelf";
  return AddViews(root, true, CampusCamera, calibration);
}

Status ReadPanoptic(const JsonPlace& root, Calibration& calibration) {
  calibration.dialect = "panoptic";
  const Expected<JsonPlace> cameras = root.Key("cameras");
  if (!cameras) return Forward(cameras);
  return AddViews(*cameras, false, PanopticCamera, calibration);
}

using Reader = Status (*)(const JsonPlace& root, Calibration& calibration);

/// By the keys that a JSON document has; null for no known format.
Reader ReaderOf(const JsonPlace& root) {
  if (root.Has("rig")) return ReadPhspdRigs;
  if (root.Has("extrinsics") || root.Has("intrinsics")) return ReadHuman36m;
  if (root.Has("convention")) return ReadPlainCameras;
  if (root.Has("cameras")) return ReadPanoptic;
  const bool campus = std::any_of(root.value->begin(), root.value->end(), [&](const json& camera) {
    const JsonPlace place{&camera, "", root.file};
    return place.Has("fx") || place.Has("fy") || place.Has("cx") || place.Has("cy");
  });
  return campus ? ReadCampusShelf : nullptr;
}

}  // namespace

std::string_view Name(PoseConvention reading) {
  constexpr std::string_view kNames[] = {"unknown", "world_to_camera", "centre", "camera_to_world"};
  return kNames[static_cast<std::size_t>(reading)];
}

Camera CameraOf(const CalibratedView& view, PoseConvention reading, double metres_per_unit) {
  Camera camera;
  camera.name = view.name;
  camera.width = view.width;
  camera.height = view.height;
  camera.fx = view.fx, camera.fy = view.fy, camera.cx = view.cx, camera.cy = view.cy;
  camera.distortion = view.distortion;
  const Quaterniond rotation = Quaterniond(NearestRotation(view.rotation)).normalized();
  const Vector3d t = view.translation * metres_per_unit;
  if (reading == PoseConvention::kCameraToWorld) {
    camera.camera_from_world = Inverse(RigidTransform{rotation, t});
  } else if (reading == PoseConvention::kCentre) {
    camera.camera_from_world = {rotation, -(rotation * t)};
  } else {
    camera.camera_from_world = {rotation, t};
  }
  return camera;
}

std::string SetIntrinsics(const std::vector<double>& matrix, CalibratedView& view) {
  view.fx = matrix[0], view.cx = matrix[2], view.fy = matrix[4], view.cy = matrix[5];
  if (!(view.fx > 0.0) || !(view.fy > 0.0)) {
    return "the focal lengths must be positive, not " + FormatDouble(view.fx) + " and " + FormatDouble(view.fy) +
           " px: correct them, or remove the camera";
  }
  if (matrix[3] != 0.0 || matrix[6] != 0.0 || matrix[7] != 0.0 || matrix[8] != 1.0) {
    return "the matrix is not a camera matrix (fx s cx; 0 fy cy; 0 0 1)";
  }
  if (std::abs(matrix[1]) > 1e-6 * view.fx) return "a skew of " + FormatDouble(matrix[1]) + " px is not supported";
  return {};
}

bool LooksLikeCalibration(std::string_view bytes) {
  const auto holds = [&](std::string_view word) { return bytes.find(word) != std::string_view::npos; };
  const std::string_view content = Trim(bytes);
  if (content.empty()) return false;
  if (content[0] == '<') return holds("<calibration") && holds("<camera");
  if (content[0] == '{') {
    const bool lens = holds("\"K\"") || holds("\"fx\"") || holds("\"fy\"") || holds("\"cx\"");
    const bool place = holds("\"R\"") || holds("\"T\"") || holds("\"t\"");
    return (lens && place) || (holds("\"intrinsics\"") || holds("\"extrinsics\"")) || holds("\"calibration_matrix\"");
  }
  return (holds("matrix") && (holds("rotation") || holds("translation"))) ||
         (holds("rotation") && holds("translation"));
}

Expected<Calibration> ParseCalibration(std::string_view bytes, const std::string& name) {
  const std::string_view content = Trim(bytes);
  if (!content.empty() && content[0] == '\x80') return ParsePhspdRigPickle(bytes, name);
  if (!content.empty() && content[0] == '<') return ParseQualisys(bytes, name);
  const bool toml = !content.empty() && content[0] != '{';
  const Expected<json> document = toml ? ParseToml(bytes, name) : ParseLenientJson(bytes, name);
  if (!document) return Forward(document);
  const JsonPlace root{&*document, "", &name};
  Calibration calibration;
  if (const Reader read = toml ? ReadPose2Sim : ReaderOf(root)) {
    if (Status status = read(root, calibration); !status) return Forward(status);
    return calibration;
  }
  return Fail(ErrorCode::kUnsupported, "the file is not a calibration of a known format", name,
              "known are Qualisys, Pose2Sim, Human3.6M, Campus/Shelf, Panoptic, PHSPD and plain cameras");
}

}  // namespace mocurate
