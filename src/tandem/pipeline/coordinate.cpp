#include "tandem/pipeline/coordinate.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>

#include "tandem/coordination/diagram_coordinator.h"
#include "tandem/coordination/path_coordinator.h"
#include "tandem/coordination/realization.h"
#include "tandem/pipeline/modules.h"
#include "tandem/planning/ompl/ompl_planning.h"

namespace tandem::pipeline {

using coordination::CoordinationProblem;
using coordination::Interpolated;
using coordination::Interpolation;
using coordination::Realization;
using motion::CellMotion;
using motion::PiecewiseCubic;

namespace {

/// Ways around what blocks that are made motions, to take the quickest.
constexpr int kAlternatives = 3;
/// Of diagrams [s]: where arms have less time to pass each other they do not.
constexpr double kFinest = 0.008;

/// Two arms that come together in the coordinated motion.
std::string touching(const world::Workcell& cell, const collision::Certificate& certificate) {
  char text[80];
  if (certificate.verdict == collision::Verdict::kCollision) {
    std::snprintf(text, sizeof text, " touch at %.4f s, %.4f m deep", certificate.time,
                  certificate.depth);
  } else {
    std::snprintf(text, sizeof text, " come too close for a proof at %.4f s", certificate.time);
  }
  return cell.describe_pair(certificate.pair) + text;
}

/// The quickest motion along the shortest ways through the diagram.
Result<CellMotion> coordinate_by_diagram(const CoordinationProblem& problem, std::uint64_t seed,
                                         const StopCondition& stop, PlanReport& report) {
  const auto scratch = problem.compiled.batch().make_scratch();
  const auto plain = [&](Realization made) {
    report.counts.certificate_evaluations += made.evaluations;
    report.least_clearance = made.least_clearance;
    return std::move(made.motion);
  };
  if (auto made = coordination::realize_at_once(problem, *scratch, stop)) return plain(*made);
  std::optional<Realization> best;
  Error last{ErrorCode::kCoordination, ""};
  int tried = 0;
  const auto use = [&](const coordination::Schedule& schedule) {
    auto made = coordination::realize(problem, schedule, *scratch, stop);
    if (made) {
      report.counts.certificate_evaluations += made->evaluations;
      if (!best || made->motion.duration() < best->motion.duration()) best = std::move(*made);
    } else {
      last = made.error();
    }
    // A schedule is about as long as the motion along it at least.
    if (++tried == kAlternatives) return 0.0;
    return best ? best->motion.duration() : std::numeric_limits<double>::infinity();
  };
  const auto coordinator = coordination::make_diagram_coordinator({.diagram = {.finest = kFinest}});
  const auto explored = coordinator->explore(problem, seed, stop, use);
  if (stop()) return std::unexpected(stop.error("coordinating the arms"));
  if (!explored && explored.error().code != ErrorCode::kCoordination) {
    return std::unexpected(explored.error());
  }
  if (!best || best->motion.duration() > coordination::durations(problem).sum()) {
    if (auto made = coordination::realize_in_sequence(problem, *scratch, stop)) {
      ++report.rungs["one_after_the_other"];
      return plain(*made);
    }
  }
  if (!explored) return std::unexpected(explored.error());
  if (!best) return std::unexpected(last);
  report.counts.repairs += best->repairs;
  if (best->repairs > 0) ++report.rungs["coordination_repair"];
  if (best->stop_and_go) ++report.rungs["stop_and_go"];
  report.least_clearance = best->least_clearance;
  return std::move(best->motion);
}

/// The motion of one interpolation, in the paper's time or slower where limits
/// would break.
Result<CellMotion> accepted(const CoordinationProblem& problem, Interpolated made,
                            PlanReport& report) {
  const world::Workcell& cell = problem.cell();
  if (!made.certificate.is_free()) {
    return fail(ErrorCode::kCollision,
                "the coordinated motion: " + touching(cell, made.certificate) +
                    "; this preset repairs nothing, --preset default does");
  }
  constexpr double kTolerance = 1e-6;  // That of verification.
  for (const motion::ArmMotion& arm : made.motion.arms()) {
    if (const double jump = arm.largest_jumps()[1]; jump > kTolerance) {
      char text[120];
      std::snprintf(text, sizeof text, "the coordinated motion: a velocity jumps by %.4f", jump);
      return fail(ErrorCode::kLimits,
                  std::string(text) + "; choose an interpolation that is smooth, cubic or quintic");
    }
  }
  report.least_clearance = made.certificate.least_clearance;
  if (made.violations.empty()) return std::move(made.motion);
  ++report.rungs["stretch"];
  std::vector<motion::ArmMotion> slower;
  for (const motion::ArmMotion& arm : made.motion.arms()) {
    slower.push_back(arm.stretched(made.stretch));
  }
  return CellMotion(std::move(slower));
}

Result<CellMotion> coordinate_as_the_paper(const CoordinationProblem& problem,
                                           const PlanOptions& options, const StopCondition& stop,
                                           PlanReport& report) {
  const auto coordinator = coordination::make_path_coordinator(planning::make_ompl_rrt_connect(),
                                                               planning::make_ompl_simplifier());
  const auto schedule = coordinator->coordinate(problem, options.seed, stop);
  if (!schedule) {
    // A search without a way ends at the deadline: that is how the paper's
    // deadlocks end.
    const Error& error = schedule.error();
    if (error.code != ErrorCode::kTimeout) return std::unexpected(error);
    return fail(ErrorCode::kCoordination, error.message);
  }
  const auto scratch = problem.exact().make_scratch();
  auto made = coordination::interpolate_unrepaired(problem, *schedule, options.interpolation,
                                                   *scratch, stop);
  if (!made) return std::unexpected(made.error());
  return accepted(problem, std::move(*made), report);
}

}  // namespace

Result<CellMotion> coordinate(const collision::CompiledCell& compiled,
                              std::vector<PiecewiseCubic> arms, const PlanOptions& options,
                              const StopCondition& stop, PlanReport& report) {
  ModuleTimer timer(report.times.coordination);
  const CoordinationProblem problem{compiled, std::move(arms)};
  return options.preset == Preset::kPaper
             ? coordinate_as_the_paper(problem, options, stop, report)
             : coordinate_by_diagram(problem, options.seed, stop, report);
}

}  // namespace tandem::pipeline
