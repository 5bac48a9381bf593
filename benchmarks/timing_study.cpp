/// How short each time optimiser makes the motions of a workcell, and what it costs.
/// Usage: timing_study WORKCELL [SEEDS]   (over all queries, SEEDS plans each, default 10)

#include <cstdio>
#include <cstdlib>
#include <map>

#include "tandem/pipeline/bench.h"
#include "tandem/tandem.h"
#include "tandem/trajectory/nlopt/slsqp_time_optimizer.h"
#include "tandem/trajectory/time_optimizer.h"

namespace {

using tandem::pipeline::Statistics;

struct Column {
  std::vector<double> duration_ratio;  // Against uniform scaling of the same waypoints.
  std::vector<double> time_ms;
};

double milliseconds_since(tandem::Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(tandem::Clock::now() - begin).count();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: timing_study WORKCELL [SEEDS]\n");
    return 2;
  }
  const auto cell = tandem::load_workcell(argv[1]);
  if (!cell) {
    std::fprintf(stderr, "timing_study: %s\n", cell.error().message.c_str());
    return 2;
  }
  const int seeds = argc > 2 ? std::atoi(argv[2]) : 10;
  const auto uniform = tandem::trajectory::make_uniform_scaling();
  const auto barrier = tandem::trajectory::make_barrier_optimizer();
  const auto slsqp = tandem::trajectory::make_slsqp_time_optimizer();
  const std::pair<const char*, const tandem::trajectory::TimeOptimizer*> optimizers[] = {
      {"uniform", uniform.get()}, {"barrier", barrier.get()}, {"slsqp", slsqp.get()}};

  std::map<std::string, Column> columns;
  std::vector<double> waypoints;
  for (const auto& query : (*cell)->queries()) {
    for (int seed = 1; seed <= seeds; ++seed) {
      tandem::PlanOptions options;
      options.seed = static_cast<std::uint64_t>(seed);
      const auto planned = tandem::plan(*cell, query, options);
      if (!planned || planned->report.phases.empty()) continue;
      const auto& path = planned->report.phases.back().path;
      waypoints.push_back(static_cast<double>(path.size()));
      double baseline = 0;
      for (const auto& [name, optimizer] : optimizers) {
        const auto begin = tandem::Clock::now();
        const auto timing = optimizer->optimize(path, (*cell)->limits());
        columns[name].time_ms.push_back(milliseconds_since(begin));
        if (baseline == 0) baseline = timing.duration;
        columns[name].duration_ratio.push_back(timing.duration / baseline);
      }
    }
  }
  std::printf("%zu paths, waypoints p50 %.0f max %.0f\n", waypoints.size(),
              Statistics::of(waypoints).p50, Statistics::of(waypoints).max);
  std::printf("%-8s  duration/uniform: mean   p50   max   time_ms: p50    p95    max\n", "");
  for (const auto& [name, optimizer] : optimizers) {
    const Statistics ratio = Statistics::of(columns[name].duration_ratio);
    const Statistics time = Statistics::of(columns[name].time_ms);
    std::printf("%-8s %22.3f %5.3f %5.3f %14.3f %6.3f %6.3f\n", name, ratio.mean, ratio.p50,
                ratio.max, time.p50, time.p95, time.max);
  }
  return 0;
}
