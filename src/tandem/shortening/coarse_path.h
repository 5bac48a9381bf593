#pragma once
/// Paths with fewer waypoints that stand for paths with many. Private to shortening/.

#include "tandem/motion/joint_path.h"

namespace tandem::shortening {

/// A path whose edge e stands for `parts[e]` equal ones.
struct CoarsePath {
  motion::JointPath waypoints;
  std::vector<int> parts;  ///< >= 1 each.

  /// Every waypoint counts.
  static CoarsePath of(const motion::JointPath& path);
  /// The path that it stands for.
  motion::JointPath divided() const;
};

/// About `edges` edges for those of `path`, at least two: it bends where `path` does, and nowhere
/// does it leave it.
CoarsePath coarsened(const motion::JointPath& path, int edges);

}  // namespace tandem::shortening
