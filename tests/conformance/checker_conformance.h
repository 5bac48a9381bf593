#pragma once
/// What every CollisionChecker must do. Include in one source per test program and instantiate:
///   INSTANTIATE_TEST_SUITE_P(Mine, CheckerConformance, testing::Values(CheckerCase{
///       "mine", [](auto cell) { return make_mine(cell); }}));

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <thread>

#include "collision/random_cell.h"
#include "tandem/collision/checker.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

struct CheckerCase {
  std::string name;
  std::function<std::unique_ptr<CollisionChecker>(std::shared_ptr<const world::Workcell>)> make;
  double tolerance = 1e-9;             ///< Of distances apart [m].
  double depth_tolerance = 1e-6;       ///< Of depths [m].
  double mesh_depth_tolerance = 1e-6;  ///< Of depths in cells that hold meshes [m].
};

inline void PrintTo(const CheckerCase& c, std::ostream* out) { *out << c.name; }

namespace conformance {

using Eigen::Vector3d;
using Eigen::VectorXd;
using world::PairScope;
using world::PairSelection;

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

class CheckerConformance : public testing::TestWithParam<CheckerCase> {
 protected:
  static constexpr int kCells = 9;
  static constexpr int kConfigurations = 60;

  /// Calls f(checker, scratch, q) on random cells and configurations, seeded; every third cell
  /// holds meshes and clouds.
  template <class F>
  static void for_each_configuration(F&& f) {
    for (int i = 0; i < kCells; ++i) {
      const auto seed = static_cast<std::uint64_t>(i);
      test::RandomCellOptions options;
      if (i % 3 == 2) options.surface_pieces = 100;
      const auto checker = GetParam().make(test::random_cell(seed, options));
      const auto scratch = checker->make_scratch();
      Rng rng(100 + seed);
      for (int k = 0; k < kConfigurations; ++k) {
        f(*checker, *scratch, test::random_configuration(rng, checker->cell()));
      }
    }
  }
  static double tolerance(double distance) {
    return distance > 0 ? GetParam().tolerance : GetParam().depth_tolerance;
  }
  static double tolerance(double distance, const world::Workcell& cell) {
    const bool meshes = std::ranges::any_of(
        cell.bodies(), [](const world::Body& body) { return !body.surfaces_L.empty(); });
    return distance <= 0 && meshes ? GetParam().mesh_depth_tolerance : tolerance(distance);
  }
};

TEST_P(CheckerConformance, KnowsTheDistanceOfTwoBalls) {
  for (const double padding : {0.0, 0.05}) {
    const auto checker = GetParam().make(test::slider_cell(padding));
    const auto scratch = checker->make_scratch();
    const PairSelection all = checker->cell().select(PairScope::all());
    ASSERT_EQ(all.size(), 1U);
    for (const double x : {0.0, 0.3, 0.6499, 0.65, 0.7, 0.9, 1.25, 1.3501, 2.0}) {
      const VectorXd q = VectorXd::Constant(1, x);
      const double exact = std::abs(x - 1) - 0.3 - padding;
      const PairClearance least = checker->least_clearance(q, all, *scratch);
      EXPECT_EQ(least.pair, 0);
      EXPECT_NEAR(least.distance, exact, tolerance(exact)) << "x = " << x;
      EXPECT_EQ(checker->is_free(q, all, *scratch), exact > 0) << "x = " << x;
      const Vector3d nhat = x < 1 ? Vector3d(-Vector3d::UnitX()) : Vector3d(Vector3d::UnitX());
      EXPECT_LT((least.nhat_BA_W - nhat).norm(), 1e-3);
      EXPECT_LT((least.p_WCb - Vector3d::UnitX() - 0.2 * nhat).norm(), 1e-3);
    }
  }
}

TEST_P(CheckerConformance, AnswersAgreeWithEachOther) {
  int free = 0, colliding = 0;
  for_each_configuration(
      [&](const CollisionChecker& checker, CollisionChecker::Scratch& scratch, const VectorXd& q) {
        const PairSelection all = checker.cell().select(PairScope::all());
        const PairClearance least = checker.least_clearance(q, all, scratch);
        ASSERT_GE(least.pair, 0);
        const bool is_free = checker.is_free(q, all, scratch);
        EXPECT_EQ(is_free, least.distance > 0) << describe(checker.cell(), least);
        (is_free ? free : colliding) += 1;

        const double within = 0.08;
        std::vector<PairClearance> near(3), expected;
        checker.clearances(q, all, within, scratch, near);
        double least_alone = kInfinity;
        for (const int pair : all) {
          const PairClearance alone = checker.least_clearance(q, {pair}, scratch);
          EXPECT_EQ(alone.pair, pair);
          EXPECT_EQ(checker.is_free(q, {pair}, scratch), alone.distance > 0);
          least_alone = std::min(least_alone, alone.distance);
          if (alone.distance < within) expected.push_back(alone);
        }
        EXPECT_NEAR(least.distance, least_alone, 2 * tolerance(least_alone, checker.cell()));
        ASSERT_EQ(near.size(), expected.size());
        for (std::size_t i = 0; i < near.size(); ++i) {
          EXPECT_EQ(near[i].pair, expected[i].pair);
          EXPECT_NEAR(near[i].distance, expected[i].distance,
                      2 * tolerance(near[i].distance, checker.cell()));
        }
      });
  EXPECT_GT(free, 10);
  EXPECT_GT(colliding, 10);
}

TEST_P(CheckerConformance, WitnessPointsSpanTheDistance) {
  for_each_configuration([&](const CollisionChecker& checker, CollisionChecker::Scratch& scratch,
                             const VectorXd& q) {
    std::vector<PairClearance> near;
    checker.clearances(q, checker.cell().select(PairScope::all()), 0.1, scratch, near);
    for (const PairClearance& c : near) {
      if (c.distance < 0) continue;
      EXPECT_NEAR(c.nhat_BA_W.norm(), 1, 1e-9);
      EXPECT_LT((c.p_WCa - c.p_WCb - c.distance * c.nhat_BA_W).norm(), 10 * GetParam().tolerance);
    }
  });
}

TEST_P(CheckerConformance, ScopesPartitionThePairs) {
  for_each_configuration(
      [&](const CollisionChecker& checker, CollisionChecker::Scratch& scratch, const VectorXd& q) {
        const world::Workcell& cell = checker.cell();
        bool parts_free = true;
        double parts_least = kInfinity;
        for (const PairScope& scope :
             {PairScope::arm(0), PairScope::arm(1), PairScope::between(0, 1)}) {
          const PairSelection part = cell.select(scope);
          parts_free = parts_free && checker.is_free(q, part, scratch);
          parts_least = std::min(parts_least, checker.least_clearance(q, part, scratch).distance);
        }
        const PairSelection all = cell.select(PairScope::all());
        EXPECT_EQ(parts_free, checker.is_free(q, all, scratch));
        EXPECT_NEAR(parts_least, checker.least_clearance(q, all, scratch).distance,
                    2 * tolerance(parts_least, cell));
      });
}

TEST_P(CheckerConformance, GradientMatchesDifferences) {
  constexpr double h = 1e-4;
  const double allowed = 2e-3 + 4 * GetParam().tolerance / h;
  int compared = 0, wrong = 0;
  for_each_configuration(
      [&](const CollisionChecker& checker, CollisionChecker::Scratch& scratch, const VectorXd& q) {
        const world::Workcell& cell = checker.cell();
        VectorXd positions, gradient(cell.dof());
        robot::LinkPoses X_WL;
        cell.forward_kinematics(q, positions, X_WL);
        std::vector<PairClearance> near;
        checker.clearances(q, cell.select(PairScope::all()), 0.1, scratch, near);
        for (const PairClearance& c : near) {
          if (c.distance < 0.01) continue;
          distance_gradient(cell, X_WL, c, gradient);
          for (Eigen::Index j = 0; j < q.size(); ++j) {
            const auto distance = [&](double step) {
              VectorXd moved = q;
              moved[j] += step;
              return checker.least_clearance(moved, {c.pair}, scratch).distance;
            };
            const double forward = (distance(h) - c.distance) / h;
            const double backward = (c.distance - distance(-h)) / h;
            if (std::abs(forward - backward) > allowed) continue;  // A kink: there is no gradient.
            ++compared;
            // Some second derivative is left where a feature is small.
            if (std::abs(0.5 * (forward + backward) - gradient[j]) > allowed) ++wrong;
          }
        }
      });
  EXPECT_GT(compared, 500);
  EXPECT_EQ(wrong, 0) << "of " << compared;
}

TEST_P(CheckerConformance, NothingSelectedIsFree) {
  const auto checker = GetParam().make(test::random_cell(1));
  const auto scratch = checker->make_scratch();
  const VectorXd q = VectorXd::Zero(checker->cell().dof());
  EXPECT_TRUE(checker->is_free(q, {}, *scratch));
  const PairClearance least = checker->least_clearance(q, {}, *scratch);
  EXPECT_EQ(least.pair, -1);
  EXPECT_EQ(least.distance, kInfinity);
  std::vector<PairClearance> near(2);
  checker->clearances(q, {}, 1.0, *scratch, near);
  EXPECT_TRUE(near.empty());
}

TEST_P(CheckerConformance, ThreadsShareOneChecker) {
  const auto checker = GetParam().make(test::random_cell(3));
  const PairSelection all = checker->cell().select(PairScope::all());
  const auto distances = [&] {
    const auto scratch = checker->make_scratch();
    Rng rng(5);
    std::vector<double> found;
    for (int i = 0; i < 200; ++i) {
      const VectorXd q = test::random_configuration(rng, checker->cell());
      found.push_back(checker->least_clearance(q, all, *scratch).distance);
    }
    return found;
  };
  const std::vector<double> expected = distances();
  std::vector<double> other[2];
  {
    std::jthread one([&] { other[0] = distances(); });
    std::jthread two([&] { other[1] = distances(); });
  }
  EXPECT_EQ(other[0], expected);
  EXPECT_EQ(other[1], expected);
}

TEST_P(CheckerConformance, RefusesWhatIsNotItsOwn) {
  const auto checker = GetParam().make(test::random_cell(1));
  const auto other = GetParam().make(test::random_cell(2));
  const auto scratch = checker->make_scratch(), foreign = other->make_scratch();
  const PairSelection all = checker->cell().select(PairScope::all());
  const VectorXd q = VectorXd::Zero(checker->cell().dof());
  EXPECT_THROW(checker->is_free(VectorXd::Zero(q.size() + 1), all, *scratch), ContractViolation);
  EXPECT_THROW(checker->is_free(q, all, *foreign), ContractViolation);
  EXPECT_THROW(checker->least_clearance(q, {static_cast<int>(all.size())}, *scratch),
               ContractViolation);
  EXPECT_THROW(checker->is_free(q, {-1}, *scratch), ContractViolation);
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(CheckerConformance);

}  // namespace conformance
}  // namespace tandem::collision
