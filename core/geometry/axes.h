#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"
#include "core/geometry/rotation.h"

namespace mocurate {

enum class Handedness { kRight, kLeft };

/// How a source lays its axes: where its +x, +y and +z point, in the words of the canonical world (right-handed, y up,
/// canonical facing +z, the person's left at +x). Written as three signed canonical axes, e.g. "+x +y +z" (ours),
/// "+x -y -z" (camera with y down), "-x +y +z" (left-handed, mirrored in x), "+x -z +y" (z up, right-handed: its y
/// points backwards).
struct AxisConvention {
  /// Columns: canonical direction of the source's x, y, z axes. Signed permutation; determinant +1 or -1.
  Matrix3d canonical_from_source = Matrix3d::Identity();

  Handedness handedness() const;
  std::string Text() const;

  /// Error kConfig for anything but a signed permutation.
  static Expected<AxisConvention> Parse(std::string_view text);
};

bool operator==(const AxisConvention& a, const AxisConvention& b);

}  // namespace mocurate
