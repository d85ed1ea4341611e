#include "core/quality/flat.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/geometry/rotation.h"

namespace mocurate {
namespace {

constexpr int kFewestFlatPoints = 5;
constexpr double kFlat = 1e-4;  // thickness over width; the flattest motionless body has 0.05

}  // namespace

std::vector<Finding> FindFlat(const TrackedPoints& points) {
  if (points.count() < kFewestFlatPoints || points.frames() < 2) return {};
  Vector3d sum = Vector3d::Zero();
  int seen = 0;
  for (int f = 0; f < points.frames(); ++f) {
    for (int k = 0; k < points.count(); ++k) {
      if (!points.sees(f, k)) continue;
      sum += points.at(f, k);
      ++seen;
    }
  }
  if (seen < kFewestFlatPoints) return {};
  const Vector3d middle = sum / seen;
  Matrix3d spread = Matrix3d::Zero();
  for (int f = 0; f < points.frames(); ++f) {
    for (int k = 0; k < points.count(); ++k) {
      if (!points.sees(f, k)) continue;
      const Vector3d away = points.at(f, k) - middle;
      spread += away * away.transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(spread);
  const Vector3d& squared = axes.eigenvalues();      // rising
  if (!(squared[1] > 1e-6 * squared[2])) return {};  // a line or a point: reported by other checks
  const double thickness = std::sqrt(std::max(0.0, squared[0]) / squared[2]);
  if (thickness >= kFlat) return {};
  const double value = thickness < 1e-7 ? 0.0 : thickness;  // what is left of rounding
  Finding finding =
      FrameFinding("flat_body", 0, 0, "", value,
                   "all joints of all frames lie in one plane (its thickness is " + Digits(value) +
                       " of its width): points of an image, or an axis that was not written; not positions "
                       "in space");
  finding.severity = Severity::kError;
  return {finding};
}

}  // namespace mocurate
