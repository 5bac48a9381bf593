/// What each interpolation of a schedule makes of the arms' motions: how continuous they are, how
/// far beyond the limits, and how long they take once they obey them; beside the realization that
/// is proven, of the same schedules and of the default coordinator's. Schedules are otherwise those
/// of the paper's coordinator. Usage: interpolation_study WORKCELL [LIST [SEEDS]]   (default 5)

#include <cstdio>
#include <cstdlib>

#include "arm_motions.h"
#include "tandem/coordination/diagram_coordinator.h"
#include "tandem/coordination/path_coordinator.h"
#include "tandem/coordination/realization.h"
#include "tandem/pipeline/bench.h"
#include "tandem/tandem.h"

namespace {

using namespace tandem;
using coordination::Interpolation;
using pipeline::Statistics;

struct Row {
  Eigen::Vector3d jumps = Eigen::Vector3d::Zero();  // Of q, qd, qdd over any knot.
  Eigen::Vector2d ends = Eigen::Vector2d::Zero();   // qd and qdd at start and goal.
  std::vector<double> duration, obedient, time_ms;
  int collides = 0, breaks_limits = 0, failed = 0;
  std::vector<double> repairs;
  int stop_and_go = 0;

  void add(const motion::CellMotion& motion) {
    for (const auto& arm : motion.arms()) jumps = jumps.cwiseMax(arm.largest_jumps());
    for (const double t : {0.0, motion.duration()}) {
      const motion::JointState state = motion.at(t);
      ends = ends.cwiseMax(
          Eigen::Vector2d(state.qd.cwiseAbs().maxCoeff(), state.qdd.cwiseAbs().maxCoeff()));
    }
    duration.push_back(motion.duration());
  }
};

double milliseconds_since(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

void interpolate(const coordination::CoordinationProblem& problem,
                 const coordination::Schedule& schedule, Interpolation kind, Row& row) {
  const auto scratch = problem.exact().make_scratch();
  const auto begin = Clock::now();
  const auto made = coordination::interpolate_unrepaired(problem, schedule, kind, *scratch);
  row.time_ms.push_back(milliseconds_since(begin));
  if (!made) return;
  row.add(made->motion);
  row.obedient.push_back(made->motion.duration() * made->stretch);
  row.collides += !made->certificate.is_free();
  row.breaks_limits += !made->violations.empty();
}

void realize(const coordination::CoordinationProblem& problem,
             const coordination::Schedule& schedule, Row& row) {
  const auto scratch = problem.compiled.batch().make_scratch();
  const auto begin = Clock::now();
  const auto made = coordination::realize(problem, schedule, *scratch, StopCondition::after(5));
  row.time_ms.push_back(milliseconds_since(begin));
  if (!made) {
    ++row.failed;
    if (std::getenv("TANDEM_VERBOSE")) std::printf("%s\n", made.error().message.c_str());
    return;
  }
  row.add(made->motion);
  row.obedient.push_back(made->motion.duration());
  row.repairs.push_back(made->repairs);
  row.stop_and_go += made->stop_and_go;
}

void print(const char* name, const Row& row) {
  const auto duration = Statistics::of(row.duration), obedient = Statistics::of(row.obedient);
  const auto time = Statistics::of(row.time_ms);
  std::printf("%-10s %8.1e %8.1e %8.1e %8.1e %8.1e %8d %7d %6d %9.3f %9.3f %8.3f %7.3f %7.3f\n",
              name, row.jumps[0], row.jumps[1], row.jumps[2], row.ends[0], row.ends[1],
              row.collides, row.breaks_limits, row.failed, duration.mean, obedient.mean, time.p50,
              time.p99, time.max);
  if (!row.repairs.empty()) {
    const auto repairs = Statistics::of(row.repairs);
    std::printf("  repaired by %.1f places in the mean, at most %.0f; %d run from stop to stop\n",
                repairs.mean, repairs.max, row.stop_and_go);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: interpolation_study WORKCELL [LIST [SEEDS]]\n");
    return 2;
  }
  const auto cell = load_workcell(argv[1]);
  const auto queries =
      cell ? (*cell)->find_list(argc > 2 ? argv[2] : "") : std::unexpected(cell.error());
  const auto resolved =
      queries ? pipeline::resolve_all(*cell, **queries) : std::unexpected(queries.error());
  if (!resolved) {
    std::fprintf(stderr, "interpolation_study: %s\n", resolved.error().message.c_str());
    return 2;
  }
  const int seeds = argc > 3 ? std::atoi(argv[3]) : 5;
  const auto coordinator = coordination::make_path_coordinator(
      std::shared_ptr(planning::make_rrt_connect()), std::shared_ptr(planning::make_simplifier()));
  constexpr Interpolation kKinds[] = {Interpolation::kLinear, Interpolation::kCubic,
                                      Interpolation::kQuintic};
  const auto shortest = coordination::make_diagram_coordinator();
  Row rows[3], realized, realized_shortest;
  int deadlocks = 0;
  std::vector<double> bound, longest, places, coordination_ms;
  for (const auto& query : *resolved) {
    const collision::CompiledCell compiled(query.cell ? query.cell : *cell);
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto arms = study::arm_motions(compiled, query, static_cast<std::uint64_t>(seed));
      if (arms.empty()) continue;
      const coordination::CoordinationProblem problem{compiled, arms};
      const auto begin = Clock::now();
      const auto schedule = coordinator->coordinate(problem, static_cast<std::uint64_t>(seed),
                                                    StopCondition::after(0.5));
      if (!schedule) {
        ++deadlocks;
        continue;
      }
      coordination_ms.push_back(milliseconds_since(begin));
      places.push_back(static_cast<double>(schedule->places.size()));
      bound.push_back(schedule->makespan());
      longest.push_back(coordination::durations(problem).maxCoeff());
      for (int k = 0; k < 3; ++k) interpolate(problem, *schedule, kKinds[k], rows[k]);
      realize(problem, *schedule, realized);
      const auto best = shortest->coordinate(problem, 1, StopCondition::after(5));
      if (best) realize(problem, *best, realized_shortest);
    }
  }
  std::printf(
      "%zu schedules (%d without), coordination p50 %.1f ms; places mean %.1f, makespan "
      "%.3f s, longest motion %.3f s\n",
      bound.size(), deadlocks, Statistics::of(coordination_ms).p50, Statistics::of(places).mean,
      Statistics::of(bound).mean, Statistics::of(longest).mean);
  std::printf(
      "           jumps: q       qd      qdd ends: qd      qdd  collide  limits failed  "
      "duration  in limits   ms: p50     p99     max\n");
  for (int k = 0; k < 3; ++k) print(to_string(kKinds[k]), rows[k]);
  print("realized", realized);
  print("shortest", realized_shortest);
  return 0;
}
