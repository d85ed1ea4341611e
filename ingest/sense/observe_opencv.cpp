#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>

#include "core/base/text.h"
#include "core/formats/json_place.h"
#include "ingest/sense/observe.h"

namespace mocurate {
namespace {

constexpr double kStoredRotationTolerance = 1e-3;
constexpr double kStoredRotationAgreement = 1e-4;  // radians between R_n and Rot_n, as a run asks

/// Matrices and names of a storage. Where OpenCV itself may be linked, ingest/sources/opencv_calibration.h reads them.
struct StorageText {
  std::string file;
  std::map<std::string, std::vector<double>> numbers;
  std::vector<std::string> names;

  Expected<std::vector<double>> Get(const std::string& key, std::size_t least, std::size_t most) const {
    const auto found = numbers.find(key);
    if (found == numbers.end()) return Fail(ErrorCode::kMalformed, "the matrix is missing", file + ":" + key);
    if (found->second.size() < least || found->second.size() > most) {
      return Fail(ErrorCode::kMalformed,
                  std::to_string(least) + " numbers are expected, not " + std::to_string(found->second.size()),
                  file + ":" + key);
    }
    return found->second;
  }
};

/// The numbers of a text, between blanks, commas and brackets; names are left as they stand.
std::vector<std::string> WordsIn(std::string_view text) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : text) {
    if (c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',' || c == '[' || c == ']' || c == '"' || c == '\'') {
      if (!word.empty()) words.push_back(std::move(word));
      word.clear();
    } else {
      word += c;
    }
  }
  if (!word.empty()) words.push_back(std::move(word));
  return words;
}

/// `rows` and `columns` as the storage says them; 0: it does not.
Status SetNumbers(std::string_view text, const std::string& key, std::size_t rows, std::size_t columns,
                  StorageText& storage) {
  std::vector<double>& values = storage.numbers[key];
  for (const std::string& word : WordsIn(text)) {
    const auto value = ParseDouble(word);
    if (!value || !std::isfinite(*value)) {
      return Fail(ErrorCode::kMalformed, "'" + word + "' is no finite number", storage.file + ":" + key);
    }
    values.push_back(*value);
  }
  // Elements of several channels have more numbers.
  if (rows * columns > 0 && values.size() % (rows * columns) != 0) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(rows) + " rows of " + std::to_string(columns) + ", " + std::to_string(rows * columns) +
                    " numbers, are announced; " + std::to_string(values.size()) + " stand there",
                storage.file + ":" + key);
  }
  return {};
}

/// <KEY type_id="opencv-matrix"> ... <data>numbers</data></KEY>, <names>words</names>.
Expected<StorageText> ParseStorageXml(const std::string& bytes, const std::string& name) {
  StorageText storage{name, {}, {}};
  const auto inside = [&](std::size_t from, const std::string& tag) -> std::optional<std::string_view> {
    const std::size_t begin = bytes.find("<" + tag + ">", from);
    const std::size_t end = bytes.find("</" + tag + ">", from);
    if (begin == std::string::npos || end == std::string::npos || end < begin) return std::nullopt;
    return std::string_view(bytes).substr(begin + tag.size() + 2, end - begin - tag.size() - 2);
  };
  constexpr std::string_view kMatrix = " type_id=\"opencv-matrix\"";
  for (std::size_t at = bytes.find(kMatrix); at != std::string::npos; at = bytes.find(kMatrix, at + 1)) {
    const std::size_t open = bytes.rfind('<', at);
    if (open == std::string::npos) continue;
    const std::string key = bytes.substr(open + 1, at - open - 1);
    const auto data = inside(at, "data");
    if (!data) return Fail(ErrorCode::kMalformed, "the matrix has no data", name + ":" + key, "is the file cut off?");
    const auto count = [&](const char* tag) -> std::size_t {
      const auto number = ParseInteger(Trim(inside(at, tag).value_or("")));
      return number && *number > 0 ? static_cast<std::size_t>(*number) : 0;
    };
    if (Status set = SetNumbers(*data, key, count("rows"), count("cols"), storage); !set) return Forward(set);
  }
  if (const auto names = inside(0, "names")) storage.names = WordsIn(*names);
  return storage;
}

/// "KEY: !!opencv-matrix" with "data: [...]" below, over several lines; "names:" as a list in either form.
Expected<StorageText> ParseStorageYaml(const std::string& bytes, const std::string& name) {
  StorageText storage{name, {}, {}};
  std::string key, list;
  std::size_t rows = 0, columns = 0;
  enum class In { kNothing, kNames, kData } in = In::kNothing;
  const auto finish = [&]() -> Status {
    if (in == In::kNames) storage.names = WordsIn(list);
    if (in == In::kData) {
      if (list.find(']') == std::string::npos)
        return Fail(ErrorCode::kMalformed, "the list of numbers has no end", name + ":" + key, "is the file cut off?");
      if (Status set = SetNumbers(list, key, rows, columns, storage); !set) return set;
    }
    in = In::kNothing;
    list.clear();
    return {};
  };
  for (const std::string_view line : SplitText(bytes, '\n')) {
    const std::string_view text = Trim(line);
    const std::size_t colon = text.find(':');
    const bool data = text.substr(0, 5) == "data:";
    const bool top = !line.empty() && line[0] != ' ' && line[0] != '-' && line[0] != '%' && colon != std::string::npos;
    if (top || data) {
      if (Status done = finish(); !done) return Forward(done);
    }
    if (top) {
      key = std::string(text.substr(0, colon));
      in = key == "names" ? In::kNames : In::kNothing;
      rows = columns = 0;
      const std::string value(Trim(text.substr(colon + 1)));
      if (in == In::kNames) list = value;
      if (const auto number = ParseDouble(value)) storage.numbers[key] = {*number};
    } else if (data) {
      in = In::kData;
      list = std::string(text.substr(5));
    } else if (in == In::kNothing && (text.substr(0, 5) == "rows:" || text.substr(0, 5) == "cols:")) {
      const auto number = ParseInteger(Trim(text.substr(5)));
      (text[0] == 'r' ? rows : columns) = number && *number > 0 ? static_cast<std::size_t>(*number) : 0;
    } else if (in == In::kNames && text.substr(0, 1) == "-") {
      list += " " + std::string(text.substr(1));
    } else if (in == In::kData) {
      list += " " + std::string(text);
    }
  }
  if (Status done = finish(); !done) return Forward(done);
  return storage;
}

Status SetPinhole(const StorageText& storage, const std::string& key, CalibratedView& view) {
  const auto matrix = storage.Get(key, 9, 9);
  if (!matrix) return Forward(matrix);
  const std::string fault = SetIntrinsics(*matrix, view);
  return fault.empty() ? Status() : Fail(ErrorCode::kMalformed, fault, storage.file + ":" + key);
}

/// k1 k2 p1 p2, and k3 where there is one.
Status SetDistortion(const StorageText& storage, const std::string& key, CalibratedView& view) {
  const auto k = storage.Get(key, 4, 5);
  if (!k) return Forward(k);
  view.distortion = {(*k)[0], (*k)[1], (*k)[2], (*k)[3], k->size() > 4 ? (*k)[4] : 0.0};
  return {};
}

Status SetPose(const StorageText& storage, const std::string& matrix_key, const std::string& vector_key,
               const std::string& t_key, CalibratedView& view) {
  const bool has_matrix = storage.numbers.count(matrix_key) > 0;
  const auto numbers = has_matrix ? storage.Get(matrix_key, 9, 9) : storage.Get(vector_key, 3, 3);
  if (!numbers) return Forward(numbers);
  if (has_matrix) {
    view.rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers->data());
    const std::string fault = RotationFault(view.rotation, kStoredRotationTolerance);
    if (!fault.empty()) return Fail(ErrorCode::kInconsistent, fault, storage.file + ":" + matrix_key);
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

/// Half a camera is told by the field that is not there. `part`: a storage with some of it, or null.
tl::unexpected<Error> Missing(const StorageText& part, const std::string& key, const std::string& what) {
  return Fail(
      ErrorCode::kMalformed, "the field is missing: " + what, part.file + ":" + key,
      "a rig is two files in one folder: K_n and dist_n of each camera n of `names`, and R_n or Rot_n with T_n; "
      "a view is one file with intrinsic, R and t");
}

bool HoldsAny(const StorageText& storage, std::initializer_list<const char*> prefixes) {
  for (const auto& [key, numbers] : storage.numbers) {
    for (const char* prefix : prefixes) {
      if (key.rfind(prefix, 0) == 0) return true;
    }
  }
  return false;
}

/// Why storages are no calibration: a part of one, with the field that it lacks, or something else.
tl::unexpected<Error> Fault(const std::vector<StorageText>& storages, const StorageText* intrinsic,
                            const StorageText* extrinsic) {
  for (const StorageText& storage : storages) {
    const bool of_rig = HoldsAny(storage, {"K_", "R_", "Rot_", "T_", "dist_"});
    if (of_rig && storage.names.empty()) return Missing(storage, "names", "the cameras are not listed");
    const bool of_view = storage.numbers.count("R") > 0 || storage.numbers.count("t") > 0;
    if (of_view && !of_rig) return Missing(storage, "intrinsic", "the view has a pose and no camera matrix");
  }
  if (intrinsic != nullptr && extrinsic == nullptr) {
    return Missing(*intrinsic, "R_" + intrinsic->names[0], "half a camera, intrinsics without a pose");
  }
  if (extrinsic != nullptr && intrinsic == nullptr && HoldsAny(*extrinsic, {"R_", "Rot_", "T_"})) {
    return Missing(*extrinsic, "K_" + extrinsic->names[0], "half a camera, a pose without intrinsics");
  }
  return Fail(ErrorCode::kUnsupported, "the storage is no calibration of a known kind",
              storages.empty() ? "" : storages[0].file,
              "known are intri and extri with names, K_n, R_n, T_n in one folder, and views with intrinsic, R, t");
}

}  // namespace

Expected<Calibration> ObserveOpenCv(const std::vector<std::pair<std::string, std::string>>& storages) {
  Calibration calibration;
  const StorageText* intrinsic = nullptr;
  const StorageText* extrinsic = nullptr;
  std::vector<StorageText> parsed;
  for (const auto& [name, bytes] : storages) {
    const std::string_view text = Trim(bytes);
    const bool yaml = text.substr(0, 5) == "%YAML";
    if (!yaml && text.substr(0, 1) != "<") {
      return Fail(ErrorCode::kMalformed, "the storage begins with neither %YAML:1.0 nor <?xml, as OpenCV asks",
                  name + ":1");
    }
    auto storage = yaml ? ParseStorageYaml(bytes, name) : ParseStorageXml(bytes, name);
    if (!storage) return Forward(storage);
    parsed.push_back(std::move(*storage));
  }
  for (const StorageText& storage : parsed) {
    if (storage.numbers.count("intrinsic") > 0) {
      CalibratedView view;
      view.name = storage.file.substr(storage.file.rfind('/') == std::string::npos ? 0 : storage.file.rfind('/') + 1);
      if (Status set = SetPinhole(storage, "intrinsic", view); !set) return Forward(set);
      if (Status set = SetPose(storage, "R", "R", "t", view); !set) return Forward(set);
      calibration.dialect = "opencv_views";
      calibration.views.push_back(std::move(view));
    } else if (!storage.names.empty()) {
      (HoldsAny(storage, {"K_", "dist_"}) ? intrinsic : extrinsic) = &storage;
    }
  }
  if (!calibration.views.empty()) return calibration;
  if (intrinsic == nullptr || extrinsic == nullptr) return Fault(parsed, intrinsic, extrinsic);
  calibration.dialect = "opencv_rig";
  for (const std::string& name : extrinsic->names) {
    CalibratedView view;
    view.name = name;
    if (Status set = SetPinhole(*intrinsic, "K_" + name, view); !set) return Forward(set);
    if (Status set = SetDistortion(*intrinsic, "dist_" + name, view); !set) return Forward(set);
    if (Status set = SetPose(*extrinsic, "Rot_" + name, "R_" + name, "T_" + name, view); !set) return Forward(set);
    for (const auto& [key, side] : {std::pair{"W_", &view.width}, {"H_", &view.height}}) {
      const auto size = intrinsic->numbers.find(key + name);
      if (size != intrinsic->numbers.end() && size->second.size() == 1) *side = static_cast<int>(size->second[0]);
    }
    calibration.views.push_back(std::move(view));
  }
  return calibration;
}

}  // namespace mocurate
