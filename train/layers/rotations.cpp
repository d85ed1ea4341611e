#include "train/layers/rotations.h"

#include "core/geometry/rotation.h"

namespace mocurate {
namespace {

using torch::Tensor;

constexpr double kSmallestNorm = 1e-12;  // as the released code

Tensor Unit(const Tensor& v) { return v / v.norm(2, -1, true).clamp_min(kSmallestNorm); }

/// Rows of a matrix.
Tensor OfRows(const Tensor& first, const Tensor& second) {
  const Tensor a = Unit(first);
  const Tensor b = Unit(second - (a * second).sum(-1, true) * a);
  return torch::stack({a, b, torch::cross(a, b, -1)}, -2);
}

Tensor OfQuaternion(const Tensor& q) {
  const Tensor s = 2.0 / q.square().sum(-1);
  const Tensor w = q.select(-1, 0), x = q.select(-1, 1), y = q.select(-1, 2), z = q.select(-1, 3);
  const Tensor rows = torch::stack(
      {1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w), s * (x * y + z * w), 1 - s * (x * x + z * z),
       s * (y * z - x * w), s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)},
      -1);
  std::vector<std::int64_t> shape = q.sizes().vec();
  shape.back() = 3;
  shape.push_back(3);
  return rows.view(shape);
}

Tensor OfRotationVector(const Tensor& v) {
  constexpr double kSmall = 1e-6;
  const Tensor square = v.square().sum(-1, true);
  const Tensor small = square < kSmall * kSmall;
  const Tensor angle = torch::where(small, torch::ones_like(square), square).sqrt();  // no root of 0: it has no slope
  const Tensor half = 0.5 * angle;
  const Tensor factor = torch::where(small, 0.5 - square / 48.0, half.sin() / angle);
  return OfQuaternion(torch::cat({torch::where(small, 1.0 - square / 8.0, half.cos()), v * factor}, -1));
}

}  // namespace

std::int64_t WidthOf(PoseChoice pose) {
  switch (pose) {
    case PoseChoice::kRotation6D:
      return 6;
    case PoseChoice::kMatrix:
      return 9;
    case PoseChoice::kQuaternion:
      return 4;
    case PoseChoice::kAxisAngle:
    case PoseChoice::kJoints:
      return 3;
  }
  return 0;
}

Tensor MatricesOf(const Tensor& numbers, PoseChoice pose) {
  std::vector<std::int64_t> shape = numbers.sizes().vec();
  shape.back() = 3;
  shape.push_back(3);
  switch (pose) {
    case PoseChoice::kRotation6D:
      return OfRows(numbers.slice(-1, 0, 3), numbers.slice(-1, 3, 6));
    case PoseChoice::kMatrix:
      return numbers.reshape(shape);
    case PoseChoice::kQuaternion:
      return OfQuaternion(numbers);
    case PoseChoice::kAxisAngle:
      return OfRotationVector(numbers);
    case PoseChoice::kJoints:
      break;
  }
  return {};
}

Tensor NumbersOf(const Tensor& matrices, PoseChoice pose) {
  std::vector<std::int64_t> shape = matrices.sizes().vec();
  shape.pop_back();
  shape.back() = WidthOf(pose);
  if (pose == PoseChoice::kRotation6D) return matrices.slice(-2, 0, 2).reshape(shape);
  if (pose == PoseChoice::kMatrix) return matrices.reshape(shape);
  const Tensor dense = matrices.to(torch::kCPU).contiguous().view({-1, 9});
  const Tensor numbers = torch::empty({dense.size(0), shape.back()});
  for (std::int64_t i = 0; i < dense.size(0); ++i) {
    const Matrix3d matrix =
        Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(dense.data_ptr<float>() + 9 * i).cast<double>();
    float* to = numbers.data_ptr<float>() + i * shape.back();
    if (pose == PoseChoice::kAxisAngle) {
      Eigen::Map<Eigen::Vector3f> vector(to);
      vector = LogMatrix(matrix).cast<float>();
      continue;
    }
    const Quaterniond q(matrix);
    const double sign = q.w() < 0.0 ? -1.0 : 1.0;
    const double values[] = {q.w(), q.x(), q.y(), q.z()};
    for (int k = 0; k < 4; ++k) to[k] = static_cast<float>(sign * values[k]);
  }
  return numbers.view(shape).to(matrices.device());
}

}  // namespace mocurate
