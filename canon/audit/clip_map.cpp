#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <limits>
#include <numeric>

#include "canon/audit/audit.h"
#include "core/base/random.h"

namespace mocurate {
namespace {

constexpr Eigen::Index kComponents = 24;  // in which neighbours are sought
constexpr int kIterations = 8;            // of the subspace
constexpr Eigen::Index kBlock = 512;      // of distances at once

/// Coordinates (K,N) in the principal components of columns (D,N), the largest first: subspace iteration (Halko et al.
/// 2011, algorithm 4.4). The largest number of each component is positive.
Eigen::MatrixXf PrincipalComponents(Eigen::MatrixXf columns) {
  const Eigen::Index count = std::min({kComponents, columns.cols() - 1, columns.rows()});
  columns.colwise() -= columns.rowwise().mean().eval();
  Random random(0, "audit.map");
  Eigen::MatrixXf drawn(columns.cols(), count);
  for (float& value : drawn.reshaped()) value = static_cast<float>(random.Normal());
  Eigen::MatrixXf basis = columns * drawn;
  for (int i = 0;; ++i) {
    basis = Eigen::HouseholderQR<Eigen::MatrixXf>(basis).householderQ() *
            Eigen::MatrixXf::Identity(basis.rows(), basis.cols());
    if (i == kIterations) break;
    basis = columns * (columns.transpose() * basis);
  }
  const Eigen::MatrixXf inside = basis.transpose() * columns;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> axes(inside * inside.transpose());
  Eigen::MatrixXf places = axes.eigenvectors().rowwise().reverse().transpose() * inside;
  for (Eigen::Index k = 0; k < places.rows(); ++k) {
    Eigen::Index at = 0;
    places.row(k).cwiseAbs().maxCoeff(&at);
    if (places(k, at) < 0.0F) places.row(k) *= -1.0F;
  }
  return places;
}

}  // namespace

ClipMap MapClips(const Dataset& dataset, std::size_t neighbours) {
  ClipMap map;
  Eigen::MatrixXf columns;
  for (std::size_t row = 0; row < dataset.clips.size(); ++row) {
    const Clip& clip = dataset.clips[row];
    if (!clip.motion || clip.motion->frame_count() < 2) continue;
    const Eigen::VectorXf one = LabelDescriptor(*clip.motion);
    if (!one.allFinite()) continue;
    if (columns.size() == 0) columns.resize(one.size(), static_cast<Eigen::Index>(dataset.clips.size() - row));
    columns.col(static_cast<Eigen::Index>(map.rows.size())) = one;
    map.rows.push_back(static_cast<int>(row));
  }
  const auto count = static_cast<Eigen::Index>(map.rows.size());
  if (count < 3) return ClipMap();
  columns.conservativeResize(Eigen::NoChange, count);
  const Eigen::MatrixXf places = PrincipalComponents(std::move(columns));
  std::vector<int> all(map.rows.size());
  std::iota(all.begin(), all.end(), 0);
  const Eigen::VectorXf squares = places.colwise().squaredNorm();
  for (Eigen::Index first = 0; first < count; first += kBlock) {
    const Eigen::Index width = std::min(kBlock, count - first);
    Eigen::MatrixXf apart = -2.0F * (places.transpose() * places.middleCols(first, width));
    apart.colwise() += squares;
    for (Eigen::Index i = 0; i < width; ++i) {
      apart(first + i, i) = std::numeric_limits<float>::infinity();  // itself
      std::vector<int> nearest(std::min(all.size() - 1, neighbours));
      std::partial_sort_copy(all.begin(), all.end(), nearest.begin(), nearest.end(),
                             [&](int a, int b) { return std::pair(apart(a, i), a) < std::pair(apart(b, i), b); });
      for (int& near : nearest) near = map.rows[static_cast<std::size_t>(near)];
      map.nearest.push_back(std::move(nearest));
      map.places.emplace_back(places(0, first + i), places.rows() > 1 ? places(1, first + i) : 0.0F);
    }
  }
  return map;
}

}  // namespace mocurate
