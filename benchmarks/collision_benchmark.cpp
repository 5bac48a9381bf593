/// Times of collision questions, by cell and instruction set: a valid configuration in a block, a
/// valid and an invalid motion of 1 rad with its proof, and the scalar checker beside them.
/// Cells of problem files need the test data (TANDEM_DATA_DIR, else ../shared beside the sources).

#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <cstdio>
#include <cstdlib>
#include <map>

#include "tandem/collision/batch_checker.h"
#include "tandem/collision/certificate.h"
#include "tandem/core/rng.h"
#include "tandem/io/problem_file.h"
#include "tandem/planning/nearest.h"
#include "tandem/tandem.h"

namespace {

using namespace tandem;
using Cell = std::shared_ptr<const world::Workcell>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kConfigurations = 256;
constexpr int kEdges = 256;
constexpr double kEdgeLength = 1.0;  // [rad]

/// Questions about one cell, drawn once.
struct Questions {
  std::unique_ptr<collision::SsvChecker> exact;
  std::unique_ptr<collision::BatchChecker> batch;
  world::PairSelection all;
  MatrixXd valid;
  std::vector<std::pair<VectorXd, VectorXd>> valid_edges, invalid_edges;
};

VectorXd random_configuration(Rng& rng, const world::Workcell& cell) {
  VectorXd q(cell.dof());
  for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = rng.uniform(cell.lower()[j], cell.upper()[j]);
  return q;
}

Questions draw(const Cell& cell) {
  Questions drawn;
  drawn.exact = std::make_unique<collision::SsvChecker>(cell);
  drawn.batch = std::make_unique<collision::BatchChecker>(*drawn.exact);
  drawn.all = cell->select(world::PairScope::all());
  const auto pairs = drawn.batch->compile(drawn.all);
  const auto scratch = drawn.batch->make_scratch();
  Rng rng(1);
  drawn.valid.resize(cell->dof(), kConfigurations);
  for (int found = 0; found < kConfigurations;) {
    const VectorXd q = random_configuration(rng, *cell);
    if (drawn.batch->are_free(q, *pairs, *scratch)) drawn.valid.col(found++) = q;
  }
  while (drawn.valid_edges.size() < kEdges || drawn.invalid_edges.size() < kEdges) {
    const VectorXd a = drawn.valid.col(static_cast<Eigen::Index>(rng.index(kConfigurations)));
    const VectorXd towards = random_configuration(rng, *cell) - a;
    const VectorXd b = a + kEdgeLength * towards.normalized();
    const bool is_free = drawn.batch->is_edge_free(a, b, *pairs, *scratch);
    (is_free ? drawn.valid_edges : drawn.invalid_edges).emplace_back(a, b);
  }
  drawn.valid_edges.resize(kEdges);
  drawn.invalid_edges.resize(kEdges);
  return drawn;
}

void report(benchmark::State& state, int count) {
  state.counters["each"] = benchmark::Counter(
      count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void run_states(benchmark::State& state, const Questions& asked) {
  const auto pairs = asked.batch->compile(asked.all);
  const auto scratch = asked.batch->make_scratch();
  for (auto _ : state) {
    benchmark::DoNotOptimize(asked.batch->are_free(asked.valid, *pairs, *scratch));
  }
  report(state, kConfigurations);
}

void run_edges(benchmark::State& state, const Questions& asked, bool valid) {
  const auto pairs = asked.batch->compile(asked.all);
  const auto scratch = asked.batch->make_scratch();
  for (auto _ : state) {
    for (const auto& [a, b] : valid ? asked.valid_edges : asked.invalid_edges) {
      benchmark::DoNotOptimize(asked.batch->is_edge_free(a, b, *pairs, *scratch));
    }
  }
  report(state, kEdges);
}

void run_exact_states(benchmark::State& state, const Questions& asked) {
  const auto scratch = asked.exact->make_scratch();
  for (auto _ : state) {
    for (Eigen::Index i = 0; i < asked.valid.cols(); ++i) {
      benchmark::DoNotOptimize(asked.exact->is_free(asked.valid.col(i), asked.all, *scratch));
    }
  }
  report(state, kConfigurations);
}

void run_exact_edges(benchmark::State& state, const Questions& asked, bool valid) {
  const auto scratch = asked.exact->make_scratch();
  for (auto _ : state) {
    for (const auto& [a, b] : valid ? asked.valid_edges : asked.invalid_edges) {
      const motion::StraightEdge edge(a, b);
      benchmark::DoNotOptimize(
          collision::certify(*asked.exact, edge, asked.all, *scratch).is_free());
    }
  }
  report(state, kEdges);
}

void run_compile(benchmark::State& state, const Questions& asked) {
  for (auto _ : state) {
    const collision::BatchChecker batch(*asked.exact);
    benchmark::DoNotOptimize(batch.compile(asked.all));
  }
  report(state, 1);
}

void run_nearest(benchmark::State& state) {
  constexpr int kDof = 7;
  planning::NearestConfigurations tree(kDof);
  Rng rng(1);
  for (int i = 0; i < state.range(0); ++i) {
    VectorXd q(kDof);
    for (double& x : q) x = rng.uniform(-3, 3);
    tree.add(q);
  }
  const VectorXd q = VectorXd::Zero(kDof);
  for (auto _ : state) benchmark::DoNotOptimize(tree.nearest(q));
}
BENCHMARK(run_nearest)->Arg(16)->Arg(100)->Arg(1000);

void add_cell(const std::string& name, const Cell& cell) {
  const auto asked = std::make_shared<const Questions>(draw(cell));
  using Run = std::function<void(benchmark::State&)>;
  const std::pair<const char*, Run> batch_runs[] = {
      {"valid_state", [asked](auto& state) { run_states(state, *asked); }},
      {"valid_edge", [asked](auto& state) { run_edges(state, *asked, true); }},
      {"invalid_edge", [asked](auto& state) { run_edges(state, *asked, false); }}};
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0;
       targets &= targets - 1) {
    const std::int64_t target = targets & -targets;
    for (const auto& [what, run] : batch_runs) {
      const std::string title = name + "/" + what + "/" + hwy::TargetName(target);
      benchmark::RegisterBenchmark(title.c_str(), [target, run = run](benchmark::State& state) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        run(state);
      });
    }
  }
  const std::pair<const char*, Run> other_runs[] = {
      {"compile", [asked](auto& state) { run_compile(state, *asked); }},
      {"valid_state/exact", [asked](auto& state) { run_exact_states(state, *asked); }},
      {"valid_edge/exact", [asked](auto& state) { run_exact_edges(state, *asked, true); }},
      {"invalid_edge/exact", [asked](auto& state) { run_exact_edges(state, *asked, false); }}};
  for (const auto& [what, run] : other_runs) {
    benchmark::RegisterBenchmark((name + "/" + what).c_str(), run);
  }
}

/// The first problem of every set of a file.
void add_problems(const std::filesystem::path& data, const std::string& model,
                  const std::string& urdf) {
  const std::filesystem::path robots = data / "robots" / (model + "_mbm");
  io::ProblemRobots files;
  files.urdf[""] = robots / urdf;
  files.srdf[""] = robots / (model + ".srdf");
  const auto problems = io::load_problems(data / "problems/mbm" / (model + ".json"), files);
  if (!problems) {
    std::fprintf(stderr, "%s\n", problems.error().message.c_str());
    return;
  }
  std::map<std::string, const pipeline::BenchProblem*> first;
  for (const pipeline::BenchProblem& problem : *problems) first.try_emplace(problem.set, &problem);
  for (const auto& [set, problem] : first) add_cell(model + "_" + set, problem->cell().value());
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path source = TANDEM_SOURCE_DIR;
  const char* folder = std::getenv("TANDEM_DATA_DIR");
  const std::filesystem::path data = folder ? std::filesystem::path(folder) : source / "../shared";
  add_cell("gearbox", load_workcell(source / "scenarios/gearbox/workcell.yaml").value());
  if (std::filesystem::exists(data)) {
    add_problems(data, "panda", "panda_spherized.urdf");
    add_problems(data, "baxter", "baxter_spherized.urdf");
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
