#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/formats/array_elements.h"
#include "core/geometry/rotation.h"

namespace mocurate {

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
