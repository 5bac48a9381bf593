#include "tandem/pipeline/prioritized.h"

#include <gtest/gtest.h>

#include "small_cell.h"
#include "tandem/pipeline/planner.h"
#include "tandem/planning/measured_path.h"

namespace tandem::pipeline {
namespace {

using Eigen::VectorXd;

TEST(Prioritized, PathsAreProvenInEveryOrder) {
  const auto cell = test::small_cell();
  const Planner planner(cell);
  const auto compiled = planner.compiled();
  const auto ends = planner.resolve(cell->query("cross"));
  ASSERT_TRUE(ends);
  for (const std::vector<int>& order : planning::orders(2)) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto i = static_cast<std::size_t>(order[0]);
      const world::Arm& arm = cell->arms()[i];
      const ResolvedQuery own{"own", ends->start.segment(arm.offset, arm.dof()),
                              ends->goal.segment(arm.offset, arm.dof()),
                              compiled->alone(order[0]).shared_cell()};
      const auto first = plan_path(own.cell, own, {.seed = seed});
      ASSERT_TRUE(first) << first.error().message;
      const auto path = plan_prioritized(*compiled, *ends, first->path, order, seed, {});
      ASSERT_TRUE(path) << path.error().message;
      EXPECT_EQ(path->front(), ends->start);
      EXPECT_EQ(path->back(), ends->goal);
      const auto clearance = certify_path(cell, *path);
      EXPECT_TRUE(clearance) << clearance.error().message;
      // The first arm stays on its path.
      for (const VectorXd& q : *path) {
        const VectorXd at = q.segment(arm.offset, arm.dof());
        double away = std::numeric_limits<double>::infinity();
        for (std::size_t k = 1; k < first->path.size(); ++k) {
          const VectorXd d = first->path[k] - first->path[k - 1];
          const double s = std::clamp((at - first->path[k - 1]).dot(d) / d.squaredNorm(), 0.0, 1.0);
          away = std::min(away, (at - first->path[k - 1] - s * d).norm());
        }
        EXPECT_LT(away, 1e-9);
      }
    }
  }
}

TEST(ArmAlone, IsPlannedByTheSamePipeline) {
  const auto cell = test::small_cell();
  const Planner planner(cell);
  const auto ends = planner.resolve(cell->query("cross"));
  ASSERT_TRUE(ends);
  for (int i = 0; i < 2; ++i) {
    const auto alone = cell->arm_alone(i);
    const ResolvedQuery own{"own", ends->start.segment(4 * i, 4), ends->goal.segment(4 * i, 4)};
    const auto planned = plan(alone, own);
    ASSERT_TRUE(planned) << planned.error().message;
    EXPECT_EQ(planned->trajectory.dof(), 4);
    EXPECT_GT(planned->report.least_clearance, 0);
    EXPECT_LT((planned->trajectory.at(planned->trajectory.duration()).q - own.goal).norm(), 1e-9);
  }
}

TEST(MeasuredPath, GoesAlongByLength) {
  const planning::MeasuredPath path(
      {Eigen::Vector2d(0, 0), Eigen::Vector2d(3, 0), Eigen::Vector2d(3, 1)});
  EXPECT_DOUBLE_EQ(path.length(), 4);
  EXPECT_EQ(path.waypoints(), (std::vector<double>{0, 0.75, 1}));
  EXPECT_TRUE(path.position(0.375).isApprox(Eigen::Vector2d(1.5, 0)));
  EXPECT_TRUE(path.position(0.875).isApprox(Eigen::Vector2d(3, 0.5)));
  EXPECT_EQ(path.position(-1), Eigen::Vector2d(0, 0));
  EXPECT_EQ(path.position(2), Eigen::Vector2d(3, 1));
  std::vector<double> parts;
  path.append_waypoints(1, 0.5, parts);
  EXPECT_EQ(parts, (std::vector<double>{0.5}));
  const planning::MeasuredPath still({Eigen::Vector2d(1, 2), Eigen::Vector2d(1, 2)});
  EXPECT_EQ(still.length(), 0);
  EXPECT_EQ(still.position(0.5), Eigen::Vector2d(1, 2));
}

TEST(Orders, AreAllForFewArmsAndRotationsForMany) {
  EXPECT_EQ(planning::orders(2), (std::vector<std::vector<int>>{{0, 1}, {1, 0}}));
  EXPECT_EQ(planning::orders(3).size(), 6U);
  EXPECT_EQ(planning::orders(4), (std::vector<std::vector<int>>{
                                     {0, 1, 2, 3}, {1, 2, 3, 0}, {2, 3, 0, 1}, {3, 0, 1, 2}}));
}

}  // namespace
}  // namespace tandem::pipeline
