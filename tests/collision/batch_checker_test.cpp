#include "tandem/collision/batch_checker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "collision/batch_targets.h"
#include "collision/random_cell.h"
#include "tandem/collision/certificate.h"
#include "tandem/core/contract.h"

namespace tandem::collision {
namespace {

using Cell = std::shared_ptr<const world::Workcell>;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::for_each_target, test::kinds_of_cells;
using world::PairScope;
using world::PairSelection;

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

/// From clear to touching, by bisection: distances of micrometres on either side, where single
/// precision alone would guess.
TEST(BatchChecker, NearContactsAreDecidedExactly) {
  std::uint64_t seed = 80;
  int compared = 0;
  for (const test::RandomCellOptions& options : kinds_of_cells()) {
    const SsvChecker exact(test::random_cell(++seed, options));
    const BatchChecker batch(exact);
    const auto scratch = batch.make_scratch();
    const auto exact_scratch = exact.make_scratch();
    const PairSelection all = exact.cell().select(PairScope::all());
    const auto pairs = batch.compile(all);
    const auto is_free = [&](const VectorXd& q) { return exact.is_free(q, all, *exact_scratch); };
    Rng rng(seed);
    for (int round = 0; round < 200; ++round) {
      VectorXd clear = test::random_configuration(rng, exact.cell());
      VectorXd touching = test::random_configuration(rng, exact.cell());
      if (!is_free(clear)) std::swap(clear, touching);
      if (!is_free(clear) || is_free(touching)) continue;
      for (int k = 0; k < 34; ++k) {
        const VectorXd middle = 0.5 * (clear + touching);
        const bool expected = is_free(middle);
        ASSERT_EQ(batch.are_free(middle, *pairs, *scratch), expected)
            << describe(exact.cell(), exact.least_clearance(middle, all, *exact_scratch));
        (expected ? clear : touching) = middle;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 5000);
}

TEST(BatchChecker, TurnsOfEndlessJointsDoNotMatter) {
  const SsvChecker exact(test::random_cell(3, {.prismatic = false}));
  const BatchChecker batch(exact);
  const auto scratch = batch.make_scratch();
  const auto exact_scratch = exact.make_scratch();
  const PairSelection all = exact.cell().select(PairScope::all());
  const auto pairs = batch.compile(all);
  Rng rng(3);
  for (int round = 0; round < 300; ++round) {
    VectorXd q = test::random_configuration(rng, exact.cell());
    q[static_cast<Eigen::Index>(rng.index(static_cast<std::size_t>(q.size())))] += 2000;
    EXPECT_EQ(batch.are_free(q, *pairs, *scratch), exact.is_free(q, all, *exact_scratch));
    const VectorXd far = q + 40 * test::random_configuration(rng, exact.cell());
    if (!batch.is_edge_free(q, far, *pairs, *scratch)) continue;
    for (int k = 0; k < 100; ++k) {
      const VectorXd between = q + k / 100.0 * (far - q);
      EXPECT_TRUE(exact.is_free(between, all, *exact_scratch));
    }
  }
}

TEST(BatchChecker, ThreadsShareOneChecker) {
  const SsvChecker exact(test::random_cell(3));
  const BatchChecker batch(exact);
  const auto pairs = batch.compile(PairScope::all());
  const auto verdicts = [&] {
    const auto scratch = batch.make_scratch();
    Rng rng(5);
    std::vector<bool> found;
    for (int i = 0; i < 500; ++i) {
      const VectorXd a = test::random_configuration(rng, exact.cell());
      const VectorXd b = test::random_configuration(rng, exact.cell());
      found.push_back(batch.are_free(a, *pairs, *scratch));
      found.push_back(batch.is_edge_free(a, 0.9 * a + 0.1 * b, *pairs, *scratch));
    }
    return found;
  };
  const std::vector<bool> expected = verdicts();
  std::vector<bool> other[2];
  {
    std::jthread one([&] { other[0] = verdicts(); });
    std::jthread two([&] { other[1] = verdicts(); });
  }
  EXPECT_EQ(other[0], expected);
  EXPECT_EQ(other[1], expected);
}

TEST(BatchChecker, NothingSelectedIsFree) {
  const SsvChecker exact(test::random_cell(1));
  const BatchChecker batch(exact);
  const auto scratch = batch.make_scratch();
  const auto pairs = batch.compile(PairSelection{});
  const VectorXd q = VectorXd::Zero(exact.cell().dof());
  EXPECT_TRUE(batch.are_free(q, *pairs, *scratch));
  EXPECT_TRUE(batch.are_free(MatrixXd(q.size(), 0), *pairs, *scratch));
  const EdgeProof proof = batch.prove_edge(q, q, *pairs, *scratch);
  EXPECT_TRUE(proof.is_free);
  EXPECT_FLOAT_EQ(static_cast<float>(proof.least_clearance),
                  static_cast<float>(BatchChecker::kClearanceCap));
}

TEST(BatchChecker, RefusesWhatIsNotItsOwn) {
  const SsvChecker exact(test::random_cell(1)), other_exact(test::random_cell(2));
  const BatchChecker batch(exact), other(other_exact);
  const auto scratch = batch.make_scratch(), foreign = other.make_scratch();
  const auto pairs = batch.compile(PairScope::all());
  const VectorXd q = VectorXd::Zero(exact.cell().dof());
  const VectorXd longer = VectorXd::Zero(q.size() + 1);
  const VectorXd nan = VectorXd::Constant(q.size(), std::nan(""));
  EXPECT_THROW(batch.are_free(longer, *pairs, *scratch), ContractViolation);
  EXPECT_THROW(batch.are_free(nan, *pairs, *scratch), ContractViolation);
  EXPECT_THROW(batch.are_free(q, *pairs, *foreign), ContractViolation);
  EXPECT_THROW(batch.are_free(q, *other.compile(PairScope::all()), *scratch), ContractViolation);
  EXPECT_THROW(batch.is_edge_free(q, longer, *pairs, *scratch), ContractViolation);
  EXPECT_THROW(batch.is_edge_free(q, nan, *pairs, *scratch), ContractViolation);
  EXPECT_THROW(batch.compile(PairSelection{-1}), ContractViolation);
  EXPECT_THROW(batch.compile(PairSelection{static_cast<int>(exact.cell().pairs().size())}),
               ContractViolation);
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

/// The cell with bodies so padded that something touches at q, hardly deeper than `depth` [m].
Cell touching_at(const VectorXd& q, double depth, test::RandomCellOptions options,
                 std::uint64_t seed) {
  const auto least_with = [&](double padding) {
    options.padding = padding;
    const SsvChecker exact(test::random_cell(seed, options));
    const auto scratch = exact.make_scratch();
    return exact.least_clearance(q, exact.cell().select(PairScope::all()), *scratch).distance;
  };
  const double bare = least_with(0);
  if (bare <= 0) return nullptr;
  const double per_padding = (bare - least_with(1e-3)) / 1e-3;
  options.padding = (bare + depth) / per_padding;
  if (std::abs(least_with(options.padding) + depth) > 0.5 * depth) return nullptr;
  return test::random_cell(seed, options);
}

TEST(BatchChecker, EdgesThatTouchAtOnePointAreRejected) {
  for_each_target([] {
    int asked = 0;
    std::uint64_t seed = 500;
    for (const test::RandomCellOptions& options : kinds_of_cells()) {
      for (int round = 0; round < 4; ++round) {
        Rng rng(++seed);
        const VectorXd q = test::random_configuration(rng, *test::random_cell(seed, options), 0.5);
        const Cell cell = touching_at(q, 2e-6, options, seed);
        if (!cell) continue;
        const SsvChecker exact(cell);
        const BatchChecker batch(exact);
        const auto scratch = batch.make_scratch();
        const auto pairs = batch.compile(PairScope::all());
        for (int edge = 0; edge < 400; ++edge) {
          const double length = std::pow(10.0, rng.uniform(-2, 0));
          const VectorXd step = length * (test::random_configuration(rng, *cell) - q);
          // It ends there, or passes.
          const double beyond = edge % 2 ? 0 : rng.uniform(0, 0.25);  // Inside the limits.
          ASSERT_FALSE(batch.is_edge_free(q - beyond * step, q + step, *pairs, *scratch))
              << "cell " << seed << ", edge " << edge;
          ++asked;
        }
      }
    }
    EXPECT_GT(asked, 4000);
  });
}

}  // namespace
}  // namespace tandem::collision
