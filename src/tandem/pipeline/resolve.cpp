#include <algorithm>

#include "tandem/collision/ssv_checker.h"
#include "tandem/core/contract.h"
#include "tandem/pipeline/plan.h"
#include "tandem/robot/inverse_kinematics.h"

namespace tandem::pipeline {

namespace {

using world::Workcell;

/// Goals of a query before its arms are placed: what is known, and which arms are.
struct Placement {
  Eigen::VectorXd q;
  world::ArmMask placed = 0;
};

world::ArmMask bit(int arm) { return world::ArmMask{1} << arm; }

/// Solves a pose for one arm, free of collisions with the world, itself and the arms placed so far.
Result<Eigen::VectorXd> solve_pose(const std::shared_ptr<const Workcell>& cell, int arm,
                                   const Eigen::Isometry3d& X_WE, const Placement& so_far,
                                   std::uint64_t seed) {
  const world::Arm& a = cell->arms()[static_cast<std::size_t>(arm)];
  const collision::SsvChecker checker(cell);
  const auto scratch = checker.make_scratch();
  const world::PairSelection selection = cell->select(world::PairScope::arm(arm, so_far.placed));
  Eigen::VectorXd q = so_far.q;

  robot::IkProblem problem;
  problem.model = &cell->model();
  problem.link = a.tip_link;
  problem.X_LE = a.X_LE;
  problem.columns = a.columns;
  cell->positions(so_far.q, problem.positions);
  problem.X_WE = X_WE;
  robot::IkOptions options;
  options.seed = seed;
  const auto validity = [&](const Eigen::VectorXd& positions) -> std::string {
    for (int j = 0; j < a.dof(); ++j) {
      q[a.offset + j] = positions[a.columns[static_cast<std::size_t>(j)]];
    }
    if (checker.is_free(q, selection, *scratch)) return "";
    const int pair = checker.least_clearance(q, selection, *scratch).pair;
    return cell->describe_pair(pair) + " touch";
  };
  auto positions = robot::solve_ik(problem, options, validity);
  if (!positions) return std::unexpected(positions.error());
  Eigen::VectorXd values(a.dof());
  for (int j = 0; j < a.dof(); ++j) {
    values[j] = (*positions)[a.columns[static_cast<std::size_t>(j)]];
  }
  return values;
}

/// Places every arm that has a goal: joint values and named states first, then poses in arm order.
Result<void> place(const std::shared_ptr<const Workcell>& cell,
                   const std::vector<std::optional<world::ArmGoal>>& goals, const std::string& what,
                   std::uint64_t seed, Placement& placement) {
  const auto set = [&](int arm, const Eigen::VectorXd& values) {
    const world::Arm& a = cell->arms()[static_cast<std::size_t>(arm)];
    placement.q.segment(a.offset, a.dof()) = values;
    placement.placed |= bit(arm);
  };
  const auto name = [&](int arm) {
    return what + ", arm '" + cell->arms()[static_cast<std::size_t>(arm)].name + "'";
  };
  const int count = static_cast<int>(goals.size());
  for (int i = 0; i < count; ++i) {
    const auto& goal = goals[static_cast<std::size_t>(i)];
    if (!goal) continue;
    if (const auto* joints = std::get_if<world::JointGoal>(&*goal)) set(i, joints->q);
    if (const auto* state = std::get_if<world::StateGoal>(&*goal)) {
      auto values = cell->named_state(i, state->name);
      if (!values) return fail(values.error().code, name(i) + ": " + values.error().message);
      set(i, *values);
    }
  }
  for (int i = 0; i < count; ++i) {
    const auto& goal = goals[static_cast<std::size_t>(i)];
    if (!goal) continue;
    if (const auto* pose = std::get_if<world::PoseGoal>(&*goal)) {
      auto values = solve_pose(cell, i, pose->X_WE, placement, seed);
      if (!values) return fail(values.error().code, name(i) + ": " + values.error().message);
      set(i, *values);
    }
  }
  return {};
}

/// Arms without a goal stand where `from` has them; they count as placed.
Placement standing(const Workcell& cell, const Eigen::VectorXd& from,
                   const std::vector<std::optional<world::ArmGoal>>& goals) {
  Placement placement{from, 0};
  for (std::size_t i = 0; i < cell.arms().size(); ++i) {
    if (!goals[i]) placement.placed |= bit(static_cast<int>(i));
  }
  return placement;
}

}  // namespace

Result<ResolvedQuery> resolve(const std::shared_ptr<const Workcell>& cell,
                              const world::Query& query, std::uint64_t seed) {
  expects(cell != nullptr, "resolve needs a workcell");
  expects(query.start.size() == cell->arms().size() && query.goal.size() == cell->arms().size(),
          "a query has one start and one goal entry per arm");
  // Walk back to the first query that states where every arm is, then forward again.
  const std::vector<world::Query>& queries = cell->queries();
  std::size_t own = 0;
  while (own < queries.size() && queries[own].name != query.name) ++own;
  std::vector<const world::Query*> chain{&query};
  const auto complete = [](const world::Query& q) {
    return std::all_of(q.start.begin(), q.start.end(), [](const auto& s) { return s.has_value(); });
  };
  for (std::size_t i = own; !complete(*chain.back()) && i > 0 && i <= queries.size(); --i) {
    if (own == queries.size()) break;
    chain.push_back(&queries[i - 1]);
  }
  if (!complete(*chain.back())) {
    for (std::size_t i = 0; i < cell->arms().size(); ++i) {
      if (chain.back()->start[i]) continue;
      return fail(ErrorCode::kInvalidInput,
                  "query '" + chain.back()->name + "': arm '" + cell->arms()[i].name +
                      "' has no start and no query before says where it is; give it a `start:`");
    }
  }

  Eigen::VectorXd at = Eigen::VectorXd::Zero(cell->dof());
  ResolvedQuery resolved;
  for (auto step = chain.rbegin(); step != chain.rend(); ++step) {
    Placement start = standing(*cell, at, (*step)->start);
    auto placed =
        place(cell, (*step)->start, "start of query '" + (*step)->name + "'", seed, start);
    if (!placed) return std::unexpected(placed.error());
    Placement goal = standing(*cell, start.q, (*step)->goal);
    placed = place(cell, (*step)->goal, "goal of query '" + (*step)->name + "'", seed, goal);
    if (!placed) return std::unexpected(placed.error());
    resolved = {(*step)->name, start.q, goal.q};
    at = goal.q;
  }
  return resolved;
}

}  // namespace tandem::pipeline
