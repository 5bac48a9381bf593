#pragma once
/// Tridiagonal systems with many right-hand sides.

#include <Eigen/Core>
#include <vector>

namespace tandem::math {

/// LU factors (with partial pivoting) of a tridiagonal matrix.
class TridiagonalLu {
 public:
  /// @param lower (n-1), diagonal (n), upper (n-1).  Throws ContractViolation for wrong sizes.
  TridiagonalLu(const Eigen::VectorXd& lower, const Eigen::VectorXd& diagonal,
                const Eigen::VectorXd& upper);

  /// False if a pivot vanished: the matrix is singular to rounding and must not be solved with.
  bool ok() const { return ok_; }
  /// X with A X = B, in place; B is n x anything.
  void solve_in_place(Eigen::Ref<Eigen::MatrixXd> B) const;
  /// X with A^T X = B, in place: for adjoint gradients.
  void solve_transposed_in_place(Eigen::Ref<Eigen::MatrixXd> B) const;

 private:
  Eigen::VectorXd l_, d_, u_, u2_;
  std::vector<bool> swapped_;
  bool ok_ = true;
};

}  // namespace tandem::math
