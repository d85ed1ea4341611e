#include "eval/metrics/kernel_distance.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace mocurate {
namespace {

/// `size` different rows, drawn by the first steps of a Fisher-Yates shuffle.
Features DrawRows(const Features& features, Eigen::Index size, Random& random) {
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(features.rows()));
  std::iota(rows.begin(), rows.end(), Eigen::Index{0});
  Features drawn(size, features.cols());
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto left = static_cast<std::uint64_t>(features.rows() - i);
    std::swap(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(i) + random.Below(left)]);
    drawn.row(i) = features.row(rows[static_cast<std::size_t>(i)]);
  }
  return drawn;
}

/// (x.y / D + 1)^3 of all pairs.
Eigen::ArrayXXd Kernel(const Features& a, const Features& b) {
  return ((a * b.transpose()).array() / static_cast<double>(a.cols()) + 1.0).cube();
}

}  // namespace

Expected<double> KernelDistance(const Features& a, const Features& b, int subsets, int size, Random& random) {
  const Eigen::Index n = std::min({static_cast<Eigen::Index>(size), a.rows(), b.rows()});
  if (n < 2 || a.cols() != b.cols()) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(a.rows()) + " and " + std::to_string(b.rows()) + " motions of " +
                    std::to_string(a.cols()) + " and " + std::to_string(b.cols()) + " features",
                "KID", "use two motions or more in each set, of one extractor");
  }
  const bool whole = n == a.rows() && n == b.rows();
  const int count = whole ? 1 : subsets;
  double sum = 0.0;
  for (int s = 0; s < count; ++s) {
    const Features x = whole ? a : DrawRows(a, n, random), y = whole ? b : DrawRows(b, n, random);
    const Eigen::ArrayXXd xx = Kernel(x, x), yy = Kernel(y, y);
    const double own = xx.sum() - xx.matrix().trace() + yy.sum() - yy.matrix().trace();
    sum += own / static_cast<double>(n * (n - 1)) - 2.0 * Kernel(x, y).mean();
  }
  return sum / count;
}

}  // namespace mocurate
