#include "tandem/pipeline/path.h"

#include <algorithm>
#include <cstdio>

#include "tandem/collision/certificate.h"
#include "tandem/core/contract.h"

namespace tandem::pipeline {

namespace {

using motion::JointPath;

std::string refusal(const world::Workcell& cell, const collision::Certificate& certificate,
                    std::size_t edge, std::size_t edges) {
  const std::string pair = certificate.pair < 0 ? "nothing" : cell.describe_pair(certificate.pair);
  char text[160];
  if (certificate.verdict == collision::Verdict::kCollision) {
    std::snprintf(text, sizeof text, " touch after %.4f of it, %.6f m deep", certificate.time,
                  certificate.depth);
  } else {
    std::snprintf(text, sizeof text, " come too close for a proof after %.4f of it",
                  certificate.time);
  }
  return "edge " + std::to_string(edge) + " of " + std::to_string(edges) + ": " + pair + text;
}

}  // namespace

void account(const Modules& modules, PlanReport& report) {
  const planning::ValidityStats& stats = modules.validity->stats();
  report.counts.state_checks = stats.states;
  report.counts.edge_checks = stats.edges;
  report.times.distance = stats.seconds + report.times.certificate;
}

PathPlan simplified(const collision::CompiledCell& compiled, const Modules& modules,
                    const ResolvedQuery& ends, JointPath planned, const PlanOptions& options,
                    const StopCondition& stop, PlanReport& report) {
  const world::Workcell& cell = compiled.cell();
  const planning::PathProblem problem{ends.start, ends.goal, cell.lower(), cell.upper()};
  PathPlan found{std::move(planned), {}};
  {
    ModuleTimer timer(report.times.simplification);
    found.path =
        modules.simplifier->simplify(problem, found.planned, *modules.validity, options.seed, stop);
  }
  account(modules, report);
  if (options.keep_phases) {
    report.phases.push_back({"planned", found.planned});
    report.phases.push_back({"simplified", found.path});
  }
  return found;
}

Result<PathPlan> find_path(const collision::CompiledCell& compiled, const Modules& modules,
                           const ResolvedQuery& ends, const PlanOptions& options,
                           const StopCondition& stop, PlanReport& report) {
  const world::Workcell& cell = compiled.cell();
  const planning::PathProblem problem{ends.start, ends.goal, cell.lower(), cell.upper()};
  Result<JointPath> planned = [&] {
    ModuleTimer timer(report.times.path_planning);
    return modules.planner->plan(problem, *modules.validity, options.seed, stop);
  }();
  account(modules, report);
  if (!planned) return std::unexpected(planned.error());
  return simplified(compiled, modules, ends, std::move(*planned), options, stop, report);
}

Result<PathPlan> find_path(const collision::CompiledCell& compiled, const ResolvedQuery& ends,
                           const PlanOptions& options, PlanReport& report) {
  report = {};
  const StopCondition stop = StopCondition::after(options.deadline, options.token);
  const Modules modules = make_modules(options.preset, compiled, stop);
  auto found = [&] {
    ModuleTimer timer(report.times.total);
    return find_path(compiled, modules, ends, options, stop, report);
  }();
  if (!found && found.error().code == ErrorCode::kInfeasible) {
    // The planner says that an end is not valid, this says why.
    if (auto feasible = check_ends(compiled, ends); !feasible) {
      return std::unexpected(feasible.error());
    }
  }
  return found;
}

Result<double> certify_path(const collision::CompiledCell& compiled, const JointPath& path,
                            const StopCondition& stop) {
  expects(path.size() >= 2, "a path has at least two waypoints");
  const collision::SsvChecker& checker = compiled.exact();
  const world::PairSelection& selection = compiled.selection(world::PairScope::all());
  const auto scratch = checker.make_scratch();
  // Planners prove edges down to a few micrometres of clearance; no less is asked here.
  constexpr collision::CertificateOptions kFinest{.smallest_deviation = 1e-7, .clearance_ratio = 0};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < path.size(); ++i) {
    const collision::Certificate certificate = collision::certify(
        checker, motion::StraightEdge(path[i - 1], path[i]), selection, *scratch, kFinest, stop);
    if (certificate.stopped) return std::unexpected(stop.error("certificate of the path"));
    if (!certificate.is_free()) {
      return fail(ErrorCode::kCollision, refusal(checker.cell(), certificate, i, path.size() - 1));
    }
    least = std::min(least, certificate.least_clearance);
  }
  return least;
}

}  // namespace tandem::pipeline
