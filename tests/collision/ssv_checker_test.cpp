#include "tandem/collision/ssv_checker.h"

#include <gtest/gtest.h>

#include "collision/random_cell.h"
#include "conformance/checker_conformance.h"
#include "tandem/geometry/distance.h"

namespace tandem::collision {
namespace conformance {

INSTANTIATE_TEST_SUITE_P(Ssv, CheckerConformance,
                         testing::Values(CheckerCase{
                             "ssv", [](auto cell) { return std::make_unique<SsvChecker>(cell); }}));

}  // namespace conformance

namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using world::PairScope;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Every shape against every shape, with poses from the robot module: no bounding volumes.
double brute_force(const world::Workcell& cell, const robot::LinkPoses& X_WL, int pair) {
  const world::Body& a = cell.bodies()[index(cell.pairs()[index(pair)].a)];
  const world::Body& b = cell.bodies()[index(cell.pairs()[index(pair)].b)];
  double least = std::numeric_limits<double>::infinity();
  for (const geometry::Shape& shape_a : a.shapes_L) {
    for (const geometry::Shape& shape_b : b.shapes_L) {
      const auto clearance = geometry::clearance(shape_a.padded(a.padding).in(X_WL[index(a.link)]),
                                                 shape_b.padded(b.padding).in(X_WL[index(b.link)]));
      least = std::min(least, clearance.distance);
    }
  }
  return least;
}

TEST(SsvChecker, MatchesBruteForceOnEveryPair) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const SsvChecker checker(test::random_cell(seed));
    const world::Workcell& cell = checker.cell();
    const auto scratch = checker.make_scratch();
    const auto all = cell.select(PairScope::all());
    Rng rng(seed);
    VectorXd positions;
    robot::LinkPoses X_WL;
    for (int i = 0; i < 50; ++i) {
      const VectorXd q = test::random_configuration(rng, cell);
      cell.forward_kinematics(q, positions, X_WL);
      double least = std::numeric_limits<double>::infinity();
      for (const int pair : all) {
        const double exact = brute_force(cell, X_WL, pair);
        least = std::min(least, exact);
        const double allowed = exact > 0 ? 1e-8 : 1e-6;
        EXPECT_NEAR(checker.least_clearance(q, {pair}, *scratch).distance, exact, allowed);
        const double needed = rng.uniform(-0.1, 0.5);
        const double found = checker.pair_distance(pair, needed, *scratch);
        if (exact < needed - allowed) {
          EXPECT_NEAR(found, exact, allowed);
        } else {
          EXPECT_LE(found, exact + allowed);
          EXPECT_GE(found, needed - allowed);
        }
      }
      EXPECT_NEAR(checker.least_clearance(q, all, *scratch).distance, least,
                  least > 0 ? 1e-8 : 1e-6);
    }
  }
}

// The independent oracle of the lever arms: Jacobians of points sampled in the bodies' cores.
TEST(SsvChecker, NoCorePointMovesFurtherThanItsLeverArm) {
  double tightest = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const SsvChecker checker(test::random_cell(seed));
    const world::Workcell& cell = checker.cell();
    Rng rng(seed);
    VectorXd positions;
    robot::LinkPoses X_WL;
    for (int i = 0; i < 300; ++i) {
      const VectorXd q = test::random_configuration(rng, cell);
      cell.forward_kinematics(q, positions, X_WL);
      for (std::size_t b = 0; b < cell.bodies().size(); ++b) {
        const world::Body& body = cell.bodies()[b];
        for (const geometry::Shape& shape_L : body.shapes_L) {
          const Vector3d p_W = X_WL[index(body.link)] * shape_L.support(test::random_point(rng, 1));
          for (const world::Arm& arm : cell.arms()) {
            Eigen::Matrix<double, 6, Eigen::Dynamic> J(6, arm.dof());
            robot::jacobian(cell.model(), X_WL, body.link, p_W, arm.columns, J);
            for (int k = 0; k < arm.dof(); ++k) {
              const double moved = J.col(k).head<3>().norm();
              const double lever = checker.lever_arm(static_cast<int>(b), arm.offset + k);
              EXPECT_LE(moved, lever + 1e-12);
              if (lever > 0) tightest = std::max(tightest, moved / lever);
            }
          }
        }
      }
    }
  }
  EXPECT_GT(tightest, 0.95);
}

TEST(SsvChecker, LeverArmsOfStandingBodiesAreZero) {
  const SsvChecker checker(test::random_cell(2));
  const world::Workcell& cell = checker.cell();
  for (std::size_t b = 0; b < cell.bodies().size(); ++b) {
    for (const world::Arm& arm : cell.arms()) {
      const bool moves = ((cell.bodies()[b].moved_by >> (&arm - cell.arms().data())) & 1U) != 0;
      double most = 0;
      for (int k = 0; k < arm.dof(); ++k) {
        most = std::max(most, checker.lever_arm(static_cast<int>(b), arm.offset + k));
      }
      EXPECT_EQ(most > 0, moves) << cell.bodies()[b].name;
    }
  }
}

TEST(SsvChecker, RefusesConfigurationsThatAreNotFinite) {
  const SsvChecker checker(test::random_cell(2));
  const auto scratch = checker.make_scratch();
  const auto all = checker.cell().select(PairScope::all());
  const VectorXd q =
      VectorXd::Constant(checker.cell().dof(), std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(checker.is_free(q, all, *scratch), ContractViolation);
}

}  // namespace
}  // namespace tandem::collision
