#include "train/layers/rotations.h"

#include <cmath>

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

/// Two vectors made orthogonal and their cross product, by Gram and Schmidt: a = u / |u|, b = c / |c| with
/// c = v - (a v) a, a x b. `columns`: they are columns, in the numbers as in the matrix, else rows.
struct Orthogonal : torch::autograd::Function<Orthogonal> {
  using Vector = Eigen::Vector3f;
  using Strided = Eigen::Map<Vector, 0, Eigen::InnerStride<>>;
  using ConstStrided = Eigen::Map<const Vector, 0, Eigen::InnerStride<>>;

  static float NormOf(const Vector& v) { return std::max(v.norm(), static_cast<float>(kSmallestNorm)); }
  static Vector NumbersAt(const float* numbers, bool columns, int k) {
    return ConstStrided(numbers + (columns ? k : 3 * k), 3, Eigen::InnerStride<>(columns ? 2 : 1));
  }
  template <class Map, class Value>
  static Map Axis(Value* matrix, bool columns, int k) {
    return Map(matrix + (columns ? k : 3 * k), 3, Eigen::InnerStride<>(columns ? 3 : 1));
  }
  /// Gradient of v / |v| by v.
  static Vector ByVector(const Vector& unit, const Vector& by_unit, float norm) {
    return (norm > static_cast<float>(kSmallestNorm) ? Vector(by_unit - unit.dot(by_unit) * unit) : by_unit) / norm;
  }

  static Tensor forward(torch::autograd::AutogradContext* context, const Tensor& numbers, bool columns) {
    const Tensor dense = numbers.contiguous();
    std::vector<std::int64_t> shape = numbers.sizes().vec();
    shape.back() = 3;
    shape.push_back(3);
    const Tensor matrices = torch::empty(shape);
    const float* from = dense.data_ptr<float>();
    float* to = matrices.data_ptr<float>();
    for (std::int64_t i = dense.numel() / 6; i > 0; --i, from += 6, to += 9) {
      const Vector u = NumbersAt(from, columns, 0), v = NumbersAt(from, columns, 1);
      const Vector a = u / NormOf(u), c = v - a.dot(v) * a;
      const Vector b = c / NormOf(c);
      Axis<Strided>(to, columns, 0) = a;
      Axis<Strided>(to, columns, 1) = b;
      Axis<Strided>(to, columns, 2) = a.cross(b);
    }
    context->save_for_backward({dense});
    context->saved_data["columns"] = columns;
    return matrices;
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 torch::autograd::variable_list gradient) {
    const Tensor numbers = context->get_saved_variables()[0];
    const bool columns = context->saved_data["columns"].toBool();
    const Tensor by_matrices = gradient[0].contiguous(), by_numbers = torch::empty_like(numbers);
    const float *from = numbers.data_ptr<float>(), *given = by_matrices.data_ptr<float>();
    float* to = by_numbers.data_ptr<float>();
    for (std::int64_t i = numbers.numel() / 6; i > 0; --i, from += 6, given += 9, to += 6) {
      const Vector u = NumbersAt(from, columns, 0), v = NumbersAt(from, columns, 1);
      const float of_u = NormOf(u);
      const Vector a = u / of_u, c = v - a.dot(v) * a;
      const float of_c = NormOf(c);
      const Vector b = c / of_c;
      const Vector by_third = Axis<ConstStrided>(given, columns, 2);
      const Vector by_b = Axis<ConstStrided>(given, columns, 1) + by_third.cross(a);
      const Vector by_c = ByVector(b, by_b, of_c);
      const Vector by_a = Axis<ConstStrided>(given, columns, 0) + b.cross(by_third) - a.dot(v) * by_c - a.dot(by_c) * v;
      const std::ptrdiff_t step = columns ? 2 : 1;
      Strided(to, 3, Eigen::InnerStride<>(step)) = ByVector(a, by_a, of_u);
      Strided(to + (columns ? 1 : 3), 3, Eigen::InnerStride<>(step)) = by_c - a.dot(by_c) * a;
    }
    return {by_numbers, Tensor()};
  }
};

bool RunsOnCpu(const Tensor& x) { return x.device().is_cpu() && x.scalar_type() == torch::kFloat32; }

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

using RowMatrix = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

/// w = log R; with R' = R exp([d]) w' = w + Jr(w)^-1 d, Jr^-1 = 1 + [w]/2 + c [w]^2, c = 1/a^2 - cot(a/2)/(2 a).
struct RotationVectors : torch::autograd::Function<RotationVectors> {
  static Tensor forward(torch::autograd::AutogradContext* context, const Tensor& matrices) {
    const Tensor dense = matrices.to(torch::kCPU).contiguous();
    std::vector<std::int64_t> shape = matrices.sizes().vec();
    shape.pop_back();
    const Tensor vectors = torch::empty(shape);
    const std::int64_t count = vectors.numel() / 3;
    for (std::int64_t i = 0; i < count; ++i) {
      const Matrix3d matrix = Eigen::Map<const RowMatrix>(dense.data_ptr<float>() + 9 * i).cast<double>();
      Eigen::Map<Eigen::Vector3f> vector(vectors.data_ptr<float>() + 3 * i);
      vector = LogMatrix(matrix).cast<float>();
    }
    context->save_for_backward({dense, vectors});
    return vectors.to(matrices.device());
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 torch::autograd::variable_list gradient) {
    const auto saved = context->get_saved_variables();
    const Tensor by_vector = gradient[0].to(torch::kCPU).contiguous();
    const Tensor result = torch::empty_like(saved[0]);
    for (std::int64_t i = 0; i < by_vector.numel() / 3; ++i) {
      const Eigen::Vector3f w = Eigen::Map<const Eigen::Vector3f>(saved[1].data_ptr<float>() + 3 * i);
      const Eigen::Vector3f g = Eigen::Map<const Eigen::Vector3f>(by_vector.data_ptr<float>() + 3 * i);
      const float angle = w.norm();
      const float c = angle < 1e-2f ? 1.0f / 12.0f : 1.0f / (angle * angle) - 0.5f / (angle * std::tan(0.5f * angle));
      const Eigen::Vector3f h = g - 0.5f * w.cross(g) + c * w.cross(w.cross(g));
      RowMatrix hat;
      hat << 0.0f, -h.z(), h.y(), h.z(), 0.0f, -h.x(), -h.y(), h.x(), 0.0f;
      Eigen::Map<RowMatrix> by_matrix(result.data_ptr<float>() + 9 * i);
      by_matrix = 0.5f * Eigen::Map<const RowMatrix>(saved[0].data_ptr<float>() + 9 * i) * hat;
    }
    return {result.to(gradient[0].device())};
  }
};

}  // namespace

Tensor RotationVectorsOf(const Tensor& matrices) { return RotationVectors::apply(matrices); }

Tensor Columns6D(const Tensor& rotation) { return rotation.slice(-1, 0, 2).flatten(-2); }

Tensor MatricesOfColumns(const Tensor& columns) {
  return RunsOnCpu(columns) ? Orthogonal::apply(columns, true) : PlainMatricesOfColumns(columns);
}

Tensor PlainMatricesOfColumns(const Tensor& columns) {
  std::vector<std::int64_t> shape = columns.sizes().vec();
  shape.back() = 3;
  shape.push_back(2);
  const Tensor pairs = columns.reshape(shape);
  return OfRows(pairs.select(-1, 0), pairs.select(-1, 1)).transpose(-1, -2);
}

Tensor PlainMatricesOfRows(const Tensor& rows) { return OfRows(rows.slice(-1, 0, 3), rows.slice(-1, 3, 6)); }

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
      return RunsOnCpu(numbers) ? Orthogonal::apply(numbers, false) : PlainMatricesOfRows(numbers);
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
