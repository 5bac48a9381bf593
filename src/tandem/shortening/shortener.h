#pragma once
/// The path length post-processor (PLPP): waypoints move until the tools' paths are short.

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include "tandem/collision/compiled_cell.h"
#include "tandem/core/stop.h"
#include "tandem/motion/joint_path.h"

namespace tandem::shortening {

/// What is made small, summed over the edges of a path and the arms:
///   arm_weight ((translation |dx|^2 + rotation |p|^2) / 2 + joints |dq|^2 / 2),
/// with dx, p and dq the tool's translation, its rotation vector and the joints' difference.
/// Ref: eq:PLPP_new; the joint term is Wittmann et al. 2022.
struct Weights {
  double translation = 5.0;       ///< The paper's alpha [1/m^2], >= 0.
  double rotation = 1.0;          ///< [1/rad^2], >= 0
  double joints = 0.02;           ///< [1/rad^2], >= 0; keeps redundant joints from wandering.
  std::vector<double> arms = {};  ///< One per arm, >= 0; empty: 1 each.
};

struct ShorteningOptions {
  Weights weights = {};
  /// d_obs: every pair keeps this distance at every waypoint, or what the path had there [m], > 0.
  double clearance = 0.02;
  bool joint_limits = true;
  /// Edges may be at most this many times as long, in R3 x SO(3), as the mean edge of the path that
  /// came in: keeps waypoints spread as in Wittmann et al. 2022; infinity: as they fall.
  double longest_edge = std::numeric_limits<double>::infinity();
  double tolerance = 1e-3;  ///< Stops when the objective falls by less than this fraction.
  /// Shorten with about so many edges that stand for those of the path, straight pieces of it:
  /// where it bends, it may go on bending. Sooner done, and hardly longer. 0: with all. Not with
  /// SLSQP.
  int edges = 0;
  /// Points inside each edge at which distances are looked at, by edge; empty: the middle of each.
  /// The paper looks at waypoints only: 0 each. Not with `edges`.
  std::vector<int> points_per_edge = {};
  /// Every edge of the result is proven to be free, if those of the path that came in are: where an
  /// edge is not, more points inside it are looked at while the search goes on. What still is not
  /// in the end is drawn back towards the last path that was proven. Not with SLSQP.
  bool prove_edges = false;
  /// Forward differences with this step instead of analytic gradients, for the comparison in the
  /// paper's implementation table [rad]; 0: analytic.
  double difference_step = 0;
};

struct Shortening {
  motion::JointPath path;        ///< As many waypoints as came in, the same ends (bit by bit).
  double before = 0, after = 0;  ///< Objective.
  /// What clearance lacks most at a waypoint or on an edge that was looked at [m], >= 0.
  double violation = 0;
  int iterations = 0;    ///< With all waypoints.
  int drawn_back = 0;    ///< Waypoints moved back because an edge could not be proven.
  long evaluations = 0;  ///< Configurations at which distances were computed.
  bool stopped = false;  ///< The stop condition ended it early.
};

/// Implementations are immutable and thread-safe; equal input gives equal paths.
class Shortener {
 public:
  virtual ~Shortener() = default;
  /// @param scope  pairs that keep their distance.
  /// @param path   at least two waypoints of compiled.cell(); its clearance is what may not shrink.
  /// @return the best path found; `violation` may be above 0, and edges are proven only on request.
  /// On a stop the best so far, at once.
  virtual Shortening shorten(const collision::CompiledCell& compiled, const world::PairScope& scope,
                             const motion::JointPath& path, const ShorteningOptions& options,
                             const StopCondition& stop) const = 0;
};

/// Sequential quadratic programming with a Gauss-Newton block-tridiagonal Hessian, with few
/// waypoints first where there are many: time grows linearly with the waypoints.
/// Ref: docs/methods.md, "PLPP".
std::unique_ptr<Shortener> make_structured_shortener();

}  // namespace tandem::shortening
