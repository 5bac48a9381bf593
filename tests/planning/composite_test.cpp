#include "tandem/planning/composite.h"

#include "conformance/planner_conformance.h"
#include "small_cell.h"
#include "tandem/collision/certificate.h"
#include "tandem/core/contract.h"

namespace tandem::planning {
namespace {

// Where the question does not split it is RRT-Connect.
INSTANTIATE_TEST_SUITE_P(Composite, PathPlannerConformance,
                         testing::Values(PlannerCase{"composite",
                                                     [] { return make_composite_planner(); }}),
                         case_name<PlannerCase>);

class CompositeOnSmallCell : public testing::Test {
 protected:
  std::unique_ptr<Validity> by_arm() const { return make_batch_validity_by_arm(compiled_); }
  bool is_proven(const motion::JointPath& path) const {
    const auto scratch = checker_.make_scratch();
    const auto all = cell_->select(world::PairScope::all());
    for (std::size_t i = 1; i < path.size(); ++i) {
      const motion::StraightEdge edge(path[i - 1], path[i]);
      if (!collision::certify(checker_, edge, all, *scratch).is_free()) return false;
    }
    return true;
  }
  /// Arms stretched towards each other, at any yaw.
  Eigen::VectorXd random(Rng& rng) const {
    Eigen::VectorXd q(cell_->dof());
    for (int arm : {0, 4}) {
      q[arm] = rng.uniform(-1.4, 1.4);
      q[arm + 1] = rng.uniform(-0.6, 0.1);
      q[arm + 2] = rng.uniform(-0.3, 0.6);
      q[arm + 3] = rng.uniform(-2, 2);
    }
    return q;
  }

  std::shared_ptr<const world::Workcell> cell_ = test::small_cell();
  collision::CompiledCell compiled_{cell_};
  const collision::SsvChecker& checker_ = compiled_.exact();
};

TEST_F(CompositeOnSmallCell, PartsOfTheQuestionMakeTheWhole) {
  const auto validity = by_arm();
  ArmQuestions& parts = *validity->by_arm();
  ASSERT_EQ(parts.arms.size(), 2u);
  const auto together = [&](const auto& ask) {
    const bool left = ask(*parts.arms[0].alone), right = ask(*parts.arms[1].alone);
    return left && right && ask(*parts.between);
  };
  Rng rng(1);
  int free = 0, between = 0;
  for (int n = 0; n < 3000; ++n) {
    const Eigen::VectorXd a = random(rng), b = a + 0.2 * (random(rng) - a);
    EXPECT_EQ(validity->state(a), together([&](Validity& part) { return part.state(a); }));
    EXPECT_EQ(validity->edge(a, b), together([&](Validity& part) { return part.edge(a, b); }));
    free += validity->state(a);
    between += !parts.between->state(a);
    // Alone, an arm does not see the others.
    Eigen::VectorXd moved = a;
    moved.tail(4) = b.tail(4);
    EXPECT_EQ(parts.arms[0].alone->state(a), parts.arms[0].alone->state(moved));
  }
  EXPECT_GT(free, 100);
  EXPECT_GT(between, 20);
  EXPECT_GT(validity->stats().edges, 6000);
}

TEST_F(CompositeOnSmallCell, PathsAreProvenAndCoordinated) {
  Rng rng(2);
  int planned = 0, detours = 0;
  for (std::uint64_t n = 0; n < 400 && planned < 40; ++n) {
    const auto validity = by_arm();
    const PathProblem problem{random(rng), random(rng), cell_->lower(), cell_->upper()};
    if (!validity->state(problem.start) || !validity->state(problem.goal)) continue;
    detours += !validity->edge(problem.start, problem.goal);
    const auto path =
        make_composite_planner()->plan(problem, *validity, n, StopCondition::after(20));
    ASSERT_TRUE(path) << path.error().message;
    ++planned;
    EXPECT_EQ(path->front(), problem.start);
    EXPECT_EQ(path->back(), problem.goal);
    EXPECT_TRUE(is_proven(*path)) << "problem " << n;
    const auto again =
        make_composite_planner()->plan(problem, *by_arm(), n, StopCondition::after(20));
    ASSERT_TRUE(again);
    EXPECT_EQ(*again, *path);
  }
  EXPECT_EQ(planned, 40);
  EXPECT_GT(detours, 20);
}

TEST_F(CompositeOnSmallCell, WithoutTriesItSearchesTheWholeSpace) {
  const auto validity = by_arm();
  Eigen::VectorXd start(8), goal(8);
  start << 1.0, -0.2, 0.3, 0, 0.9, -0.3, 0.4, 0;
  goal << -0.8, -0.2, 0.3, 0, -0.9, -0.3, 0.4, 0;
  const PathProblem problem{start, goal, cell_->lower(), cell_->upper()};
  CompositeOptions options;
  options.tries = 0;
  const auto path =
      make_composite_planner(options)->plan(problem, *validity, 1, StopCondition::after(20));
  ASSERT_TRUE(path) << path.error().message;
  EXPECT_TRUE(is_proven(*path));
}

TEST(CompositePlanner, RefusesOptionsOutOfRange) {
  CompositeOptions options;
  options.tries = -1;
  EXPECT_THROW(make_composite_planner(options), ContractViolation);
  options = {};
  options.arm_samples = 0;
  EXPECT_THROW(make_composite_planner(options), ContractViolation);
}

}  // namespace
}  // namespace tandem::planning
