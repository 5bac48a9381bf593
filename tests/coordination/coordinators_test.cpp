#include "conformance/coordinator_conformance.h"
#include "tandem/coordination/sequential.h"

namespace tandem::coordination {
namespace {

INSTANTIATE_TEST_SUITE_P(All, CoordinatorConformance,
                         testing::Values(CoordinatorCase{"sequential", &make_sequential_coordinator,
                                                         Finds::kSequential}),
                         coordinator_name);

TEST(SequentialCoordinator, TakesTheSumOfTheDurations) {
  for (const auto& c : {test::crossing(), test::three_cross(), test::four_cross()}) {
    const auto schedule =
        make_sequential_coordinator()->coordinate(c.problem(), 1, StopCondition::after(10));
    ASSERT_TRUE(schedule) << schedule.error().message;
    EXPECT_NEAR(schedule->makespan(), durations(c.problem()).sum(), 1e-12);
    EXPECT_EQ(schedule->places.size(), c.arms.size() + 1);
  }
}

TEST(SequentialCoordinator, TakesTheOrderThatIsFree) {
  // Only if "b" leaves first can "a" pass; then "c", whose place is where "b" began.
  auto c = test::disc_case("order", {{{-1, 0}, {1, 0}}, {{0, 0}, {0, 1}}, {{0.5, -1}, {0, -0.05}}});
  const auto schedule =
      make_sequential_coordinator()->coordinate(c.problem(), 1, StopCondition::after(10));
  ASSERT_TRUE(schedule) << schedule.error().message;
  EXPECT_EQ(schedule->places[1], Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(schedule->places[2], Eigen::Vector3d(1, 1, 0));
}

TEST(SequentialCoordinator, NamesWhatBlocksTheFirstOrder) {
  const auto schedule = make_sequential_coordinator()->coordinate(test::head_on().problem(), 1,
                                                                  StopCondition::after(10));
  ASSERT_FALSE(schedule);
  EXPECT_NE(schedule.error().message.find("a/disc and b/disc with a at"), std::string::npos)
      << schedule.error().message;
}

}  // namespace
}  // namespace tandem::coordination
