#include <gtest/gtest.h>

#include "small_cell.h"
#include "tandem/pipeline/plan.h"

namespace tandem::pipeline {
namespace {

TEST(Resolve, StartDefaultsToTheGoalBefore) {
  const auto cell = test::small_cell();
  const auto cross = resolve(cell, cell->query("cross"));
  const auto back = resolve(cell, cell->query("back"));
  ASSERT_TRUE(cross && back);
  EXPECT_EQ(back->start, cross->goal);
  EXPECT_DOUBLE_EQ(back->goal[1], -1.4);
  EXPECT_DOUBLE_EQ(back->goal[5], -1.4);
}

TEST(Resolve, ArmWithoutGoalStays) {
  auto spec = test::small_cell_spec();
  spec.queries[0].goal.erase("right");
  const auto cell = *world::Workcell::make(spec);
  const auto cross = resolve(cell, cell->query("cross"));
  ASSERT_TRUE(cross);
  EXPECT_EQ(cross->goal.tail(4), cross->start.tail(4));
  EXPECT_NE(cross->goal.head(4), cross->start.head(4));
}

TEST(Resolve, AQueryOfItsOwnNeedsAStart) {
  const auto cell = test::small_cell();
  world::Query own = cell->query("back");
  own.name = "not in the cell";
  const auto resolved = resolve(cell, own);
  ASSERT_FALSE(resolved);
  EXPECT_NE(resolved.error().message.find("'left' has no start"), std::string::npos)
      << resolved.error().message;
}

// The tool pose of a known configuration, as a goal: the solution must reach it, free of
// collisions.
TEST(Resolve, PosesAreReachedWithoutCollision) {
  auto spec = test::small_cell_spec();
  const auto cell = test::small_cell();
  const auto cross = resolve(cell, cell->query("cross"));
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  cell->forward_kinematics(cross->goal, positions, X_WL);
  spec.queries[0].goal["left"] = world::PoseGoal{cell->tool_pose(0, X_WL)};
  const auto with_pose = *world::Workcell::make(spec);
  const auto solved = resolve(with_pose, with_pose->query("cross"));
  ASSERT_TRUE(solved) << solved.error().message;
  ASSERT_TRUE(check_ends(*with_pose, *solved));
  robot::LinkPoses reached;
  with_pose->forward_kinematics(solved->goal, positions, reached);
  EXPECT_LT((with_pose->tool_pose(0, reached).matrix() - cell->tool_pose(0, X_WL).matrix()).norm(),
            1e-5);
}

TEST(Resolve, PoseOutOfReachSaysSo) {
  auto spec = test::small_cell_spec();
  world::PoseGoal far;
  far.X_WE.translation().x() = 5;
  spec.queries[0].goal["left"] = far;
  const auto cell = *world::Workcell::make(spec);
  const auto solved = resolve(cell, cell->query("cross"));
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(solved.error().message.find("goal of query 'cross', arm 'left'"), std::string::npos);
  EXPECT_NE(solved.error().message.find("reach"), std::string::npos) << solved.error().message;
}

// A tool pose whose only configurations put the arm through the table.
TEST(Resolve, BlockedPoseNamesThePair) {
  auto spec = test::small_cell_spec();
  auto free_spec = spec;
  free_spec.obstacles.clear();
  const auto free_cell = *world::Workcell::make(free_spec);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(8), positions;
  q << 0.1, 0.7, 0.2, 0.1, 0, -1.4, 0.5, 0;
  robot::LinkPoses X_WL;
  free_cell->forward_kinematics(q, positions, X_WL);
  spec.queries[0].goal["left"] = world::PoseGoal{free_cell->tool_pose(0, X_WL)};
  const auto cell = *world::Workcell::make(spec);
  const auto solved = resolve(cell, cell->query("cross"));
  ASSERT_FALSE(solved);
  EXPECT_NE(solved.error().message.find("table"), std::string::npos) << solved.error().message;
}

// A pose takes a search, which a caller may end; joint values do not.
TEST(Resolve, StopsWhenToldTo) {
  auto spec = test::small_cell_spec();
  const auto cell = test::small_cell();
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  cell->forward_kinematics(resolve(cell, cell->query("cross"))->goal, positions, X_WL);
  spec.queries[0].goal["left"] = world::PoseGoal{cell->tool_pose(0, X_WL)};
  const auto with_pose = *world::Workcell::make(spec);
  std::stop_source source;
  source.request_stop();
  const StopCondition cancelled = StopCondition::after(60, source.get_token());
  const StopCondition late(Clock::now());
  for (const auto& [stop, code] :
       {std::pair{&cancelled, ErrorCode::kCancelled}, {&late, ErrorCode::kTimeout}}) {
    const auto one = resolve(with_pose, with_pose->query("cross"), 1, *stop);
    ASSERT_FALSE(one);
    EXPECT_EQ(one.error().code, code) << one.error().message;
    const auto all = resolve_all(with_pose, with_pose->queries(), 1, *stop);
    ASSERT_FALSE(all);
    EXPECT_EQ(all.error().code, code) << all.error().message;
    EXPECT_TRUE(resolve(cell, cell->query("cross"), 1, *stop));
  }
  const PlanOptions options{.token = source.get_token()};
  const auto planned = plan(with_pose, with_pose->query("cross"), options);
  ASSERT_FALSE(planned);
  EXPECT_EQ(planned.error().code, ErrorCode::kCancelled);
}

/// A box at the left tool's place after `cross`, carried away by `back`, put down before `again`.
world::WorkcellSpec carrying_spec() {
  auto spec = test::small_cell_spec();
  const auto cell = test::small_cell();
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  cell->forward_kinematics(resolve(cell, cell->query("cross"))->goal, positions, X_WL);
  const Eigen::Isometry3d X_WE = cell->tool_pose(0, X_WL);
  Eigen::Isometry3d X_WO = X_WE;
  X_WO.translation() += X_WE.linear() * Eigen::Vector3d(0.06, 0, 0);
  world::ObstacleSpec part{"part", {*geometry::Shape::box(X_WO, {0.04, 0.04, 0.04})}};
  part.X_WO = X_WO;
  spec.obstacles.push_back(part);
  world::Attach grip;
  grip.object = "part";
  grip.arm = "left";
  spec.queries[1].changes.attach = {grip};
  world::QuerySpec again = spec.queries[0];
  again.name = "again";
  again.start = {};
  Eigen::Isometry3d X_WP = Eigen::Isometry3d::Identity();
  X_WP.translation() = Eigen::Vector3d(0, -0.7, 0.1);
  again.changes.detach = {{"part", X_WP}};
  spec.queries.push_back(again);
  return spec;
}

TEST(Resolve, CarriesTheSceneFromQueryToQuery) {
  const auto cell = *world::Workcell::make(carrying_spec());
  const auto cross = resolve(cell, cell->query("cross"));
  const auto back = resolve(cell, cell->query("back"));
  const auto again = resolve(cell, cell->query("again"));
  ASSERT_TRUE(cross && back && again);
  EXPECT_EQ(cross->cell, cell);
  const auto state = [](const ResolvedQuery& query) { return *query.cell->find_object("part"); };
  EXPECT_EQ(state(*back).link, "left/link4");
  // The tool frame is 0.15 m out on the link, the part 0.06 m further.
  EXPECT_LT((state(*back).X_LO.translation() - Eigen::Vector3d(0.21, 0, 0)).norm(), 1e-12);
  EXPECT_FALSE(state(*again).carried());
  EXPECT_EQ(state(*again).X_LO.translation().y(), -0.7);
  const auto all = resolve_all(cell, cell->queries());
  ASSERT_TRUE(all);
  ASSERT_EQ(all->size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto alone = resolve(cell, cell->queries()[i]);
    EXPECT_EQ((*all)[i].start, alone->start);
    EXPECT_EQ((*all)[i].goal, alone->goal);
    EXPECT_EQ(state((*all)[i]).link, state(*alone).link);
  }
  // From a cell in another scene, a query of the cell still starts from the file.
  const auto elsewhere = resolve(again->cell, cell->query("cross"));
  ASSERT_TRUE(elsewhere);
  EXPECT_TRUE(elsewhere->cell->scene().objects.empty());
}

TEST(Resolve, AStartInBetweenDoesNotForgetWhatIsCarried) {
  auto spec = carrying_spec();
  spec.queries[2].start = spec.queries[0].start;
  spec.queries[2].changes = {};
  const auto cell = *world::Workcell::make(spec);
  const auto again = resolve(cell, cell->query("again"));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_TRUE(again->cell->find_object("part")->carried());
}

TEST(Resolve, GoalPosesAreFreeOfWhatIsCarried) {
  auto spec = carrying_spec();
  const auto bare = test::small_cell();
  Eigen::VectorXd q = resolve(bare, bare->query("cross"))->goal, positions;
  // Out of reach of the wall with an empty hand, into it with the part.
  robot::LinkPoses X_WL;
  q.head(4) << 0.25, -0.12, 0.55, 0;
  bare->forward_kinematics(q, positions, X_WL);
  spec.queries[1].goal = {{"left", world::PoseGoal{bare->tool_pose(0, X_WL)}}};
  Eigen::Isometry3d X_WO = bare->tool_pose(0, X_WL);
  X_WO.translation() += X_WO.linear() * Eigen::Vector3d(0.09, 0, 0);
  spec.obstacles.push_back({"stop", {*geometry::Shape::sphere(X_WO.translation(), 0.04)}});
  const auto carrying = *world::Workcell::make(spec);
  const auto blocked = resolve(carrying, carrying->query("back"));
  ASSERT_FALSE(blocked);
  EXPECT_NE(blocked.error().message.find("part and stop touch"), std::string::npos)
      << blocked.error().message;
  spec.queries[1].changes = {};
  spec.queries[2].changes = {};
  const auto empty = *world::Workcell::make(spec);
  const auto reached = resolve(empty, empty->query("back"));
  EXPECT_TRUE(reached) << reached.error().message;
}

TEST(Resolve, ChangesThatCannotBeMadeNameTheQuery) {
  const auto cell = *world::Workcell::make(carrying_spec());
  world::Query own = cell->query("cross");
  own.name = "own";
  own.changes.detach = {{"part"}};
  const auto resolved = resolve(cell, own);
  ASSERT_FALSE(resolved);
  EXPECT_NE(resolved.error().message.find("query 'own': 'part' cannot be detached"),
            std::string::npos)
      << resolved.error().message;
}

TEST(CheckEnds, SeesWhatIsCarried) {
  const auto cell = *world::Workcell::make(carrying_spec());
  auto ends = *resolve(cell, cell->query("back"));
  ASSERT_TRUE(check_ends(*cell, ends));
  ends.goal.head(4) << -0.8, -0.4, 1.1, 0;  // The tool is above the table, the part is not.
  const auto checked = check_ends(*cell, ends);
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().message.find("table and part"), std::string::npos)
      << checked.error().message;
  ends.cell = nullptr;
  const auto empty = check_ends(*test::small_cell(), ends);
  EXPECT_TRUE(empty) << empty.error().message;
}

TEST(CheckEnds, NamesThePairAndDepth) {
  const auto cell = test::small_cell();
  auto ends = *resolve(cell, cell->query("cross"));
  ASSERT_TRUE(check_ends(*cell, ends));
  ends.goal[1] = 1.0;  // Pitches the left arm through the table.
  const auto checked = check_ends(*cell, ends);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::kInfeasible);
  EXPECT_NE(checked.error().message.find("goal of query 'cross'"), std::string::npos);
  EXPECT_NE(checked.error().message.find("table"), std::string::npos) << checked.error().message;
  EXPECT_NE(checked.error().message.find("deep"), std::string::npos);
}

TEST(CheckEnds, NamesTheJointOutsideItsLimit) {
  const auto cell = test::small_cell();
  auto ends = *resolve(cell, cell->query("cross"));
  ends.start[6] = 3.0;
  const auto checked = check_ends(*cell, ends);
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().message.find("right/joint3"), std::string::npos)
      << checked.error().message;
}

}  // namespace
}  // namespace tandem::pipeline
