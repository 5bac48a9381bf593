/// Times of collision questions, by cell and instruction set: a valid configuration in a block, a
/// valid and an invalid motion of 1 rad with its proof, and the scalar checker beside them; by pair
/// of shapes; nearest neighbours. Cells of problem files need the test data (see cells.h).

#include <benchmark/benchmark.h>

#include "cells.h"
#include "pair_benchmarks.h"
#include "tandem/collision/batch_checker.h"
#include "tandem/collision/certificate.h"
#include "tandem/planning/nearest.h"

namespace {

using namespace tandem;
using bench::Cell, bench::random_configuration;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kConfigurations = 1024;  // More than branches can be learnt by heart.
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

void run_nearest(benchmark::State& state, std::int64_t target, int size) {
  constexpr int kDof = 7;
  bench::use_target(target);
  planning::NearestConfigurations tree(kDof);
  Rng rng(1);
  for (int i = 0; i < size; ++i) {
    VectorXd q(kDof);
    for (double& x : q) x = rng.uniform(-3, 3);
    tree.add(q);
  }
  const VectorXd q = VectorXd::Zero(kDof);
  for (auto _ : state) benchmark::DoNotOptimize(tree.nearest(q));
}

void add_nearest() {
  for (const std::int64_t target : bench::targets()) {
    for (const int size : {16, 100, 1000, 10000}) {
      const std::string name = "nearest/" + std::to_string(size) + "/" + hwy::TargetName(target);
      benchmark::RegisterBenchmark(name.c_str(), [target, size](benchmark::State& state) {
        run_nearest(state, target, size);
      });
    }
  }
}

void add_cell(const std::string& name, const Cell& cell) {
  const auto asked = std::make_shared<const Questions>(draw(cell));
  using Run = std::function<void(benchmark::State&)>;
  const std::pair<const char*, Run> batch_runs[] = {
      {"valid_state", [asked](auto& state) { run_states(state, *asked); }},
      {"valid_edge", [asked](auto& state) { run_edges(state, *asked, true); }},
      {"invalid_edge", [asked](auto& state) { run_edges(state, *asked, false); }}};
  for (const std::int64_t target : bench::targets()) {
    for (const auto& [what, run] : batch_runs) {
      const std::string title = name + "/" + what + "/" + hwy::TargetName(target);
      benchmark::RegisterBenchmark(title.c_str(), [target, run = run](benchmark::State& state) {
        bench::use_target(target);
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

}  // namespace

int main(int argc, char** argv) {
  add_nearest();
  bench::add_pairs();
  const bench::NamedCell gearbox = bench::scenario("gearbox", "gearbox/workcell.yaml");
  add_cell(gearbox.name, gearbox.cell);
  for (const char* model : {"panda", "baxter"}) {
    for (const auto& [name, cell] : bench::problem_cells(model)) add_cell(name, cell);
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
