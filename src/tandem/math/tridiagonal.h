#pragma once
/// Tridiagonal systems with many right-hand sides.

#include <Eigen/Core>
#include <vector>

namespace tandem::math {

/// Row-major, so that one row operation runs over all right-hand sides at once.
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// LU factors (with partial pivoting) of a tridiagonal matrix.
class TridiagonalLu {
 public:
  /// @param lower (n-1), diagonal (n), upper (n-1).  Throws ContractViolation for wrong sizes.
  TridiagonalLu(const Eigen::VectorXd& lower, const Eigen::VectorXd& diagonal,
                const Eigen::VectorXd& upper);

  /// False if a pivot vanished: the matrix is singular to rounding and must not be solved with.
  bool ok() const { return ok_; }
  /// X with A X = B, in place; B is n x anything. Allocates nothing.
  void solve_in_place(Eigen::Ref<RowMatrix> B) const;
  /// X with A^T X = B, in place: for adjoint gradients.
  void solve_transposed_in_place(Eigen::Ref<RowMatrix> B) const;

 private:
  Eigen::VectorXd l_, d_, u_, u2_;  ///< Multipliers, and the three diagonals of U.
  std::vector<bool> swapped_;       ///< Row k was exchanged with row k + 1.
  bool ok_ = true;
};

}  // namespace tandem::math
