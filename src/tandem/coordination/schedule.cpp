#include <algorithm>
#include <bit>
#include <cstdio>
#include <limits>

#include "tandem/coordination/coordinator.h"
#include "tandem/core/contract.h"

namespace tandem::coordination {

using Eigen::Index, Eigen::VectorXd;

Schedule make_schedule(const std::vector<VectorXd>& places) {
  expects(!places.empty(), "a schedule needs a place");
  Schedule schedule{{places.front()}, {0.0}};
  for (const VectorXd& place : places) {
    const double longest = (place - schedule.places.back()).cwiseAbs().maxCoeff();
    const double time = schedule.times.back() + longest;
    if (!(time > schedule.times.back())) continue;
    schedule.places.push_back(place);
    schedule.times.push_back(time);
  }
  schedule.places.back() = places.back();
  return schedule;
}

Result<void> Coordinator::explore(const CoordinationProblem& problem, std::uint64_t seed,
                                  const StopCondition& stop, const Use& use) const {
  const auto schedule = coordinate(problem, seed, stop);
  if (!schedule) return std::unexpected(schedule.error());
  use(*schedule);
  return {};
}

Result<std::vector<Schedule>> Coordinator::alternatives(const CoordinationProblem& problem,
                                                        int most, std::uint64_t seed,
                                                        const StopCondition& stop) const {
  expects(most > 0, "at least one schedule is asked for");
  std::vector<Schedule> schedules;
  const auto explored = explore(problem, seed, stop, [&](const Schedule& schedule) {
    if (static_cast<int>(schedules.size()) < most) schedules.push_back(schedule);
    return static_cast<int>(schedules.size()) < most ? std::numeric_limits<double>::infinity()
                                                     : 0.0;
  });
  if (!explored) return std::unexpected(explored.error());
  std::ranges::stable_sort(schedules.begin() + 1, schedules.end(), {}, &Schedule::makespan);
  return schedules;
}

VectorXd durations(const CoordinationProblem& problem) {
  VectorXd T(static_cast<Index>(problem.arms.size()));
  for (Index i = 0; i < T.size(); ++i) {
    T[i] = problem.arms[static_cast<std::size_t>(i)].duration();
  }
  return T;
}

world::PairSelection pairs_between_arms(const world::Workcell& cell) {
  world::PairSelection selection;
  for (int i = 0; i < static_cast<int>(cell.pairs().size()); ++i) {
    if (std::popcount(cell.pairs()[static_cast<std::size_t>(i)].moved_by) > 1) {
      selection.push_back(i);
    }
  }
  return selection;
}

void check_arms(const CoordinationProblem& problem) {
  const auto& arms = problem.cell().arms();
  expects(problem.arms.size() == arms.size(), "there is one motion per arm of the cell");
  for (std::size_t i = 0; i < arms.size(); ++i) {
    expects(problem.arms[i].dof() == arms[i].dof(), "an arm's motion moves all its joints");
  }
}

Result<void> check_problem(const CoordinationProblem& problem,
                           collision::CollisionChecker::Scratch& scratch) {
  check_arms(problem);
  const world::Workcell& cell = problem.cell();
  const world::PairSelection pairs = pairs_between_arms(cell);
  const VectorXd T = durations(problem);
  const PlacesEdge diagonal(problem.arms, VectorXd::Zero(T.size()), T);
  VectorXd q(cell.dof());
  for (const double t : {0.0, 1.0}) {
    diagonal.position(t, q);
    if (problem.exact().is_free(q, pairs, scratch)) continue;
    const auto nearest = problem.exact().least_clearance(q, pairs, scratch);
    return fail(ErrorCode::kInfeasible,
                std::string("with all arms at the ") + (t == 0 ? "start" : "goal") + " touch " +
                    describe(cell, nearest) + ": no coordination changes that");
  }
  return {};
}

Result<void> check_problem(const CoordinationProblem& problem,
                           collision::BatchChecker::Scratch& scratch) {
  check_arms(problem);
  const VectorXd T = durations(problem);
  const PlacesEdge diagonal(problem.arms, VectorXd::Zero(T.size()), T);
  Eigen::MatrixXd ends(problem.cell().dof(), 2);
  for (const int end : {0, 1}) diagonal.position(end, ends.col(end));
  const auto pairs = problem.compiled.pairs(world::PairScope::several());
  if (problem.compiled.batch().are_free(ends, *pairs, scratch)) return {};
  return check_problem(problem, *problem.exact().make_scratch());
}

PlacesEdge::PlacesEdge(const std::vector<motion::PiecewiseCubic>& arms, VectorXd a, VectorXd b)
    : arms_(arms), a_(std::move(a)), d_(std::move(b)) {
  expects(a_.size() == static_cast<Index>(arms.size()) && d_.size() == a_.size(),
          "a place has one local time per arm");
  d_ -= a_;
  for (const auto& arm : arms_) dof_ += arm.dof();
}

void PlacesEdge::position(double t, Eigen::Ref<VectorXd> q) const {
  Index first = 0;
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    const auto k = static_cast<Index>(i);
    arms_[i].position(a_[k] + t * d_[k], q.segment(first, arms_[i].dof()));
    first += arms_[i].dof();
  }
}

motion::JointState PlacesEdge::at(double t) const {
  motion::JointState state;
  for (VectorXd* v : {&state.q, &state.qd, &state.qdd, &state.qddd}) v->resize(dof_);
  Index first = 0;
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    const auto k = static_cast<Index>(i);
    const Index n = arms_[i].dof();
    const motion::JointState part = arms_[i].at(a_[k] + t * d_[k]);
    state.q.segment(first, n) = part.q;
    state.qd.segment(first, n) = d_[k] * part.qd;
    state.qdd.segment(first, n) = d_[k] * d_[k] * part.qdd;
    state.qddd.segment(first, n) = d_[k] * d_[k] * d_[k] * part.qddd;
    first += n;
  }
  return state;
}

void PlacesEdge::deviation(double t0, double t1, Eigen::Ref<VectorXd> D) const {
  Index first = 0;
  for (std::size_t i = 0; i < arms_.size(); ++i) {
    const auto k = static_cast<Index>(i);
    const double from = a_[k] + t0 * d_[k], to = a_[k] + t1 * d_[k];
    arms_[i].deviation(std::min(from, to), std::max(from, to), D.segment(first, arms_[i].dof()));
    first += arms_[i].dof();
  }
}

collision::Certificate certify_edge(const CoordinationProblem& problem, const VectorXd& a,
                                    const VectorXd& b, const world::PairSelection& pairs,
                                    collision::CollisionChecker::Scratch& scratch,
                                    const StopCondition& stop) {
  return collision::certify(problem.exact(), PlacesEdge(problem.arms, a, b), pairs, scratch, {},
                            stop);
}

collision::Certificate certify_schedule(const CoordinationProblem& problem,
                                        const Schedule& schedule,
                                        collision::CollisionChecker::Scratch& scratch,
                                        const StopCondition& stop) {
  expects(!schedule.places.empty() && schedule.places.size() == schedule.times.size(),
          "a schedule has a time for each place");
  const world::PairSelection pairs = pairs_between_arms(problem.cell());
  collision::Certificate whole;
  whole.verdict = collision::Verdict::kFree;
  for (std::size_t k = 1; k < schedule.places.size(); ++k) {
    auto part =
        certify_edge(problem, schedule.places[k - 1], schedule.places[k], pairs, scratch, stop);
    part.time = schedule.times[k - 1] + part.time * (schedule.times[k] - schedule.times[k - 1]);
    part.evaluations += whole.evaluations;
    if (!part.is_free()) return part;
    if (part.least_clearance < whole.least_clearance) whole = part;
    whole.evaluations = part.evaluations;
  }
  return whole;
}

std::string describe_blocking(const world::Workcell& cell, int pair, const VectorXd& place) {
  std::string text = cell.describe_pair(pair);
  const world::ArmMask moved_by = cell.pairs()[static_cast<std::size_t>(pair)].moved_by;
  const char* joint = " with ";
  for (std::size_t i = 0; i < cell.arms().size(); ++i) {
    if (!(moved_by >> i & 1)) continue;
    char at[32];
    std::snprintf(at, sizeof at, " at %.3f s", place[static_cast<Index>(i)]);
    text.append(joint).append(cell.arms()[i].name).append(at);
    joint = " and ";
  }
  return text + " of their own motions";
}

}  // namespace tandem::coordination
