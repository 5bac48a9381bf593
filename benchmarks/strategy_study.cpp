/// Where it pays to plan arms apart: planning time, motion duration and failures of the strategies
/// for the first 2, 3, ... arms of a file of pose pairs, every plan verified by FCL on the URDF's
/// geometry. Usage:
/// strategy_study PROBLEMS MODEL=URDF MODEL=SRDF [PAIRS] [DEADLINE]
/// (the first PAIRS pairs whose ends are free, default 20; DEADLINE in seconds, default 10)
/// Joint limits are the URDF's; where it has none, those that problem files assume.

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "tandem/io/problem_file.h"
#include "tandem/pipeline/bench.h"
#include "tandem/pipeline/planner.h"
#include "tandem/verification/verify.h"

namespace {

using tandem::pipeline::BenchProblem;
using tandem::pipeline::Planner;
using tandem::pipeline::PlanOptions;
using tandem::pipeline::PlanReport;
using tandem::pipeline::Statistics;
using tandem::pipeline::Strategy;
using tandem::world::Workcell;
using Cell = std::shared_ptr<const Workcell>;

/// The cell with its first `arms` robots, which have one arm each.
tandem::Result<Cell> with_arms(const Workcell& whole, std::size_t arms) {
  tandem::world::WorkcellSpec spec = whole.spec();
  for (std::size_t i = arms; i < spec.robots.size(); ++i) {
    const std::string prefix = spec.robots[i].name + "/";
    const auto on_it = [&](const std::string& body) { return body.starts_with(prefix); };
    std::erase_if(spec.attached, [&](const auto& object) { return on_it(object.link); });
    std::erase_if(spec.allowed, [&](const auto& pair) { return on_it(pair.a) || on_it(pair.b); });
    for (auto& query : spec.queries) {
      query.start.erase(spec.arms[i].name);
      query.goal.erase(spec.arms[i].name);
    }
  }
  spec.robots.resize(arms);
  spec.arms.resize(arms);
  return Workcell::make(std::move(spec));
}

struct Tally {
  std::vector<double> planning, coordination, makespan;
  std::map<std::string, int> rungs, failures;
  int verified = 0;
};

void run(const Cell& cell, const BenchProblem& problem, Strategy strategy, double deadline,
         Tally& tally) {
  const Planner planner(cell);
  const auto ends = planner.resolve(cell->queries().front());
  if (!ends || !planner.check_ends(*ends)) return;
  PlanOptions options{.strategy = strategy, .deadline = deadline, .keep_phases = false};
  // Cells are compiled when first asked about: not what is measured here.
  PlanReport report;
  static_cast<void>(planner.plan(*ends, options, &report));
  const auto plan = planner.plan(*ends, options, &report);
  if (!plan) {
    ++tally.failures[to_string(plan.error().code)];
    std::fprintf(stderr, "%s, %zu arms, %s: %s\n", problem.ends.name.c_str(), cell->arms().size(),
                 to_string(strategy), plan.error().message.c_str());
    return;
  }
  tally.planning.push_back(1e3 * report.times.total);
  tally.coordination.push_back(1e3 * report.times.coordination);
  tally.makespan.push_back(plan->trajectory.duration());
  for (const auto& [rung, count] : report.rungs) tally.rungs[rung] += count;
  const auto checked =
      tandem::verification::verify(cell, plan->trajectory, ends->start, ends->goal);
  if (checked && checked->ok()) {
    ++tally.verified;
  } else {
    std::fprintf(stderr, "%s, %zu arms, %s: %s\n", problem.ends.name.c_str(), cell->arms().size(),
                 to_string(strategy),
                 checked ? checked->failures.front().c_str() : checked.error().message.c_str());
  }
}

void print(std::size_t arms, Strategy strategy, const Tally& tally) {
  const Statistics planning = Statistics::of(tally.planning);
  const Statistics coordination = Statistics::of(tally.coordination);
  const Statistics makespan = Statistics::of(tally.makespan);
  std::string notes;
  for (const auto& [rung, count] : tally.rungs) notes += " " + rung + " " + std::to_string(count);
  for (const auto& [kind, count] : tally.failures) {
    notes += " FAILED by " + kind + " " + std::to_string(count);
  }
  std::printf("%4zu  %-12s %6zu %8d %10.1f %10.1f %10.1f %12.2f %12.3f %s\n", arms,
              to_string(strategy), tally.planning.size(), tally.verified, planning.p50,
              planning.mean, planning.p95, coordination.p50, makespan.mean, notes.c_str());
  std::fflush(stdout);
}

int study(const std::vector<BenchProblem>& problems, std::size_t pairs, double deadline) {
  const auto first = problems.front().cell();
  if (!first) return std::fprintf(stderr, "%s\n", first.error().message.c_str()), 2;
  std::printf("%4s  %-12s %6s %8s %10s %10s %10s %12s %12s %s\n", "arms", "strategy", "plans",
              "verified", "p50 [ms]", "mean [ms]", "p95 [ms]", "coord. [ms]", "makespan [s]",
              "rungs");
  for (std::size_t arms = 2; arms <= (*first)->arms().size(); ++arms) {
    std::map<Strategy, Tally> tallies;
    std::size_t done = 0;
    for (const BenchProblem& problem : problems) {
      if (done == pairs) break;
      const auto whole = problem.cell();
      if (!whole) return std::fprintf(stderr, "%s\n", whole.error().message.c_str()), 2;
      const auto cell = with_arms(**whole, arms);
      if (!cell) return std::fprintf(stderr, "%s\n", cell.error().message.c_str()), 2;
      // Pairs of poses are feasible with all arms, so they are with fewer.
      ++done;
      for (const Strategy strategy :
           {Strategy::kCentralized, Strategy::kDecoupled, Strategy::kAuto}) {
        run(*cell, problem, strategy, deadline, tallies[strategy]);
      }
    }
    for (const auto& [strategy, tally] : tallies) print(arms, strategy, tally);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr,
                 "usage: strategy_study PROBLEMS MODEL=URDF MODEL=SRDF [PAIRS] [DEADLINE]\n");
    return 2;
  }
  tandem::io::ProblemRobots robots;
  for (int k : {2, 3}) {
    const std::string text = argv[k];
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      return std::fprintf(stderr, "%s is not MODEL=FILE\n", argv[k]), 2;
    }
    (k == 2 ? robots.urdf : robots.srdf)[text.substr(0, equals)] = text.substr(equals + 1);
  }
  const auto problems = tandem::io::load_problems(argv[1], robots);
  if (!problems) return std::fprintf(stderr, "%s\n", problems.error().message.c_str()), 2;
  return study(*problems, argc > 4 ? std::strtoul(argv[4], nullptr, 10) : 20,
               argc > 5 ? std::atof(argv[5]) : 10.0);
}
