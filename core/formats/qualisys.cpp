#include "core/formats/qualisys.h"

#include <cmath>
#include <optional>

#include "core/base/text.h"
#include "core/formats/binary_numbers.h"
#include "core/formats/json_place.h"
#include "core/formats/xml.h"

namespace mocurate {
namespace {

constexpr double kUnitsPerPixel = 64.0;

/// Attributes of one element of a camera.
struct Attributes {
  const XmlElement& element;
  const std::string& file;

  std::string Where(const std::string& key) const {
    return file + ":" + std::to_string(element.line) + ":" + element.name + "/" + key;
  }
  Expected<double> Number(const std::string& key) const {
    const auto found = element.attributes.find(key);
    if (found == element.attributes.end()) return Fail(ErrorCode::kMalformed, "the attribute is missing", Where(key));
    const std::optional<double> number = ParseDouble(Trim(found->second));
    if (!number || !std::isfinite(*number)) {
      return Fail(ErrorCode::kMalformed, "'" + ShownText(found->second) + "' is not a finite number", Where(key));
    }
    return *number;
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

Expected<Attributes> Child(const XmlElement& camera, const std::string& child, const std::string& file) {
  const XmlElement* found = camera.Find(child);
  if (found != nullptr) return Attributes{*found, file};
  return Fail(ErrorCode::kMalformed, "the camera has no element '" + child + "'",
              file + ":" + std::to_string(camera.line));
}

/// What is not read holds numbers as well: a file that is damaged there is not trusted elsewhere.
Status CheckNumbers(const XmlElement& camera, const std::string& file) {
  for (const XmlElement& element : camera.children) {
    const bool numbers =
        element.name.rfind("fov_", 0) == 0 || element.name == "transform" || element.name == "intrinsic";
    if (!numbers) continue;
    for (const auto& [key, text] : element.attributes) {
      if (const Expected<double> number = Attributes{element, file}.Number(key); !number) return Forward(number);
    }
  }
  return {};
}

Expected<CalibratedView> ParseCamera(const XmlElement& camera, const std::string& file) {
  CalibratedView view;
  const auto serial = camera.attributes.find("serial");
  if (serial == camera.attributes.end() || serial->second.empty()) {
    return Fail(ErrorCode::kMalformed, "the camera has no attribute 'serial'",
                file + ":" + std::to_string(camera.line));
  }
  view.name = serial->second;
  if (Status numbers = CheckNumbers(camera, file); !numbers) return Forward(numbers);
  const Expected<Attributes> video = Child(camera, "fov_video", file);
  if (!video) return Forward(video);
  const auto fov = video->Numbers({"left", "top", "right", "bottom"});
  if (!fov) return Forward(fov);
  for (const double side : {(*fov)[2], (*fov)[3]}) {
    if (side < 0 || side > 100'000 || side != std::floor(side)) {
      return Fail(ErrorCode::kMalformed, FormatDouble(side) + " is no last pixel of an image",
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

  const Expected<Attributes> intrinsic = Child(camera, "intrinsic", file);
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

  const Expected<Attributes> transform = Child(camera, "transform", file);
  if (!transform) return Forward(transform);
  const auto r = transform->Numbers({"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"});
  if (!r) return Forward(r);
  const Matrix3d given(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r->data()));
  if (const std::string fault = RotationFault(given, 1e-3); !fault.empty()) {
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
  const Expected<XmlElement> root = ParseXml(bytes, name);
  if (!root) return Forward(root);
  const XmlElement* cameras = root->Find("cameras");
  if (root->name != "calibration" || cameras == nullptr || cameras->children.empty()) {
    return Fail(ErrorCode::kMalformed, "the file is no Qualisys calibration (calibration/cameras/camera)", name);
  }
  Calibration calibration;
  calibration.dialect = "qualisys";
  calibration.reading = PoseReading::kCentre;
  calibration.metres_per_unit = 0.001;
  for (const XmlElement& camera : cameras->children) {
    if (camera.name != "camera") {
      return Fail(ErrorCode::kMalformed, "'" + ShownText(camera.name) + "' is no camera",
                  name + ":" + std::to_string(camera.line));
    }
    Expected<CalibratedView> view = ParseCamera(camera, name);
    if (!view) return Forward(view);
    calibration.views.push_back(std::move(*view));
  }
  return calibration;
}

}  // namespace mocurate
