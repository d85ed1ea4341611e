#include "fitting/clouds/view_likeness.h"

#include <algorithm>
#include <cmath>

#include "fitting/clouds/depth_image.h"

namespace mocurate {
namespace {

constexpr double kAsDeep_m = 0.03;  ///< larger than noise and filters of a sensor at a person's distance

/// Negative when both images are empty.
double ImageSimilarity(const DepthImage& a, double a_m, const DepthImage& b, double b_m) {
  if (a.width != b.width || a.height != b.height) return 0.0;
  double seen = 0.0;
  double alike = 0.0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    if (a.values[i] == 0 && b.values[i] == 0) continue;
    seen += 1.0;
    const bool both = a.values[i] != 0 && b.values[i] != 0;
    alike += both && std::abs(a_m * a.values[i] - b_m * b.values[i]) < kAsDeep_m ? 1.0 : 0.0;
  }
  return seen > 0.0 ? alike / seen : -1.0;
}

}  // namespace

Expected<double> DepthSimilarity(const DepthView& a, const DepthView& b) {
  const std::size_t frames = std::min(a.files.size(), b.files.size());
  double least = -1.0;
  for (const std::size_t f : {std::size_t{0}, frames / 2, frames - 1}) {
    if (frames == 0 || a.files[f].empty() || b.files[f].empty()) continue;
    const Expected<DepthImage> one = ReadDepthImage(a.files[f]);
    if (!one) return Forward(one);
    const Expected<DepthImage> other = ReadDepthImage(b.files[f]);
    if (!other) return Forward(other);
    const double share = ImageSimilarity(*one, a.metres_per_unit, *other, b.metres_per_unit);
    if (share >= 0.0) least = least < 0.0 ? share : std::min(least, share);
  }
  return least;
}

}  // namespace mocurate
