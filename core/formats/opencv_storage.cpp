#include "core/formats/camera_files.h"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <initializer_list>
#include <iomanip>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <sstream>

#include "core/base/text.h"
#include "core/formats/json_place.h"
#include "core/formats/line_reader.h"
#include "core/formats/xml.h"

namespace mocurate {
namespace {

constexpr double kStoredRotationAgreement = 1e-4;  ///< radians between R_n and Rot_n
constexpr int kMaxStoredSide = 100'000;
/// Of a storage in YAML: thousands of cameras. yaml-cpp takes up to 250 bytes for each of its bytes.
constexpr std::size_t kMostYamlBytes = std::size_t{2} << 20;

/// 0: it is not declared.
std::size_t StoredExtent(std::string_view text) {
  const std::optional<long long> extent = ParseInteger(text);
  return extent && *extent > 0 && *extent <= kMaxStoredSide ? static_cast<std::size_t>(*extent) : 0;
}

/// Matrices, numbers and camera names of a storage.
struct OpenCvStorage {
  std::string file;
  std::map<std::string, std::vector<double>> numbers;
  std::vector<std::string> names;

  std::string Where(const std::string& key) const { return file + ":" + Shown(key); }

  Expected<std::vector<double>> Get(const std::string& key, std::size_t least, std::size_t most) const {
    const auto found = numbers.find(key);
    if (found == numbers.end()) return Fail(ErrorCode::kMalformed, "the matrix is missing", Where(key));
    if (found->second.size() >= least && found->second.size() <= most) return found->second;
    return Fail(ErrorCode::kMalformed,
                std::to_string(least) + " numbers are expected, not " + std::to_string(found->second.size()),
                Where(key));
  }

  /// `rows` and `columns` as the storage declares them.
  Status AddMatrix(const std::string& key, const std::vector<std::string>& words, std::string_view rows,
                   std::string_view columns) {
    std::vector<double>& values = numbers[key];
    for (const std::string& word : words) {
      const std::optional<double> value = ParseDouble(word);
      if (!value || !std::isfinite(*value)) {
        return Fail(ErrorCode::kMalformed, "'" + Shown(word) + "' is not a finite number", Where(key));
      }
      values.push_back(*value);
    }
    const std::size_t count = StoredExtent(rows) * StoredExtent(columns);
    // Elements of several channels have more numbers.
    if (count == 0 || values.size() % count == 0) return {};
    return Fail(ErrorCode::kInconsistent,
                std::string(rows) + " rows of " + std::string(columns) + ", " + std::to_string(count) +
                    " numbers, are announced; " + std::to_string(values.size()) + " are there",
                Where(key));
  }

  /// A number outside of a matrix; other texts are skipped.
  void AddText(const std::string& key, std::string_view text) {
    const std::optional<double> value = ParseDouble(text);
    if (value && std::isfinite(*value)) numbers[key] = {*value};
  }

  tl::unexpected<Error> NoData(const std::string& key) const {
    return Fail(ErrorCode::kMalformed, "the data are missing", Where(key), "is the file cut off?");
  }
};

/// Words between blanks; a word in quotes may hold blanks.
std::vector<std::string> StorageWords(const char* text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; stream >> std::quoted(word);) words.push_back(word);
  return words;
}

tl::unexpected<Error> DuplicateKey(const std::string& where) {
  return Fail(ErrorCode::kMalformed, "the key appears twice", where, "keep one of them");
}

using XmlFields = std::map<std::string, pugi::xml_node>;

Expected<XmlFields> XmlFieldsOf(const pugi::xml_node& element, const std::string& where) {
  XmlFields fields;
  for (const pugi::xml_node child : element) {
    if (!fields.emplace(child.name(), child).second) return DuplicateKey(where + ":" + Shown(child.name()));
  }
  return fields;
}

/// <KEY type_id="opencv-matrix"> with <rows>, <cols>, <dt>, <data>; <KEY>number</KEY>; <names>words</names>.
Expected<OpenCvStorage> ParseXmlStorage(const std::string& bytes, const std::string& name) {
  pugi::xml_document document;
  if (Status parsed = ParseXml(bytes, name, document); !parsed) return Forward(parsed);
  OpenCvStorage storage{name, {}, {}};
  const Expected<XmlFields> root = XmlFieldsOf(document.document_element(), name);
  if (!root) return Forward(root);
  for (const auto& [key, node] : *root) {
    if (key == "names") {
      storage.names = StorageWords(node.child_value());
    } else if (std::string_view(node.attribute("type_id").value()) != "opencv-matrix") {
      storage.AddText(key, Trim(node.child_value()));
    } else {
      Expected<XmlFields> fields = XmlFieldsOf(node, storage.Where(key));
      if (!fields) return Forward(fields);
      if (fields->count("data") == 0) return storage.NoData(key);
      Status added = storage.AddMatrix(key, StorageWords((*fields)["data"].child_value()),
                                       Trim((*fields)["rows"].child_value()), Trim((*fields)["cols"].child_value()));
      if (!added) return Forward(added);
    }
  }
  return storage;
}

using YamlFields = std::map<std::string, YAML::Node>;

Expected<YamlFields> YamlFieldsOf(const YAML::Node& mapping, const std::string& where) {
  YamlFields fields;
  for (const auto& item : mapping) {
    const std::string key = item.first.IsScalar() ? item.first.Scalar() : "";
    if (!fields.emplace(key, item.second).second) return DuplicateKey(where + ":" + Shown(key));
  }
  return fields;
}

/// Texts of a list, or a single one.
Expected<std::vector<std::string>> YamlTexts(const YAML::Node& node, const std::string& where) {
  if (node.IsScalar()) return std::vector<std::string>{node.Scalar()};
  std::vector<std::string> texts;
  bool listed = node.IsSequence();
  for (std::size_t i = 0; listed && i < node.size(); ++i) {
    listed = node[i].IsScalar();
    if (listed) texts.push_back(node[i].Scalar());
  }
  if (!listed) return Fail(ErrorCode::kMalformed, "a list of values is expected", where);
  return texts;
}

bool IsYamlMatrix(const YAML::Node& node) { return node.Tag() == "tag:yaml.org,2002:opencv-matrix"; }

/// !!opencv-matrix with rows, cols, dt, data.
Status AddYamlMatrix(const std::string& key, const YAML::Node& value, OpenCvStorage& storage) {
  Expected<YamlFields> fields = YamlFieldsOf(value, storage.Where(key));
  if (!fields) return Forward(fields);
  if (fields->count("data") == 0) return IsYamlMatrix(value) ? storage.NoData(key) : Status();
  const auto words = YamlTexts((*fields)["data"], storage.Where(key));
  if (!words) return Forward(words);
  const auto text = [&](const char* field) {
    return fields->count(field) > 0 && (*fields)[field].IsScalar() ? (*fields)[field].Scalar() : "";
  };
  return storage.AddMatrix(key, *words, text("rows"), text("cols"));
}

/// KEY: matrix; KEY: number; names as a list.
Status AddYaml(const YAML::Node& document, OpenCvStorage& storage) {
  if (!document.IsMap()) return {};
  const Expected<YamlFields> root = YamlFieldsOf(document, storage.file);
  if (!root) return Forward(root);
  for (const auto& [key, value] : *root) {
    // yaml-cpp reads text behind the last value as a key without one.
    if (value.IsNull() || (IsYamlMatrix(value) && !value.IsMap())) return storage.NoData(key);
    if (key == "names") {
      auto names = YamlTexts(value, storage.Where(key));
      if (!names) return Forward(names);
      storage.names = std::move(*names);
    } else if (value.IsScalar()) {
      storage.AddText(key, value.Scalar());
    } else if (value.IsMap()) {
      if (Status added = AddYamlMatrix(key, value, storage); !added) return added;
    }
  }
  return {};
}

Expected<OpenCvStorage> ParseYamlStorage(const std::string& bytes, const std::string& name) {
  if (bytes.size() > kMostYamlBytes) {
    return Fail(ErrorCode::kUnsupported,
                "the storage has " + std::to_string(bytes.size()) + " bytes, a calibration in YAML has at most " +
                    std::to_string(kMostYamlBytes),
                name, "save what is not of the cameras to another file, or all as XML");
  }
  if (Status text = CheckMarkup(bytes, name); !text) return Forward(text);
  // YAML::LoadAll may find documents without end.
  const std::size_t begin = bytes.find("\n---");
  if (begin != std::string::npos && bytes.find("\n---", begin + 1) != std::string::npos) {
    return Fail(ErrorCode::kMalformed, "one YAML document is expected", name);
  }
  OpenCvStorage storage{name, {}, {}};
  try {
    // yaml-cpp skips the line %YAML:1.0, which is not a directive of YAML.
    if (Status added = AddYaml(YAML::Load(bytes), storage); !added) return Forward(added);
  } catch (const YAML::Exception& error) {
    return Fail(ErrorCode::kMalformed, "the file is not YAML: " + error.msg,
                name + ":" + std::to_string(error.mark.line + 1) + ":" + std::to_string(error.mark.column + 1),
                "is the file cut off?");
  }
  return storage;
}

Status SetStoredPinhole(const OpenCvStorage& storage, const std::string& key, CalibratedView& view) {
  const auto matrix = storage.Get(key, 9, 9);
  if (!matrix) return Forward(matrix);
  const std::string fault = SetIntrinsics(*matrix, view);
  return fault.empty() ? Status() : Fail(ErrorCode::kMalformed, fault, storage.Where(key));
}

/// k1 k2 p1 p2, and k3 where there is one.
Status SetStoredDistortion(const OpenCvStorage& storage, const std::string& key, CalibratedView& view) {
  const auto k = storage.Get(key, 4, 5);
  if (!k) return Forward(k);
  view.distortion = {(*k)[0], (*k)[1], (*k)[2], (*k)[3], k->size() > 4 ? (*k)[4] : 0.0};
  return {};
}

Status SetStoredPose(const OpenCvStorage& storage, const std::string& matrix_key, const std::string& vector_key,
                     const std::string& t_key, CalibratedView& view) {
  const bool has_matrix = storage.numbers.count(matrix_key) > 0;
  const auto numbers = has_matrix ? storage.Get(matrix_key, 9, 9) : storage.Get(vector_key, 3, 3);
  if (!numbers) return Forward(numbers);
  if (has_matrix) {
    view.rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers->data());
    const std::string fault = RotationFault(view.rotation);
    if (!fault.empty()) return Fail(ErrorCode::kInconsistent, fault, storage.Where(matrix_key));
    if (vector_key != matrix_key && storage.numbers.count(vector_key) > 0) {
      const auto vector = storage.Get(vector_key, 3, 3);
      if (!vector) return Forward(vector);
      const Matrix3d other = ExpMatrix(Vector3d((*vector)[0], (*vector)[1], (*vector)[2]));
      const double angle = LogMatrix(NearestRotation(view.rotation).transpose() * other).norm();
      if (angle > kStoredRotationAgreement) {
        return Fail(ErrorCode::kInconsistent,
                    vector_key + " and " + matrix_key + " are " + FormatDouble(angle) + " rad apart", storage.file);
      }
    }
  } else {
    view.rotation = ExpMatrix(Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]));
  }
  const auto t = storage.Get(t_key, 3, 3);
  if (!t) return Forward(t);
  view.translation = Vector3d((*t)[0], (*t)[1], (*t)[2]);
  return {};
}

/// Error of a camera without a required field, naming it. `part`: a storage with some of it, or null.
tl::unexpected<Error> MissingField(const OpenCvStorage& part, const std::string& key, const std::string& what) {
  return Fail(
      ErrorCode::kMalformed, "the field is missing: " + what, part.Where(key),
      "a rig is two files in one folder: K_n and dist_n of each camera n of `names`, and R_n or Rot_n with T_n; "
      "a view is one file with intrinsic, R and t");
}

bool HoldsAny(const OpenCvStorage& storage, std::initializer_list<const char*> prefixes) {
  for (const auto& [key, numbers] : storage.numbers) {
    for (const char* prefix : prefixes) {
      if (key.rfind(prefix, 0) == 0) return true;
    }
  }
  return false;
}

/// Why storages are not a calibration: a part of one, with the missing field, or something else.
tl::unexpected<Error> StorageFault(const std::vector<OpenCvStorage>& storages, const OpenCvStorage* intrinsic,
                                   const OpenCvStorage* extrinsic) {
  for (const OpenCvStorage& storage : storages) {
    const bool of_rig = HoldsAny(storage, {"K_", "R_", "Rot_", "T_", "dist_"});
    if (of_rig && storage.names.empty()) return MissingField(storage, "names", "the cameras are not listed");
    const bool of_view = storage.numbers.count("R") > 0 || storage.numbers.count("t") > 0;
    if (of_view && !of_rig) return MissingField(storage, "intrinsic", "the view has a pose and no camera matrix");
  }
  if (intrinsic != nullptr && extrinsic == nullptr) {
    return MissingField(*intrinsic, "R_" + intrinsic->names[0], "the camera has intrinsics, but no pose");
  }
  if (extrinsic != nullptr && intrinsic == nullptr && HoldsAny(*extrinsic, {"R_", "Rot_", "T_"})) {
    return MissingField(*extrinsic, "K_" + extrinsic->names[0], "the camera has a pose, but no intrinsics");
  }
  return Fail(ErrorCode::kUnsupported, "the storage is not a calibration of a known format",
              storages.empty() ? "" : storages[0].file,
              "known are intri and extri with names, K_n, R_n, T_n in one folder, and views with intrinsic, R, t");
}

}  // namespace

Expected<Calibration> ParseOpenCvCalibration(const std::vector<std::pair<std::string, std::string>>& storages) {
  Calibration calibration;
  const OpenCvStorage* intrinsic = nullptr;
  const OpenCvStorage* extrinsic = nullptr;
  std::vector<OpenCvStorage> parsed;
  for (const auto& [name, bytes] : storages) {
    const std::string_view text = Trim(bytes);
    const bool yaml = text.substr(0, 5) == "%YAML";
    if (!yaml && text.substr(0, 1) != "<") {
      return Fail(ErrorCode::kMalformed, "the storage begins with neither %YAML:1.0 nor <?xml, as OpenCV requires",
                  name + ":1");
    }
    auto storage = yaml ? ParseYamlStorage(bytes, name) : ParseXmlStorage(bytes, name);
    if (!storage) return Forward(storage);
    parsed.push_back(std::move(*storage));
  }
  for (const OpenCvStorage& storage : parsed) {
    if (storage.numbers.count("intrinsic") > 0) {
      CalibratedView view;
      view.name = storage.file.substr(storage.file.rfind('/') == std::string::npos ? 0 : storage.file.rfind('/') + 1);
      if (Status set = SetStoredPinhole(storage, "intrinsic", view); !set) return Forward(set);
      if (Status set = SetStoredPose(storage, "R", "R", "t", view); !set) return Forward(set);
      calibration.dialect = "opencv_views";
      calibration.views.push_back(std::move(view));
    } else if (!storage.names.empty()) {
      (HoldsAny(storage, {"K_", "dist_"}) ? intrinsic : extrinsic) = &storage;
    }
  }
  if (!calibration.views.empty()) return calibration;
  if (intrinsic == nullptr || extrinsic == nullptr) return StorageFault(parsed, intrinsic, extrinsic);
  calibration.dialect = "opencv_rig";
  for (const std::string& name : extrinsic->names) {
    CalibratedView view;
    view.name = name;
    if (Status set = SetStoredPinhole(*intrinsic, "K_" + name, view); !set) return Forward(set);
    if (Status set = SetStoredDistortion(*intrinsic, "dist_" + name, view); !set) return Forward(set);
    if (Status set = SetStoredPose(*extrinsic, "Rot_" + name, "R_" + name, "T_" + name, view); !set)
      return Forward(set);
    for (const auto& [prefix, side] : {std::pair{"W_", &view.width}, {"H_", &view.height}}) {
      const std::string key = prefix + name;
      if (intrinsic->numbers.count(key) == 0) continue;
      const auto pixels = intrinsic->Get(key, 1, 1);
      if (!pixels) return Forward(pixels);
      const double size = pixels->front();
      if (size < 1 || size > kMaxStoredSide || size != std::floor(size)) {
        return Fail(ErrorCode::kMalformed, FormatDouble(size) + " is not a size in pixels", intrinsic->Where(key));
      }
      *side = static_cast<int>(size);
    }
    calibration.views.push_back(std::move(view));
  }
  return calibration;
}

}  // namespace mocurate
