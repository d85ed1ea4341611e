#include "fitting/solver/block_tridiagonal.h"

#include <algorithm>

// Level 3 routines of the linked BLAS and LAPACK (column-major, Fortran interface).
extern "C" {
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dtrsm_(const char* side, const char* uplo, const char* trans, const char* diag, const int* m, const int* n,
            const double* alpha, const double* a, const int* lda, double* b, const int* ldb);
void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha, const double* a,
            const int* lda, const double* beta, double* c, const int* ldc);
void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* b, const int* ldb, const double* beta, double* c,
            const int* ldc);
void dgemv_(const char* trans, const int* m, const int* n, const double* alpha, const double* a, const int* lda,
            const double* x, const int* incx, const double* beta, double* y, const int* incy);
void dtrsv_(const char* uplo, const char* trans, const char* diag, const int* n, const double* a, const int* lda,
            double* x, const int* incx);
void dpotri_(const char* uplo, const int* n, double* a, const int* lda, int* info);
}

namespace mocurate {
namespace {

constexpr double kOne = 1.0;        ///< number 1 as an argument of BLAS (numerical)
constexpr double kMinusOne = -1.0;  ///< number -1 as an argument of BLAS (numerical)
constexpr int kStep = 1;            ///< number 1 as an argument of BLAS (numerical)

/// A = U'U in the upper triangle. Number of the row that is not positive definite, from 1; 0: none.
int CholeskyInPlace(double* a, int n) {
  int info = 0;
  dpotrf_("U", &n, a, &n, &info);
  return info;
}

/// U := (U'U)^-1, both triangles.
void InverseOfFactored(Eigen::MatrixXd& u) {
  const auto size = static_cast<int>(u.rows());
  int info = 0;
  dpotri_("U", &size, u.data(), &size, &info);
  u.triangularView<Eigen::StrictlyLower>() = u.transpose();
}

/// B := U^-T B, B of n x columns.
void SolveTransposedInPlace(const double* u, int n, double* b, int columns) {
  dtrsm_("L", "U", "T", "N", &n, &columns, &kOne, u, &n, b, &n);
}

/// c -= A'b with A of n x n.
void SubtractProduct(const double* a, const double* b, int n, double* c) {
  dgemv_("T", &n, &n, &kMinusOne, a, &n, b, &kStep, &kOne, c, &kStep);
}

/// Upper triangle of C -= A'A with A of k x n.
void SubtractSquare(const double* a, int n, int k, double* c) {
  dsyrk_("U", "T", &n, &k, &kMinusOne, a, &k, &kOne, c, &n);
}

}  // namespace

void BlockTridiagonal::Resize(int blocks, int size) {
  blocks_ = blocks;
  size_ = size;
  diagonal_.resize(Square(blocks));
  panel_.resize(Panel(blocks));
  factor_.resize(Square(blocks));
  reduced_.resize(Panel(blocks));
}

void BlockTridiagonal::SetZero(int f) {
  std::fill_n(diagonal_.begin() + static_cast<std::ptrdiff_t>(Square(f)), Square(1), 0.0);
  std::fill_n(panel_.begin() + static_cast<std::ptrdiff_t>(Panel(f)), Panel(1), 0.0);
}

Eigen::VectorXd BlockTridiagonal::DiagonalEntries() const {
  Eigen::VectorXd entries(blocks_ * size_);
  for (int f = 0; f < blocks_; ++f) {
    entries.segment(static_cast<Eigen::Index>(f) * size_, size_) =
        Eigen::Map<const Eigen::MatrixXd>(diagonal_.data() + Square(f), size_, size_).diagonal();
  }
  return entries;
}

Eigen::VectorXd BlockTridiagonal::GradientEntries() const {
  Eigen::VectorXd entries(blocks_ * size_);
  for (int f = 0; f < blocks_; ++f) {
    entries.segment(static_cast<Eigen::Index>(f) * size_, size_) =
        Eigen::Map<const Eigen::VectorXd>(panel_.data() + Panel(f) + Square(1), size_);
  }
  return entries;
}

bool BlockTridiagonal::Factor(const Eigen::VectorXd& damping) {
  for (int f = 0; f < blocks_; ++f) {
    double* diagonal = factor_.data() + Square(f);
    double* panel = reduced_.data() + Panel(f);
    std::copy_n(diagonal_.data() + Square(f), Square(1), diagonal);
    std::copy_n(panel_.data() + Panel(f), Panel(1), panel);
    Block(diagonal, size_, size_).diagonal() += damping.segment(static_cast<Eigen::Index>(f) * size_, size_);
    if (f > 0) {
      const double* above = reduced_.data() + Panel(f - 1);  // U^-T [O g] of the block before
      SubtractSquare(above, size_, size_, diagonal);
      SubtractProduct(above, above + Square(1), size_, panel + Square(1));
    }
    if (const int row = CholeskyInPlace(diagonal, size_); row != 0) {
      failed_ = {f, row - 1};
      return false;
    }
    const bool last = f + 1 == blocks_;
    double* first = last ? panel + Square(1) : panel;
    SolveTransposedInPlace(diagonal, size_, first, last ? 1 : size_ + 1);
  }
  return true;
}

bool BlockTridiagonal::IsDetermined() {
  constexpr double kRounding = 1e-12;  ///< of the diagonal (numerical)
  for (int f = 0; f < blocks_; ++f) {
    for (int row = 0; row < size_; ++row) {
      const std::size_t at = Square(f) + static_cast<std::size_t>(row) * static_cast<std::size_t>(size_ + 1);
      if (factor_[at] * factor_[at] > kRounding * diagonal_[at]) continue;
      failed_ = {f, row};
      return false;
    }
  }
  return true;
}

Eigen::VectorXd BlockTridiagonal::Solve() const {
  Eigen::VectorXd x(blocks_ * size_);
  for (int f = blocks_ - 1; f >= 0; --f) {
    const double* panel = reduced_.data() + Panel(f);
    Eigen::VectorXd right = -Eigen::Map<const Eigen::VectorXd>(panel + Square(1), size_);
    if (f + 1 < blocks_) {
      right.noalias() -= Eigen::Map<const Eigen::MatrixXd>(panel, size_, size_) *
                         x.segment(static_cast<Eigen::Index>(f + 1) * size_, size_);
    }
    dtrsv_("U", "N", "N", &size_, factor_.data() + Square(f), &size_, right.data(), &kStep);
    x.segment(static_cast<Eigen::Index>(f) * size_, size_) = right;
  }
  return x;
}

void BlockTridiagonal::VisitInverse(const VisitBlocks& visit) const {
  constexpr double kZero = 0.0;         ///< number 0 as an argument of BLAS (numerical)
  Eigen::MatrixXd after(size_, size_);  // inverse block of the next
  Eigen::MatrixXd here(size_, size_);
  Eigen::MatrixXd gain(size_, size_);
  Eigen::MatrixXd next;
  for (int f = blocks_ - 1; f >= 0; --f) {
    const double* factor = factor_.data() + Square(f);
    here = Eigen::Map<const Eigen::MatrixXd>(factor, size_, size_);
    InverseOfFactored(here);
    if (f + 1 < blocks_) {
      // With K = U^-1 (U^-T O): next = -K after, here += K after K'.
      next.resize(size_, size_);
      gain = Eigen::Map<const Eigen::MatrixXd>(reduced_.data() + Panel(f), size_, size_);
      dtrsm_("L", "U", "N", "N", &size_, &size_, &kOne, factor, &size_, gain.data(), &size_);
      dgemm_("N", "N", &size_, &size_, &size_, &kMinusOne, gain.data(), &size_, after.data(), &size_, &kZero,
             next.data(), &size_);
      dgemm_("N", "T", &size_, &size_, &size_, &kMinusOne, next.data(), &size_, gain.data(), &size_, &kOne, here.data(),
             &size_);
    }
    visit(f, here, next);
    std::swap(here, after);
  }
}

bool InvertInPlace(Eigen::MatrixXd& matrix) {
  const auto size = static_cast<int>(matrix.rows());
  if (CholeskyInPlace(matrix.data(), size) != 0) return false;
  InverseOfFactored(matrix);
  return true;
}

}  // namespace mocurate
