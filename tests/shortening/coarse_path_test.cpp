#include "tandem/shortening/coarse_path.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tandem/core/rng.h"

namespace tandem::shortening {
namespace {

using motion::JointPath;

JointPath random_path(Rng& rng, int dof, std::size_t count) {
  JointPath path(count, Eigen::VectorXd(dof));
  for (Eigen::VectorXd& q : path) {
    for (double& value : q) value = rng.uniform(-2, 2);
  }
  return path;
}

TEST(CoarsePath, StandsForThePathItCameFrom) {
  Rng rng(1);
  for (int n = 0; n < 200; ++n) {
    const std::size_t bends = 2 + rng.index(9);
    const JointPath corners = random_path(rng, 1 + n % 8, bends);
    const JointPath path = motion::interpolated(corners, static_cast<int>(bends + rng.index(150)));
    const int edges = 1 + static_cast<int>(rng.index(40));
    const CoarsePath coarse = coarsened(path, edges);
    ASSERT_EQ(coarse.parts.size() + 1, coarse.waypoints.size());
    EXPECT_GE(std::ranges::min(coarse.parts), 1);
    EXPECT_LE(coarse.parts.size(), static_cast<std::size_t>(edges) + bends);
    const JointPath again = coarse.divided();
    ASSERT_EQ(again.size(), path.size());
    for (std::size_t i = 0; i < path.size(); ++i) {
      EXPECT_LT((again[i] - path[i]).norm(), 1e-12) << "path " << n << ", waypoint " << i;
    }
    EXPECT_EQ(again.front(), path.front());
    EXPECT_EQ(again.back(), path.back());
  }
}

TEST(CoarsePath, DividesStraightPathsEvenly) {
  const JointPath ends{Eigen::VectorXd::Zero(3), Eigen::VectorXd::Ones(3)};
  for (const int count : {20, 41, 160}) {
    const CoarsePath coarse = coarsened(motion::interpolated(ends, count), 19);
    EXPECT_EQ(coarse.parts.size(), 19u);
    EXPECT_LE(std::ranges::max(coarse.parts) - std::ranges::min(coarse.parts), 1);
    EXPECT_EQ(std::accumulate(coarse.parts.begin(), coarse.parts.end(), 0), count - 1);
  }
}

TEST(CoarsePath, KeepsEveryWaypointOfACurve) {
  Rng rng(2);
  const JointPath path = random_path(rng, 7, 60);
  const CoarsePath coarse = coarsened(path, 10);
  EXPECT_EQ(coarse.waypoints, path);
  EXPECT_EQ(coarse.parts, CoarsePath::of(path).parts);
}

TEST(CoarsePath, IsAsGoodForOneEdgeOrStandingStill) {
  const JointPath edge{Eigen::VectorXd::Zero(2), Eigen::VectorXd::Ones(2)};
  EXPECT_EQ(coarsened(edge, 5).divided(), edge);
  const JointPath still(30, Eigen::VectorXd::Constant(4, 0.3));
  EXPECT_EQ(coarsened(still, 5).divided(), still);
  EXPECT_EQ(coarsened(still, 5).parts.size(), 5u);
}

}  // namespace
}  // namespace tandem::shortening
