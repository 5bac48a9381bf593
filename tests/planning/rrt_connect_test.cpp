#include "tandem/planning/rrt_connect.h"

#include "conformance/planner_conformance.h"
#include "conformance/simplifier_conformance.h"
#include "tandem/core/contract.h"
#include "tandem/planning/simplifier.h"

namespace tandem::planning {
namespace {

std::unique_ptr<PathPlanner> with(const std::function<void(RrtConnectOptions&)>& change) {
  RrtConnectOptions options;
  change(options);
  return make_rrt_connect(options);
}

INSTANTIATE_TEST_SUITE_P(
    Own, PathPlannerConformance,
    testing::Values(
        PlannerCase{"default", [] { return make_rrt_connect(); }},
        PlannerCase{"short_range", [] { return with([](auto& o) { o.range = 0.2; }); }},
        PlannerCase{"unbalanced", [] { return with([](auto& o) { o.balanced = false; }); }},
        PlannerCase{"uniform", [] { return with([](auto& o) { o.local_fraction = 0; }); }},
        PlannerCase{"near_the_line",
                    [] {
                      return with([](auto& o) {
                        o.local_fraction = 0.9;
                        o.local_radius = 0.3;
                      });
                    }},
        PlannerCase{"dynamic_domain", [] { return with([](auto& o) { o.domain_radius = 4; }); }}),
    case_name<PlannerCase>);

INSTANTIATE_TEST_SUITE_P(Own, PathSimplifierConformance,
                         testing::Values(SimplifierCase{"own", [] { return make_simplifier(); }},
                                         SimplifierCase{"patient",
                                                        [] {
                                                          return make_simplifier(
                                                              {.rounds = 8, .tolerance = 0.001});
                                                        }}),
                         case_name<SimplifierCase>);

TEST(RrtConnect, RefusesOptionsOutOfRange) {
  EXPECT_THROW(with([](auto& o) { o.range = 0; }), ContractViolation);
  EXPECT_THROW(with([](auto& o) { o.local_fraction = 1; }), ContractViolation);
  EXPECT_THROW(with([](auto& o) { o.local_radius = 0; }), ContractViolation);
  EXPECT_THROW(with([](auto& o) { o.domain_radius = 0; }), ContractViolation);
  EXPECT_THROW(make_simplifier({.rounds = 0}), ContractViolation);
}

}  // namespace
}  // namespace tandem::planning
