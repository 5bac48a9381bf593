#pragma once
/// A quadratic program with soft linear constraints and a block-tridiagonal Hessian. Private to
/// shortening/.

#include <Eigen/Core>
#include <vector>

#include "tandem/math/block_tridiagonal.h"

namespace tandem::shortening {

/// min over x in [lower, upper]:  x^T H x / 2 + g^T x + penalty sum_k max(0, b_k - a_k^T x).
/// x stacks the blocks of H.
struct SoftQp {
  /// Constraints with entries in the same block, or the same two neighbouring ones.
  struct Group {
    int block;                          ///< The first of the two.
    Eigen::MatrixXd at_block, at_next;  ///< Columns are a_k; block size x count, or empty for 0.
    Eigen::VectorXd bounds;             ///< b_k
    Eigen::Index count() const { return bounds.size(); }
  };

  SoftQp(int block_size, int block_count) : H(block_size, block_count) {}

  math::BlockTridiagonal H;  ///< Positive definite.
  Eigen::VectorXd g, lower, upper;
  std::vector<Group> groups;
  double penalty = 1;

  Eigen::Index constraint_count() const;
  /// b_k - a_k^T x of all constraints, group after group.
  void lacking(const Eigen::VectorXd& x, Eigen::ArrayXd& out) const;
  /// The objective at x, where each constraint may lack `free` without penalty.
  double value(const Eigen::VectorXd& x, double free = 0) const;
};

struct QpSolution {
  Eigen::VectorXd x;  ///< Strictly between the bounds.
  double value = 0;
  int iterations = 0;
  bool converged = false;
};

/// Primal-dual interior point with Mehrotra's corrector; each iteration costs one factorisation of
/// H's structure.
/// @param tolerance  on the duality gap, relative to the objective's fall from x = 0, which must
/// lie between the bounds.   Ref: Nocedal and Wright, Numerical Optimization, 16.6.
QpSolution solve(const SoftQp& qp, double tolerance);

}  // namespace tandem::shortening
