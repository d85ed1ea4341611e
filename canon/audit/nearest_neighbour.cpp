#include "canon/audit/audit.h"

#include <limits>

#include "core/motion/operations.h"

namespace mocurate {
namespace {

constexpr int kFramesOfNeighbour = 32;  // that clips are resampled to

Eigen::VectorXd Descriptor(const Motion& motion) {
  const Motion sampled = ResampleToCount(motion, kFramesOfNeighbour);
  Eigen::Map<const Eigen::Matrix3Xd> points(sampled.joints.xyz.data(), 3,
                                            Eigen::Index{kFramesOfNeighbour} * sampled.joint_count());
  const Vector3d root = sampled.joints.at(0, 0);
  Eigen::Matrix3Xd centred = points.colwise() - root;
  const double extent = (centred.rowwise().maxCoeff() - centred.rowwise().minCoeff()).maxCoeff();
  if (extent > 0.0) centred /= extent;
  return Eigen::Map<const Eigen::VectorXd>(centred.data(), centred.size());
}

}  // namespace

NearestNeighbourResult NearestNeighbour(const Dataset& dataset, const Split& split) {
  std::vector<int> rows = split.train;
  rows.insert(rows.end(), split.validation.begin(), split.validation.end());
  std::vector<Eigen::VectorXd> known;
  for (const int row : rows) known.push_back(Descriptor(*dataset.clips[row].motion));
  NearestNeighbourResult result;
  for (const int row : split.test) {
    const Eigen::VectorXd query = Descriptor(*dataset.clips[row].motion);
    double best = std::numeric_limits<double>::infinity();
    int nearest = -1;
    for (std::size_t i = 0; i < known.size(); ++i) {
      const double distance = (known[i] - query).squaredNorm();
      if (distance < best) {
        best = distance;
        nearest = rows[i];
      }
    }
    if (nearest >= 0 && dataset.clips[nearest].label == dataset.clips[row].label) ++result.correct;
    ++result.count;
  }
  return result;
}

}  // namespace mocurate
