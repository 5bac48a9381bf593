#include "conformance/coordinator_conformance.h"
#include "tandem/coordination/baselines.h"
#include "tandem/coordination/diagram_coordinator.h"
#include "tandem/coordination/joint_search.h"
#include "tandem/coordination/sequential.h"

namespace tandem::coordination {
namespace {

INSTANTIATE_TEST_SUITE_P(
    All, CoordinatorConformance,
    testing::Values(CoordinatorCase{"diagram", [] { return make_diagram_coordinator(); }},
                    CoordinatorCase{"monotone", &make_monotone_coordinator, Finds::kMonotone},
                    CoordinatorCase{"sw_closure", [] { return make_sw_closure_coordinator(); },
                                    Finds::kMonotone},
                    CoordinatorCase{"exclusive", [] { return make_exclusive_coordinator(); },
                                    Finds::kSequential}),
    coordinator_name);

/// The joint search alone, as the fallback of merging.
class JointCoordinator final : public Coordinator {
 public:
  Result<Schedule> coordinate(const CoordinationProblem& problem, std::uint64_t,
                              const StopCondition& stop) const override {
    const auto scratch = problem.exact().make_scratch();
    if (const auto ends = check_problem(problem, *scratch); !ends) {
      return std::unexpected(ends.error());
    }
    return search_jointly(problem, {}, stop);
  }
};

TEST(JointSearch, CoordinatesDiscsOrProvesTheDeadlock) {
  for (const auto& c : test::disc_cases()) {
    SCOPED_TRACE(c.name);
    const auto schedule = JointCoordinator().coordinate(c.problem(), 1, StopCondition::after(20));
    EXPECT_EQ(schedule.has_value(), !c.deadlocks);
    if (!schedule) {
      EXPECT_NE(schedule.error().message.find("deadlock, proven"), std::string::npos);
      continue;
    }
    const auto scratch = c.checker->make_scratch();
    EXPECT_TRUE(certify_schedule(c.problem(), *schedule, *scratch).is_free());
    EXPECT_EQ(schedule->places.back(), durations(c.problem()));
    const auto merged =
        make_diagram_coordinator()->coordinate(c.problem(), 1, StopCondition::after(20));
    ASSERT_TRUE(merged);
    EXPECT_LT(merged->makespan(), 1.15 * schedule->makespan());
    std::printf("%s: joint %.3f s, merged %.3f s\n", c.name.c_str(), schedule->makespan(),
                merged->makespan());
  }
}

/// Nobody is slower than one arm after the other, and who may go back is not slower than who may
/// not.
TEST(Coordinators, AreOrderedByWhatTheyMayDo) {
  const auto makespan = [](const Coordinator& coordinator, const test::CoordinationCase& c) {
    const auto schedule = coordinator.coordinate(c.problem(), 1, StopCondition::after(20));
    return schedule ? schedule->makespan() : std::numeric_limits<double>::infinity();
  };
  int compared = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const auto c = test::swinging_arms(seed);
    if (!c) continue;
    SCOPED_TRACE(c->name);
    const double best = makespan(*make_diagram_coordinator(), *c);
    const double sequential = makespan(*make_sequential_coordinator(), *c);
    const double exclusive = makespan(*make_exclusive_coordinator(), *c);
    const double monotone = makespan(*make_monotone_coordinator(), *c);
    EXPECT_LE(best, sequential + 1e-9);
    EXPECT_LE(monotone, sequential + 1e-9);
    EXPECT_LE(best, 1.12 * monotone);
    EXPECT_LE(best, 1.12 * exclusive);
    ++compared;
  }
  EXPECT_GT(compared, 25);
}

}  // namespace
}  // namespace tandem::coordination
