#pragma once

#include <Eigen/Core>
#include <functional>
#include <utility>
#include <vector>

namespace mocurate {

/// Normal equations H x = -g of a chain of F blocks of n unknowns, each coupled with the next:
///   [ D_0   O_0        ]
///   [ O_0'  D_1   O_1  ]
///   [       ...        ]
/// Time grows with F n^3, memory with F n^2; nothing is sparse inside a block.
class BlockTridiagonal {
 public:
  using Block = Eigen::Map<Eigen::MatrixXd>;
  using Column = Eigen::Map<Eigen::VectorXd>;

  BlockTridiagonal() : BlockTridiagonal(0, 0) {}
  BlockTridiagonal(int blocks, int size) { Resize(blocks, size); }

  /// Resizes for other equations and reuses memory; the contents are undefined.
  void Resize(int blocks, int size);

  int blocks() const { return blocks_; }
  int size() const { return size_; }

  /// D_f, O_f and g_f. Call shortly before summation, while they are in the cache.
  void SetZero(int f);
  /// D_f: only its upper triangle is read.
  Block Diagonal(int f) { return {diagonal_.data() + Square(f), size_, size_}; }
  Block Next(int f) { return {panel_.data() + Panel(f), size_, size_}; }            ///< O_f
  Column Gradient(int f) { return {panel_.data() + Panel(f) + Square(1), size_}; }  ///< g_f

  /// Diagonal of H (F n).
  Eigen::VectorXd DiagonalEntries() const;
  /// Gradient (F n).
  Eigen::VectorXd GradientEntries() const;

  /// Cholesky factor of H + diag(damping) (F n numbers); false if that is not positive definite.
  bool Factor(const Eigen::VectorXd& damping);
  /// Whether every pivot of the factored matrix is above rounding.
  bool IsDetermined();
  /// Block and row where Factor failed, or IsDetermined.
  std::pair<int, int> failed() const { return failed_; }
  /// x of the factored matrix (F n).
  Eigen::VectorXd Solve() const;

  /// Blocks of the inverse of the factored matrix, n x n: (f, f), and (f, f + 1), which is empty for the last.
  using VisitBlocks = std::function<void(int f, const Eigen::MatrixXd& diagonal, const Eigen::MatrixXd& next)>;
  /// Those blocks without the others (selected inversion), last f first.
  void VisitInverse(const VisitBlocks& visit) const;

 private:
  std::size_t Square(int f) const { return static_cast<std::size_t>(f) * size_ * size_; }
  std::size_t Panel(int f) const { return static_cast<std::size_t>(f) * size_ * (size_ + 1); }

  int blocks_ = 0;
  int size_ = 0;
  std::pair<int, int> failed_{-1, -1};
  std::vector<double> diagonal_;  ///< D_f, one after the other
  std::vector<double> panel_;     ///< [O_f g_f]
  std::vector<double> factor_;    ///< upper U_f with U'U = D_f - ...
  std::vector<double> reduced_;   ///< U_f^-T [O_f g_f]
};

/// Inverse of a symmetric positive definite matrix in place; reads the upper triangle. False for a matrix that is not
/// positive definite.
bool InvertInPlace(Eigen::MatrixXd& matrix);

}  // namespace mocurate
