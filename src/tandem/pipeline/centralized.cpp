#include "tandem/pipeline/centralized.h"

#include "tandem/pipeline/curve.h"
#include "tandem/pipeline/modules.h"
#include "tandem/pipeline/path.h"
#include "tandem/pipeline/shorten.h"

namespace tandem::pipeline {

namespace {

using motion::JointPath;

constexpr double kSamePlace = 1e-9;  // [rad] start and goal this near are one configuration.

/// Start and goal alike: nothing to plan, but a motion must last. Two control ticks at rest.
motion::CellMotion standing_still(const world::Workcell& cell, const Eigen::VectorXd& q) {
  constexpr double kDuration = 2e-3;  // [s]
  std::vector<motion::ArmMotion> arms;
  for (const world::Arm& arm : cell.arms()) {
    motion::PiecewiseCubic::Coefficients at_rest =
        motion::PiecewiseCubic::Coefficients::Zero(arm.dof(), 4);
    at_rest.col(0) = q.segment(arm.offset, arm.dof());
    arms.emplace_back(*motion::PiecewiseCubic::make({0.0, kDuration}, {at_rest}));
  }
  return motion::CellMotion(std::move(arms));
}

/// From the simplified path on.
Result<PlannedMotion> make_motion(const collision::CompiledCell& compiled, const Modules& modules,
                                  const ResolvedQuery& ends, const PathPlan& found,
                                  const PlanOptions& options, const StopCondition& stop,
                                  PlanReport& report) {
  JointPath path = found.path;
  if (options.plpp) {
    path = shorten_path({compiled, modules, options, stop, report}, ends, path);
    account(modules, report);
  } else {
    report.arms = arm_lengths(compiled.cell(), found.planned, path);
  }
  const CurveContext context{compiled, modules.batches, *modules.timing, stop, report};
  auto curve = make_curve(context, path, modules.repair);
  account(modules, report);
  if (!curve) return std::unexpected(curve.error());
  return PlannedMotion{std::move(path), std::move(*curve)};
}

}  // namespace

Result<PlannedMotion> plan_motion(const collision::CompiledCell& compiled,
                                  const ResolvedQuery& ends, const PlanOptions& options,
                                  const StopCondition& stop, PlanReport& report) {
  const world::Workcell& cell = compiled.cell();
  if ((ends.goal - ends.start).cwiseAbs().maxCoeff() < kSamePlace) {
    report.arms.resize(cell.arms().size());
    const auto scratch = compiled.exact().make_scratch();
    report.least_clearance =
        compiled.exact()
            .least_clearance(ends.start, compiled.selection(world::PairScope::all()), *scratch)
            .distance;
    return PlannedMotion{{ends.start, ends.goal}, standing_still(cell, ends.start)};
  }
  const Modules modules = make_modules(options.preset, compiled, stop);
  const auto found = find_path(compiled, modules, ends, options, stop, report);
  if (!found) return std::unexpected(found.error());
  return make_motion(compiled, modules, ends, *found, options, stop, report);
}

Result<PlannedMotion> finish_path(const collision::CompiledCell& compiled,
                                  const ResolvedQuery& ends, JointPath path,
                                  const PlanOptions& options, const StopCondition& stop,
                                  PlanReport& report) {
  const Modules modules = make_modules(options.preset, compiled, stop);
  const PathPlan found =
      simplified(compiled, modules, ends, std::move(path), options, stop, report);
  return make_motion(compiled, modules, ends, found, options, stop, report);
}

}  // namespace tandem::pipeline
