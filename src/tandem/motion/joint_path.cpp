#include "tandem/motion/joint_path.h"

#include <cmath>
#include <queue>

#include "tandem/core/contract.h"
#include "tandem/math/so3.h"

namespace tandem::motion {

double joint_length(const JointPath& path) {
  double length = 0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
  return length;
}

JointPath interpolated(const JointPath& path, int count) {
  const auto wanted = static_cast<std::size_t>(std::max(count, 0));
  if (path.size() >= wanted) return path;
  expects(path.size() >= 2, "a path needs an edge before waypoints can be added to it");

  struct Edge {
    double piece;  ///< Length of each part.
    std::size_t index;
    /// Equal pieces are divided from the start on, so that the result is the same everywhere.
    bool operator<(const Edge& other) const {
      return piece != other.piece ? piece < other.piece : index > other.index;
    }
  };
  std::vector<std::size_t> parts(path.size() - 1, 1);
  std::vector<double> lengths(parts.size());
  std::priority_queue<Edge> longest;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    lengths[i] = (path[i + 1] - path[i]).norm();
    longest.push({lengths[i], i});
  }
  for (std::size_t added = path.size(); added < wanted; ++added) {
    const std::size_t i = longest.top().index;
    longest.pop();
    ++parts[i];
    longest.push({lengths[i] / static_cast<double>(parts[i]), i});
  }

  JointPath result;
  result.reserve(wanted);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t k = 0; k < parts[i]; ++k) {
      const double s = static_cast<double>(k) / static_cast<double>(parts[i]);
      result.push_back(path[i] + s * (path[i + 1] - path[i]));
    }
  }
  result.push_back(path.back());
  return result;
}

CartesianLength cartesian_length(std::span<const Eigen::Isometry3d> X_WE, double alpha) {
  CartesianLength length;
  for (std::size_t i = 1; i < X_WE.size(); ++i) {
    const Eigen::Vector3d dx = X_WE[i].translation() - X_WE[i - 1].translation();
    const Eigen::Quaterniond u(
        Eigen::Matrix3d(X_WE[i - 1].linear().transpose() * X_WE[i].linear()));
    const double squared = alpha * dx.squaredNorm() + math::log_map(u).squaredNorm();
    length.f += 0.5 * squared;
    length.L += std::sqrt(squared);
  }
  return length;
}

}  // namespace tandem::motion
