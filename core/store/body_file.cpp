#include "core/store/body_file.h"

#include <cmath>

#include "core/store/hdf5_file.h"

namespace mocurate {
namespace {

using store::Array;
using store::FieldType;
using store::Hdf5Reader;

/// Reads fields of known shapes; a 0 in a shape means any length.
class Fields {
 public:
  explicit Fields(const Hdf5Reader& reader) : reader_(reader) {}

  template <class T>
  Expected<Array> Read(const std::string& path, FieldType type, const std::vector<std::uint64_t>& shape) const {
    Expected<Array> array = reader_.Read(path, type);
    if (!array) return array;
    bool fits = array->shape.size() == shape.size();
    for (std::size_t i = 0; fits && i < shape.size(); ++i) fits = shape[i] == 0 || array->shape[i] == shape[i];
    if (!fits) {
      return Fail(ErrorCode::kMalformed, "the shape " + array->ShapeText() + " is not the one expected",
                  store::Where(reader_.file(), path));
    }
    if constexpr (std::is_floating_point_v<T>) {
      for (const T value : array->as<T>()) {
        if (!std::isfinite(value)) {
          return Fail(ErrorCode::kMalformed, "a value is not finite", store::Where(reader_.file(), path));
        }
      }
    }
    return array;
  }

  /// (count, 3)
  Expected<std::vector<Vector3d>> Points(const std::string& path, std::uint64_t count) const {
    const Expected<Array> array = Read<float>(path, FieldType::kFloat32, {count, 3});
    if (!array) return Forward(array);
    return ToPoints(array->as<float>(), 0, array->rows());
  }

  static std::vector<Vector3d> ToPoints(const std::vector<float>& values, std::size_t first, std::size_t count) {
    std::vector<Vector3d> points;
    for (std::size_t i = first; i < first + count; ++i) {
      points.emplace_back(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
    }
    return points;
  }

  const Hdf5Reader& reader_;
};

Status ReadRig(const Fields& fields, BodyTemplate& body) {
  const auto parents = fields.Read<int>("/parents", FieldType::kInt32, {0});
  if (!parents) return Forward(parents);
  body.parents.assign(parents->as<std::int32_t>().begin(), parents->as<std::int32_t>().end());
  const std::uint64_t joints = body.parents.size();
  const auto names = fields.Read<std::string>("/joint_names", FieldType::kText, {joints});
  if (!names) return Forward(names);
  body.joint_names = names->as<std::string>();
  auto vertices = fields.Points("/v_template", 0);
  if (!vertices) return Forward(vertices);
  body.rest.vertices = std::move(*vertices);
  auto positions = fields.Points("/J_template", joints);
  if (!positions) return Forward(positions);
  body.rest.joints = std::move(*positions);
  const auto faces = fields.Read<int>("/faces", FieldType::kInt32, {0, 3});
  if (!faces) return Forward(faces);
  const auto& corners = faces->as<std::int32_t>();
  for (std::size_t f = 0; f < faces->rows(); ++f) {
    body.faces.push_back({corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]});
  }
  const std::uint64_t count = body.rest.vertices.size();
  const auto indices = fields.Read<int>("/weights_idx4", FieldType::kInt32, {count, 4});
  if (!indices) return Forward(indices);
  const auto values = fields.Read<float>("/weights_val4", FieldType::kFloat32, {count, 4});
  if (!values) return Forward(values);
  for (std::size_t v = 0; v < count; ++v) {
    std::array<int, 4> joint{};
    std::array<double, 4> weight{};
    for (std::size_t k = 0; k < 4; ++k) {
      joint[k] = indices->as<std::int32_t>()[4 * v + k];
      weight[k] = values->as<float>()[4 * v + k];
    }
    body.weight_joints.push_back(joint);
    body.weights.push_back(weight);
  }
  return {};
}

Status ReadShapes(const Fields& fields, BodyTemplate& body) {
  const std::uint64_t vertices = body.rest.vertices.size();
  const std::uint64_t joints = body.rest.joints.size();
  const auto names = fields.Read<std::string>("/shape_names", FieldType::kText, {0});
  if (!names) return Forward(names);
  body.shape_names = names->as<std::string>();
  const std::uint64_t shapes = body.shape_names.size();
  const auto skin = fields.Read<float>("/shapedirs", FieldType::kFloat32, {shapes, vertices, 3});
  if (!skin) return Forward(skin);
  const auto bones = fields.Read<float>("/J_shapedirs", FieldType::kFloat32, {shapes, joints, 3});
  if (!bones) return Forward(bones);
  for (std::size_t s = 0; s < shapes; ++s) {
    body.shape_directions.push_back({Fields::ToPoints(skin->as<float>(), s * vertices, vertices),
                                     Fields::ToPoints(bones->as<float>(), s * joints, joints)});
  }
  for (const std::string& name : fields.reader_.GroupsBelow("/variants")) {
    const std::string folder = "/variants/" + name;
    auto variant_skin = fields.Points(folder + "/vertices_tpose", vertices);
    if (!variant_skin) return Forward(variant_skin);
    auto variant_joints = fields.Points(folder + "/joints_tpose", joints);
    if (!variant_joints) return Forward(variant_joints);
    body.variants[name] = {std::move(*variant_skin), std::move(*variant_joints)};
  }
  return {};
}

}  // namespace

Expected<BodyTemplate> ReadBodyTemplate(const std::filesystem::path& file) {
  const Expected<Hdf5Reader> reader = Hdf5Reader::Open(file);
  if (!reader) return Forward(reader);
  const Fields fields(*reader);
  BodyTemplate body;
  if (Status status = ReadRig(fields, body); !status) return Forward(status);
  if (Status status = ReadShapes(fields, body); !status) return Forward(status);
  if (Status status = body.Check(); !status) {
    Error error = status.error();
    error.where = store::Where(file, "/" + error.where);
    return tl::unexpected<Error>(std::move(error));
  }
  return body;
}

}  // namespace mocurate
