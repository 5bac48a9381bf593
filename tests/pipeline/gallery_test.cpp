// Deadlocks and how they end: cells in which it is known whether and by what the arms get along.

#include "gallery.h"

#include <algorithm>
#include <cmath>

#include "tandem/collision/ssv_checker.h"
#include "tandem/pipeline/decoupled.h"
#include "tandem/pipeline/planner.h"

namespace tandem::pipeline {
namespace {

using Cell = std::shared_ptr<const world::Workcell>;
using Eigen::Vector2d;
using geometry::Shape;

/// One rung alone or a part of the ladder, on the first query.
struct Climb {
  explicit Climb(Cell in, std::uint64_t seed = 1, double deadline = 60)
      : cell(std::move(in)), planner(cell) {
    options.strategy = Strategy::kDecoupled;
    options.seed = seed;
    options.deadline = deadline;
  }

  Result<motion::CellMotion> rungs(Rung first, Rung last) {
    report = {};
    const auto ends = planner.resolve(cell->queries().front());
    EXPECT_TRUE(ends) << ends.error().message;
    return plan_decoupled(*planner.compiled(), *ends, options,
                          StopCondition::after(options.deadline), report,
                          {.first = first, .last = last});
  }

  Cell cell;
  Planner planner;
  PlanOptions options;
  PlanReport report;
};

/// Samples of the motion are free, and it goes from start to goal.
void expect_free(const Cell& cell, const motion::CellMotion& motion) {
  const collision::SsvChecker checker(cell);
  const auto scratch = checker.make_scratch();
  const auto all = cell->select(world::PairScope::all());
  Eigen::VectorXd q(cell->dof());
  for (int k = 0; k <= 1000; ++k) {
    motion.position(motion.duration() * k / 1000, q);
    ASSERT_TRUE(checker.is_free(q, all, *scratch)) << "at " << k << " of 1000";
  }
  const Planner planner(cell);
  const auto ends = planner.resolve(cell->queries().front());
  EXPECT_LT((motion.at(0).q - ends->start).norm(), 1e-9);
  EXPECT_LT((motion.at(motion.duration()).q - ends->goal).norm(), 1e-9);
}

/// The whole ladder ends at `rung`.
void expect_rung(const Cell& cell, Rung rung, std::uint64_t seed = 1) {
  const auto planned = plan(cell, cell->queries().front(),
                            {.strategy = Strategy::kDecoupled, .seed = seed, .deadline = 60});
  ASSERT_TRUE(planned) << planned.error().message;
  EXPECT_TRUE(planned->report.rungs.contains(to_string(rung)))
      << "ended by another rung than " << to_string(rung);
  expect_free(cell, planned->trajectory);
}

/// Coordination proves that there is none, and says who blocks.
void expect_deadlock(const Cell& cell) {
  Climb climb(cell);
  const auto motion = climb.rungs(Rung::kCoordinated, Rung::kCoordinated);
  ASSERT_FALSE(motion);
  EXPECT_EQ(motion.error().code, ErrorCode::kCoordination) << motion.error().message;
  EXPECT_NE(motion.error().message.find("a/link"), std::string::npos) << motion.error().message;
  EXPECT_NE(motion.error().message.find("b/link"), std::string::npos) << motion.error().message;
}

/// How often an arm's local time turns round.
int turns(const motion::ArmMotion& arm) {
  if (!arm.map()) return 0;
  int count = 0, last = 0;
  for (int k = 0; k <= 2000; ++k) {
    const double rate = arm.map()->at(arm.duration() * k / 2000)[1];
    const int sign = rate > 1e-3 ? 1 : rate < -1e-3 ? -1 : 0;
    if (sign != 0 && last != 0 && sign != last) ++count;
    if (sign != 0) last = sign;
  }
  return count;
}

TEST(Gallery, CrossingForksWaitForEachOther) {
  const Cell cell = test::stencil_cell({{{0.5, 0.5}, {0.5, 0.5}}});
  expect_rung(cell, Rung::kCoordinated);
  Climb climb(cell);
  const auto motion = climb.rungs(Rung::kCoordinated, Rung::kCoordinated);
  ASSERT_TRUE(motion) << motion.error().message;
  const motion::ArmMotion &a = motion->arms()[0], &b = motion->arms()[1];
  EXPECT_LT(motion->duration(), 1.6 * a.spline().duration());
  // Alike as they are, one of them lets the other go first.
  ASSERT_TRUE(a.map() && b.map());
  double apart = 0;
  for (int k = 0; k <= 100; ++k) {
    const double t = motion->duration() * k / 100;
    apart = std::max(apart, std::abs((*a.map())(t) - (*b.map())(t)));
  }
  EXPECT_GT(apart, 0.05);
}

TEST(Gallery, AWideObstacleInTheDiagramSendsOneArmFirst) {
  const Cell cell = test::stencil_cell({{{0.25, 0.25}, {0.75, 0.75}}});
  expect_rung(cell, Rung::kCoordinated);
}

TEST(Gallery, AZigzagTakesGoingBackInTime) {
  const Cell cell = test::stencil_cell({{{-0.3, 0.35}, {0.6, 0.35}}, {{0.5, 0.7}, {1.3, 0.7}}});
  expect_rung(cell, Rung::kCoordinated);
  Climb climb(cell);
  const auto motion = climb.rungs(Rung::kCoordinated, Rung::kCoordinated);
  ASSERT_TRUE(motion) << motion.error().message;
  EXPECT_GE(turns(motion->arms()[0]), 2);
}

TEST(Gallery, AWallAcrossTheDiagramIsADeadlock) {
  const Cell cell = test::stencil_cell({{{-2.5, 0.5}, {2.5, 0.5}}});
  expect_deadlock(cell);
  // One joint per arm: no other path can help, and only the deadline says so.
  const auto planned =
      plan(cell, cell->queries().front(), {.strategy = Strategy::kDecoupled, .deadline = 0.5});
  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::kTimeout) << planned.error().message;
}

TEST(Gallery, ASwapOnOneRailIsADeadlock) {
  const Shape ball = *Shape::sphere(Eigen::Vector3d::Zero(), 0.1);
  const std::vector<Eigen::Vector3d> rail = {Eigen::Vector3d::UnitX()};
  expect_deadlock(test::gallery_cell(
      {test::sliding_robot("a", rail, 2, {ball}), test::sliding_robot("b", rail, 2, {ball})},
      {{test::one(-1), test::one(1)}, {test::one(1), test::one(-1)}}));
}

TEST(Gallery, ASwapInACorridorWithABayIsPlannedAroundTheOther) {
  const Cell cell = test::disc_cell({Vector2d(-1, 0), Vector2d(1, 0)},
                                    {Vector2d(1, 0), Vector2d(-1, 0)}, test::corridor_with_bay());
  expect_deadlock(cell);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) expect_rung(cell, Rung::kPrioritized, seed);
}

TEST(Gallery, AnArmParkedOnTheOnlyPathMakesWay) {
  const Cell cell = test::disc_cell({Vector2d(-1, 0), Vector2d(1, 0)},
                                    {Vector2d(0, 0), Vector2d(0, 0)}, test::corridor_with_bay());
  expect_deadlock(cell);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) expect_rung(cell, Rung::kPrioritized, seed);
}

TEST(Gallery, AnArmLeavesTheOthersGoalFirst) {
  expect_rung(test::disc_cell({Vector2d(-1, 0), Vector2d(0, 0.05)},
                              {Vector2d(0, 0.05), Vector2d(1, 0)}, {}),
              Rung::kCoordinated);
}

TEST(Gallery, AnArmParkedAtTheOthersGoalIsInfeasible) {
  const Cell cell =
      test::disc_cell({Vector2d(-1, 0), Vector2d(0, 0)}, {Vector2d(0.1, 0), Vector2d(0.1, 0)}, {});
  const auto planned = plan(cell, cell->queries().front(), {.strategy = Strategy::kDecoupled});
  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(planned.error().message.find("goal"), std::string::npos) << planned.error().message;
  EXPECT_NE(planned.error().message.find("a/link2 and b/link2"), std::string::npos);
}

TEST(Gallery, OneGoalForBothIsInfeasible) {
  const Cell cell =
      test::disc_cell({Vector2d(-1, 0), Vector2d(0, 0)}, {Vector2d(1, 0), Vector2d(0, 0)}, {});
  const auto planned = plan(cell, cell->queries().front(), {.strategy = Strategy::kDecoupled});
  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::kInfeasible);
}

TEST(Gallery, OtherPairsOfPathsGoRoundOnBothSides) {
  const Cell cell = test::disc_cell({Vector2d(-0.55, 0), Vector2d(0.55, 0)},
                                    {Vector2d(0.55, 0), Vector2d(-0.55, 0)}, test::ring());
  int first = 0, further = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Climb climb(cell, seed);
    const auto motion = climb.rungs(Rung::kCoordinated, Rung::kPrioritized);
    ASSERT_TRUE(motion) << motion.error().message;
    expect_free(cell, *motion);
    first += climb.report.rungs.contains(to_string(Rung::kCoordinated));
    further += climb.report.rungs.contains(to_string(Rung::kCandidates));
  }
  // A pair of paths is on one side as often as not, and then three of each hardly ever all are.
  EXPECT_GE(first, 4);
  EXPECT_GE(further, 4);
}

TEST(Gallery, EveryRungCanStandAlone) {
  const Cell open =
      test::disc_cell({Vector2d(-1, 0), Vector2d(1, 0)}, {Vector2d(0, -1), Vector2d(0, 1)}, {});
  for (const Rung rung :
       {Rung::kCoordinated, Rung::kCandidates, Rung::kPrioritized, Rung::kCentralized}) {
    Climb climb(open);
    const auto motion = climb.rungs(rung, rung);
    ASSERT_TRUE(motion) << to_string(rung) << ": " << motion.error().message;
    EXPECT_TRUE(climb.report.rungs.contains(to_string(rung)));
    expect_free(open, *motion);
  }
}

}  // namespace
}  // namespace tandem::pipeline
