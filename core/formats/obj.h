#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rotation.h"

namespace mocurate {

/// One corner of a face: indices from 0, -1 where the file gives none.
struct ObjCorner {
  int vertex = 0;
  int texture = -1;
  int normal = -1;
};

/// Wavefront OBJ: polygons. Groups, materials, lines and free-form surfaces are passed over.
struct Obj {
  std::vector<Vector3d> vertices;  ///< file units
  std::vector<int> vertex_lines;   ///< of the file, from 1; empty where none was read
  std::vector<Vector2d> textures;
  std::vector<Vector3d> normals;
  std::vector<std::vector<ObjCorner>> faces;
};

bool operator==(const ObjCorner& a, const ObjCorner& b);
bool operator==(const Obj& a, const Obj& b);  ///< but for the lines

/// Indices from 1, or negative: counted from the last one so far. A fourth number of a vertex (weight) and a colour are
/// checked and left. Error kMalformed "name:line" for anything else, also a word that is no keyword of the format, for
/// a coordinate beyond kLargestCoordinate, and for vertices without a face whose last line has no end: the file is cut
/// off.
Expected<Obj> ParseObj(std::string_view bytes, const std::string& name);
std::string WriteObj(const Obj& obj);

/// Faces cut into triangles (fans) of vertex indices.
std::vector<std::array<int, 3>> ObjTriangles(const Obj& obj);

}  // namespace mocurate
