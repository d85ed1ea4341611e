#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/formats/array_elements.h"
#include "core/geometry/rotation.h"

namespace mocurate {

/// Points of a cloud, or vertices of a mesh, in file units.
struct PointCloud {
  std::vector<Vector3d> points;
  std::vector<Vector3d> normals;  ///< (points) unit, of the file; none where a point has none
  std::size_t triangles = 0;
  std::size_t without_depth = 0;  ///< points at 0 0 0 of a file that has several: nothing was measured there; dropped
};

/// A PLY or a PCD file, by its first bytes. Errors of ParsePly, PlyPoints, PlyTriangles, ParsePcd and PcdPoints;
/// kUnsupported for another file.
Expected<PointCloud> ParsePointCloud(std::string_view bytes, const std::string& name);

/// Distances of the points from their middle, the median of each axis.
std::vector<double> DistancesFromMiddle(const std::vector<Vector3d>& points);

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

/// One field of a point cloud, `count` numbers per point. Colours packed into a float ("rgb", "rgba") are stored as the
/// whole number 0xRRGGBB: as floats they are denormal or, with an alpha, NaN; that alpha is dropped.
struct PcdField {
  std::string name;
  ElementType type = kFloat32;
  int count = 1;
  std::vector<double> values;  ///< (points * count), rounded to `type`; 0 where the file has nan, and at missing points

  bool PackedColour() const { return type == kFloat32 && (name == "rgb" || name == "rgba"); }
};

/// A PCD file of version 0.7 (0.6 without VIEWPOINT): a cloud, organised as an image when height > 1.
struct Pcd {
  enum class Encoding { kAscii, kBinary, kBinaryCompressed };
  Encoding encoding = Encoding::kAscii;
  int width = 0;
  int height = 1;
  std::array<double, 7> viewpoint{0, 0, 0, 1, 0, 0, 0};  ///< tx ty tz qw qx qy qz
  std::vector<PcdField> fields;
  std::vector<std::uint8_t> missing;  ///< (points); 1 where x, y or z is nan: nothing was measured

  std::size_t point_count() const { return missing.size(); }
  const PcdField* Find(std::string_view field) const;
};

/// ascii, binary (little-endian) and binary_compressed (LZF). Error kMalformed or kInconsistent with "name:line"
/// (header, ascii) or "name:point 12/x"; kUnsupported for 8-byte whole numbers and for coordinates
/// beyond kLargestCoordinate.
Expected<Pcd> ParsePcd(std::string_view bytes, const std::string& name);

/// Points measured, x y z in file units. Error kMalformed when these fields are missing.
Expected<std::vector<Vector3d>> PcdPoints(const Pcd& pcd, const std::string& name);

/// LZF blocks (Marc Lehmann's liblzf, as PCD files hold them). Empty when the block is damaged or does not give exactly
/// `size` bytes; nothing beyond what the block could give is allocated.
std::optional<std::string> UnpackLzf(std::string_view block, std::size_t size);

}  // namespace mocurate
