// The batch checker on real robots: the exact checker's verdicts, and edges without surprises.

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "tandem/collision/batch_checker.h"
#include "tandem/core/rng.h"
#include "tandem/io/problem_file.h"
#include "tandem/io/workcell_yaml.h"
#include "test_data.h"

namespace tandem {
namespace {

using collision::BatchChecker;
using collision::SsvChecker;
using Eigen::VectorXd;
using Cell = std::shared_ptr<const world::Workcell>;

/// More than a test run has time for: TANDEM_LONG_TESTS=100 looks a hundred times as hard.
int effort() {
  const char* factor = std::getenv("TANDEM_LONG_TESTS");
  return factor ? std::max(1, std::atoi(factor)) : 1;
}

VectorXd random_configuration(Rng& rng, const world::Workcell& cell) {
  VectorXd q(cell.dof());
  for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = rng.uniform(cell.lower()[j], cell.upper()[j]);
  return q;
}

/// Verdicts on `count` configurations.
void compare_verdicts(const Cell& cell, int count) {
  const SsvChecker exact(cell);
  const BatchChecker batch(exact);
  const auto all = cell->select(world::PairScope::all());
  const auto pairs = batch.compile(all);
  const auto scratch = batch.make_scratch();
  const auto exact_scratch = exact.make_scratch();
  Rng rng(1);
  int free = 0;
  for (int i = 0; i < count; ++i) {
    const VectorXd q = random_configuration(rng, *cell);
    const bool expected = exact.is_free(q, all, *exact_scratch);
    ASSERT_EQ(batch.are_free(q, *pairs, *scratch), expected)
        << describe(*cell, exact.least_clearance(q, all, *exact_scratch)) << " at "
        << q.transpose();
    free += expected;
  }
  std::printf("%s: %d of %d free\n", cell->name().c_str(), free, count);
  EXPECT_GT(free, count / 100);
}

/// Accepted edges of about a radian against samples 32 times as dense as usual.
void compare_edges(const Cell& cell, int count) {
  constexpr double kResolution = 0.0335 / 32;  // [rad], L1
  const SsvChecker exact(cell);
  const BatchChecker batch(exact);
  const auto all = cell->select(world::PairScope::all());
  const auto pairs = batch.compile(all);
  const auto scratch = batch.make_scratch();
  const auto exact_scratch = exact.make_scratch();
  Rng rng(2);
  int accepted = 0;
  while (accepted < count) {
    const VectorXd a = random_configuration(rng, *cell);
    if (!batch.are_free(a, *pairs, *scratch)) continue;
    const VectorXd towards = random_configuration(rng, *cell) - a;
    const VectorXd b = a + std::min(1.0, 1 / towards.norm()) * towards;
    if (!batch.is_edge_free(a, b, *pairs, *scratch)) continue;
    ++accepted;
    const int samples = static_cast<int>((b - a).lpNorm<1>() / kResolution);
    for (int k = 0; k <= samples; ++k) {
      const VectorXd q = a + k / static_cast<double>(samples) * (b - a);
      ASSERT_TRUE(exact.is_free(q, all, *exact_scratch)) << "edge " << accepted;
    }
  }
}

/// The first problem of every set of a file.
std::vector<Cell> problem_cells(const std::string& model, const std::string& urdf) {
  const auto robots = test::data_path("robots/" + model + "_mbm");
  io::ProblemRobots files;
  files.urdf[""] = robots / urdf;
  files.srdf[""] = robots / (model + ".srdf");
  const auto problems =
      io::load_problems(test::data_path("problems/mbm/" + model + ".json"), files);
  if (!problems) throw std::runtime_error(problems.error().message);
  std::map<std::string, Cell> first;
  for (const pipeline::BenchProblem& problem : *problems) {
    if (!first.contains(problem.set)) first[problem.set] = problem.cell().value();
  }
  std::vector<Cell> cells;
  for (const auto& [set, cell] : first) cells.push_back(cell);
  return cells;
}

TEST(BatchOnRobots, Gearbox) {
  const auto cell = io::load_workcell(test::source_path("scenarios/gearbox/workcell.yaml"));
  ASSERT_TRUE(cell) << cell.error().message;
  compare_verdicts(*cell, 20000 * effort());
  compare_edges(*cell, 100 * effort());
}

TEST(BatchOnRobots, SpheresOfThePanda) {
  TANDEM_SKIP_WITHOUT_DATA("problems/mbm/panda.json");
  for (const Cell& cell : problem_cells("panda", "panda_spherized.urdf")) {
    compare_verdicts(cell, 10000 * effort());
    compare_edges(cell, 40 * effort());
  }
}

TEST(BatchOnRobots, SpheresOfTheBaxter) {
  TANDEM_SKIP_WITHOUT_DATA("problems/mbm/baxter.json");
  for (const Cell& cell : problem_cells("baxter", "baxter_spherized.urdf")) {
    compare_verdicts(cell, 10000 * effort());
    compare_edges(cell, 40 * effort());
  }
}

}  // namespace
}  // namespace tandem
