// Objects that are attached, carried, let go and moved.

#include "tandem/world/scene.h"

#include "small_cells.h"
#include "tandem/core/rng.h"

namespace tandem::world {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

Isometry3d at(double x, double y, double z) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = Vector3d(x, y, z);
  return X;
}

Isometry3d random_pose(Rng& rng) {
  const auto number = [&] { return rng.uniform(-1, 1); };
  Isometry3d X = at(number(), number(), number());
  X.linear() = Eigen::Quaterniond(number(), number(), number(), number() + 2)
                   .normalized()
                   .toRotationMatrix();
  return X;
}

/// Two arms with tools, a table, a part that stands free and a camera on the left hand.
WorkcellSpec cell_with_part() {
  WorkcellSpec spec = test::two_arms();
  spec.padding = 0.002;
  for (ArmSpec& arm : spec.arms) arm.X_LE = at(0.1, 0, 0.05);
  ObstacleSpec part{"part", {test::ball(0.03), test::ball(0.02).in(at(0, 0, 0.1))}};
  part.X_WO = at(1, 2, 3);
  for (geometry::Shape& shape : part.shapes_W) shape = shape.in(part.X_WO);
  spec.obstacles.push_back(part);
  AttachedSpec camera;
  camera.name = "camera";
  camera.link = "left/a3";
  camera.X_LO = at(0, 0, 0.2);
  camera.shapes_L = {test::ball(0.01).in(camera.X_LO)};
  camera.touching = {"right/a3"};
  spec.attached.push_back(camera);
  return spec;
}

Attach by_arm(const std::string& object, const std::string& arm) {
  Attach change;
  change.object = object;
  change.arm = arm;
  return change;
}

const Body& body(const Workcell& cell, const std::string& name) {
  return cell.bodies()[static_cast<std::size_t>(cell.find_body(name))];
}

/// The second ball's place in the world: with the first, it fixes the part's frame.
std::vector<Vector3d> balls_in_world(const Workcell& cell, const VectorXd& q,
                                     const std::string& name) {
  VectorXd positions;
  robot::LinkPoses X_WL;
  cell.forward_kinematics(q, positions, X_WL);
  std::vector<Vector3d> centers;
  const Body& b = body(cell, name);
  for (const geometry::Shape& shape : b.shapes_L) {
    centers.push_back(X_WL[static_cast<std::size_t>(b.link)] * shape.origin());
  }
  return centers;
}

class Scene : public ::testing::Test {
 protected:
  std::shared_ptr<const Workcell> after(const std::shared_ptr<const Workcell>& cell,
                                        const SceneChanges& changes, const VectorXd& q) {
    const auto changed = after_changes(cell, changes, q);
    EXPECT_TRUE(changed) << (changed ? "" : changed.error().message);
    return changed ? *changed : cell;
  }
  VectorXd random_q() {
    return VectorXd::NullaryExpr(6, [&] { return rng_.uniform(-2, 2); });
  }

  Rng rng_{7};
  std::shared_ptr<const Workcell> cell_ = test::make_cell(cell_with_part());
  VectorXd home_ = VectorXd::Zero(6);
};

TEST_F(Scene, WhatIsAttachedStaysWhereItIsAndThenMovesWithTheLink) {
  for (int k = 0; k < 50; ++k) {
    const VectorXd q = random_q();
    const auto carrying = after(cell_, {.attach = {by_arm("part", "left")}}, q);
    const auto before = balls_in_world(*cell_, q, "part");
    const auto now = balls_in_world(*carrying, q, "part");
    ASSERT_EQ(now.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((now[i] - before[i]).norm(), 1e-12);
    // Elsewhere it has moved as the hand has.
    const VectorXd there = random_q();
    VectorXd positions;
    robot::LinkPoses X_WL, X_WL_there;
    cell_->forward_kinematics(q, positions, X_WL);
    cell_->forward_kinematics(there, positions, X_WL_there);
    const auto moved = balls_in_world(*carrying, there, "part");
    for (std::size_t i = 0; i < 2; ++i) {
      const Vector3d expected =
          cell_->tool_pose(0, X_WL_there) * cell_->tool_pose(0, X_WL).inverse() * before[i];
      EXPECT_LT((moved[i] - expected).norm(), 1e-12);
    }
  }
}

TEST_F(Scene, CarriedBodiesArePaddedCheckedAndAllowedLikeAttachedOnes) {
  const auto carrying = after(cell_, {.attach = {by_arm("part", "left")}}, home_);
  const Body& part = body(*carrying, "part");
  EXPECT_EQ(part.kind, Body::Kind::kAttached);
  EXPECT_EQ(part.moved_by, 1u);
  EXPECT_EQ(part.padding, 0.002);
  EXPECT_EQ(body(*cell_, "part").kind, Body::Kind::kObstacle);
  EXPECT_EQ(body(*cell_, "part").padding, 0);
  EXPECT_EQ(carrying->find_body("part"), cell_->find_body("part"));
  EXPECT_EQ(test::pair_state(*cell_, "part", "table"), "no arm moves them");
  EXPECT_EQ(test::pair_state(*carrying, "part", "table"), "checked");
  EXPECT_EQ(test::pair_state(*carrying, "part", "right/a3"), "checked");
  EXPECT_EQ(test::pair_state(*carrying, "part", "left/a2"), "checked");
  EXPECT_EQ(test::pair_state(*carrying, "part", "left/a3"), "on the same link");
  EXPECT_EQ(test::pair_state(*carrying, "part", "camera"), "on the same link");
  EXPECT_EQ(test::pair_state(*carrying, "camera", "right/a3"), "attached, may touch");
  EXPECT_EQ(carrying->pairs().size() + carrying->skipped_pairs().size(),
            cell_->pairs().size() + cell_->skipped_pairs().size());
}

TEST_F(Scene, TouchingLastsAsLongAsItIsCarriedAllowedForOneMotion) {
  Attach grip = by_arm("part", "left");
  grip.touching = {"left/a2"};
  const SceneChanges pick{.attach = {grip}, .allowed = {{"table", "part", "it stands on it"}}};
  const auto lifting = after(cell_, pick, home_);
  EXPECT_EQ(test::pair_state(*lifting, "part", "left/a2"), "attached, may touch");
  EXPECT_EQ(test::pair_state(*lifting, "part", "table"), "allowed: it stands on it");
  const auto carrying = after(lifting, {}, random_q());
  EXPECT_EQ(test::pair_state(*carrying, "part", "left/a2"), "attached, may touch");
  EXPECT_EQ(test::pair_state(*carrying, "part", "table"), "checked");
  EXPECT_EQ(after(carrying, {}, random_q()), carrying) << "nothing changes, nothing is made";
  const auto released = after(carrying, {.detach = {{"part"}}}, home_);
  EXPECT_EQ(test::pair_state(*released, "part", "left/a2"), "checked");
  EXPECT_EQ(test::pair_state(*released, "part", "left/a3"), "checked");
}

TEST_F(Scene, WhatIsLetGoStandsWhereItIsOrWhereItIsPut) {
  for (int k = 0; k < 50; ++k) {
    const VectorXd q = random_q(), there = random_q();
    const auto carrying = after(cell_, {.attach = {by_arm("part", "right")}}, q);
    const auto dropped = after(carrying, {.detach = {{"part"}}}, there);
    const auto carried = balls_in_world(*carrying, there, "part");
    const auto standing = balls_in_world(*dropped, random_q(), "part");
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((standing[i] - carried[i]).norm(), 1e-12);
    EXPECT_EQ(body(*dropped, "part").kind, Body::Kind::kObstacle);
    EXPECT_EQ(body(*dropped, "part").padding, 0);
    EXPECT_EQ(body(*dropped, "part").moved_by, 0u);

    const Isometry3d X_WO = random_pose(rng_);
    const auto placed = after(carrying, {.detach = {{"part", X_WO}}}, there);
    const auto put = balls_in_world(*placed, home_, "part");
    EXPECT_LT((put[0] - X_WO.translation()).norm(), 1e-12);
    EXPECT_LT((put[1] - X_WO * Vector3d(0, 0, 0.1)).norm(), 1e-12);
  }
}

TEST_F(Scene, AnExplicitPoseIsInTheToolFrameOrTheLink) {
  const Isometry3d X = random_pose(rng_);
  Attach grip = by_arm("part", "left");
  grip.pose = X;
  const auto in_tool = after(cell_, {.attach = {grip}}, random_q());
  grip.arm = "";
  grip.link = "left/a2";
  const auto in_link = after(cell_, {.attach = {grip}}, random_q());
  const Isometry3d X_LE = at(0.1, 0, 0.05);
  EXPECT_LT((body(*in_tool, "part").shapes_L[0].origin() - (X_LE * X).translation()).norm(), 1e-12);
  EXPECT_LT((body(*in_link, "part").shapes_L[0].origin() - X.translation()).norm(), 1e-12);
  EXPECT_EQ(body(*in_link, "part").link, cell_->model().find_link("left/a2"));
}

TEST_F(Scene, IsHandedOverInOneStep) {
  const VectorXd q = random_q();
  const auto left = after(cell_, {.attach = {by_arm("part", "left")}}, q);
  const auto right = after(left, {.detach = {{"part"}}, .attach = {by_arm("part", "right")}}, q);
  EXPECT_EQ(body(*right, "part").moved_by, 2u);
  const auto before = balls_in_world(*cell_, q, "part"), now = balls_in_world(*right, q, "part");
  EXPECT_LT((now[1] - before[1]).norm(), 1e-12);
}

TEST_F(Scene, WhatTheFileAttachesCanBeLetGoAndTakenAgain) {
  const VectorXd q = random_q();
  const auto dropped = after(cell_, {.detach = {{"camera"}}}, q);
  EXPECT_EQ(body(*dropped, "camera").kind, Body::Kind::kObstacle);
  EXPECT_EQ(test::pair_state(*dropped, "camera", "right/a3"), "checked");
  EXPECT_LT((balls_in_world(*dropped, home_, "camera")[0] - balls_in_world(*cell_, q, "camera")[0])
                .norm(),
            1e-12);
  const auto again = after(dropped, {.attach = {by_arm("camera", "right")}}, q);
  EXPECT_EQ(body(*again, "camera").moved_by, 2u);
}

TEST_F(Scene, TheSameStateGivesTheSameCellWhateverCameBefore) {
  const VectorXd q = random_q();
  auto cell = after(cell_, {.attach = {by_arm("part", "left")}}, q);
  cell = after(cell, {.detach = {{"part"}, {"camera"}}}, random_q());
  cell = after(cell, {.attach = {by_arm("part", "right")}}, random_q());
  const auto direct = cell_->in_scene(cell->scene());
  const auto back = cell->in_scene({});
  ASSERT_TRUE(direct && back);
  const auto expect_same = [](const Workcell& a, const Workcell& b) {
    ASSERT_EQ(a.bodies().size(), b.bodies().size());
    for (std::size_t i = 0; i < a.bodies().size(); ++i) {
      EXPECT_EQ(a.bodies()[i].link, b.bodies()[i].link);
      for (std::size_t k = 0; k < a.bodies()[i].shapes_L.size(); ++k) {
        EXPECT_EQ(a.bodies()[i].shapes_L[k].origin(), b.bodies()[i].shapes_L[k].origin());
      }
    }
    ASSERT_EQ(a.pairs().size(), b.pairs().size());
    for (std::size_t i = 0; i < a.pairs().size(); ++i) {
      EXPECT_EQ(a.pairs()[i].a, b.pairs()[i].a);
      EXPECT_EQ(a.pairs()[i].b, b.pairs()[i].b);
      EXPECT_EQ(a.pairs()[i].moved_by, b.pairs()[i].moved_by);
    }
  };
  expect_same(**direct, *cell);
  expect_same(**back, *cell_);
}

TEST_F(Scene, AFileAllowsObstaclesWhatMattersOnceTheyAreCarried) {
  WorkcellSpec spec = cell_with_part();
  spec.allowed = {{"part", "table", "felt"}};
  const auto cell = test::make_cell(spec);
  EXPECT_EQ(test::pair_state(*cell, "part", "table"), "no arm moves them");
  const auto carrying = after(cell, {.attach = {by_arm("part", "left")}}, home_);
  EXPECT_EQ(test::pair_state(*carrying, "part", "table"), "allowed: felt");
}

struct Fault {
  SceneChanges changes;
  ErrorCode code;
  std::string says;
};

TEST_F(Scene, ChangesThatCannotBeMadeSayWhy) {
  Attach to_base = by_arm("part", ""), both = by_arm("part", "left"), no_link = to_base,
         touching = by_arm("part", "left"), skewed = by_arm("part", "left");
  to_base.link = "left/base";
  both.link = "left/a3";
  no_link.link = "left/a33";
  touching.touching = {"tabel"};
  skewed.pose = Isometry3d::Identity();
  skewed.pose->linear() *= 2;
  const auto bad = ErrorCode::kInvalidInput, absent = ErrorCode::kNotFound;
  const Fault faults[] = {
      {{.attach = {by_arm("prat", "left")}}, absent, "no object 'prat'; did you mean 'part'?"},
      {{.attach = {by_arm("left/a1", "left")}}, absent, "no object 'left/a1'"},
      {{.attach = {by_arm("part", "lefd")}}, absent, "arm 'lefd', which does not exist; did you"},
      {{.attach = {no_link}}, absent, "did you mean 'left/a3'"},
      {{.attach = {to_base}}, bad, "'left/base', which no arm moves"},
      {{.attach = {both}}, bad, "name one of them"},
      {{.attach = {by_arm("part", "")}}, bad, "name one of them"},
      {{.attach = {by_arm("part", "left"), by_arm("part", "right")}},
       bad,
       "link 'left/a3' carries it; detach it first"},
      {{.attach = {by_arm("camera", "right")}}, bad, "link 'left/a3' carries it"},
      {{.attach = {touching}}, absent, "did you mean 'table'"},
      {{.attach = {skewed}}, bad, "not a rigid pose"},
      {{.detach = {{"prat"}}}, absent, "did you mean 'part'"},
      {{.detach = {{"part"}}}, bad, "'part' cannot be detached: nothing carries it"},
      {{.detach = {{"camera"}, {"camera"}}}, bad, "nothing carries it"},
      {{.detach = {{"camera", *skewed.pose}}}, bad, "not a rigid pose"},
      {{.allowed = {{"part", "tabel", "?"}}}, absent, "did you mean 'table'"},
      {{.allowed = {{"part", "part", "?"}}}, bad, "touch itself"},
  };
  for (const Fault& fault : faults) {
    const auto changed = after_changes(cell_, fault.changes, home_);
    ASSERT_FALSE(changed) << fault.says;
    EXPECT_EQ(changed.error().code, fault.code) << changed.error().message;
    EXPECT_NE(changed.error().message.find(fault.says), std::string::npos)
        << "no '" << fault.says << "' in: " << changed.error().message;
  }
}

QuerySpec motion(const std::string& name, bool first, SceneChanges changes = {}) {
  QuerySpec query;
  query.name = name;
  if (first) query.start = {{"left", StateGoal{"ready"}}, {"right", StateGoal{"ready"}}};
  query.goal = {{"left", StateGoal{"ready"}}};
  query.changes = std::move(changes);
  return query;
}

TEST_F(Scene, ListsAreCheckedWhenTheCellIsMade) {
  WorkcellSpec spec = cell_with_part();
  Attach grip = by_arm("part", "left");
  grip.where = "cell.yaml:7:3";
  spec.queries = {motion("a", true), motion("b", false, {.attach = {grip}})};
  spec.lists = {{"one", {motion("a", true, {.attach = {grip}}), motion("b", false)}},
                {"two", {motion("a", true), motion("b", false, {.detach = {{"camera"}}})}}};
  const auto cell = test::make_cell(spec);
  ASSERT_EQ(cell->lists().size(), 2u);
  EXPECT_EQ(cell->query("two/b").changes.detach[0].object, "camera");
  EXPECT_EQ(cell->list_of("two/b"), &cell->lists()[1].queries);
  EXPECT_EQ(cell->list_of("b"), &cell->queries());
  EXPECT_EQ(cell->list_of("c"), nullptr);
  EXPECT_EQ(*cell->find_list(""), &cell->queries());
  EXPECT_EQ((*cell->find_list("one"))->front().name, "one/a");
  EXPECT_NE(cell->find_list("tow").error().message.find("did you mean 'two'"), std::string::npos);
  EXPECT_NE(cell->find_query("one/c").error().message.find("did you mean"), std::string::npos);
  EXPECT_NE(cell->find_query("two").error().message.find("a list of this name; name one of its "
                                                         "queries, such as 'two/a'"),
            std::string::npos);

  spec.lists[0].queries[1].changes.attach = {grip};
  const auto twice = Workcell::make(spec);
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().message,
            "cell.yaml:7:3: 'part' cannot be attached: link 'left/a3' carries it; detach it first "
            "(before query 'one/b')");
}

TEST_F(Scene, ListsAreNamedApart) {
  const auto refused = [](const WorkcellSpec& spec, const std::string& says) {
    const auto cell = Workcell::make(spec);
    ASSERT_FALSE(cell);
    EXPECT_NE(cell.error().message.find(says), std::string::npos) << cell.error().message;
  };
  WorkcellSpec spec = cell_with_part();
  spec.lists = {{"one", {motion("a", true)}}, {"one", {motion("a", true)}}};
  refused(spec, "list 'one' exists twice");
  spec.lists = {{"one", {motion("a", true), motion("a", false)}}};
  refused(spec, "query 'a' exists twice");
  spec.lists = {{"one/two", {motion("a", true)}}};
  refused(spec, "must not contain '/'");
  spec.lists = {{"one", {motion("a", false)}}};
  refused(spec, "query 'one/a' has no start for arm 'left'");
  spec.lists = {{"one", {motion("a", true)}}};
  spec.queries = {motion("one/a", true)};
  refused(spec, "query 'one/a' exists twice");
}

}  // namespace
}  // namespace tandem::world
