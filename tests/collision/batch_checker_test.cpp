#include "tandem/collision/batch_checker.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <thread>

#include "collision/random_cell.h"
#include "tandem/collision/certificate.h"
#include "tandem/core/contract.h"

namespace tandem::collision {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using world::PairScope;
using world::PairSelection;

/// Runs `f` once for each instruction set that this machine and this build have.
template <class F>
void for_each_target(F&& f) {
  hwy::DisableTargets(0);
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0;
       targets &= targets - 1) {
    const std::int64_t target = targets & -targets;
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    f();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

/// Cells whose links are made of single kinds of shapes, or of everything.
std::vector<test::RandomCellOptions> kinds_of_cells() {
  std::vector<test::RandomCellOptions> all(1);
  for (int core = 0; core < 6; ++core) {
    test::RandomCellOptions options;
    options.cores = {static_cast<geometry::CoreType>(core)};
    all.push_back(options);
  }
  test::RandomCellOptions revolute;
  revolute.prismatic = false;
  revolute.padding = 0;
  all.push_back(revolute);
  return all;
}

TEST(BatchChecker, VerdictsAreThoseOfTheExactChecker) {
  for_each_target([] {
    int free = 0, colliding = 0;
    std::uint64_t seed = 0;
    for (const test::RandomCellOptions& options : kinds_of_cells()) {
      const SsvChecker exact(test::random_cell(++seed, options));
      const BatchChecker batch(exact);
      const auto scratch = batch.make_scratch();
      const auto exact_scratch = exact.make_scratch();
      const world::Workcell& cell = exact.cell();
      const std::vector<PairScope> scopes = {PairScope::all(), PairScope::arm(0), PairScope::arm(1),
                                             PairScope::between(0, 1)};
      Rng rng(1000 + seed);
      for (const PairScope& scope : scopes) {
        const PairSelection selection = cell.select(scope);
        const auto pairs = batch.compile(selection);
        for (int round = 0; round < 400; ++round) {
          const VectorXd q = test::random_configuration(rng, cell);
          const bool expected = exact.is_free(q, selection, *exact_scratch);
          ASSERT_EQ(batch.are_free(q, *pairs, *scratch), expected)
              << "cell " << seed << ": "
              << describe(cell, exact.least_clearance(q, selection, *exact_scratch));
          (expected ? free : colliding) += 1;
        }
      }
    }
    EXPECT_GT(free, 500);
    EXPECT_GT(colliding, 500);
  });
}

TEST(BatchChecker, EveryPairAlone) {
  std::uint64_t seed = 50;
  for (const test::RandomCellOptions& options : kinds_of_cells()) {
    const SsvChecker exact(test::random_cell(++seed, options));
    const BatchChecker batch(exact);
    const auto scratch = batch.make_scratch();
    const auto exact_scratch = exact.make_scratch();
    Rng rng(seed);
    MatrixXd Q(exact.cell().dof(), 40);
    for (int i = 0; i < Q.cols(); ++i) Q.col(i) = test::random_configuration(rng, exact.cell());
    int touching = 0;
    for (const int pair : exact.cell().select(PairScope::all())) {
      const auto pairs = batch.compile(PairSelection{pair});
      bool all_free = true;
      for (int i = 0; i < Q.cols(); ++i) {
        const bool expected = exact.is_free(Q.col(i), {pair}, *exact_scratch);
        ASSERT_EQ(batch.are_free(Q.col(i), *pairs, *scratch), expected)
            << describe(exact.cell(), exact.least_clearance(Q.col(i), {pair}, *exact_scratch));
        all_free = all_free && expected;
        touching += !expected;
      }
      ASSERT_EQ(batch.are_free(Q, *pairs, *scratch), all_free);
    }
    EXPECT_GT(touching, 10);
  }
}

TEST(BatchChecker, AcceptedEdgesAreFreeAtDenseSamples) {
  for_each_target([] {
    int accepted = 0, rejected = 0, missed = 0;
    std::uint64_t seed = 100;
    for (const test::RandomCellOptions& options : kinds_of_cells()) {
      const SsvChecker exact(test::random_cell(++seed, options));
      const BatchChecker batch(exact);
      const auto scratch = batch.make_scratch();
      const auto exact_scratch = exact.make_scratch();
      const PairSelection all = exact.cell().select(PairScope::all());
      const auto pairs = batch.compile(all);
      Rng rng(seed);
      for (int round = 0; round < 120; ++round) {
        const VectorXd a = test::random_configuration(rng, exact.cell());
        if (!exact.is_free(a, all, *exact_scratch)) continue;
        const double step = std::pow(10.0, rng.uniform(-2, 0));
        const VectorXd b = a + step * (test::random_configuration(rng, exact.cell()) - a);
        const bool is_free = batch.is_edge_free(a, b, *pairs, *scratch);
        EXPECT_EQ(is_free, batch.is_edge_free(b, a, *pairs, *scratch));
        const EdgeProof proof = batch.prove_edge(a, b, *pairs, *scratch);
        EXPECT_EQ(is_free, proof.is_free);
        double least = BatchChecker::kClearanceCap;
        for (int k = 0; k <= 200; ++k) {
          const VectorXd q = a + k / 200.0 * (b - a);
          least = std::min(least, exact.least_clearance(q, all, *exact_scratch).distance);
        }
        if (is_free) {
          ASSERT_GT(least, 0) << "cell " << seed << ", round " << round;
          ASSERT_LE(proof.least_clearance, least);
          ASSERT_GT(proof.least_clearance, 0);
        } else {
          missed += least > 1e-3;
        }
        (is_free ? accepted : rejected) += 1;
      }
    }
    EXPECT_GT(accepted, 100);
    EXPECT_GT(rejected, 50);
    EXPECT_LE(missed, 2) << "free edges that were not proven";
  });
}

}  // namespace
}  // namespace tandem::collision
