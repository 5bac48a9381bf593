#include "tandem/trajectory/timing_problem.h"

namespace tandem::trajectory {

namespace {

class UniformScaling final : public TimeOptimizer {
 public:
  Timing optimize(const motion::JointPath& waypoints, const std::vector<robot::JointLimits>& limits,
                  const TimingOptions& options, const StopCondition&) const override {
    const TimingProblem problem(waypoints, limits, options);
    return problem.finish(problem.initial_intervals(), 1);
  }
};

}  // namespace

std::unique_ptr<TimeOptimizer> make_uniform_scaling() { return std::make_unique<UniformScaling>(); }

}  // namespace tandem::trajectory
