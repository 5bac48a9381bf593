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
  /// Joint limits [rad or m]. An infinite one is searched up to half a turn beyond start and goal;
  /// turns are not wrapped: the path goes from `start` to `goal` as the numbers say.
  Eigen::VectorXd lower, upper;
};

/// Waypoints nearer than this are one: a spline cannot be timed through both [rad].
inline constexpr double kSameWaypoint = 1e-9;

/// What every planner checks first.
/// @return kInfeasible naming the end, joint, value and limits, or the end that is not valid.
/// Throws ContractViolation for unequal sizes or lower > upper.
Result<void> check_problem(const PathProblem& problem, Validity& validity);

/// The limits with infinite ones replaced as PathProblem says.
struct SearchBox {
  Eigen::VectorXd lower, upper;
};
SearchBox search_box(const PathProblem& problem);

/// The path without waypoints nearer than kSameWaypoint to the one before. Ends are kept, even
/// where start and goal are the same. Edges beside a dropped waypoint are new: check them.
motion::JointPath without_duplicates(const motion::JointPath& path);

/// Finds a path from start to goal. Implementations are thread-safe; equal seeds give equal paths.
class PathPlanner {
 public:
  virtual ~PathPlanner() = default;
  /// @return at least two waypoints without duplicates, start first and goal last (bit by bit),
  /// every edge accepted by `validity`; kInfeasible as check_problem says; the stop's error within
  /// 10 ms of the stop (and of the check that `validity` is then in). Searches until it stops.
  virtual Result<motion::JointPath> plan(const PathProblem& problem, Validity& validity,
                                         std::uint64_t seed, const StopCondition& stop) const = 0;
};

/// Shortens a path. Implementations are thread-safe; equal seeds give equal paths.
class PathSimplifier {
 public:
  virtual ~PathSimplifier() = default;
  /// @param path  at least two waypoints, its edges accepted by `validity`.
  /// @return the ends of `path` (bit by bit), every edge accepted by `validity`, duplicates
  /// dropped, no longer than `path` (joint_length). On a stop the best path so far, within 10 ms.
  virtual motion::JointPath simplify(const PathProblem& problem, motion::JointPath path,
                                     Validity& validity, std::uint64_t seed,
                                     const StopCondition& stop) const = 0;
};

}  // namespace tandem::planning
