#include "tandem/robot/inverse_kinematics.h"

#include <numbers>

#include "robots.h"
#include "tandem/core/contract.h"

namespace tandem::robot {
namespace {

using test::expect_error;
using test::named_joint;
using test::named_link;

/// An arm of the test data: its model and the problem without goal, seeded at zero.
struct Arm {
  Arm(const std::string& urdf, const std::string& srdf, const std::string& name)
      : model(test::load(urdf)) {
    const Semantics semantics = test::load_semantics(srdf, model);
    const Group* group = semantics.find_group(name);
    if (!group) throw std::runtime_error("no group " + name);
    problem.model = &model;
    problem.link = group->tip_link;
    for (const int joint : group->joints) {
      problem.columns.push_back(test::position_of(model, joint));
    }
    problem.positions = Eigen::VectorXd::Zero(model.position_count());
  }
  Arm(const Arm&) = delete;
  Arm& operator=(const Arm&) = delete;

  /// Pose of the tool at `positions`.
  Eigen::Isometry3d tool(const Eigen::VectorXd& positions) const {
    LinkPoses X_WL;
    forward_kinematics(model, positions, X_WL);
    return X_WL[static_cast<std::size_t>(problem.link)] * problem.X_LE;
  }

  Model model;
  IkProblem problem;
};

std::unique_ptr<Arm> panda() {
  return std::make_unique<Arm>("dual_panda/dual_panda.urdf", "dual_panda/panda.srdf",
                               "left_panda_arm");
}

/// Inside the limits, other entries untouched, and at the goal by forward kinematics.
void expect_solution(const Arm& arm, const Eigen::VectorXd& q, const IkOptions& options = {}) {
  ASSERT_EQ(q.size(), arm.model.position_count());
  const IkProblem& problem = arm.problem;
  for (int i = 0; i < q.size(); ++i) {
    if (std::ranges::find(problem.columns, i) == problem.columns.end()) {
      EXPECT_EQ(q[i], problem.positions[i]);
      continue;
    }
    const int joint = arm.model.joint_of_position(i);
    const JointLimits& limits = arm.model.joints()[static_cast<std::size_t>(joint)].limits;
    EXPECT_GE(q[i], limits.lower);
    EXPECT_LE(q[i], limits.upper);
  }
  const Eigen::Isometry3d X_WE = arm.tool(q);
  EXPECT_LE((X_WE.translation() - problem.X_WE.translation()).norm(),
            options.position_tolerance * 1.001);
  const Eigen::Quaterniond actual(X_WE.linear()), wanted(problem.X_WE.linear());
  EXPECT_LE(actual.angularDistance(wanted), options.orientation_tolerance * 1.001 + 3e-8);
}

TEST(InverseKinematics, SolvesReachablePosesOfKnownArms) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  struct Case {
    const char *urdf, *srdf, *group;
  };
  for (const Case& c :
       {Case{"dual_panda/dual_panda.urdf", "dual_panda/panda.srdf", "left_panda_arm"},
        {"dual_panda/dual_panda.urdf", "dual_panda/panda.srdf", "right_panda_arm"},
        {"fr3_duo/fr3_duo.urdf", "fr3_duo/fr3_duo.srdf", "left_arm"},
        {"dual_ur5e/dual_ur5e.urdf", "dual_ur5e/dual_ur5e.srdf", "right_arm"},
        {"baxter_mbm/baxter.urdf", "baxter_mbm/baxter.srdf", "left_arm"}}) {
    SCOPED_TRACE(std::string(c.urdf) + " " + c.group);
    Arm arm(c.urdf, c.srdf, c.group);
    Rng rng(1);
    constexpr int kPoses = 500;
    int solved = 0;
    for (int i = 0; i < kPoses; ++i) {
      arm.problem.X_LE = i % 2 ? test::random_pose(rng) : Eigen::Isometry3d::Identity();
      arm.problem.X_LE.translation() *= 0.2;
      Eigen::VectorXd goal = test::random_positions(arm.model, rng);
      arm.problem.positions = test::random_positions(arm.model, rng);
      for (int k = 0; k < goal.size(); ++k) {
        const auto& columns = arm.problem.columns;
        if (std::ranges::find(columns, k) == columns.end()) goal[k] = arm.problem.positions[k];
      }
      arm.problem.X_WE = arm.tool(goal);
      const auto q = solve_ik(arm.problem, {.seed = rng.split()});
      if (!q) continue;
      ++solved;
      expect_solution(arm, *q);
    }
    EXPECT_GE(solved, kPoses * 99 / 100);
    std::printf("%s: %d of %d poses solved\n", c.group, solved, kPoses);
  }
}

TEST(InverseKinematics, NeedsOneDescentFromNearbyEvenAtLimits) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  const auto arm = panda();
  Rng rng(12);
  int solved = 0;
  for (int i = 0; i < 500; ++i) {
    Eigen::VectorXd goal = test::random_positions(arm->model, rng);
    arm->problem.positions = goal;
    for (const int k : arm->problem.columns) {
      const int joint = arm->model.joint_of_position(k);
      const JointLimits& limits = arm->model.joints()[static_cast<std::size_t>(joint)].limits;
      if (rng.index(3) == 0) goal[k] = rng.index(2) ? limits.lower : limits.upper;
      arm->problem.positions[k] =
          std::clamp(goal[k] + rng.uniform(-0.5, 0.5), limits.lower, limits.upper);
    }
    arm->problem.X_WE = arm->tool(goal);
    const auto q = solve_ik(arm->problem, {.restarts = 0});
    if (!q) continue;
    ++solved;
    expect_solution(*arm, *q);
  }
  EXPECT_GE(solved, 490);
}

TEST(InverseKinematics, StaysAtASeedThatSolvesAndNearOneThatAlmostDoes) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  const auto arm = panda();
  Rng rng(2);
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd goal = test::random_positions(arm->model, rng);
    arm->problem.positions = goal;
    arm->problem.X_WE = arm->tool(goal);
    const auto same = solve_ik(arm->problem);
    ASSERT_TRUE(same) << same.error().message;
    EXPECT_EQ(*same, goal);
    for (const int k : arm->problem.columns) arm->problem.positions[k] += rng.uniform(-0.01, 0.01);
    const auto near = solve_ik(arm->problem);
    ASSERT_TRUE(near) << near.error().message;
    EXPECT_LT((*near - goal).cwiseAbs().maxCoeff(), 0.6);
  }
}

TEST(InverseKinematics, TurnsNoFurtherThanNeeded) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  // Joints of the UR5e turn twice, except for the elbow.
  Arm arm("dual_ur5e/dual_ur5e.urdf", "dual_ur5e/dual_ur5e.srdf", "left_arm");
  Rng rng(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::VectorXd goal = test::random_positions(arm.model, rng);
    for (const int k : arm.problem.columns) arm.problem.positions[k] = rng.uniform(-2, 2);
    for (int k = 0; k < goal.size(); ++k) {
      const auto& columns = arm.problem.columns;
      if (std::ranges::find(columns, k) == columns.end()) arm.problem.positions[k] = goal[k];
    }
    arm.problem.X_WE = arm.tool(goal);
    const auto q = solve_ik(arm.problem);
    ASSERT_TRUE(q) << q.error().message;
    expect_solution(arm, *q);
    EXPECT_LT((*q - arm.problem.positions).cwiseAbs().maxCoeff(), std::numbers::pi + 1e-9);
  }
}

TEST(InverseKinematics, GivesEqualAnswersForEqualSeeds) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  const auto arm = panda();
  Rng rng(4);
  int different = 0;
  for (int i = 0; i < 50; ++i) {
    arm->problem.X_WE = arm->tool(test::random_positions(arm->model, rng));
    arm->problem.positions = test::random_positions(arm->model, rng);
    const auto a = solve_ik(arm->problem, {.seed = 7}), b = solve_ik(arm->problem, {.seed = 7});
    const auto c = solve_ik(arm->problem, {.seed = 8});
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a || !c) continue;
    EXPECT_EQ(*a, *b);
    different += *a != *c;
  }
  EXPECT_GT(different, 0);
}

TEST(InverseKinematics, SaysThatAGoalIsOutOfReach) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  const auto arm = panda();
  arm->problem.X_WE = Eigen::Isometry3d::Identity();
  arm->problem.X_WE.translation() = Eigen::Vector3d(3, 0, 0.5);
  expect_error(
      solve_ik(arm->problem), ErrorCode::kInfeasible,
      {"'left_panda_link8'", "out of reach", "from joint 'left_panda_joint1'", "m at most"});
  // Just inside the bound, but the links would have to be straighter than they can be.
  LinkPoses X_WL;
  forward_kinematics(arm->model, arm->problem.positions, X_WL);
  const auto link1 = static_cast<std::size_t>(arm->model.find_link("left_panda_link1"));
  arm->problem.X_WE.translation() = X_WL[link1].translation() + Eigen::Vector3d(0.95, 0, 0);
  expect_error(solve_ik(arm->problem), ErrorCode::kInfeasible,
               {"out of reach", "none of 101 attempts came nearer than"});
  arm->problem.columns.clear();
  expect_error(solve_ik(arm->problem), ErrorCode::kInfeasible, {"no given joint moves the link"});
}

TEST(InverseKinematics, BoundsTheReachOfEveryPoseThatItCanTake) {
  Rng rng(5);
  for (int round = 0; round < 300; ++round) {
    const auto model = test::random_model(8, rng);
    ASSERT_TRUE(model) << model.error().message;
    if (model->position_count() == 0) continue;
    // Prismatic followers of continuous joints have no bound; draw inside the limits.
    IkProblem problem;
    problem.model = &*model;
    problem.link = static_cast<int>(rng.index(model->links().size()));
    problem.X_LE = test::random_pose(rng);
    problem.positions = test::random_positions(*model, rng);
    Eigen::VectorXd goal = problem.positions;
    for (int k = 0; k < goal.size(); ++k) {
      if (rng.index(3) == 0) continue;
      problem.columns.push_back(k);
      goal[k] = test::random_positions(*model, rng)[k];
    }
    LinkPoses X_WL;
    forward_kinematics(*model, goal, X_WL);
    problem.X_WE = X_WL[static_cast<std::size_t>(problem.link)] * problem.X_LE;
    const auto q = solve_ik(problem, {.restarts = 3});
    if (q) continue;
    EXPECT_EQ(q.error().message.find("m at most"), std::string::npos) << q.error().message;
  }
}

TEST(InverseKinematics, SaysThatItFoundNothingNearTheGoal) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  const auto arm = panda();
  Rng rng(6);
  const Eigen::VectorXd goal = test::random_positions(arm->model, rng);
  arm->problem.X_WE = arm->tool(goal);
  arm->problem.positions = goal;
  arm->problem.positions[arm->problem.columns[0]] += 1e-3;
  expect_error(solve_ik(arm->problem, {.restarts = 0, .iterations = 0}), ErrorCode::kInfeasible,
               {"not found in 1 attempts", "missed by", "m and", "rad", "restarts"});
}

TEST(InverseKinematics, NamesTheMostFrequentRefusal) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  const auto arm = panda();
  Rng rng(7);
  arm->problem.X_WE = arm->tool(test::random_positions(arm->model, rng));
  int calls = 0;
  const IkValidity refuse = [&](const Eigen::VectorXd&) {
    return ++calls % 3 ? "hand and table" : "elbow and wall";
  };
  const auto q = solve_ik(arm->problem, {}, refuse);
  ASSERT_GT(calls, 3);
  expect_error(q, ErrorCode::kInfeasible,
               {"blocked", "the " + std::to_string(calls) + " solutions", "by hand and table",
                std::to_string(calls - calls / 3) + " times"});
}

TEST(InverseKinematics, ReturnsOnlyWhatIsValid) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  const auto arm = panda();
  Rng rng(8);
  const int column = arm->problem.columns[2];
  for (int i = 0; i < 50; ++i) {
    const Eigen::VectorXd goal = test::random_positions(arm->model, rng);
    arm->problem.positions = goal;
    arm->problem.X_WE = arm->tool(goal);
    // The seed solves, but its side of joint 3 is closed.
    const bool positive = goal[column] > 0;
    const auto q = solve_ik(arm->problem, {}, [&](const Eigen::VectorXd& p) {
      return (p[column] > 0) == positive ? "wall" : "";
    });
    if (!q) {
      EXPECT_NE(q.error().message.find("blocked"), std::string::npos) << q.error().message;
      continue;
    }
    EXPECT_NE((*q)[column] > 0, positive);
    expect_solution(*arm, *q);
  }
}

TEST(InverseKinematics, StopsWhenAsked) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  const auto arm = panda();
  std::stop_source source;
  const StopCondition stop(Clock::time_point::max(), source.get_token());
  int calls = 0;
  const IkValidity refuse = [&](const Eigen::VectorXd&) {
    if (++calls == 2) source.request_stop();
    return "wall";
  };
  Rng rng(9);
  arm->problem.X_WE = arm->tool(test::random_positions(arm->model, rng));
  expect_error(solve_ik(arm->problem, {}, refuse, stop), ErrorCode::kCancelled, {"kinematics"});
  EXPECT_EQ(calls, 2);
  expect_error(solve_ik(arm->problem, {}, {}, StopCondition::after(-1)), ErrorCode::kTimeout,
               {"kinematics"});
}

/// A gantry whose second slide follows the first, with a wrist of three joints.
Model gantry() {
  std::vector<Link> links = {named_link("base")};
  std::vector<Joint> joints;
  const auto add = [&](const char* name, JointType type, const Eigen::Vector3d& axis) {
    const int parent = static_cast<int>(links.size()) - 1;
    links.push_back(named_link(std::string("link_") + name));
    joints.push_back(named_joint(name, type, parent, parent + 1, axis));
  };
  add("x", JointType::kPrismatic, Eigen::Vector3d::UnitX());
  add("x2", JointType::kPrismatic, Eigen::Vector3d::UnitX());
  add("y", JointType::kPrismatic, Eigen::Vector3d(0, 3, 0));
  add("z", JointType::kPrismatic, -Eigen::Vector3d::UnitZ());
  add("roll", JointType::kContinuous, Eigen::Vector3d::UnitZ());
  add("pitch", JointType::kRevolute, Eigen::Vector3d::UnitY());
  add("yaw", JointType::kContinuous, Eigen::Vector3d::UnitZ());
  joints[1].mimic = Mimic{0, 0.5, 0.1};
  joints[5].limits.lower = -2;
  joints[5].limits.upper = 2;
  return *Model::make("gantry", links, joints);
}

TEST(InverseKinematics, SolvesSlidesMimicsAndEndlessJoints) {
  const Model model = gantry();
  IkProblem problem;
  problem.model = &model;
  problem.link = model.find_link("link_yaw");
  problem.X_LE.translation() = Eigen::Vector3d(0.1, 0, 0.2);
  problem.columns = test::all_columns(model);
  Rng rng(10);
  for (int i = 0; i < 100; ++i) {
    LinkPoses X_WL;
    forward_kinematics(model, test::random_positions(model, rng), X_WL);
    problem.X_WE = X_WL.back() * problem.X_LE;
    problem.positions = test::random_positions(model, rng);
    const auto q = solve_ik(problem);
    ASSERT_TRUE(q) << q.error().message;
    forward_kinematics(model, *q, X_WL);
    EXPECT_TRUE((X_WL.back() * problem.X_LE).isApprox(problem.X_WE, 1e-5));
  }
  // 1 m and its half and 0.1 m in x, 1 m in y and in z, and the tool.
  problem.X_WE.translation() = Eigen::Vector3d(5, 0, 0);
  expect_error(solve_ik(problem), ErrorCode::kInfeasible, {"out of reach", "'x'", "3.8"});
}

TEST(InverseKinematics, SolvesWithPartOfTheJoints) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  const auto arm = panda();
  Rng rng(11);
  arm->problem.columns.erase(arm->problem.columns.begin(), arm->problem.columns.begin() + 4);
  for (int i = 0; i < 50; ++i) {
    arm->problem.positions = test::random_positions(arm->model, rng);
    Eigen::VectorXd goal = arm->problem.positions;
    for (const int k : arm->problem.columns) goal[k] = test::random_positions(arm->model, rng)[k];
    arm->problem.X_WE = arm->tool(goal);
    const auto q = solve_ik(arm->problem);
    ASSERT_TRUE(q) << q.error().message;
    expect_solution(*arm, *q);
  }
}

TEST(InverseKinematics, RejectsProblemsThatAreNone) {
  const Model model = gantry();
  IkProblem good;
  good.model = &model;
  good.link = 1;
  good.columns = {0};
  good.positions = Eigen::VectorXd::Zero(model.position_count());
  const auto spoilt = [&](auto spoil) {
    IkProblem problem = good;
    spoil(problem);
    return problem;
  };
  EXPECT_TRUE(solve_ik(good));
  for (const IkProblem& problem :
       {spoilt([](IkProblem& p) { p.model = nullptr; }), spoilt([](IkProblem& p) { p.link = -1; }),
        spoilt([](IkProblem& p) { p.link = 99; }), spoilt([](IkProblem& p) { p.columns = {6}; }),
        spoilt([](IkProblem& p) { p.positions.resize(2); }),
        spoilt([](IkProblem& p) { p.positions[0] = std::nan(""); }),
        spoilt([](IkProblem& p) { p.X_WE.matrix() *= 2; })}) {
    EXPECT_THROW((void)solve_ik(problem), ContractViolation);
  }
}

}  // namespace
}  // namespace tandem::robot
