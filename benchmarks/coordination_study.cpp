/// How soon each coordinator brings the arms of a workcell through motions that were planned for
/// each arm alone, and what it costs to find out.
/// Usage: coordination_study WORKCELL [LIST [SEEDS]]   (all queries of the list, SEEDS sets of
/// motions each, default 10)

#include <cstdio>
#include <cstdlib>
#include <map>

#include "arm_motions.h"
#include "tandem/collision/compiled_cell.h"
#include "tandem/coordination/baselines.h"
#include "tandem/coordination/diagram_coordinator.h"
#include "tandem/coordination/sequential.h"
#include "tandem/pipeline/bench.h"
#include "tandem/tandem.h"

namespace {

using namespace tandem;
using pipeline::Statistics;

struct Column {
  std::vector<double> time_ms, makespan, ratio;
  int failed = 0;
};

using Coordinators =
    std::vector<std::pair<const char*, std::unique_ptr<coordination::Coordinator>>>;

void print_table(int problems, const Coordinators& coordinators,
                 std::map<std::string, Column>& columns) {
  std::printf(
      "%d problems\n%-12s failed  time_ms: p50    p95    p99    max   makespan: mean   of the "
      "longest: mean   max\n",
      problems, "");
  for (const auto& [name, coordinator] : coordinators) {
    const Column& column = columns[name];
    const auto time = Statistics::of(column.time_ms), makespan = Statistics::of(column.makespan),
               ratio = Statistics::of(column.ratio);
    std::printf("%-12s %6d %13.3f %6.3f %6.3f %6.3f %16.3f %22.3f %5.3f\n", name, column.failed,
                time.p50, time.p95, time.p99, time.max, makespan.mean, ratio.mean, ratio.max);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: coordination_study WORKCELL [LIST [SEEDS]]\n");
    return 2;
  }
  const auto cell = load_workcell(argv[1]);
  const auto queries =
      cell ? (*cell)->find_list(argc > 2 ? argv[2] : "") : std::unexpected(cell.error());
  const auto resolved =
      queries ? pipeline::resolve_all(*cell, **queries) : std::unexpected(queries.error());
  if (!resolved) {
    std::fprintf(stderr, "coordination_study: %s\n", resolved.error().message.c_str());
    return 2;
  }
  const int seeds = argc > 3 ? std::atoi(argv[3]) : 10;
  Coordinators coordinators;
  coordinators.emplace_back("diagram", coordination::make_diagram_coordinator());
  coordinators.emplace_back("monotone", coordination::make_monotone_coordinator());
  coordinators.emplace_back("sw_closure", coordination::make_sw_closure_coordinator());
  coordinators.emplace_back("exclusive", coordination::make_exclusive_coordinator());
  coordinators.emplace_back("sequential", coordination::make_sequential_coordinator());
  std::map<std::string, Column> columns;
  int problems = 0;
  for (const auto& query : *resolved) {
    const auto& at = query.cell ? query.cell : *cell;
    const collision::CompiledCell compiled(at);
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto arms = study::arm_motions(compiled, query, static_cast<std::uint64_t>(seed));
      if (arms.empty()) continue;
      const coordination::CoordinationProblem problem{compiled, arms};
      ++problems;
      for (const auto& [name, coordinator] : coordinators) {
        Column& column = columns[name];
        const auto begin = Clock::now();
        const auto schedule = coordinator->coordinate(problem, 1, StopCondition::after(5));
        column.time_ms.push_back(
            std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
        if (!schedule) {
          ++column.failed;
          if (std::getenv("TANDEM_VERBOSE"))
            std::printf("%s %d %s: %s\n", query.name.c_str(), seed, name,
                        schedule.error().message.c_str());
          continue;
        }
        column.makespan.push_back(schedule->makespan());
        column.ratio.push_back(schedule->makespan() / coordination::durations(problem).maxCoeff());
      }
    }
  }
  print_table(problems, coordinators, columns);
  return 0;
}
