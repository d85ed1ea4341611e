#include "core/formats/ply.h"

#include <algorithm>
#include <utility>

#include "core/base/text.h"

namespace mocurate {

const PlyProperty* PlyElement::Find(std::string_view property) const {
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [&](const PlyProperty& candidate) { return candidate.name == property; });
  return found == properties.end() ? nullptr : &*found;
}

const PlyElement* Ply::Find(std::string_view element) const {
  const auto found = std::find_if(elements.begin(), elements.end(),
                                  [&](const PlyElement& candidate) { return candidate.name == element; });
  return found == elements.end() ? nullptr : &*found;
}

Expected<std::vector<Vector3d>> PlyPoints(const Ply& ply, const std::string& name) {
  const PlyElement* vertex = ply.Find("vertex");
  if (vertex == nullptr) return Fail(ErrorCode::kMalformed, "the file has no element 'vertex'", name);
  std::array<const PlyProperty*, 3> axes{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string axis(1, "xyz"[a]);
    axes[a] = vertex->Find(axis);
    if (axes[a] == nullptr || axes[a]->list_count) {
      return Fail(ErrorCode::kMalformed, "the element 'vertex' has no property '" + axis + "'", name);
    }
  }
  std::vector<Vector3d> points(vertex->count);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = Vector3d(axes[0]->values[i], axes[1]->values[i], axes[2]->values[i]);
  }
  return points;
}

Expected<std::vector<std::array<int, 3>>> PlyTriangles(const Ply& ply, const std::string& name) {
  std::vector<std::array<int, 3>> triangles;
  const PlyElement* face = ply.Find("face");
  if (face == nullptr || face->count == 0) return triangles;
  const PlyProperty* list = face->Find("vertex_indices");
  if (list == nullptr) list = face->Find("vertex_index");
  if (list == nullptr || !list->list_count || !list->type.is_integer()) {
    return Fail(ErrorCode::kMalformed, "the element 'face' has no list of whole numbers 'vertex_indices'", name);
  }
  const PlyElement* vertex = ply.Find("vertex");
  const double vertices = vertex == nullptr ? 0.0 : static_cast<double>(vertex->count);
  for (std::size_t i = 0; i < face->count; ++i) {
    const std::size_t begin = list->first[i];
    const std::size_t end = list->first[i + 1];
    const std::string where = name + ":face " + std::to_string(i) + "/" + list->name;
    if (end - begin < 3) return Fail(ErrorCode::kMalformed, "a face has at least 3 corners", where);
    for (std::size_t k = begin; k < end; ++k) {
      if (list->values[k] < 0.0 || list->values[k] >= vertices) {
        return Fail(
            ErrorCode::kInconsistent,
            "the file has no vertex " + FormatDouble(list->values[k]) + " (it has " + FormatDouble(vertices) + ")",
            where);
      }
    }
    for (std::size_t k = begin + 1; k + 1 < end; ++k) {
      triangles.push_back({static_cast<int>(list->values[begin]), static_cast<int>(list->values[k]),
                           static_cast<int>(list->values[k + 1])});
    }
  }
  return triangles;
}

}  // namespace mocurate
