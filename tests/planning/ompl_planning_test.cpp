#include "tandem/planning/ompl/ompl_planning.h"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/util/Console.h>

#include "conformance/planner_conformance.h"
#include "conformance/simplifier_conformance.h"

namespace tandem::planning {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

INSTANTIATE_TEST_SUITE_P(
    Ompl, PathPlannerConformance,
    testing::Values(PlannerCase{"default_range", [] { return make_ompl_rrt_connect(); }},
                    PlannerCase{"short_range", [] { return make_ompl_rrt_connect({0.3}); }}),
    case_name<PlannerCase>);

INSTANTIATE_TEST_SUITE_P(Ompl, PathSimplifierConformance,
                         testing::Values(SimplifierCase{"simplifier", make_ompl_simplifier}),
                         case_name<SimplifierCase>);

/// OMPL's simplifier as anybody would use it, but for the seed.
class PlainSimplifier final : public og::PathSimplifier {
 public:
  PlainSimplifier(const ob::SpaceInformationPtr& si, std::uint64_t seed) : PathSimplifier(si) {
    Rng rng(seed);
    rng_.setLocalSeed(static_cast<std::uint32_t>(rng.split()));
  }
};

class PlainEdges final : public ob::MotionValidator {
 public:
  PlainEdges(const ob::SpaceInformationPtr& si, Validity& validity)
      : MotionValidator(si), validity_(validity) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return validity_.edge(read(a), read(b));
  }
  bool checkMotion(const ob::State*, const ob::State*,
                   std::pair<ob::State*, double>&) const override {
    throw std::logic_error("not asked for by the simplifier");
  }
  Eigen::VectorXd read(const ob::State* s) const {
    return Eigen::Map<const Eigen::VectorXd>(s->as<ob::RealVectorStateSpace::StateType>()->values,
                                             si_->getStateSpace()->getDimension());
  }

 private:
  Validity& validity_;
};

motion::JointPath plain_simplify(const conformance::BallWorld& world, const motion::JointPath& path,
                                 std::uint64_t seed, Validity& validity) {
  const auto n = static_cast<unsigned>(world.problem.start.size());
  const auto space = std::make_shared<ob::RealVectorStateSpace>(n);
  ob::RealVectorBounds bounds(n);
  bounds.low.assign(world.problem.lower.begin(), world.problem.lower.end());
  bounds.high.assign(world.problem.upper.begin(), world.problem.upper.end());
  space->setBounds(bounds);
  const auto si = std::make_shared<ob::SpaceInformation>(space);
  const auto edges = std::make_shared<PlainEdges>(si, validity);
  si->setStateValidityChecker([&](const ob::State* s) { return validity.state(edges->read(s)); });
  si->setMotionValidator(edges);
  si->setup();
  og::PathGeometric working(si);
  for (const Eigen::VectorXd& q : path) {
    ob::ScopedState<> state(space);
    std::ranges::copy(q, state->as<ob::RealVectorStateSpace::StateType>()->values);
    working.append(state.get());
  }
  PlainSimplifier(si, seed).simplifyMax(working);
  motion::JointPath result;
  for (const ob::State* s : working.getStates()) result.push_back(edges->read(s));
  return result;
}

TEST(OmplSimplifier, GivesWhatOmplGives) {
  const auto world = conformance::arms_world();
  long asked = 0, plainly = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    conformance::BallValidity first(world), second(world), third(world);
    const auto path = make_ompl_rrt_connect({0.4})
                          ->plan(world.problem, first, seed, StopCondition::after(20))
                          .value();
    const auto ours = make_ompl_simplifier()->simplify(world.problem, path, second, seed, {});
    const auto plain = plain_simplify(world, path, seed, third);
    EXPECT_TRUE(conformance::same_bits(ours, plain)) << "seed " << seed;
    asked += second.stats().edges;
    plainly += third.stats().edges;
  }
  // Answers are remembered, so that keeping paths between steps costs nothing.
  EXPECT_LE(asked, plainly);
  std::printf("%ld edges asked, plainly %ld\n", asked, plainly);
}

TEST(OmplSimplifier, StopInAnyStepLeavesAValidPath) {
  // Stops at the n-th question instead of at a time, for every n.
  struct Counted final : conformance::BallValidity {
    Counted(const conformance::BallWorld& world, long n) : BallValidity(world), left(n) {}
    bool edge(const Eigen::VectorXd& a, const Eigen::VectorXd& b) override {
      if (--left == 0) source.request_stop();
      return BallValidity::edge(a, b);
    }
    long left;
    std::stop_source source;
  };
  const auto world = conformance::arms_world();
  conformance::BallValidity free(world);
  const auto path =
      make_ompl_rrt_connect({0.4})->plan(world.problem, free, 2, StopCondition::after(20)).value();
  double before = motion::joint_length(path) * (1 + 1e-12);
  bool ended = false;
  for (long n = 1; !ended; n += 7) {
    Counted validity(world, n);
    const auto stop = StopCondition::after(1e9, validity.source.get_token());
    const auto result = make_ompl_simplifier()->simplify(world.problem, path, validity, 1, stop);
    conformance::expect_good(result, world);
    const double length = motion::joint_length(result);
    EXPECT_LE(length, before * (1 + 1e-9)) << "longer for stopping later, n = " << n;
    before = length;
    ended = validity.left > 0;
  }
  EXPECT_LT(before, 0.9 * motion::joint_length(path));
}

TEST(OmplPlanner, IsSilentAndLeavesTheLogLevelToOthers) {
  const auto world = conformance::door_world();
  conformance::BallValidity first(world);
  const auto plan = [&] {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    EXPECT_TRUE(make_ompl_rrt_connect()->plan(world.problem, first, 1, StopCondition::after(20)));
    return testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
  };
  EXPECT_EQ(plan(), "");
  ompl::msg::setLogLevel(ompl::msg::LOG_DEBUG);
  EXPECT_NE(plan(), "");
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
}

TEST(OmplPlanner, DoesNotDependOnOmplsGlobalGenerator) {
  const auto world = conformance::door_world();
  const auto plan = [&] {
    conformance::BallValidity validity(world);
    return make_ompl_rrt_connect()->plan(world.problem, validity, 1, StopCondition::after(20));
  };
  const auto before = plan();
  ompl::RNG drawn, also_drawn;
  const auto after = plan();
  EXPECT_TRUE(conformance::same_bits(before.value(), after.value()));
}

}  // namespace
}  // namespace tandem::planning
