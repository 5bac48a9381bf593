#include "tandem/motion/joint_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::motion {
namespace {

using Eigen::VectorXd;

JointPath random_path(Rng& rng, int count, int dof) {
  JointPath path;
  for (int i = 0; i < count; ++i) {
    path.push_back(VectorXd::NullaryExpr(dof, [&] { return rng.uniform(-3, 3); }));
  }
  return path;
}

TEST(JointLength, SumsEuclideanEdges) {
  EXPECT_EQ(joint_length({}), 0);
  EXPECT_EQ(joint_length({VectorXd::Ones(3)}), 0);
  EXPECT_DOUBLE_EQ(joint_length({Eigen::Vector2d(0, 0), Eigen::Vector2d(3, 4),
                                 Eigen::Vector2d(3, 4), Eigen::Vector2d(3, 3)}),
                   6);
}

TEST(Interpolated, KeepsWaypointsAndLengthAndReachesTheCount) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const int n = static_cast<int>(2 + rng.index(8)), count = static_cast<int>(rng.index(40));
    const JointPath path = random_path(rng, n, 3);
    const JointPath dense = interpolated(path, count);
    EXPECT_EQ(dense.size(), static_cast<std::size_t>(std::max(n, count)));
    EXPECT_NEAR(joint_length(dense), joint_length(path), 1e-12);
    auto at = dense.begin();
    for (const VectorXd& waypoint : path) {
      at = std::find(at, dense.end(), waypoint);  // Exactly, and in order.
      ASSERT_NE(at, dense.end());
    }
  }
}

TEST(Interpolated, DividesTheLongestEdgesEvenly) {
  const JointPath path{VectorXd::Zero(1), VectorXd::Constant(1, 6), VectorXd::Constant(1, 7)};
  const JointPath dense = interpolated(path, 6);
  const std::vector<double> expected{0, 1.5, 3, 4.5, 6, 7};
  ASSERT_EQ(dense.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_DOUBLE_EQ(dense[i][0], expected[i]);
}

TEST(Interpolated, DividesEqualEdgesFromTheStartOn) {
  const JointPath path{VectorXd::Zero(1), VectorXd::Ones(1), VectorXd::Constant(1, 2)};
  EXPECT_EQ(interpolated(path, 4)[1][0], 0.5);
}

TEST(Interpolated, HasNoPieceThatAnotherDivisionWouldNotExcuse) {
  Rng rng(2);
  for (int i = 0; i < 100; ++i) {
    const JointPath path = random_path(rng, 5, 7);
    const JointPath dense = interpolated(path, 20);
    double longest = 0, shortest_divided = 1e9;
    std::size_t edge = 0, parts = 0;
    for (std::size_t k = 1; k < dense.size(); ++k) {
      longest = std::max(longest, (dense[k] - dense[k - 1]).norm());
      ++parts;
      if (dense[k] != path[edge + 1]) continue;
      // Undoing the last division of this edge must leave pieces longer than all others.
      if (parts > 1) {
        shortest_divided = std::min(shortest_divided, (path[edge + 1] - path[edge]).norm() /
                                                          static_cast<double>(parts - 1));
      }
      ++edge;
      parts = 0;
    }
    EXPECT_GE(shortest_divided, longest * (1 - 1e-12));
  }
}

TEST(Interpolated, RejectsAPathWithoutEdges) {
  EXPECT_EQ(interpolated({VectorXd::Zero(2)}, 1).size(), 1u);
  EXPECT_THROW(interpolated({VectorXd::Zero(2)}, 3), ContractViolation);
}

TEST(CartesianLength, MatchesTheFormulaOnKnownMoves) {
  using Eigen::AngleAxisd, Eigen::Isometry3d, Eigen::Vector3d;
  Rng rng(3);
  for (int i = 0; i < 200; ++i) {
    const double alpha = rng.uniform(0, 10);
    std::vector<Isometry3d> X_WE{Isometry3d::Identity()};
    X_WE[0].rotate(AngleAxisd(rng.uniform(-3, 3), Vector3d(1, 2, -1).normalized()));
    double f = 0, L = 0;
    for (int k = 0; k < 6; ++k) {
      // A known turn about a random axis of the tool and a known shift in the world.
      const double angle = rng.uniform(0, std::numbers::pi), shift = rng.uniform(0, 1);
      const Vector3d axis = Vector3d(rng.uniform(-1, 1), rng.uniform(-1, 1), 0.3).normalized();
      Isometry3d next = X_WE.back();
      next.linear() = X_WE.back().linear() * AngleAxisd(angle, axis).toRotationMatrix();
      next.translation() += shift * Vector3d(rng.uniform(-1, 1), 0.4, 1).normalized();
      X_WE.push_back(next);
      f += 0.5 * (alpha * shift * shift + angle * angle);
      L += std::sqrt(alpha * shift * shift + angle * angle);
    }
    const CartesianLength length = cartesian_length(X_WE, alpha);
    EXPECT_NEAR(length.f, f, 1e-10);
    EXPECT_NEAR(length.L, L, 1e-10);
  }
}

TEST(CartesianLength, IsZeroWhereNothingMoves) {
  EXPECT_EQ(cartesian_length({}).f, 0);
  const std::vector<Eigen::Isometry3d> still(4, Eigen::Isometry3d::Identity());
  EXPECT_EQ(cartesian_length(still).f, 0);
  EXPECT_EQ(cartesian_length(still).L, 0);
}

TEST(CartesianLength, LIsIndependentOfTheWaypointCountAndFFallsWithIt) {
  std::vector<Eigen::Isometry3d> X_WE;
  const auto pose = [](double s) {
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.translation() = s * Eigen::Vector3d(0.3, -0.2, 0.6);
    X.rotate(Eigen::AngleAxisd(2.5 * s, Eigen::Vector3d(0, 0.6, 0.8)));
    return X;
  };
  double L_once = 0, f_once = 0;
  for (int parts : {1, 2, 5, 40}) {
    X_WE.clear();
    for (int k = 0; k <= parts; ++k) X_WE.push_back(pose(static_cast<double>(k) / parts));
    const CartesianLength length = cartesian_length(X_WE);
    if (parts == 1) {
      L_once = length.L;
      f_once = length.f;
    }
    EXPECT_NEAR(length.L, L_once, 1e-12);
    EXPECT_NEAR(length.f, f_once / parts, 1e-12);
  }
}

}  // namespace
}  // namespace tandem::motion
