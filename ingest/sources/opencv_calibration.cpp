#include "ingest/sources/opencv_calibration.h"

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "core/base/text.h"
#include "core/formats/json_place.h"

namespace mocurate {
namespace {

constexpr double kRotationTolerance = 1e-3;
constexpr double kRotationAgreement = 1e-4;  ///< radians between R_n and Rot_n; files print 6 decimals

/// A file in memory. OpenCV throws on what it cannot parse.
class Storage {
 public:
  static Expected<Storage> Open(const std::string& bytes, const std::string& name) {
    if (Trim(bytes).empty()) return EmptyFile(name);
    if (bytes.find('\0') != std::string::npos) return Fail(ErrorCode::kMalformed, "the file is no text", name);
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    Storage storage;
    storage.name_ = name;
    try {
      const bool opened = storage.file_.open(bytes, cv::FileStorage::READ | cv::FileStorage::MEMORY);
      if (opened && storage.file_.root().isMap()) return storage;
    } catch (const std::exception&) {
      // Told below.
    }
    return Fail(ErrorCode::kMalformed, "the file is no OpenCV storage (YAML or XML)", name, "is the file cut off?");
  }

  bool Has(const std::string& key) const { return !file_[key].empty(); }

  /// Row-major; of rows x columns, or, with columns 0, of any shape with at least `rows` numbers.
  Expected<std::vector<double>> Matrix(const std::string& key, int rows, int columns) const {
    const std::string where = name_ + ":" + key;
    if (!Has(key)) return Fail(ErrorCode::kMalformed, "the matrix is missing", where);
    std::vector<double> values;
    try {
      cv::Mat stored;
      file_[key] >> stored;
      const bool fits =
          columns == 0 ? static_cast<int>(stored.total()) >= rows : stored.rows == rows && stored.cols == columns;
      if (stored.dims != 2 || stored.channels() != 1 || !fits) {
        return Fail(ErrorCode::kMalformed,
                    "a matrix of " + std::to_string(rows) + " x " + std::to_string(std::max(columns, 1)) +
                        " numbers is expected, not " + std::to_string(stored.rows) + " x " +
                        std::to_string(stored.cols),
                    where);
      }
      cv::Mat numbers;
      stored.convertTo(numbers, CV_64F);
      values.assign(numbers.begin<double>(), numbers.end<double>());
    } catch (const std::exception&) {
      return Fail(ErrorCode::kMalformed, "the matrix cannot be read", where);
    }
    for (const double value : values) {
      if (!std::isfinite(value)) return Fail(ErrorCode::kMalformed, "a number is not finite", where);
    }
    return values;
  }

  Expected<std::vector<std::string>> Names() const {
    std::vector<std::string> names;
    const cv::FileNode list = file_["names"];
    const std::string where = name_ + ":names";
    if (!list.isSeq() || list.size() == 0) return Fail(ErrorCode::kMalformed, "a list of cameras is expected", where);
    for (const cv::FileNode node : list) {
      // Numbers without quotes are names as well.
      if (node.isInt()) {
        names.push_back(std::to_string(static_cast<int>(node)));
      } else if (node.isString()) {
        names.push_back(node.string());
      } else {
        return Fail(ErrorCode::kMalformed, "a name is expected", where + "/" + std::to_string(names.size()));
      }
    }
    return names;
  }

  /// A side of the image, 0 when the file does not say.
  Expected<int> Side(const std::string& key) const {
    if (!Has(key)) return 0;
    const cv::FileNode node = file_[key];
    const double value = node.isReal() || node.isInt() ? static_cast<double>(node) : 0.0;
    if (value >= 1.0 && value <= 100'000.0 && value == std::floor(value)) return static_cast<int>(value);
    return Fail(ErrorCode::kMalformed, "a size in pixels is expected", name_ + ":" + key);
  }

  const std::string& name() const { return name_; }

 private:
  cv::FileStorage file_;
  std::string name_;
};

Status SetIntrinsicsOf(const Storage& storage, const std::string& key, CalibratedView& view) {
  const Expected<std::vector<double>> matrix = storage.Matrix(key, 3, 3);
  if (!matrix) return Forward(matrix);
  const std::string fault = SetIntrinsics(*matrix, view);
  return fault.empty() ? Status() : Fail(ErrorCode::kMalformed, fault, storage.name() + ":" + key);
}

Expected<Matrix3d> RotationOf(const Storage& storage, const std::string& key) {
  const Expected<std::vector<double>> numbers = storage.Matrix(key, 3, 3);
  if (!numbers) return Forward(numbers);
  const Matrix3d matrix(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers->data()));
  const std::string fault = RotationFault(matrix, kRotationTolerance);
  if (!fault.empty()) return Fail(ErrorCode::kInconsistent, fault, storage.name() + ":" + key);
  return matrix;
}

Status SetTranslation(const Storage& storage, const std::string& key, CalibratedView& view) {
  const Expected<std::vector<double>> t = storage.Matrix(key, 3, 0);
  if (!t) return Forward(t);
  if (t->size() != 3) return Fail(ErrorCode::kMalformed, "3 numbers are expected", storage.name() + ":" + key);
  view.translation = Vector3d((*t)[0], (*t)[1], (*t)[2]);
  return {};
}

Status SetRotation(const Storage& storage, const std::string& camera, CalibratedView& view) {
  const std::string vector_key = "R_" + camera;
  const std::string matrix_key = "Rot_" + camera;
  const bool has_matrix = storage.Has(matrix_key);
  if (storage.Has(vector_key) || !has_matrix) {
    const Expected<std::vector<double>> numbers = storage.Matrix(vector_key, 3, 0);
    if (!numbers) return Forward(numbers);
    if (numbers->size() != 3)
      return Fail(ErrorCode::kMalformed, "3 numbers are expected", storage.name() + ":" + vector_key);
    view.rotation = ExpMatrix(Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]));
    if (!has_matrix) return {};
  }
  const Expected<Matrix3d> matrix = RotationOf(storage, matrix_key);
  if (!matrix) return Forward(matrix);
  if (storage.Has(vector_key)) {
    const double angle = LogMatrix(NearestRotation(*matrix).transpose() * view.rotation).norm();
    if (angle > kRotationAgreement) {
      return Fail(ErrorCode::kInconsistent,
                  vector_key + " and " + matrix_key + " are " + FormatDouble(angle) + " rad apart", storage.name());
    }
  }
  view.rotation = *matrix;
  return {};
}

Status SetCamera(const Storage& intrinsic, const Storage& extrinsic, CalibratedView& view) {
  if (Status status = SetIntrinsicsOf(intrinsic, "K_" + view.name, view); !status) return status;
  const Expected<std::vector<double>> k = intrinsic.Matrix("dist_" + view.name, 4, 0);
  if (!k) return Forward(k);
  if (k->size() > 5)
    return Fail(ErrorCode::kUnsupported, "4 or 5 numbers are expected", intrinsic.name() + ":dist_" + view.name);
  view.distortion = {(*k)[0], (*k)[1], (*k)[2], (*k)[3], k->size() > 4 ? (*k)[4] : 0.0};
  for (const auto& [key, side] : {std::pair{"W_", &view.width}, {"H_", &view.height}}) {
    const Expected<int> pixels = intrinsic.Side(key + view.name);
    if (!pixels) return Forward(pixels);
    *side = *pixels;
  }
  if (Status status = SetRotation(extrinsic, view.name, view); !status) return status;
  return SetTranslation(extrinsic, "T_" + view.name, view);
}

}  // namespace

Expected<Calibration> ReadOpenCvRig(const std::string& intrinsic_bytes, const std::string& extrinsic_bytes,
                                    const std::string& intrinsic_name, const std::string& extrinsic_name) {
  const Expected<Storage> intrinsic = Storage::Open(intrinsic_bytes, intrinsic_name);
  if (!intrinsic) return Forward(intrinsic);
  const Expected<Storage> extrinsic = Storage::Open(extrinsic_bytes, extrinsic_name);
  if (!extrinsic) return Forward(extrinsic);
  const Expected<std::vector<std::string>> names = extrinsic->Names();
  if (!names) return Forward(names);
  Calibration calibration;
  calibration.dialect = "opencv_rig";
  for (const std::string& name : *names) {
    CalibratedView view;
    view.name = name;
    if (Status status = SetCamera(*intrinsic, *extrinsic, view); !status) return Forward(status);
    calibration.views.push_back(std::move(view));
  }
  return calibration;
}

Expected<CalibratedView> ReadOpenCvView(const std::string& bytes, const std::string& name) {
  const Expected<Storage> storage = Storage::Open(bytes, name);
  if (!storage) return Forward(storage);
  CalibratedView view;
  if (Status status = SetIntrinsicsOf(*storage, "intrinsic", view); !status) return Forward(status);
  const Expected<Matrix3d> rotation = RotationOf(*storage, "R");
  if (!rotation) return Forward(rotation);
  view.rotation = *rotation;
  if (Status status = SetTranslation(*storage, "t", view); !status) return Forward(status);
  return view;
}

}  // namespace mocurate
