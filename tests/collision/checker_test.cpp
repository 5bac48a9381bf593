#include "tandem/collision/checker.h"

#include <gtest/gtest.h>

#include "collision/random_cell.h"
#include "tandem/core/contract.h"

namespace tandem::collision {
namespace {

TEST(Describe, SaysWhichPairAndHowFar) {
  const auto cell = test::slider_cell();
  PairClearance clearance;
  EXPECT_EQ(describe(*cell, clearance), "no pair");
  clearance.pair = 0;
  clearance.distance = 0.012;
  EXPECT_EQ(describe(*cell, clearance), "slider/carriage and ball, 0.012 m apart");
  clearance.distance = -0.0301;
  EXPECT_EQ(describe(*cell, clearance), "slider/carriage and ball, 0.0301 m deep");
}

TEST(DistanceGradient, RefusesWhatDoesNotFit) {
  const auto cell = test::slider_cell();
  Eigen::VectorXd positions, gradient(1), wrong(2);
  robot::LinkPoses X_WL;
  cell->forward_kinematics(Eigen::VectorXd::Zero(1), positions, X_WL);
  PairClearance clearance;
  EXPECT_THROW(distance_gradient(*cell, X_WL, clearance, gradient), ContractViolation);
  clearance.pair = 0;
  EXPECT_THROW(distance_gradient(*cell, X_WL, clearance, wrong), ContractViolation);
}

TEST(DistanceGradient, HandlesArmsOfManyJoints) {
  test::RandomCellOptions options;
  options.joints = 19;
  options.obstacles = 1;
  const auto cell = test::random_cell(4, options);
  Rng rng(3);
  for (int i = 0; i < 20; ++i) {
    const Eigen::VectorXd q = test::random_configuration(rng, *cell);
    Eigen::VectorXd positions, gradient(cell->dof());
    robot::LinkPoses X_WL;
    cell->forward_kinematics(q, positions, X_WL);
    PairClearance clearance;
    clearance.pair = static_cast<int>(rng.index(cell->pairs().size()));
    clearance.p_WCa = test::random_point(rng, 1);
    clearance.p_WCb = test::random_point(rng, 1);
    clearance.nhat_BA_W = test::random_point(rng, 1).normalized();
    distance_gradient(*cell, X_WL, clearance, gradient);
    // The witness points fixed on their links, moved by hand.
    const world::BodyPair& pair = cell->pairs()[static_cast<std::size_t>(clearance.pair)];
    const auto link = [&](int body) {
      return static_cast<std::size_t>(cell->bodies()[static_cast<std::size_t>(body)].link);
    };
    const Eigen::Vector3d p_La = X_WL[link(pair.a)].inverse() * clearance.p_WCa;
    const Eigen::Vector3d p_Lb = X_WL[link(pair.b)].inverse() * clearance.p_WCb;
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      constexpr double h = 1e-6;
      double apart[2];
      for (const int side : {0, 1}) {
        Eigen::VectorXd moved = q;
        moved[j] += side == 0 ? -h : h;
        cell->forward_kinematics(moved, positions, X_WL);
        apart[side] =
            clearance.nhat_BA_W.dot(X_WL[link(pair.a)] * p_La - X_WL[link(pair.b)] * p_Lb);
      }
      EXPECT_NEAR(gradient[j], (apart[1] - apart[0]) / (2 * h), 1e-7);
    }
  }
}

}  // namespace
}  // namespace tandem::collision
