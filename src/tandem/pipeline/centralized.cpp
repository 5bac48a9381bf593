#include "tandem/pipeline/centralized.h"

#include "tandem/pipeline/curve.h"
#include "tandem/pipeline/modules.h"
#include "tandem/pipeline/path.h"

namespace tandem::pipeline {

namespace {

using motion::JointPath;

constexpr double kSamePlace = 1e-9;  // [rad] start and goal this near are one configuration.

/// Lengths of every arm's tool path: `before` shortening and `after`.
std::vector<ArmLengths> arm_lengths(const world::Workcell& cell, const JointPath& before,
                                    const JointPath& after) {
  std::vector<ArmLengths> lengths(cell.arms().size());
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  const auto measure = [&](const JointPath& path) {
    std::vector<std::vector<Eigen::Isometry3d>> tools(cell.arms().size());
    for (const Eigen::VectorXd& q : path) {
      cell.forward_kinematics(q, positions, X_WL);
      for (std::size_t i = 0; i < tools.size(); ++i) {
        tools[i].push_back(cell.tool_pose(static_cast<int>(i), X_WL));
      }
    }
    std::vector<motion::CartesianLength> measured;
    for (const auto& X_WE : tools) measured.push_back(motion::cartesian_length(X_WE));
    return measured;
  };
  const auto first = measure(before), last = measure(after);
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const world::Arm& arm = cell.arms()[i];
    JointPath part;
    for (const Eigen::VectorXd& q : after) part.push_back(q.segment(arm.offset, arm.dof()));
    lengths[i] = {first[i].f, last[i].f, first[i].L, last[i].L, motion::joint_length(part)};
  }
  return lengths;
}

/// Start and goal alike: nothing to plan, but a motion must last. Two control ticks at rest.
motion::CellMotion standing_still(const world::Workcell& cell, const Eigen::VectorXd& q) {
  constexpr double kDuration = 2e-3;  // [s]
  std::vector<motion::PiecewiseCubic> arms;
  for (const world::Arm& arm : cell.arms()) {
    motion::PiecewiseCubic::Coefficients at_rest =
        motion::PiecewiseCubic::Coefficients::Zero(arm.dof(), 4);
    at_rest.col(0) = q.segment(arm.offset, arm.dof());
    arms.push_back(*motion::PiecewiseCubic::make({0.0, kDuration}, {at_rest}));
  }
  return motion::CellMotion(std::move(arms));
}

}  // namespace

Result<Plan> plan_centralized(const collision::SsvChecker& checker, const ResolvedQuery& ends,
                              const PlanOptions& options, const StopCondition& stop,
                              PlanReport& report) {
  const world::Workcell& cell = checker.cell();
  const world::PairSelection selection = cell.select(world::PairScope::all());
  const Modules modules = make_modules(options.preset, checker, selection, stop);
  if ((ends.goal - ends.start).cwiseAbs().maxCoeff() < kSamePlace) {
    report.arms.resize(cell.arms().size());
    return Plan{ends.name,      options.strategy,
                options.preset, options.seed,
                ends,           standing_still(cell, ends.start),
                report};
  }
  auto found = find_path(checker, modules, ends, options, stop, report);
  if (!found) return std::unexpected(found.error());
  report.arms = arm_lengths(cell, found->planned, found->path);

  const auto scratch = checker.make_scratch();
  const CurveContext context{checker, selection, *scratch, *modules.timing, stop, report};
  auto curve = make_curve(context, found->path, modules.repair);
  account(modules, report);
  if (!curve) return std::unexpected(curve.error());
  return Plan{ends.name, options.strategy,  options.preset, options.seed,
              ends,      std::move(*curve), report};
}

}  // namespace tandem::pipeline
