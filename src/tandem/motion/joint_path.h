#pragma once
/// Waypoints in joint space, and how long the path through them is.

#include <Eigen/Geometry>
#include <span>
#include <vector>

namespace tandem::motion {

/// Waypoints q, straight edges between them.
using JointPath = std::vector<Eigen::VectorXd>;

/// Sum of Euclidean edge lengths [rad].
double joint_length(const JointPath& path);

/// The path with at least `count` waypoints: the longest edges are divided evenly, waypoints kept.
JointPath interpolated(const JointPath& path, int count);

/// Cartesian length of a tool's motion through its poses at the waypoints.
struct CartesianLength {
  double f = 0;  ///< The paper's objective, Ref: eq:PLPP_new.
  double L = 0;  ///< Sum of sqrt(alpha |dx|^2 + |p|^2): independent of the waypoint count.
};

/// @param X_WE   tool poses at the waypoints.
/// @param alpha  weight of translation against rotation [rad^2/m^2]; the paper's is 5.
CartesianLength cartesian_length(std::span<const Eigen::Isometry3d> X_WE, double alpha = 5.0);

}  // namespace tandem::motion
