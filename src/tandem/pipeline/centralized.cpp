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

}  // namespace

Result<Plan> plan_centralized(const collision::CompiledCell& compiled, const ResolvedQuery& ends,
                              const PlanOptions& options, const StopCondition& stop,
                              PlanReport& report) {
  const world::Workcell& cell = compiled.cell();
  const Modules modules = make_modules(options.preset, compiled, stop);
  const auto finished = [&](motion::CellMotion motion) {
    return Plan{ends.name, options.strategy,  options.preset, options.seed, options.plpp,
                ends,      std::move(motion), report};
  };
  if ((ends.goal - ends.start).cwiseAbs().maxCoeff() < kSamePlace) {
    report.arms.resize(cell.arms().size());
    return finished(standing_still(cell, ends.start));
  }
  auto found = find_path(compiled, modules, ends, options, stop, report);
  if (!found) return std::unexpected(found.error());
  JointPath path = std::move(found->path);
  if (options.plpp) {
    path = shorten_path({compiled, modules, options, stop, report}, ends, path);
    account(modules, report);
  } else {
    report.arms = arm_lengths(cell, found->planned, path);
  }

  const auto scratch = compiled.exact().make_scratch();
  const CurveContext context{compiled, *scratch, *modules.timing, stop, report};
  auto curve = make_curve(context, path, modules.repair);
  account(modules, report);
  if (!curve) return std::unexpected(curve.error());
  return finished(std::move(*curve));
}

}  // namespace tandem::pipeline
