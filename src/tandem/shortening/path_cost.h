#pragma once
/// The objective of the path length post-processor and its derivatives. Private to shortening/.

#include "tandem/math/block_tridiagonal.h"
#include "tandem/shortening/shortener.h"

namespace tandem::shortening {

/// A waypoint and the tools of all arms there.
struct Waypoint {
  struct Tool {
    Eigen::Vector3d p_WE;
    Eigen::Quaterniond Q_WE;
    Eigen::Matrix<double, 6, Eigen::Dynamic> J_WE;  ///< 6 x dof of the arm.
  };
  Eigen::VectorXd q;
  std::vector<Tool> tools;  ///< One per arm.
};

/// The edge cost is half the square of a residual: per arm sqrt(w) (sqrt(translation) dx,
/// sqrt(rotation) p), and the joints'. Not thread-safe: it owns its scratch.
class PathCost {
 public:
  PathCost(const world::Workcell& cell, const Weights& weights);

  /// Where the tools are at q, with `jacobians` or without.
  void place(const Eigen::Ref<const Eigen::VectorXd>& q, bool jacobians, Waypoint& waypoint);

  /// Cost of a whole path,
  double path(const motion::JointPath& path);
  /// and of the edge between two placed waypoints.
  double edge(const Waypoint& from, const Waypoint& to) const;
  /// Square of its length in R3 x SO(3), all arms together: the cost without the joints, twice.
  double squared_length(const Waypoint& from, const Waypoint& to) const;

  /// Adds the derivatives of an edge's cost, times `scale`: to the gradients at its ends, and the
  /// Gauss-Newton Hessian to blocks `block` (of `from`) and `block` + 1 of H. An end whose block H
  /// does not have is fixed: its gradient is not touched. Both have Jacobians.
  /// @param gradient  stacked over the blocks.
  /// Ref: eq:GradientTrans, eq:left, eq:right.
  void add_derivatives(const Waypoint& from, const Waypoint& to, double scale, int block,
                       Eigen::VectorXd& gradient, math::BlockTridiagonal* H);
  /// d squared_length / d q at both ends, overwritten.
  void length_gradient(const Waypoint& from, const Waypoint& to, Eigen::VectorXd& at_from,
                       Eigen::VectorXd& at_to);

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6Xd = Eigen::Matrix<double, 6, Eigen::Dynamic>;

  Vector6d residual(const Waypoint& from, const Waypoint& to, std::size_t arm) const;
  /// d residual / d q of the arm at both ends, into J_from_ and J_to_.
  Vector6d linearise(const Waypoint& from, const Waypoint& to, std::size_t arm);

  const world::Workcell& cell_;
  double joints_;
  std::vector<double> translation_, rotation_;  ///< Square roots of the weights, by arm.
  Matrix6Xd J_from_, J_to_;
  Eigen::VectorXd positions_;
  robot::LinkPoses X_WL_;
};

}  // namespace tandem::shortening
