#include "tandem/shortening/coarse_path.h"

#include <algorithm>
#include <cmath>

namespace tandem::shortening {

using motion::JointPath;

namespace {

/// Waypoints where the path bends or its edges' lengths change, and both ends.
std::vector<std::size_t> corners(const JointPath& path) {
  constexpr double kStraight = 1e-9;  // Of the edges' lengths.
  std::vector<std::size_t> found{0};
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const Eigen::VectorXd in = path[i] - path[i - 1], out = path[i + 1] - path[i];
    if ((out - in).norm() > kStraight * (in.norm() + out.norm())) found.push_back(i);
  }
  found.push_back(path.size() - 1);
  return found;
}

}  // namespace

CoarsePath CoarsePath::of(const JointPath& path) {
  return {path, std::vector<int>(path.size() - 1, 1)};
}

JointPath CoarsePath::divided() const {
  JointPath path;
  for (std::size_t e = 0; e < parts.size(); ++e) {
    for (int k = 0; k < parts[e]; ++k) {
      const double s = k / static_cast<double>(parts[e]);
      path.push_back(waypoints[e] + s * (waypoints[e + 1] - waypoints[e]));
    }
  }
  path.push_back(waypoints.back());
  return path;
}

CoarsePath coarsened(const JointPath& path, int edges) {
  const double each = std::max(1.0, static_cast<double>(path.size() - 1) / std::max(edges, 2));
  CoarsePath coarse;
  const std::vector<std::size_t> bends = corners(path);
  for (std::size_t k = 0; k + 1 < bends.size(); ++k) {
    const auto length = static_cast<int>(bends[k + 1] - bends[k]);
    const int pieces = std::max(1, static_cast<int>(std::lround(length / each)));
    for (int i = 0; i < pieces; ++i) {
      const int from = length * i / pieces, to = length * (i + 1) / pieces;
      coarse.waypoints.push_back(path[bends[k] + static_cast<std::size_t>(from)]);
      coarse.parts.push_back(to - from);
    }
  }
  coarse.waypoints.push_back(path.back());
  return coarse;
}

}  // namespace tandem::shortening
