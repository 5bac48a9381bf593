#pragma once
/// A quadratic program with soft linear constraints and a block-tridiagonal Hessian. Private to
/// shortening/.

#include <Eigen/Core>
#include <vector>

#include "tandem/core/stop.h"
#include "tandem/math/block_tridiagonal.h"

namespace tandem::shortening {

/// min over x in [lower, upper]:  x^T H x / 2 + g^T x + penalty sum_k max(0, b_k - a_k^T x).
/// x stacks the blocks of H.
struct SoftQp {
  /// Constraints with entries in block `block`, `here` times the columns of `at`, and in the next
  /// one, `next` times those of `at_next` or, where that is empty, of `at` again. A block that H
  /// does not have is left out.
  struct Group {
    int block;
    double here, next;
    Eigen::MatrixXd at;                           ///< Block size x count.
    Eigen::VectorXd bounds;                       ///< b_k
    Eigen::MatrixXd at_next = Eigen::MatrixXd();  ///< The same size, or empty.

    Eigen::Index count() const { return bounds.size(); }
    const Eigen::MatrixXd& columns_next() const { return at_next.size() > 0 ? at_next : at; }
  };

  SoftQp(int block_size, int block_count) : H(block_size, block_count) {}

  math::BlockTridiagonal H;  ///< Positive definite.
  Eigen::VectorXd g, lower, upper;
  std::vector<Group> groups;
  double penalty = 1;

  bool has_here(const Group& group) const { return group.block >= 0 && group.here != 0; }
  bool has_next(const Group& group) const {
    return group.block + 1 < H.block_count() && group.next != 0;
  }
  Eigen::Index constraint_count() const;
  /// b_k of all constraints, group after group,
  Eigen::ArrayXd bounds() const;
  /// and a_k^T x.
  void project(const Eigen::VectorXd& x, Eigen::ArrayXd& out) const;
  /// The objective at x, where each constraint may lack `free` without penalty.
  double value(const Eigen::VectorXd& x, double free = 0) const;
};

struct QpSolution {
  Eigen::VectorXd x;  ///< Strictly between the bounds.
  double value = 0;
  Eigen::ArrayXd multipliers;  ///< Of the constraints, 0 to the penalty.
  int rounds = 0;              ///< In which constraints were added.
  bool converged = false;
};

/// An active set method on the dual problem: H is factorised once, and only constraints that the
/// optimum without them would break are looked at, a few more in each round.
/// @param tolerance  on the duality gap, relative to the objective's fall from x = 0, which must
/// lie between the bounds.
/// @param multipliers  where to begin, one per constraint; empty: 0.
/// @param stop  ends it within milliseconds, with the best so far, which has not converged.
/// Ref: Bertsekas, Projected Newton methods for optimization problems with simple constraints
/// (1982).
QpSolution solve(const SoftQp& qp, double tolerance, const Eigen::ArrayXd& multipliers = {},
                 const StopCondition& stop = {});

}  // namespace tandem::shortening
