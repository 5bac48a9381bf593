#pragma once
/// Interfaces of path planners and path simplifiers.

#include <cstdint>
#include <memory>

#include "tandem/core/result.h"
#include "tandem/core/stop.h"
#include "tandem/motion/joint_path.h"
#include "tandem/planning/validity.h"

namespace tandem::planning {

struct PathProblem {
  Eigen::VectorXd start, goal;
  Eigen::VectorXd lower, upper;  ///< Joint limits [rad or m].
};

/// Finds a path from start to goal. Implementations are thread-safe; equal seeds give equal paths.
class PathPlanner {
 public:
  virtual ~PathPlanner() = default;
  /// @return waypoints, start first and goal last, every edge accepted by `validity`;
  /// kInfeasible if start or goal is invalid or outside the limits; the stop's error within 10 ms
  /// of the stop.
  virtual Result<motion::JointPath> plan(const PathProblem& problem, Validity& validity,
                                         std::uint64_t seed, const StopCondition& stop) const = 0;
};

/// Shortens a path. Ends are kept; the result's edges are accepted by `validity`.
class PathSimplifier {
 public:
  virtual ~PathSimplifier() = default;
  /// On a stop the best path so far is returned, within 10 ms.
  virtual motion::JointPath simplify(const PathProblem& problem, motion::JointPath path,
                                     Validity& validity, std::uint64_t seed,
                                     const StopCondition& stop) const = 0;
};

}  // namespace tandem::planning
