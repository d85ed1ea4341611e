#pragma once

#include <torch/torch.h>

#include "train/options.h"

namespace mocurate {

/// Rotation matrices (...,3,3) of ACTOR's representations (a2m_actor.md C.1), differentiable: (...,6) the first two
/// rows, made orthogonal; (...,9); (...,4) w first; (...,3) rotation vectors. kJoints has none.
torch::Tensor MatricesOf(const torch::Tensor& numbers, PoseChoice pose);

/// The numbers of rotation matrices; not differentiable for quaternions and rotation vectors.
torch::Tensor NumbersOf(const torch::Tensor& matrices, PoseChoice pose);

/// Rotation vectors (...,3) of rotation matrices (...,3,3), differentiable; angles in [0, pi]. The gradient is that of
/// changes which keep a matrix a rotation.
torch::Tensor RotationVectorsOf(const torch::Tensor& matrices);

/// (...,3,3) -> (...,6): the first two columns as 3 x 2 numbers row by row (MultiAct's layout).
torch::Tensor Columns6D(const torch::Tensor& rotation);
/// The reverse, made orthogonal.
torch::Tensor MatricesOfColumns(const torch::Tensor& columns);

/// MatricesOfColumns, and MatricesOf of the first two rows, in plain tensor operations: their references in tests, and
/// what other devices run.
torch::Tensor PlainMatricesOfColumns(const torch::Tensor& columns);
torch::Tensor PlainMatricesOfRows(const torch::Tensor& rows);

/// Numbers of a joint's row.
std::int64_t WidthOf(PoseChoice pose);

}  // namespace mocurate
