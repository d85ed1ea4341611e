#include <cmath>

#include "core/base/text.h"
#include "core/formats/camera_files.h"
#include "core/formats/json_place.h"
#include "core/formats/pickle.h"

namespace mocurate {
namespace {

constexpr double kNormTolerance = 1e-2;  // the published ones are off by up to 1.5e-4

/// qw qx qy qz tx ty tz.
Expected<RigidTransform> Pose(const JsonPlace& place) {
  const Expected<std::vector<double>> n = place.Numbers(7);
  if (!n) return Forward(n);
  const Quaterniond rotation((*n)[0], (*n)[1], (*n)[2], (*n)[3]);
  const double norm = rotation.norm();
  if (std::abs(norm - 1.0) > kNormTolerance) {
    return Fail(ErrorCode::kInconsistent, "the quaternion has the norm " + FormatDouble(norm) + ", not 1",
                place.Where());
  }
  return RigidTransform{rotation.normalized(), Vector3d((*n)[4], (*n)[5], (*n)[6])};
}

Expected<RigidTransform> PoseAt(const JsonPlace& place, const std::string& key) {
  const Expected<JsonPlace> at = place.Key(key);
  if (!at) return Forward(at);
  return Pose(*at);
}

/// fx fy cx cy k1 k2 k3, of which the last three are not applied.
Expected<CalibratedView> ReadPhspdView(const JsonPlace& rig, const std::string& world, const std::string& name,
                                       const RigidTransform& pose) {
  CalibratedView view;
  view.name = name;
  view.world = world;
  const Expected<std::vector<double>> n = NumbersAt(rig, "param_" + name, 7);
  if (!n) return Forward(n);
  const std::string fault = SetIntrinsics({(*n)[0], 0, (*n)[2], 0, (*n)[1], (*n)[3], 0, 0, 1}, view);
  if (!fault.empty()) return rig.Key("param_" + name)->Bad(fault);
  view.kind = name[0] == 'p' ? "polarisation" : name[0] == 'd' ? "depth" : "colour";
  view.width = name[0] == 'p' ? 1224 : name[0] == 'd' ? 512 : 1920;
  view.height = name[0] == 'p' ? 1024 : name[0] == 'd' ? 424 : 1080;
  view.rotation = pose.rotation.toRotationMatrix();
  view.translation = pose.translation;
  return view;
}

Status AddBoards(const JsonPlace& rig, const std::string& world, Calibration& calibration) {
  for (int i = 1; rig.Has("p" + std::to_string(i) + "w"); ++i) {
    const Expected<std::vector<JsonPlace>> boards = rig.Key("p" + std::to_string(i) + "w")->Items();
    if (!boards) return Forward(boards);
    for (const JsonPlace& board : *boards) {
      const Expected<RigidTransform> pose = Pose(board);
      if (!pose) return Forward(pose);
      calibration.subject_points.push_back({world, pose->translation});
    }
  }
  return {};
}

Status AddRig(const JsonPlace& rig, const std::string& world, Calibration& calibration) {
  const auto add = [&](const std::string& name, const RigidTransform& pose) -> Status {
    Expected<CalibratedView> view = ReadPhspdView(rig, world, name, pose);
    if (!view) return Forward(view);
    calibration.views.push_back(std::move(*view));
    return {};
  };
  if (Status status = add("p", RigidTransform{}); !status) return status;
  int kinects = 0;
  for (int i = 1; i == 1 || rig.Has("d" + std::to_string(i) + "p"); ++i, ++kinects) {
    const std::string number = std::to_string(i);
    const Expected<RigidTransform> depth = PoseAt(rig, "d" + number + "p");
    if (!depth) return Forward(depth);
    const Expected<RigidTransform> colour = PoseAt(rig, "cd" + number);
    if (!colour) return Forward(colour);
    if (Status status = add("d" + number, *depth); !status) return status;
    if (Status status = add("c" + number, *colour * *depth); !status) return status;
  }
  for (const auto& item : rig.value->items()) {
    const int number = item.key().size() == 3 && item.key()[0] == 'd' && item.key()[2] == 'p' ? item.key()[1] - '0' : 0;
    if (number > kinects) return rig.Bad("'" + item.key() + "' comes without the cameras before it");
  }
  return AddBoards(rig, world, calibration);
}

/// Numbers of an array as nested lists.
nlohmann::json Nested(const NpyArray& array, std::size_t axis, std::size_t& next) {
  if (axis == array.shape.size()) return array.values[next++];
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < array.shape[axis]; ++i) list.push_back(Nested(array, axis + 1, next));
  return list;
}

}  // namespace

Status ReadPhspdRigs(const JsonPlace& root, Calibration& calibration) {
  calibration.dialect = "phspd";
  if (root.Has("units")) {
    const Expected<std::string> units = root.Key("units")->Text();
    if (!units) return Forward(units);
    if (*units != "mm") return root.Key("units")->Bad("'mm' is expected");
    calibration.metres_per_unit = 0.001;
  }
  const Expected<JsonPlace> rigs = root.Key("rig");
  if (!rigs) return Forward(rigs);
  if (!rigs->value->is_object() || rigs->value->empty()) return rigs->Bad("at least one rig is expected");
  for (const auto& rig : rigs->value->items()) {
    const JsonPlace place{&rig.value(), rigs->path + "/" + rig.key(), root.file};
    if (!place.value->is_object()) return place.Bad("a rig is expected");
    if (Status status = AddRig(place, rig.key(), calibration); !status) return status;
  }
  return {};
}

Expected<Calibration> ParsePhspdRigPickle(std::string_view bytes, const std::string& name) {
  const Expected<Pickle> pickle = ParsePickle(bytes, name);
  if (!pickle) return Forward(pickle);
  const PickleRef top = pickle->top();
  if (!top.Find("param_p") || !top.Find("d1p")) {
    return Fail(ErrorCode::kUnsupported, "the pickle is not a rig of PHSPD: it has no 'param_p' and 'd1p'", name,
                "cameras are read from CamParams*.pkl of PHSPD, or from one of the text calibrations");
  }
  nlohmann::json rig = nlohmann::json::object();
  for (std::size_t i = 0; i < top.size(); ++i) {
    const Expected<std::string> key = top.KeyAt(i).Text();
    if (!key) return Forward(key);
    const Expected<NpyArray> array = top.ValueAt(i).Array();
    if (!array) return Forward(array);
    if (array->values.empty()) continue;
    std::size_t next = 0;
    rig[*key] = Nested(*array, 0, next);
  }
  const std::size_t slash = name.rfind('/');
  const std::string file = name.substr(slash == std::string::npos ? 0 : slash + 1);
  const nlohmann::json rigs = {{"units", "mm"},
                               {"rig", {{file.substr(0, file.rfind('.')), rig}}}};  // millimetres by the set's own code
  Calibration calibration;
  if (Status status = ReadPhspdRigs(JsonPlace{&rigs, "", &name}, calibration); !status) return Forward(status);
  return calibration;
}

}  // namespace mocurate
