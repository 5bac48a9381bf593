#pragma once
/// Motions of a workcell's queries that were planned for each arm alone, for studies.

#include <algorithm>
#include <vector>

#include "tandem/core/rng.h"
#include "tandem/motion/piecewise_cubic.h"
#include "tandem/pipeline/plan.h"
#include "tandem/planning/arm_validity.h"
#include "tandem/planning/rrt_connect.h"
#include "tandem/planning/simplifier.h"
#include "tandem/trajectory/spline.h"
#include "tandem/trajectory/time_optimizer.h"

namespace tandem::study {

/// By arm: a path that is proven alone, as a spline through it within the arm's limits. Empty if an
/// arm has no way or none to go.
inline std::vector<motion::PiecewiseCubic> arm_motions(const collision::CompiledCell& compiled,
                                                       const pipeline::ResolvedQuery& query,
                                                       std::uint64_t seed) {
  using Eigen::VectorXd;
  const world::Workcell& cell = compiled.cell();
  const auto validity = planning::make_batch_validity_by_arm(compiled);
  const auto planner = planning::make_rrt_connect();
  const auto simplifier = planning::make_simplifier();
  const auto optimizer = trajectory::make_barrier_optimizer();
  std::vector<motion::PiecewiseCubic> arms;
  Rng rng(seed);
  for (const auto& arm : validity->by_arm()->arms) {
    planning::ArmValidity alone(arm, query.start);
    const auto part = [&](const VectorXd& q) { return VectorXd(q.segment(arm.offset, arm.dof)); };
    const planning::PathProblem problem{part(query.start), part(query.goal), part(cell.lower()),
                                        part(cell.upper())};
    const auto stop = StopCondition::after(5);
    auto path = planner->plan(problem, alone, rng.split(), stop);
    if (!path) return {};
    const auto shorter = simplifier->simplify(problem, std::move(*path), alone, rng.split(), stop);
    if ((shorter.front() - shorter.back()).norm() < 1e-9) return {};
    const auto first = cell.limits().begin() + arm.offset;
    const auto timing = optimizer->optimize(shorter, {first, first + arm.dof});
    arms.push_back(trajectory::fit_spline(shorter, timing.durations));
  }
  return arms;
}

}  // namespace tandem::study
