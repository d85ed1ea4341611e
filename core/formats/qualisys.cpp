#include "core/formats/camera_files.h"

#include <cmath>
#include <optional>
#include <pugixml.hpp>

#include "core/base/text.h"
#include "core/formats/json_place.h"
#include "core/formats/line_reader.h"
#include "core/formats/xml.h"

namespace mocurate {
namespace {

constexpr double kUnitsPerPixel = 64.0;

/// An element of the file, for messages with its line.
struct QualisysElement {
  pugi::xml_node node;
  std::string_view bytes;
  const std::string& file;

  QualisysElement With(const pugi::xml_node& other) const { return {other, bytes, file}; }
  std::string Line() const { return XmlPlace(bytes, file, node); }
  std::string Where(const std::string& key) const { return Line() + ":" + node.name() + "/" + key; }
  Expected<QualisysElement> Child(const char* name) const {
    if (const pugi::xml_node child = node.child(name)) return With(child);
    return Fail(ErrorCode::kMalformed, "the camera has no element '" + std::string(name) + "'", Line());
  }
  Expected<double> Number(const std::string& key) const {
    const pugi::xml_attribute attribute = node.attribute(key.c_str());
    if (!attribute) return Fail(ErrorCode::kMalformed, "the attribute is missing", Where(key));
    const std::optional<double> number = ParseDouble(Trim(attribute.value()));
    if (number && std::isfinite(*number)) return *number;
    return Fail(ErrorCode::kMalformed, "'" + Shown(attribute.value()) + "' is not a finite number", Where(key));
  }
  Expected<std::vector<double>> Numbers(const std::vector<std::string>& keys) const {
    std::vector<double> numbers;
    for (const std::string& key : keys) {
      const Expected<double> number = Number(key);
      if (!number) return Forward(number);
      numbers.push_back(*number);
    }
    return numbers;
  }
};

/// Checks the numbers that are not read too: a file that is damaged there may be damaged elsewhere.
Status CheckNumbers(const QualisysElement& camera) {
  for (const pugi::xml_node node : camera.node.children()) {
    const std::string_view name = node.name();
    if (name.substr(0, 4) != "fov_" && name != "transform" && name != "intrinsic") continue;
    for (const pugi::xml_attribute attribute : node.attributes()) {
      if (const auto number = camera.With(node).Number(attribute.name()); !number) return Forward(number);
    }
  }
  return {};
}

Expected<CalibratedView> ParseCamera(const QualisysElement& camera) {
  CalibratedView view;
  view.name = camera.node.attribute("serial").value();
  if (view.name.empty()) return Fail(ErrorCode::kMalformed, "the camera has no attribute 'serial'", camera.Line());
  if (Status numbers = CheckNumbers(camera); !numbers) return Forward(numbers);
  const Expected<QualisysElement> video = camera.Child("fov_video");
  if (!video) return Forward(video);
  const auto fov = video->Numbers({"left", "top", "right", "bottom"});
  if (!fov) return Forward(fov);
  for (const double side : {(*fov)[2], (*fov)[3]}) {
    if (side < 0 || side > 100'000 || side != std::floor(side)) {
      return Fail(ErrorCode::kMalformed, FormatDouble(side) + " is not the last pixel of an image",
                  video->Where("right, bottom"));
    }
  }
  for (const int last : {2, 3}) {
    if ((*fov)[last] <= (*fov)[last - 2]) {
      return Fail(
          ErrorCode::kInconsistent,
          "the image ends at " + FormatDouble((*fov)[last]) + " and begins at " + FormatDouble((*fov)[last - 2]),
          video->Where(last == 2 ? "left, right" : "top, bottom"));
    }
  }
  view.width = static_cast<int>((*fov)[2]) + 1;
  view.height = static_cast<int>((*fov)[3]) + 1;

  const Expected<QualisysElement> intrinsic = camera.Child("intrinsic");
  if (!intrinsic) return Forward(intrinsic);
  const auto k = intrinsic->Numbers({"focalLengthU", "focalLengthV", "centerPointU", "centerPointV", "skew"});
  if (!k) return Forward(k);
  const std::vector<double> matrix = {(*k)[0] / kUnitsPerPixel,
                                      (*k)[4],
                                      (*k)[2] / kUnitsPerPixel - (*fov)[0],
                                      0,
                                      (*k)[1] / kUnitsPerPixel,
                                      (*k)[3] / kUnitsPerPixel - (*fov)[1],
                                      0,
                                      0,
                                      1};
  if (const std::string fault = SetIntrinsics(matrix, view); !fault.empty()) {
    return Fail(ErrorCode::kMalformed, fault, intrinsic->Where("focalLengthU, focalLengthV, skew"));
  }
  // The format itself writes "tangental".
  const auto lens = intrinsic->Numbers(
      {"radialDistortion1", "radialDistortion2", "tangentalDistortion1", "tangentalDistortion2", "radialDistortion3"});
  if (!lens) return Forward(lens);
  view.distortion = {(*lens)[0], (*lens)[1], (*lens)[2], (*lens)[3], (*lens)[4]};

  const Expected<QualisysElement> transform = camera.Child("transform");
  if (!transform) return Forward(transform);
  const auto r = transform->Numbers({"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"});
  if (!r) return Forward(r);
  const Matrix3d given(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r->data()));
  if (const std::string fault = RotationFault(given); !fault.empty()) {
    return Fail(ErrorCode::kInconsistent, fault, transform->Where("r11..r33"));
  }
  view.rotation = Vector3d(1, -1, -1).asDiagonal() * given;
  const auto centre = transform->Numbers({"x", "y", "z"});
  if (!centre) return Forward(centre);
  view.translation = Vector3d((*centre)[0], (*centre)[1], (*centre)[2]);
  return view;
}

}  // namespace

Expected<Calibration> ParseQualisys(std::string_view bytes, const std::string& name) {
  pugi::xml_document document;
  if (Status parsed = ParseXml(bytes, name, document); !parsed) return Forward(parsed);
  const pugi::xml_node cameras = document.child("calibration").child("cameras");
  if (!cameras.first_child()) {
    return Fail(ErrorCode::kMalformed, "the file is not a Qualisys calibration (calibration/cameras/camera)", name);
  }
  Calibration calibration;
  calibration.dialect = "qualisys";
  calibration.reading = PoseConvention::kCentre;
  calibration.metres_per_unit = 0.001;
  for (const pugi::xml_node node : cameras) {
    if (node.type() != pugi::node_element) continue;
    const QualisysElement camera{node, bytes, name};
    if (std::string_view(node.name()) != "camera") {
      return Fail(ErrorCode::kMalformed, "'" + Shown(node.name()) + "' is not a camera", camera.Line());
    }
    Expected<CalibratedView> view = ParseCamera(camera);
    if (!view) return Forward(view);
    calibration.views.push_back(std::move(*view));
  }
  return calibration;
}

}  // namespace mocurate
