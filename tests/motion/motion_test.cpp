#include "tandem/motion/motion.h"

#include <gtest/gtest.h>

namespace tandem::motion {
namespace {

using Eigen::Vector2d, Eigen::VectorXd;

TEST(StraightEdge, RunsFromOneEndToTheOtherAndStands) {
  const StraightEdge edge(Vector2d(1, -1), Vector2d(3, 0));
  EXPECT_EQ(edge.dof(), 2);
  EXPECT_EQ(edge.duration(), 1);
  VectorXd q(2);
  edge.position(0.25, q);
  EXPECT_TRUE(q.isApprox(Vector2d(1.5, -0.75)));
  edge.position(-1, q);
  EXPECT_EQ(q, Vector2d(1, -1));
  edge.position(2, q);
  EXPECT_EQ(q, Vector2d(3, 0));

  EXPECT_EQ(edge.at(0.5).qd, Vector2d(2, 1));
  EXPECT_EQ(edge.at(0.5).qdd, Vector2d(0, 0));
  EXPECT_EQ(edge.at(1.5).qd, Vector2d(0, 0));
  EXPECT_EQ(edge.at(-0.5).q, Vector2d(1, -1));
}

TEST(StraightEdge, DeviatesByHalfOfWhatItCovers) {
  const StraightEdge edge(Vector2d(1, -1), Vector2d(3, -2));
  VectorXd D(2);
  edge.deviation(0.25, 0.75, D);
  EXPECT_TRUE(D.isApprox(Vector2d(0.5, 0.25)));
}

}  // namespace
}  // namespace tandem::motion
