#include "tandem/pipeline/decoupled.h"

#include <algorithm>
#include <exception>
#include <numeric>
#include <thread>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"
#include "tandem/pipeline/centralized.h"
#include "tandem/pipeline/coordinate.h"
#include "tandem/pipeline/modules.h"
#include "tandem/pipeline/prioritized.h"
#include "tandem/planning/measured_path.h"

namespace tandem::pipeline {

using motion::CellMotion;
using motion::JointPath;

const char* to_string(Rung rung) {
  switch (rung) {
    case Rung::kCoordinated:
      return "coordinated";
    case Rung::kCandidates:
      return "candidates";
    case Rung::kPrioritized:
      return "prioritized";
    case Rung::kCentralized:
      return "centralized";
  }
  return "unknown";
}

namespace {

/// Most sets of candidates that are coordinated after each new candidate per arm.
constexpr std::size_t kMostSets = 24;
/// `auto` looks for a centralized plan where coordination makes the motion longer than the slowest
/// arm's by more than this fraction.
constexpr double kWorthwhile = 0.25;

/// One arm planned as if it were alone.
struct ArmTry {
  Result<PlannedMotion> motion = fail(ErrorCode::kNoPath, "not tried");
  PlanReport report;
};

/// What came of it if it went well.
struct ArmPlan {
  JointPath path;
  motion::PiecewiseCubic curve;
  double least_clearance;  ///< [m] certified, of the pairs that the arm alone moves.
};

/// Calls f(0), ..., f(count - 1) at the same time, on a thread each; rethrows what one throws.
template <class F>
void at_once(std::size_t count, const F& f) {
  std::vector<std::exception_ptr> thrown(count);
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < count; ++i) {
      threads.emplace_back([&, i] {
        try {
          f(i);
        } catch (...) {
          thrown[i] = std::current_exception();
        }
      });
    }
  }
  for (const std::exception_ptr& exception : thrown) {
    if (exception) std::rethrow_exception(exception);
  }
}

/// Adds what a part of the work cost.
void add_costs(const PlanReport& part, PlanReport& whole) {
  whole.times += part.times;
  whole.counts += part.counts;
  for (const auto& [rung, count] : part.rungs) whole.rungs[rung] += count;
}

/// Paths of the arms as one path of the cell: at every place that one of them has a waypoint, by
/// the fraction of their lengths.
JointPath side_by_side(const world::Workcell& cell, const std::vector<JointPath>& paths) {
  std::vector<planning::MeasuredPath> measured(paths.begin(), paths.end());
  std::vector<double> places;
  for (const auto& path : measured) {
    places.insert(places.end(), path.waypoints().begin(), path.waypoints().end());
  }
  places.push_back(1.0);
  std::ranges::sort(places);
  places.erase(std::unique(places.begin(), places.end()), places.end());
  JointPath whole;
  for (const double s : places) {
    whole.emplace_back(cell.dof());
    for (std::size_t i = 0; i < measured.size(); ++i) {
      const world::Arm& arm = cell.arms()[i];
      whole.back().segment(arm.offset, arm.dof()) = measured[i].position(s);
    }
  }
  return whole;
}

/// The steps of the ladder, and what they share.
class Ladder {
 public:
  Ladder(const collision::CompiledCell& compiled, const ResolvedQuery& ends,
         const PlanOptions& options, const StopCondition& stop, PlanReport& report, int candidates)
      : compiled_(compiled),
        ends_(ends),
        options_(options),
        stop_(stop),
        report_(report),
        candidates_(static_cast<std::size_t>(candidates)),
        rng_(options.seed),
        plans_(compiled.cell().arms().size()) {}

  Result<CellMotion> climb(Rung rung);
  Result<CellMotion> centralized(const StopCondition& stop);
  /// The duration of the slowest arm: no coordination of these motions is shorter.
  double slowest() const;
  /// What spoke against coordinating the first motions.
  const Error& blocked() const { return blocked_; }

 private:
  using Indices = std::vector<std::size_t>;  ///< By arm: which of its motions.

  std::size_t arms() const { return plans_.size(); }
  Result<void> add_motions();
  ArmTry plan_arm(std::size_t i, std::uint64_t seed) const;
  Result<CellMotion> coordinated(const Indices& indices);
  Result<CellMotion> first_motions();
  Result<CellMotion> further_motions();
  Result<CellMotion> prioritized();
  std::vector<Indices> new_sets() const;
  void account(const std::vector<ArmTry>& tries);
  void keep(const std::vector<ArmTry>& tries);
  CellMotion adopted(PlannedMotion planned, PlanReport part);

  const collision::CompiledCell& compiled_;
  const ResolvedQuery& ends_;
  const PlanOptions& options_;
  const StopCondition& stop_;
  PlanReport& report_;
  std::size_t candidates_;
  Rng rng_;
  std::vector<std::vector<ArmPlan>> plans_;  ///< By arm, as many for each.
  Error blocked_{ErrorCode::kCoordination, "nothing was coordinated"};
};

Result<CellMotion> Ladder::climb(Rung rung) {
  Result<CellMotion> motion = [&]() -> Result<CellMotion> {
    if (rung == Rung::kCentralized) return centralized(stop_);
    if (plans_[0].empty()) {
      if (auto done = add_motions(); !done) return std::unexpected(done.error());
    }
    if (rung == Rung::kCoordinated) return first_motions();
    return rung == Rung::kCandidates ? further_motions() : prioritized();
  }();
  if (motion) ++report_.rungs[to_string(rung)];
  return motion;
}

Result<CellMotion> Ladder::centralized(const StopCondition& stop) {
  PlanReport part;
  auto planned = plan_motion(compiled_, ends_, options_, stop, part);
  if (!planned) {
    add_costs(part, report_);
    return std::unexpected(planned.error());
  }
  return adopted(std::move(*planned), std::move(part));
}

double Ladder::slowest() const {
  double longest = 0;
  for (const auto& plans : plans_) longest = std::max(longest, plans[0].curve.duration());
  return longest;
}

/// One more motion of every arm.
Result<void> Ladder::add_motions() {
  std::vector<std::uint64_t> seeds(arms());
  for (std::uint64_t& seed : seeds) seed = rng_.split();
  std::vector<ArmTry> tries(arms());
  at_once(arms(), [&](std::size_t i) { tries[i] = plan_arm(i, seeds[i]); });
  account(tries);
  for (std::size_t i = 0; i < arms(); ++i) {
    if (tries[i].motion) continue;
    const Error& error = tries[i].motion.error();
    return fail(error.code,
                "arm '" + compiled_.cell().arms()[i].name + "' alone: " + error.message);
  }
  if (plans_[0].empty()) keep(tries);
  for (std::size_t i = 0; i < arms(); ++i) {
    PlannedMotion& planned = *tries[i].motion;
    plans_[i].push_back({std::move(planned.path), planned.curve.arms()[0].spline(),
                         tries[i].report.least_clearance});
  }
  return {};
}

ArmTry Ladder::plan_arm(std::size_t i, std::uint64_t seed) const {
  const collision::CompiledCell& alone = compiled_.alone(static_cast<int>(i));
  const world::Arm& arm = compiled_.cell().arms()[i];
  const ResolvedQuery ends{ends_.name, ends_.start.segment(arm.offset, arm.dof()),
                           ends_.goal.segment(arm.offset, arm.dof()), alone.shared_cell()};
  PlanOptions options = options_;
  options.seed = seed;
  ArmTry made;
  {
    ModuleTimer timer(made.report.times.total);
    made.motion = plan_motion(alone, ends, options, stop_, made.report);
  }
  return made;
}

/// The times of each arm, and those of the slowest as the plan's: they run at once.
void Ladder::account(const std::vector<ArmTry>& tries) {
  report_.arm_times.resize(arms());
  const ArmTry* slowest = &tries[0];
  for (std::size_t i = 0; i < arms(); ++i) {
    const PlanReport& report = tries[i].report;
    report_.arm_times[i] += report.times;
    report_.counts += report.counts;
    for (const auto& [rung, count] : report.rungs) report_.rungs[rung] += count;
    if (report.times.total > slowest->report.times.total) slowest = &tries[i];
  }
  const double total = report_.times.total;  // Measured around everything.
  report_.times += slowest->report.times;
  report_.times.total = total;
}

/// Lengths and phases of the motions that were planned first.
void Ladder::keep(const std::vector<ArmTry>& tries) {
  report_.arms.clear();
  for (const ArmTry& made : tries) report_.arms.push_back(made.report.arms.at(0));
  std::size_t count = tries[0].report.phases.size();
  for (const ArmTry& made : tries) count = std::max(count, made.report.phases.size());
  for (std::size_t k = 0; k < count; ++k) {
    Phase phase;
    std::vector<JointPath> paths;
    for (const ArmTry& made : tries) {
      const std::vector<Phase>& phases = made.report.phases;
      // An arm that stands still has no phases.
      if (k < phases.size()) phase.name = phases[k].name;
      paths.push_back(k < phases.size() ? phases[k].path : made.motion->path);
    }
    phase.path = side_by_side(compiled_.cell(), paths);
    report_.phases.push_back(std::move(phase));
  }
}

Result<CellMotion> Ladder::coordinated(const Indices& indices) {
  std::vector<motion::PiecewiseCubic> curves;
  double least_clearance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < arms(); ++i) {
    const ArmPlan& plan = plans_[i][indices[i]];
    curves.push_back(plan.curve);
    least_clearance = std::min(least_clearance, plan.least_clearance);
  }
  PlanOptions options = options_;
  options.seed = rng_.split();
  auto motion = coordinate(compiled_, std::move(curves), options, stop_, report_);
  if (motion) report_.least_clearance = std::min(report_.least_clearance, least_clearance);
  return motion;
}

Result<CellMotion> Ladder::first_motions() {
  auto motion = coordinated(Indices(arms(), 0));
  if (!motion) blocked_ = motion.error();
  return motion;
}

Result<CellMotion> Ladder::further_motions() {
  while (plans_[0].size() < candidates_) {
    if (auto done = add_motions(); !done) return std::unexpected(done.error());
    for (const Indices& set : new_sets()) {
      if (stop_()) return std::unexpected(stop_.error("coordinating further motions"));
      auto motion = coordinated(set);
      if (motion || stop_()) return motion;
    }
  }
  return std::unexpected(blocked_);
}

/// Sets with the newest motion of an arm, the quickest first.
std::vector<Ladder::Indices> Ladder::new_sets() const {
  const std::size_t newest = plans_[0].size() - 1;
  std::vector<Indices> sets;
  for (Indices set(arms(), 0); sets.size() < kMostSets;) {
    if (std::ranges::find(set, newest) != set.end()) sets.push_back(set);
    const auto digit = std::ranges::find_if(set, [&](std::size_t i) { return i < newest; });
    if (digit == set.end()) break;
    std::fill(set.begin(), digit, 0);
    ++*digit;
  }
  const auto longest = [&](const Indices& set) {
    double duration = 0;
    for (std::size_t i = 0; i < set.size(); ++i) {
      duration = std::max(duration, plans_[i][set[i]].curve.duration());
    }
    return duration;
  };
  std::ranges::stable_sort(sets, {}, longest);
  return sets;
}

/// Every order in which arms keep their paths or go around them.
Result<CellMotion> Ladder::prioritized() {
  Error last = blocked_;
  for (const std::vector<int>& order : planning::orders(static_cast<int>(arms()))) {
    PlanReport part;
    PlanOptions options = options_;
    options.seed = rng_.split();
    auto planned = [&]() -> Result<PlannedMotion> {
      const JointPath& first = plans_[static_cast<std::size_t>(order[0])][0].path;
      Result<JointPath> path = [&] {
        ModuleTimer timer(part.times.path_planning);
        return plan_prioritized(compiled_, ends_, first, order, options.seed, stop_);
      }();
      if (!path) return std::unexpected(path.error());
      return finish_path(compiled_, ends_, std::move(*path), options, stop_, part);
    }();
    if (planned) return adopted(std::move(*planned), std::move(part));
    add_costs(part, report_);
    last = planned.error();
    if (stop_()) break;
  }
  return std::unexpected(last);
}

/// A motion of all arms together: what the report says of paths is about it.
CellMotion Ladder::adopted(PlannedMotion planned, PlanReport part) {
  add_costs(part, report_);
  report_.arms = std::move(part.arms);
  report_.phases = std::move(part.phases);
  report_.least_clearance = part.least_clearance;
  return std::move(planned.curve);
}

}  // namespace

Result<CellMotion> plan_decoupled(const collision::CompiledCell& compiled,
                                  const ResolvedQuery& ends, const PlanOptions& options,
                                  const StopCondition& stop, PlanReport& report,
                                  const LadderOptions& ladder) {
  expects(ladder.first <= ladder.last && ladder.candidates > 0,
          "the ladder has a rung, and motions to coordinate");
  Ladder steps(compiled, ends, options, stop, report, ladder.candidates);
  if (options.preset == Preset::kPaper) return steps.climb(Rung::kCoordinated);
  for (int rung = static_cast<int>(ladder.first);; ++rung) {
    auto motion = steps.climb(static_cast<Rung>(rung));
    if (motion || stop() || rung == static_cast<int>(ladder.last)) return motion;
  }
}

Result<CellMotion> plan_auto(const collision::CompiledCell& compiled, const ResolvedQuery& ends,
                             const PlanOptions& options, const StopCondition& stop,
                             PlanReport& report) {
  Ladder steps(compiled, ends, options, stop, report, LadderOptions{}.candidates);
  auto coordinated = steps.climb(Rung::kCoordinated);
  if (stop() || options.preset == Preset::kPaper) return coordinated;
  if (!coordinated) return steps.climb(Rung::kCentralized);
  const double extra = coordinated->duration() - steps.slowest();
  if (extra <= kWorthwhile * steps.slowest()) return coordinated;
  // What takes longer to plan than the arms would wait is no gain.
  const PlanReport before = report;
  auto together = steps.centralized(stop.within(extra));
  if (together && together->duration() < coordinated->duration()) {
    report.rungs.erase(to_string(Rung::kCoordinated));
    ++report.rungs[to_string(Rung::kCentralized)];
    return together;
  }
  if (together) {  // Its cost remains, what is said of paths is about the other.
    report.arms = before.arms;
    report.phases = before.phases;
    report.least_clearance = before.least_clearance;
  }
  return coordinated;
}

}  // namespace tandem::pipeline
