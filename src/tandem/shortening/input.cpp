#include "tandem/shortening/input.h"

#include "tandem/core/contract.h"
#include "tandem/shortening/path_cost.h"

namespace tandem::shortening {

void check_input(const world::Workcell& cell, const motion::JointPath& path,
                 const ShorteningOptions& options) {
  expects(path.size() >= 2, "a path has at least two waypoints");
  for (const Eigen::VectorXd& q : path) {
    expects(q.size() == cell.dof(), "a waypoint has one entry per joint of the cell's arms");
  }
  expects(options.clearance > 0 && options.tolerance > 0 && options.longest_edge >= 1 &&
              options.difference_step >= 0,
          "clearance and tolerance are positive, edges may at least be as long as the mean");
  expects(
      options.edges >= 0 && (options.edges == 0 || options.points_per_edge.empty()),
      "the number of edges is not negative, and points on edges are given for all of them only");
  expects(options.points_per_edge.empty() || options.points_per_edge.size() + 1 == path.size(),
          "one number of points per edge, or none");
}

collision::BatchChecker::Pairs pairs_within(const collision::CompiledCell& compiled,
                                            const world::PairScope& scope, double clearance) {
  if (clearance <= collision::BatchChecker::kClearanceCap) return compiled.pairs(scope);
  return compiled.batch().compile(compiled.selection(scope), clearance);
}

Shortening unchanged(const world::Workcell& cell, const motion::JointPath& path,
                     const ShorteningOptions& options) {
  Shortening result;
  result.path = path;
  result.before = result.after = PathCost(cell, options.weights).path(path);
  return result;
}

}  // namespace tandem::shortening
