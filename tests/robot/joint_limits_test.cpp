#include "tandem/robot/joint_limits.h"

#include <locale>

#include "robots.h"

namespace tandem::robot {
namespace {

using test::expect_error;
using test::named_joint;
using test::named_link;

constexpr double kInf = std::numeric_limits<double>::infinity();

/// Joints turn (+-1), wheel (continuous), slide (+-1 m), weld (fixed).
Model robot() {
  std::vector<Joint> joints = {named_joint("turn", JointType::kRevolute, 0, 1),
                               named_joint("wheel", JointType::kContinuous, 1, 2),
                               named_joint("slide", JointType::kPrismatic, 2, 3),
                               named_joint("weld", JointType::kFixed, 3, 4)};
  joints[0].limits.velocity = 2;
  return *Model::make(
      "r", {named_link("a"), named_link("b"), named_link("c"), named_link("d"), named_link("e")},
      joints);
}

Result<Model> overlaid(const std::string& entries) {
  Model model = robot();
  if (auto done = parse_joint_limits("joint_limits:\n" + entries, "limits.yaml", model); !done) {
    return std::unexpected(done.error());
  }
  return model;
}

TEST(JointLimits, ApplyToAllRobots) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  for (const test::RobotFiles& files : test::robot_files()) {
    if (files.limits.empty()) continue;
    SCOPED_TRACE(files.urdf);
    Model model = test::load(files.urdf);
    const auto done = overlay_joint_limits(test::robot_path(files.limits), model);
    ASSERT_TRUE(done) << done.error().message;
    int accelerations = 0;
    for (const Joint& joint : model.joints()) {
      accelerations += std::isfinite(joint.limits.acceleration);
    }
    EXPECT_GE(accelerations, 7);
  }
}

TEST(JointLimits, OfTheDualPandaAreThoseOfTheFile) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  Model model = test::load("dual_panda/dual_panda.urdf");
  ASSERT_TRUE(overlay_joint_limits(test::robot_path("dual_panda/joint_limits.yaml"), model));
  const auto limits = [&](const char* name) {
    return model.joints()[static_cast<std::size_t>(model.find_joint(name))].limits;
  };
  EXPECT_EQ(limits("right_panda_joint2").velocity, 2.175);
  EXPECT_EQ(limits("right_panda_joint2").acceleration, 1.875);
  EXPECT_EQ(limits("right_panda_joint2").jerk, kInf);
  EXPECT_EQ(limits("right_panda_joint2").upper, 1.8326);
  // has_acceleration_limits: false stands beside max_acceleration: 0.0.
  EXPECT_EQ(limits("left_panda_finger_joint2").acceleration, kInf);
}

TEST(JointLimits, ReplaceAddAndRemove) {
  const auto model = overlaid(
      "  turn: {has_velocity_limits: false, max_velocity: 0.0, has_acceleration_limits: true,\n"
      "         max_acceleration: 4, max_jerk: 5.5e2, min_position: -0.5}\n"
      "  wheel: {has_position_limits: true, min_position: -3, max_position: +3}\n"
      "  slide: {max_velocity: .5, has_position_limits: true, has_effort_limits: true,\n"
      "          max_effort: 9}\n"
      "  weld: {max_velocity: 1}\n");
  ASSERT_TRUE(model) << model.error().message;
  const JointLimits& turn = model->joints()[0].limits;
  EXPECT_EQ(turn.velocity, kInf);
  EXPECT_EQ(turn.acceleration, 4);
  EXPECT_EQ(turn.jerk, 550);
  EXPECT_EQ(turn.lower, -0.5);
  EXPECT_EQ(turn.upper, 1);
  EXPECT_EQ(model->joints()[1].type, JointType::kRevolute);
  EXPECT_EQ(model->joints()[1].limits.upper, 3);
  EXPECT_EQ(model->joints()[2].limits.velocity, 0.5);
  EXPECT_EQ(model->joints()[2].limits.lower, -1);
  const auto free = overlaid("  turn: {has_position_limits: false, has_velocity_limits: true}\n");
  ASSERT_TRUE(free) << free.error().message;
  EXPECT_EQ(free->joints()[0].type, JointType::kContinuous);
  EXPECT_EQ(free->joints()[0].limits.lower, -kInf);
  EXPECT_EQ(free->joints()[0].limits.velocity, 2);
}

TEST(JointLimits, KnowTheOtherKeysOfMoveIt) {
  Model model = robot();
  const auto done = parse_joint_limits(
      "default_velocity_scaling_factor: 0.1\ndefault_acceleration_scaling_factor: 0.1\n"
      "joint_limits:\n",
      "limits.yaml", model);
  EXPECT_TRUE(done) << done.error().message;
}

TEST(JointLimits, ReadNumbersWhateverTheLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale(), new Comma));
  const auto model = overlaid("  turn: {max_velocity: 2.5}\n");
  std::locale::global(before);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->joints()[0].limits.velocity, 2.5);
}

TEST(JointLimits, RejectMalformedFiles) {
  struct Case {
    const char* what;
    std::string entries;
    std::vector<std::string> parts;
  };
  const std::vector<Case> cases = {
      {"no YAML", "  turn: {max_velocity: 1\n", {"not well-formed"}},
      {"tab", "  turn:\n\t\tmax_velocity: 1\n", {"limits.yaml:3:15: not well-formed"}},
      {"column", "  turn: {max_jerk: 2, max_velocity: -1}\n", {"limits.yaml:2:37: joint 'turn'"}},
      {"two documents", "  turn: {}\n---\njoint_limits: {}\n", {":3:1:", "second document"}},
      {"an anchor in itself", "  turn: &a {max_jerk: *a}\n", {"limits.yaml:2:", "max_jerk"}},
      {"too deep",
       "  turn: " + std::string(10'000, '[') + "\n",
       {"limits.yaml:", "not well-formed"}},
      {"unknown joint",
       "  trun: {max_velocity: 1}\n",
       {"limits.yaml:2", "no joint 'trun'", "robot 'r'", "did you mean 'turn'"}},
      {"joint twice",
       "  turn: {max_velocity: 1}\n  turn: {max_jerk: 1}\n",
       {"limits.yaml:3", "'turn' exists twice"}},
      {"unknown key",
       "  turn:\n    max_velocty: 1\n",
       {"limits.yaml:3", "joint 'turn'", "max_velocty", "did you mean 'max_velocity'"}},
      {"key twice",
       "  turn:\n    max_jerk: 1\n    max_jerk: 2\n",
       {"limits.yaml:4", "'max_jerk' exists twice"}},
      {"no map", "  turn: 3\n", {"limits.yaml:2", "joint 'turn'", "max_velocity"}},
      {"list", "  - turn\n", {"limits.yaml:2", "joint names"}},
      {"word",
       "  turn: {max_velocity: fast}\n",
       {"limits.yaml:2", "joint 'turn'", "max_velocity", "number", "'fast'"}},
      {"zero", "  turn: {max_velocity: 0}\n", {"limits.yaml:2", "max_velocity", "positive", "'0'"}},
      {"negative", "  turn: {max_jerk: -1}\n", {"limits.yaml:2", "max_jerk", "positive", "'-1'"}},
      {"NaN", "  turn: {max_acceleration: .nan}\n", {"limits.yaml:2", "max_acceleration", ".nan"}},
      {"infinite", "  turn: {max_velocity: .inf}\n", {"limits.yaml:2", "max_velocity", ".inf"}},
      {"list of values", "  turn: {max_velocity: [1, 2]}\n", {"limits.yaml:2", "a list or map"}},
      {"no flag",
       "  turn: {has_jerk_limits: maybe}\n",
       {"limits.yaml:2", "has_jerk_limits", "true or false", "'maybe'"}},
      {"flag alone", "  turn: {has_jerk_limits: true}\n", {"limits.yaml:2", "needs max_jerk"}},
      {"word beside false",
       "  turn: {has_jerk_limits: false, max_jerk: x}\n",
       {"limits.yaml:2", "max_jerk", "'x'"}},
      {"inverted",
       "  turn: {min_position: 3}\n",
       {"limits.yaml:2", "joint 'turn'", "min_position 3", "max_position 1"}},
      {"half", "  wheel: {min_position: 3}\n", {"limits.yaml:2", "joint 'wheel'", "max_position"}},
      {"endless slide",
       "  slide: {has_position_limits: false}\n",
       {"limits.yaml:2", "joint 'slide'", "has_position_limits"}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.what);
    expect_error(overlaid(c.entries), ErrorCode::kInvalidInput, c.parts);
  }
}

TEST(JointLimits, RejectFilesWithoutLimits) {
  Model model = robot();
  expect_error(parse_joint_limits("", "limits.yaml", model), ErrorCode::kInvalidInput,
               {"limits.yaml", "joint_limits"});
  expect_error(parse_joint_limits("turn: {}\n", "limits.yaml", model), ErrorCode::kInvalidInput,
               {"limits.yaml", "joint_limits"});
  expect_error(parse_joint_limits("joint_limits: {}\njoints: {}\n", "limits.yaml", model),
               ErrorCode::kInvalidInput, {"limits.yaml:2", "'joints'"});
  // From this, YAML's parser takes empty documents without end.
  expect_error(parse_joint_limits(", a\njoint_limits: {}\n", "limits.yaml", model),
               ErrorCode::kInvalidInput, {"limits.yaml"});
  expect_error(overlay_joint_limits("/no/such.yaml", model), ErrorCode::kNotFound,
               {"/no/such.yaml"});
}

TEST(JointLimits, LeaveTheModelAloneAfterAnError) {
  Model model = robot();
  EXPECT_FALSE(parse_joint_limits(
      "joint_limits:\n  turn: {max_velocity: 7}\n  wheel: {max_velocity: -7}\n", "x", model));
  EXPECT_EQ(model.joints()[0].limits.velocity, 2);
}

}  // namespace
}  // namespace tandem::robot
