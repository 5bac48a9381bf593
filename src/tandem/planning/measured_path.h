#pragma once
/// Paths by how far one is on them, for planning along paths that are given.

#include "tandem/motion/joint_path.h"

namespace tandem::planning {

/// A path by the fraction s of its length, in [0, 1]. A path that stands still is at its first
/// waypoint until its end.
class MeasuredPath {
 public:
  explicit MeasuredPath(motion::JointPath path);

  double length() const { return length_; }  ///< Sum of Euclidean edge lengths [rad].
  /// Fractions at which the waypoints are, ascending.
  const std::vector<double>& waypoints() const { return at_; }
  /// At s, clamped; waypoints bit by bit at both ends.
  Eigen::VectorXd position(double s) const;
  /// Appends the parts in (0, 1) of the way from fraction `from` to `to` at which a waypoint is.
  void append_waypoints(double from, double to, std::vector<double>& parts) const;

 private:
  motion::JointPath path_;
  std::vector<double> at_;
  double length_;
};

/// Orders in which `count` arms may go one after the other: all of up to three, else its rotations.
std::vector<std::vector<int>> orders(int count);

}  // namespace tandem::planning
