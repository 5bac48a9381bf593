#pragma once
/// Shortest knot durations of a zero-clamped spline within the joint limits.

#include <memory>
#include <vector>

#include "tandem/core/stop.h"
#include "tandem/motion/joint_path.h"
#include "tandem/robot/model.h"
#include "tandem/trajectory/limit_check.h"

namespace tandem::trajectory {

struct TimingOptions {
  double shortest_interval = 2e-3;  ///< [s] lower bound of every knot interval: two control ticks.
};

struct Timing {
  std::vector<double> durations;  ///< N + 1 knot intervals [s]
  double duration = 0;            ///< Their sum [s]
  int iterations = 0;
};

/// One way to choose knot durations. Every implementation returns a timing whose spline obeys
/// velocity, acceleration and jerk limits exactly (limit_check finds nothing); position limits may
/// be overshot between waypoints, at every time scale alike.
/// Thread-safe. On a stop the best feasible timing so far is returned.
class TimeOptimizer {
 public:
  virtual ~TimeOptimizer() = default;
  /// @param waypoints N >= 2, neighbours differ.  @param limits by joint, finite velocity and
  /// acceleration.
  virtual Timing optimize(const motion::JointPath& waypoints,
                          const std::vector<robot::JointLimits>& limits,
                          const TimingOptions& options = {},
                          const StopCondition& stop = {}) const = 0;
};

/// Durations in proportion to the edges' own least times, scaled uniformly: the baseline.
std::unique_ptr<TimeOptimizer> make_uniform_scaling();
/// Log-barrier Newton in log durations after a few stretching steps, analytic gradients: default.
std::unique_ptr<TimeOptimizer> make_barrier_optimizer();

}  // namespace tandem::trajectory
