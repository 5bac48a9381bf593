#pragma once
/// What every PathPlanner must do. Include in one source per test program and instantiate:
///   INSTANTIATE_TEST_SUITE_P(Mine, PathPlannerConformance,
///                            testing::Values(PlannerCase{"mine", [] { return make_mine(); }}),
///                            case_name<PlannerCase>);

#include "conformance/ball_world.h"

namespace tandem::planning {

struct PlannerCase {
  std::string name;
  std::function<std::unique_ptr<PathPlanner>()> make;
};

inline void PrintTo(const PlannerCase& planner, std::ostream* out) { *out << planner.name; }

class PathPlannerConformance : public testing::TestWithParam<PlannerCase> {
 protected:
  Result<motion::JointPath> plan(const conformance::BallWorld& world, std::uint64_t seed,
                                 const StopCondition& stop = StopCondition::after(20)) const {
    conformance::BallValidity validity(world);
    return planner_->plan(world.problem, validity, seed, stop);
  }
  std::unique_ptr<PathPlanner> planner_ = GetParam().make();
};

TEST_P(PathPlannerConformance, PathsAreValidAndKeepTheirEnds) {
  for (const auto& world : {conformance::door_world(), conformance::arms_world()}) {
    ASSERT_LT(world.clearance(world.problem.start, world.problem.goal), 0) << "too easy";
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const auto path = plan(world, seed);
      ASSERT_TRUE(path) << path.error().message;
      conformance::expect_good(*path, world);
    }
  }
}

TEST_P(PathPlannerConformance, EqualSeedsGiveEqualPathsAndOthersDiffer) {
  for (const auto& world : {conformance::door_world(), conformance::arms_world()}) {
    motion::JointPath before;
    for (std::uint64_t seed : {1ull, 2ull, 3ull, 1ull << 40}) {
      const auto first = plan(world, seed), second = plan(world, seed);
      ASSERT_TRUE(first && second);
      EXPECT_TRUE(conformance::same_bits(*first, *second)) << "seed " << seed;
      EXPECT_FALSE(conformance::same_bits(*first, before)) << "seed " << seed;
      before = *first;
    }
  }
}

TEST_P(PathPlannerConformance, ThreadsDoNotChangePaths) {
  constexpr int kThreads = 4;
  const auto world = conformance::arms_world();
  std::vector<motion::JointPath> alone;
  for (int i = 0; i < kThreads; ++i)
    alone.push_back(plan(world, 10 + static_cast<std::uint64_t>(i)).value());
  for (int round = 0; round < 5; ++round) {
    std::vector<motion::JointPath> together(kThreads);
    conformance::at_once(kThreads, [&](int i) {
      together[static_cast<std::size_t>(i)] =
          plan(world, 10 + static_cast<std::uint64_t>(i)).value();
    });
    for (std::size_t i = 0; i < kThreads; ++i) {
      EXPECT_TRUE(conformance::same_bits(alone[i], together[i])) << "thread " << i;
    }
  }
}

TEST_P(PathPlannerConformance, StopsAtTheDeadline) {
  const auto world = conformance::closed_world();
  double worst = 0;
  for (double seconds : {0.0, 0.02, 0.1, 0.2}) {
    const auto begin = Clock::now();
    const auto path = plan(world, 1, StopCondition::after(seconds));
    worst = std::max(worst, conformance::seconds_since(begin) - seconds);
    ASSERT_FALSE(path);
    EXPECT_EQ(path.error().code, ErrorCode::kTimeout);
  }
  EXPECT_LT(worst, conformance::kStopSlack);
  RecordProperty("worst_overrun_ms", std::to_string(1e3 * worst));
  std::printf("worst overrun %.2f ms\n", 1e3 * worst);
}

TEST_P(PathPlannerConformance, StopsOnRequest) {
  const auto world = conformance::closed_world();
  std::stop_source source;
  Clock::time_point requested;
  const std::jthread asker([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    requested = Clock::now();
    source.request_stop();
  });
  const auto path = plan(world, 1, StopCondition::after(20, source.get_token()));
  EXPECT_LT(conformance::seconds_since(requested), conformance::kStopSlack);
  ASSERT_FALSE(path);
  EXPECT_EQ(path.error().code, ErrorCode::kCancelled);
}

TEST_P(PathPlannerConformance, NamesTheEndThatCannotBeStoodAt) {
  const auto expect_infeasible = [&](const conformance::BallWorld& world, const char* end,
                                     const char* reason) {
    const auto path = plan(world, 1, StopCondition::after(1));
    ASSERT_FALSE(path);
    EXPECT_EQ(path.error().code, ErrorCode::kInfeasible);
    EXPECT_NE(path.error().message.find(end), std::string::npos) << path.error().message;
    EXPECT_NE(path.error().message.find(reason), std::string::npos) << path.error().message;
  };
  auto world = conformance::door_world();
  const auto good = world.problem;
  world.problem.start = world.centres[3];
  expect_infeasible(world, "start", "not valid");
  world.problem = good;
  world.problem.goal = world.centres[3];
  expect_infeasible(world, "goal", "not valid");
  world.problem = good;
  world.problem.start[1] = -2.5;
  expect_infeasible(world, "start", "joint 1");
  world.problem = good;
  world.problem.goal[0] = std::numeric_limits<double>::quiet_NaN();
  expect_infeasible(world, "goal", "joint 0");
  world.problem = good;
  world.problem.goal[0] = std::nextafter(2.0, 3.0);
  expect_infeasible(world, "goal", "joint 0");
}

TEST_P(PathPlannerConformance, StartAtTheGoalAndAtTheLimits) {
  auto world = conformance::door_world();
  world.problem.goal = world.problem.start;
  auto path = plan(world, 1);
  ASSERT_TRUE(path) << path.error().message;
  ASSERT_EQ(path->size(), 2u);
  EXPECT_TRUE(conformance::same_bits(path->front(), world.problem.start));
  EXPECT_TRUE(conformance::same_bits(path->back(), world.problem.goal));

  world = conformance::door_world();
  world.problem.start = conformance::vector2(-2, -2);
  world.problem.goal = conformance::vector2(2, -2);
  path = plan(world, 1);
  ASSERT_TRUE(path) << path.error().message;
  conformance::expect_good(*path, world);
}

TEST_P(PathPlannerConformance, JointsWithoutLimitsOrWithoutRange) {
  auto world = conformance::door_world();
  world.problem.lower[1] = -std::numeric_limits<double>::infinity();
  world.problem.upper[1] = std::numeric_limits<double>::infinity();
  auto path = plan(world, 1);
  ASSERT_TRUE(path) << path.error().message;
  conformance::expect_good(*path, world);

  world = {};
  world.radius = 0.1;
  world.problem = {conformance::vector2(-1, 0.5), conformance::vector2(1, 0.5),
                   conformance::vector2(-2, 0.5), conformance::vector2(2, 0.5)};
  path = plan(world, 1);
  ASSERT_TRUE(path) << path.error().message;
  conformance::expect_good(*path, world);
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PathPlannerConformance);

}  // namespace tandem::planning
