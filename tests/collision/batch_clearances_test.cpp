// Distances of many configurations at once against the exact checker, one by one.

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "collision/batch_targets.h"
#include "collision/random_cell.h"
#include "tandem/collision/batch_checker.h"
#include "tandem/core/contract.h"

namespace tandem::collision {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kWithin = 0.08;  // [m]

/// A cell with its checkers, and random configurations of it.
struct Sampled {
  SsvChecker exact;
  BatchChecker batch{exact};
  world::PairSelection selection = exact.cell().select(world::PairScope::all());
  BatchChecker::Pairs pairs = batch.compile(selection, kWithin);
  BatchChecker::ScratchPtr scratch = batch.make_scratch();
  std::unique_ptr<CollisionChecker::Scratch> exact_scratch = exact.make_scratch();
  MatrixXd Q;

  Sampled(std::uint64_t seed, const test::RandomCellOptions& options, int count)
      : exact(test::random_cell(seed, options)), Q(exact.cell().dof(), count) {
    Rng rng(seed + 500);
    for (int i = 0; i < count; ++i) Q.col(i) = test::random_configuration(rng, exact.cell());
  }
};

bool before(const PairClearance& a, const PairClearance& b) {
  return std::pair(a.pair, a.distance) < std::pair(b.pair, b.distance);
}

TEST(BatchClearances, AreThoseOfTheExactChecker) {
  std::size_t found = 0;
  test::for_each_target([&] {
    std::uint64_t seed = 200;
    for (const test::RandomCellOptions& options : test::kinds_of_cells()) {
      Sampled cell(++seed, options, 61);  // Blocks of every width, the last one not full.
      NearShapes near;
      cell.batch.shape_clearances(cell.Q, *cell.pairs, kWithin, *cell.scratch, near);
      ASSERT_EQ(near.first.size(), 62u);
      std::vector<PairClearance> expected;
      for (Eigen::Index i = 0; i < cell.Q.cols(); ++i) {
        const auto first = near.clearances.begin() + static_cast<std::ptrdiff_t>(near.first[i]);
        const auto end = near.clearances.begin() + static_cast<std::ptrdiff_t>(near.first[i + 1]);
        std::vector<PairClearance> got(first, end);
        cell.exact.shape_clearances(cell.Q.col(i), cell.selection, kWithin, *cell.exact_scratch,
                                    expected);
        ASSERT_EQ(got.size(), expected.size()) << "cell " << seed << ", column " << i;
        std::ranges::sort(got, before);
        std::ranges::sort(expected, before);
        for (std::size_t k = 0; k < got.size(); ++k) {
          ASSERT_EQ(got[k].pair, expected[k].pair);
          ASSERT_NEAR(got[k].distance, expected[k].distance, 1e-12);
          ASSERT_NEAR(got[k].nhat_BA_W.dot(got[k].p_WCa - got[k].p_WCb), got[k].distance, 1e-6);
        }
        found += got.size();
      }
    }
  });
  EXPECT_GT(found, 10000u);
}

TEST(BatchClearances, GradientsAreThoseOfThePair) {
  std::uint64_t seed = 300;
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  for (const test::RandomCellOptions& options : test::kinds_of_cells()) {
    Sampled cell(++seed, options, 40);
    const world::Workcell& of = cell.exact.cell();
    NearShapes near;
    cell.batch.shape_clearances(cell.Q, *cell.pairs, kWithin, *cell.scratch, near);
    VectorXd expected(of.dof());
    for (Eigen::Index i = 0; i < cell.Q.cols(); ++i) {
      of.forward_kinematics(cell.Q.col(i), positions, X_WL);
      for (std::size_t k = near.first[i]; k < near.first[i + 1]; ++k) {
        distance_gradient(of, X_WL, near.clearances[k], expected);
        ASSERT_LT((near.gradient(k, of.dof()) - expected).norm(), 1e-10 * (1 + expected.norm()));
      }
    }
  }
}

// The distance itself, moved a little: independent of Jacobians and witness points.
TEST(BatchClearances, GradientsAgreeWithDifferences) {
  test::RandomCellOptions options;  // Smooth pairs: spheres and capsules.
  options.cores = {geometry::CoreType::kPoint, geometry::CoreType::kSegment};
  Sampled cell(401, options, 60);
  const Eigen::Index dof = cell.exact.cell().dof();
  NearShapes near, moved;
  cell.batch.shape_clearances(cell.Q, *cell.pairs, kWithin, *cell.scratch, near);
  constexpr double kStep = 1e-6;
  int compared = 0, kinks = 0;
  const auto distance_of = [&](Eigen::Index column, std::uint64_t key) {
    for (std::size_t k = moved.first[column]; k < moved.first[column + 1]; ++k) {
      if (moved.keys[k] == key) return moved.clearances[k].distance;
    }
    return std::numeric_limits<double>::quiet_NaN();
  };
  for (Eigen::Index j = 0; j < dof; ++j) {
    MatrixXd up = cell.Q, down = cell.Q;
    up.row(j).array() += kStep;
    down.row(j).array() -= kStep;
    std::vector<double> differences(near.keys.size());
    for (const auto& [Q, sign] : {std::pair(&up, 1.0), std::pair(&down, -1.0)}) {
      cell.batch.shape_clearances(*Q, *cell.pairs, 2 * kWithin, *cell.scratch, moved);
      for (Eigen::Index i = 0; i < Q->cols(); ++i) {
        for (std::size_t k = near.first[i]; k < near.first[i + 1]; ++k) {
          differences[k] += sign * distance_of(i, near.keys[k]) / (2 * kStep);
        }
      }
    }
    for (std::size_t k = 0; k < differences.size(); ++k) {
      if (near.clearances[k].distance < 0.01) continue;
      ++compared;
      // Where the nearest feature changes the distance has a kink, which few pairs are at.
      kinks += std::abs(near.gradient(k, dof)[j] - differences[k]) > 1e-5;
    }
  }
  EXPECT_GT(compared, 2000);
  EXPECT_LT(kinks, compared / 200);
}

TEST(BatchClearances, KeysNameTheShapes) {
  Sampled cell(402, {}, 80);
  NearShapes near;
  cell.batch.shape_clearances(cell.Q, *cell.pairs, kWithin, *cell.scratch, near);
  std::map<std::uint64_t, int> pair_of;
  for (Eigen::Index i = 0; i < cell.Q.cols(); ++i) {
    std::set<std::uint64_t> here;
    for (std::size_t k = near.first[i]; k < near.first[i + 1]; ++k) {
      EXPECT_TRUE(here.insert(near.keys[k]).second) << "twice in column " << i;
      const auto [known, is_new] = pair_of.try_emplace(near.keys[k], near.clearances[k].pair);
      EXPECT_EQ(known->second, near.clearances[k].pair);
    }
  }
  EXPECT_GT(pair_of.size(), 50u);
}

TEST(BatchClearances, LeastOnesAreThoseOfTheExactChecker) {
  int near = 0, far = 0;
  test::for_each_target([&] {
    std::uint64_t seed = 500;
    for (const test::RandomCellOptions& options : test::kinds_of_cells()) {
      Sampled cell(++seed, options, 150);
      VectorXd least(cell.Q.cols());
      cell.batch.least_clearances(cell.Q, *cell.pairs, kWithin, *cell.scratch, least);
      for (Eigen::Index i = 0; i < cell.Q.cols(); ++i) {
        const double expected =
            cell.exact.least_clearance(cell.Q.col(i), cell.selection, *cell.exact_scratch).distance;
        ASSERT_NEAR(least[i], std::min(kWithin, expected), 1e-12)
            << "cell " << seed << ", column " << i;
        (expected < kWithin ? near : far) += 1;
      }
    }
  });
  EXPECT_GT(near, 1000);
  EXPECT_GT(far, 100);
}

TEST(BatchClearances, MisuseIsAContractViolation) {
  Sampled cell(403, {}, 3);
  NearShapes near;
  VectorXd least(2);
  EXPECT_THROW(cell.batch.compile(cell.selection, 0.01), ContractViolation);
  EXPECT_THROW(
      cell.batch.shape_clearances(cell.Q.topRows(2), *cell.pairs, 0.1, *cell.scratch, near),
      ContractViolation);
  EXPECT_THROW(cell.batch.shape_clearances(cell.Q, *cell.pairs, -0.1, *cell.scratch, near),
               ContractViolation);
  EXPECT_THROW(cell.batch.least_clearances(cell.Q, *cell.pairs, 0.1, *cell.scratch, least),
               ContractViolation);
  cell.batch.shape_clearances(cell.Q.leftCols(0), *cell.pairs, 0.1, *cell.scratch, near);
  EXPECT_EQ(near.first.size(), 1u);
}

}  // namespace
}  // namespace tandem::collision
