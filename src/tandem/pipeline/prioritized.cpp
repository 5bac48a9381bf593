#include "tandem/pipeline/prioritized.h"

#include <algorithm>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"
#include "tandem/planning/measured_path.h"
#include "tandem/planning/rrt_connect.h"
#include "tandem/planning/simplifier.h"

namespace tandem::pipeline {

using Eigen::VectorXd;
using motion::JointPath;
using planning::MeasuredPath;

namespace {

/// Where one arm may be while others are at a place of their path: points (q of the arm, way of the
/// others [rad]).
class AroundOthers final : public planning::Validity {
 public:
  /// @param others  configurations of the cell; the arm's own entries do not matter.
  /// @param whole   answers for the cell: the pairs that the arm moves, alone or with the others.
  AroundOthers(const world::Arm& arm, const MeasuredPath& others, planning::Validity& whole)
      : arm_(arm), others_(others), whole_(whole) {}

  VectorXd configuration(const VectorXd& point) const {
    VectorXd q = others_.position(fraction(point));
    q.segment(arm_.offset, arm_.dof()) = point.head(arm_.dof());
    return q;
  }
  /// Appends the configurations after `a` on the straight way to `b`: those with the others at a
  /// waypoint, and `b`.
  void append(const VectorXd& a, const VectorXd& b, JointPath& path) const {
    std::vector<double> parts{1.0};
    others_.append_waypoints(fraction(a), fraction(b), parts);
    std::ranges::sort(parts);
    for (const double part : parts) {
      path.push_back(configuration(part < 1 ? VectorXd(a + part * (b - a)) : b));
    }
  }

  bool state(const VectorXd& point) override { return whole_.state(configuration(point)); }
  bool edge(const VectorXd& a, const VectorXd& b) override {
    JointPath path{configuration(a)};
    append(a, b, path);
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (!whole_.edge(path[i - 1], path[i])) return false;
    }
    return true;
  }
  const planning::ValidityStats& stats() const override { return whole_.stats(); }

 private:
  double fraction(const VectorXd& point) const {
    const double length = others_.length();
    return length > 0 ? point[arm_.dof()] / length : 0.0;
  }

  const world::Arm& arm_;
  const MeasuredPath& others_;
  planning::Validity& whole_;
};

/// The arm's entries of both ends, and the whole way of the others.
planning::PathProblem problem_around(const world::Workcell& cell, const world::Arm& arm,
                                     const ResolvedQuery& ends, double way) {
  const auto with = [&](const VectorXd& q, double at) {
    VectorXd point(arm.dof() + 1);
    point << q.segment(arm.offset, arm.dof()), at;
    return point;
  };
  return {with(ends.start, 0), with(ends.goal, way), with(cell.lower(), 0),
          with(cell.upper(), way)};
}

}  // namespace

Result<JointPath> plan_prioritized(const collision::CompiledCell& compiled,
                                   const ResolvedQuery& ends, const JointPath& first,
                                   const std::vector<int>& order, std::uint64_t seed,
                                   const StopCondition& stop, const PrioritizedOptions& options) {
  const world::Workcell& cell = compiled.cell();
  expects(order.size() == cell.arms().size(), "an order names every arm once");
  expects(first.size() >= 2, "the first arm has a path");
  const auto arm_at = [&](std::size_t k) -> const world::Arm& {
    return cell.arms()[static_cast<std::size_t>(order[k])];
  };
  Rng rng(seed);
  planning::RrtConnectOptions search;
  search.most_samples = options.most_samples;
  const auto planner = planning::make_rrt_connect(search);
  const auto simplifier = planning::make_simplifier();

  JointPath path(first.size(), ends.start);
  for (std::size_t i = 0; i < first.size(); ++i) {
    path[i].segment(arm_at(0).offset, arm_at(0).dof()) = first[i];
  }
  world::ArmMask before = world::ArmMask{1} << order[0];
  for (std::size_t k = 1; k < order.size(); ++k) {
    const auto whole = planning::make_batch_validity(
        compiled.batch(), compiled.pairs(world::PairScope::arm(order[k], before)), stop);
    const MeasuredPath others(std::move(path));
    AroundOthers around(arm_at(k), others, *whole);
    const auto problem = problem_around(cell, arm_at(k), ends, others.length());
    auto found = planner->plan(problem, around, rng.split(), stop);
    if (!found) return std::unexpected(found.error());
    const JointPath way =
        simplifier->simplify(problem, std::move(*found), around, rng.split(), stop);
    path = {around.configuration(way.front())};
    for (std::size_t i = 1; i < way.size(); ++i) around.append(way[i - 1], way[i], path);
    before |= world::ArmMask{1} << order[k];
  }
  path.front() = ends.start;
  path.back() = ends.goal;
  return planning::without_duplicates(path);
}

}  // namespace tandem::pipeline
