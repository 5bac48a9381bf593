#include "tandem/planning/ompl/ompl_planning.h"

#include "conformance/planner_conformance.h"

namespace tandem::planning {
namespace {

INSTANTIATE_TEST_SUITE_P(
    Ompl, PathPlannerConformance,
    testing::Values(PlannerCase{"default_range", [] { return make_ompl_rrt_connect(); }},
                    PlannerCase{"short_range", [] { return make_ompl_rrt_connect({0.3}); }}),
    case_name<PlannerCase>);

INSTANTIATE_TEST_SUITE_P(Ompl, PathSimplifierConformance,
                         testing::Values(SimplifierCase{"simplifier", make_ompl_simplifier}),
                         case_name<SimplifierCase>);

}  // namespace
}  // namespace tandem::planning
