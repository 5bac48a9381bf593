#pragma once
/// Symmetric positive definite block-tridiagonal systems.

#include <Eigen/Core>
#include <vector>

namespace tandem::math {

/// A symmetric block-tridiagonal matrix of `block_count` blocks of size `block_size`, and its
/// Cholesky factors in the same place. Time and memory grow with the number of blocks.
class BlockTridiagonal {
 public:
  using Block = Eigen::Map<Eigen::MatrixXd>;
  using ConstBlock = Eigen::Map<const Eigen::MatrixXd>;

  /// All zero. Throws ContractViolation unless both are at least 1.
  BlockTridiagonal(int block_size, int block_count);

  int block_size() const { return size_; }
  int block_count() const { return count_; }

  void set_zero();
  /// Block (k, k); its lower triangle is read.
  Block diagonal(int k) { return {blocks_.data() + 2 * k * area(), size_, size_}; }
  ConstBlock diagonal(int k) const { return {blocks_.data() + 2 * k * area(), size_, size_}; }
  /// Block (k + 1, k), k < block_count() - 1.
  Block lower(int k) { return {blocks_.data() + (2 * k + 1) * area(), size_, size_}; }
  ConstBlock lower(int k) const { return {blocks_.data() + (2 * k + 1) * area(), size_, size_}; }

  /// y = A x; x and y have block_size() * block_count() entries. Before factorise().
  void multiply(const Eigen::Ref<const Eigen::VectorXd>& x, Eigen::Ref<Eigen::VectorXd> y) const;

  /// Replaces the blocks by their Cholesky factors.   @return false if the matrix is not positive
  /// definite to rounding; the blocks are then undefined.
  [[nodiscard]] bool factorise();
  /// x with A x = b, in place, after factorise(). Allocates nothing.
  void solve_in_place(Eigen::Ref<Eigen::VectorXd> b) const;
  /// Half of it, the factors being L L^T: b <- L^-1 b, where blocks of b before `first` are zero,
  void forward_in_place(Eigen::Ref<Eigen::VectorXd> b, int first = 0) const;
  /// and b <- L^-T b.
  void backward_in_place(Eigen::Ref<Eigen::VectorXd> b) const;

 private:
  Eigen::Index area() const { return Eigen::Index{size_} * size_; }

  int size_, count_;
  std::vector<double> blocks_;  ///< Column-major; (0, 0), (1, 0), (1, 1), (2, 1), ...
};

}  // namespace tandem::math
