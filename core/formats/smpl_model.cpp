#include "core/formats/smpl_model.h"

#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "core/formats/array_fields.h"
#include "core/formats/npz.h"
#include "core/formats/pickle.h"

namespace mocurate {
namespace {

constexpr std::size_t kMaxJoints = 1024;
constexpr std::size_t kMaxVertices = 1'000'000;
constexpr std::size_t kMaxRegressor = std::size_t{1} << 26;
constexpr double kRootOfUint32 = 4294967295.0;

/// The array of a key; empty when the file does not have it.
using Fields = std::function<Expected<std::optional<NpyArray>>(const char* key)>;

Expected<NpyArray> Dense(const SparseMatrix& matrix, const PickleRef& place) {
  if (matrix.rows > kMaxJoints || matrix.columns > kMaxVertices || matrix.rows * matrix.columns > kMaxRegressor) {
    return place.Bad("a matrix of " + std::to_string(matrix.rows) + " x " + std::to_string(matrix.columns) +
                     " exceeds the limits of joints x vertices");
  }
  NpyArray array = MakeArray({matrix.rows, matrix.columns}, std::vector<double>(matrix.rows * matrix.columns, 0.0));
  for (std::size_t i = 0; i < matrix.value.size(); ++i) {
    array.values[matrix.row[i] * matrix.columns + matrix.column[i]] += matrix.value[i];
  }
  return array;
}

/// Each array once: it is moved out of the archive.
Fields FieldsOf(Npz& npz) {
  return [&npz](const char* key) -> Expected<std::optional<NpyArray>> {
    for (NpzMember& member : npz.members) {
      if (member.name == key && npz.Find(key) != nullptr) return std::optional<NpyArray>(std::move(member.array));
    }
    return std::optional<NpyArray>();
  };
}

Fields FieldsOf(const Pickle& pickle) {
  return [&pickle](const char* key) -> Expected<std::optional<NpyArray>> {
    const std::optional<PickleRef> found = pickle.top().Find(key);
    if (!found || found->kind() == PickleKind::kNone) return std::nullopt;
    Expected<NpyArray> array;
    if (found->kind() == PickleKind::kSparse) {
      const Expected<SparseMatrix> sparse = found->Sparse();
      if (!sparse) return Forward(sparse);
      array = Dense(*sparse, *found);
    } else {
      array = found->Array();
    }
    if (!array) return Forward(array);
    return std::optional<NpyArray>(std::move(*array));
  };
}

class ModelReader {
 public:
  ModelReader(Fields fields, const std::string& name) : fields_(std::move(fields)), name_(name) {}

  Expected<SmplModel> Read() {
    if (Status s = Template(); !s) return Forward(s);
    if (Status s = Tree(); !s) return Forward(s);
    const std::size_t v = model_.vertices, j = model_.joints;
    if (Status s = Take("J_regressor", {j, v}, true, model_.joint_regressor); !s) return Forward(s);
    if (Status s = RowsSumToOne("J_regressor", model_.joint_regressor, v, -10.0); !s) return Forward(s);
    if (Status s = Take("weights", {v, j}, true, model_.weights); !s) return Forward(s);
    if (Status s = RowsSumToOne("weights", model_.weights, j, -1e-2); !s) return Forward(s);
    if (Status s = Take("shapedirs", {v, 3, kAnyExtent}, true, model_.shapedirs, &model_.shapes); !s) return Forward(s);
    if (Status s = Take("posedirs", {v, 3, 9 * (j - 1)}, false, model_.posedirs, &model_.pose_columns); !s) {
      return Forward(s);
    }
    if (Status s = Faces(); !s) return Forward(s);
    return std::move(model_);
  }

 private:
  std::string Where(const std::string& key) const { return name_ + ":" + key; }
  tl::unexpected<Error> Bad(const std::string& key, const std::string& what) const {
    return Fail(ErrorCode::kMalformed, what, Where(key));
  }

  Expected<NpyArray> Need(const char* key) {
    Expected<std::optional<NpyArray>> array = fields_(key);
    if (!array) return Forward(array);
    if (!*array) return Bad(key, "the array is missing: no body model of SMPL's family");
    return std::move(**array);
  }

  Status Take(const char* key, const std::vector<std::size_t>& shape, bool needed, std::vector<double>& values,
              std::size_t* last = nullptr) {
    Expected<std::optional<NpyArray>> array = fields_(key);
    if (!array) return Forward(array);
    if (!*array) return needed ? Status(Bad(key, "the array is missing")) : Status{};
    if (Status s = CheckField(**array, shape, Where(key)); !s) return s;
    if (last != nullptr) *last = (*array)->shape.back();
    values = std::move((*array)->values);
    return {};
  }

  Status Template() {
    Expected<NpyArray> array = Need("v_template");
    if (!array) return Forward(array);
    if (Status s = CheckField(*array, {kAnyExtent, 3}, Where("v_template")); !s) return s;
    model_.vertices = array->shape[0];
    if (model_.vertices == 0 || model_.vertices > kMaxVertices) {
      return Bad("v_template", std::to_string(model_.vertices) + " vertices");
    }
    model_.v_template = std::move(array->values);
    return {};
  }

  Status Tree() {
    const Expected<NpyArray> array = Need("kintree_table");
    if (!array) return Forward(array);
    const std::string where = Where("kintree_table");
    if (Status s = CheckField(*array, {2, kAnyExtent}, where); !s) return s;
    const std::size_t count = array->shape[1];
    if (count == 0 || count > kMaxJoints) return Bad("kintree_table", std::to_string(count) + " joints");
    model_.joints = count;
    // Row 0: parents, with the root's as -1 or the largest number of its type; row 1: the joints' own numbers.
    for (std::size_t j = 0; j < count; ++j) {
      const double parent = array->values[j], own = array->values[count + j];
      if (own != static_cast<double>(j)) {
        return Bad("kintree_table", "column " + std::to_string(j) + " is that of joint " + FormatDouble(own));
      }
      if (j == 0) {
        if (parent != -1.0 && parent < kRootOfUint32) return Bad("kintree_table", "the root has a parent");
        model_.parents.push_back(-1);
        continue;
      }
      if (!(parent >= 0.0 && parent < static_cast<double>(j) && parent == std::floor(parent))) {
        return Bad("kintree_table",
                   "the parent of joint " + std::to_string(j) + " is " + FormatDouble(parent) + ", no earlier joint");
      }
      model_.parents.push_back(static_cast<int>(parent));
    }
    return {};
  }

  Status RowsSumToOne(const char* key, const std::vector<double>& values, std::size_t columns, double least) {
    for (std::size_t row = 0; row * columns < values.size(); ++row) {
      double sum = 0.0;
      for (std::size_t c = 0; c < columns; ++c) {
        const double value = values[row * columns + c];
        if (value < least) return Bad(key, "row " + std::to_string(row) + " holds " + FormatDouble(value));
        sum += value;
      }
      if (std::abs(sum - 1.0) > 1e-2) {
        return Bad(key, "row " + std::to_string(row) + " sums to " + FormatDouble(sum) + ", not 1");
      }
    }
    return {};
  }

  Status Faces() {
    const Expected<NpyArray> array = Need("f");
    if (!array) return Forward(array);
    if (Status s = CheckField(*array, {kAnyExtent, 3}, Where("f")); !s) return s;
    // A closed surface has twice as many triangles as vertices (Euler).
    if (array->shape[0] > 2 * kMaxVertices) return Bad("f", std::to_string(array->shape[0]) + " triangles");
    const Expected<std::vector<std::int64_t>> corners =
        WholeNumbers(*array, 0, static_cast<std::int64_t>(model_.vertices) - 1, Where("f"));
    if (!corners) return Forward(corners);
    model_.faces.assign(corners->begin(), corners->end());
    return {};
  }

  Fields fields_;
  const std::string& name_;
  SmplModel model_;
};

}  // namespace

Expected<SmplModel> ParseSmplModel(std::string_view bytes, const std::string& name) {
  if (bytes.substr(0, 2) == "PK") {
    Expected<Npz> npz = ParseNpz(bytes, name);
    if (!npz) return Forward(npz);
    Expected<SmplModel> model = ModelReader(FieldsOf(*npz), name).Read();
    if (!model && !npz->unsafe.empty()) return tl::unexpected<Error>(npz->unsafe.front());
    return model;
  }
  const Expected<Pickle> pickle = ParsePickle(bytes, name);
  if (!pickle) return Forward(pickle);
  if (pickle->top().kind() != PickleKind::kDict) return pickle->top().Bad("a dictionary of arrays is expected");
  return ModelReader(FieldsOf(*pickle), name).Read();
}

}  // namespace mocurate
