#include "tandem/pipeline/resolve.h"

#include <algorithm>
#include <functional>
#include <span>

#include "tandem/core/contract.h"
#include "tandem/robot/inverse_kinematics.h"

namespace tandem::pipeline {

namespace {

using world::Workcell;

/// Goals of a query before its arms are placed: what is known, and which arms are.
struct Placement {
  Eigen::VectorXd q;
  world::ArmMask placed = 0;
};

/// How inverse kinematics searches.
struct Search {
  std::uint64_t seed;
  const StopCondition& stop;
};

world::ArmMask bit(int arm) { return world::ArmMask{1} << arm; }

/// Solves a pose for one arm, free of collisions with the world, itself and the arms placed so far.
Result<Eigen::VectorXd> solve_pose(const Planner& planner,
                                   const std::shared_ptr<const Workcell>& cell, int arm,
                                   const Eigen::Isometry3d& X_WE, const Placement& so_far,
                                   const Search& search) {
  const world::Arm& a = cell->arms()[static_cast<std::size_t>(arm)];
  const auto compiled = planner.compiled(cell);
  const collision::SsvChecker& checker = compiled->exact();
  const auto scratch = checker.make_scratch();
  const world::PairSelection& selection =
      compiled->selection(world::PairScope::arm(arm, so_far.placed));
  Eigen::VectorXd q = so_far.q;

  robot::IkProblem problem;
  problem.model = &cell->model();
  problem.link = a.tip_link;
  problem.X_LE = a.X_LE;
  problem.columns = a.columns;
  cell->positions(so_far.q, problem.positions);
  problem.X_WE = X_WE;
  robot::IkOptions options;
  options.seed = search.seed;
  const auto validity = [&](const Eigen::VectorXd& positions) -> std::string {
    for (int j = 0; j < a.dof(); ++j) {
      q[a.offset + j] = positions[a.columns[static_cast<std::size_t>(j)]];
    }
    if (checker.is_free(q, selection, *scratch)) return "";
    const int pair = checker.least_clearance(q, selection, *scratch).pair;
    return cell->describe_pair(pair) + " touch";
  };
  auto positions = robot::solve_ik(problem, options, validity, search.stop);
  if (!positions) return std::unexpected(positions.error());
  Eigen::VectorXd values(a.dof());
  for (int j = 0; j < a.dof(); ++j) {
    values[j] = (*positions)[a.columns[static_cast<std::size_t>(j)]];
  }
  return values;
}

/// Places every arm that has a goal: joint values and named states first, then poses in arm order.
Result<void> place(const Planner& planner, const std::shared_ptr<const Workcell>& cell,
                   const std::vector<std::optional<world::ArmGoal>>& goals, const std::string& what,
                   const Search& search, Placement& placement) {
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
      auto values = solve_pose(planner, cell, i, pose->X_WE, placement, search);
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

/// How things stand between two queries.
struct Standing {
  std::shared_ptr<const Workcell> cell;
  Eigen::VectorXd q;
};

/// The query, from how the one before left things.
Result<ResolvedQuery> follow(const Planner& planner, const Standing& before,
                             const world::Query& query, const Search& search) {
  const auto what = [&](const char* end) { return end + (" of query '" + query.name + "'"); };
  Placement start = standing(*before.cell, before.q, query.start);
  auto placed = place(planner, before.cell, query.start, what("start"), search, start);
  if (!placed) return std::unexpected(placed.error());
  auto cell = world::after_changes(before.cell, query.changes, start.q);
  if (!cell) {
    return fail(cell.error().code, "query '" + query.name + "': " + cell.error().message);
  }
  Placement goal = standing(**cell, start.q, query.goal);
  placed = place(planner, *cell, query.goal, what("goal"), search, goal);
  if (!placed) return std::unexpected(placed.error());
  return ResolvedQuery{query.name, start.q, goal.q, std::move(*cell)};
}

bool is_complete(const world::Query& query) {
  return std::ranges::all_of(query.start, [](const auto& arm) { return arm.has_value(); });
}

/// Whether every arm of the first query has a start.
Result<void> check_first(const Workcell& cell, const world::Query& query) {
  for (std::size_t i = 0; i < cell.arms().size(); ++i) {
    if (query.start[i]) continue;
    return fail(ErrorCode::kInvalidInput,
                "query '" + query.name + "': arm '" + cell.arms()[i].name +
                    "' has no start and no query before says where it is; give it a `start:`");
  }
  return {};
}

using Queries = std::span<const world::Query>;

Result<ResolvedQuery> follow_all(const Planner& planner,
                                 const std::shared_ptr<const Workcell>& cell, Queries queries,
                                 const Search& search,
                                 const std::function<void(const ResolvedQuery&)>& visit = {}) {
  if (auto first = check_first(*cell, queries.front()); !first) {
    return std::unexpected(first.error());
  }
  Standing at{cell, Eigen::VectorXd::Zero(cell->dof())};
  Result<ResolvedQuery> resolved;
  for (const world::Query& query : queries) {
    resolved = follow(planner, at, query, search);
    if (!resolved) return resolved;
    if (visit) visit(*resolved);
    at = {resolved->cell, resolved->goal};
  }
  return resolved;
}

/// The cell of the file, whatever scene `cell` is in.
Result<std::shared_ptr<const Workcell>> at_first(const std::shared_ptr<const Workcell>& cell) {
  if (cell->scene().objects.empty() && cell->scene().allowed.empty()) return cell;
  return cell->in_scene({});
}

}  // namespace

Result<ResolvedQuery> resolve_query(const Planner& planner, const world::Query& query,
                                    std::uint64_t seed, const StopCondition& stop) {
  const std::shared_ptr<const Workcell>& cell = planner.cell();
  expects(query.start.size() == cell->arms().size() && query.goal.size() == cell->arms().size(),
          "a query has one start and one goal entry per arm");
  const std::vector<world::Query>* list = cell->list_of(query.name);
  if (list == nullptr) return follow_all(planner, cell, {&query, 1}, {seed, stop});
  const auto own = std::ranges::find(*list, query.name, &world::Query::name);
  // From the last query that says where every arm is, unless one before it changed the scene.
  auto first = own;
  while (first != list->begin() && !is_complete(first == own ? query : *first)) --first;
  const auto changing = std::ranges::find_if(
      list->begin(), first, [](const world::Query& q) { return !q.changes.empty(); });
  if (changing != first) first = list->begin();
  std::vector<world::Query> chain(first, own);
  chain.push_back(query);
  const auto base = at_first(planner.cell());
  if (!base) return std::unexpected(base.error());
  return follow_all(planner, *base, chain, {seed, stop});
}

Result<std::vector<ResolvedQuery>> resolve_queries(const Planner& planner,
                                                   const std::vector<world::Query>& queries,
                                                   std::uint64_t seed, const StopCondition& stop) {
  std::vector<ResolvedQuery> resolved;
  if (queries.empty()) return resolved;
  const auto base = at_first(planner.cell());
  if (!base) return std::unexpected(base.error());
  const auto last = follow_all(planner, *base, queries, {seed, stop},
                               [&](const ResolvedQuery& one) { resolved.push_back(one); });
  if (!last) return std::unexpected(last.error());
  return resolved;
}

}  // namespace tandem::pipeline
