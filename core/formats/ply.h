#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/formats/array_elements.h"
#include "core/geometry/rotation.h"

namespace mocurate {

/// One property of a PLY element. A scalar has one value per item; a list has values[first[i]..first[i + 1]) for item
/// i.
struct PlyProperty {
  std::string name;
  ElementType type = kFloat32;
  std::optional<ElementType> list_count;  ///< set: a list, with counts of this type
  std::vector<double> values;             ///< rounded to `type`
  std::vector<std::size_t> first;         ///< lists only, (items + 1)
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  const PlyProperty* Find(std::string_view property) const;
};

/// A PLY file (Stanford polygon format 1.0): elements with properties of any name.
struct Ply {
  enum class Encoding { kAscii, kBinaryLittleEndian, kBinaryBigEndian };
  Encoding encoding = Encoding::kAscii;
  std::vector<std::string> comments;  ///< text after "comment "
  std::vector<PlyElement> elements;

  const PlyElement* Find(std::string_view element) const;
};

/// Error kMalformed with "name:line" (header, ASCII) or "name:vertex 12/x" (binary) for anything that is not the
/// format, is cut off or has bytes left over; values that are not finite are refused,
/// and coordinates of vertices beyond kLargestCoordinate.
Expected<Ply> ParsePly(std::string_view bytes, const std::string& name);

/// Vertices x y z in file units. Error kMalformed when there is no vertex element with them.
Expected<std::vector<Vector3d>> PlyPoints(const Ply& ply, const std::string& name);
/// Faces cut into triangles (fans), checked against the number of vertices; none when there is no face element.
Expected<std::vector<std::array<int, 3>>> PlyTriangles(const Ply& ply, const std::string& name);

}  // namespace mocurate
