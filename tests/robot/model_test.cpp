#include "tandem/robot/model.h"

#include <functional>

#include "robots.h"
#include "tandem/core/contract.h"

namespace tandem::robot {
namespace {

using test::expect_error;
using test::named_joint;
using test::named_link;

constexpr auto kFixed = JointType::kFixed;
constexpr auto kRevolute = JointType::kRevolute;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

std::vector<Link> named_links(const std::vector<std::string>& names) {
  std::vector<Link> links;
  for (const auto& name : names) links.push_back(named_link(name));
  return links;
}

Mimic follow(int joint, double multiplier = 1, double offset = 0) {
  return {joint, multiplier, offset};
}

TEST(Model, SortsParentsFirstAndNumbersPositions) {
  // The tree base -> (a -> b), c, written child first.
  std::vector<Joint> joints = {named_joint("jb", kRevolute, 1, 0), named_joint("jc", kFixed, 3, 2),
                               named_joint("ja", JointType::kPrismatic, 3, 1)};
  const auto model = Model::make("m", named_links({"b", "a", "c", "base"}), std::move(joints));
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->name(), "m");
  std::vector<std::string> links, names;
  for (const Link& link : model->links()) links.push_back(link.name);
  for (const Joint& joint : model->joints()) names.push_back(joint.name);
  EXPECT_EQ(links, (std::vector<std::string>{"base", "c", "a", "b"}));
  EXPECT_EQ(names, (std::vector<std::string>{"jc", "ja", "jb"}));
  EXPECT_EQ(model->position_count(), 2);
  EXPECT_EQ(model->joint_of_position(0), model->find_joint("ja"));
  EXPECT_EQ(model->joint_of_position(1), model->find_joint("jb"));
  EXPECT_EQ(model->find_link("b"), 3);
  EXPECT_EQ(model->find_link("x"), -1);
  EXPECT_EQ(model->find_joint("x"), -1);
}

TEST(Model, KeepsItsInvariantsOnRandomTrees) {
  Rng rng(3);
  for (int round = 0; round < 200; ++round) {
    const auto model = test::random_model(1 + static_cast<int>(rng.index(30)), rng);
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->links()[0].parent_joint, -1);
    int next_position = 0;
    for (std::size_t k = 0; k < model->joints().size(); ++k) {
      const Joint& joint = model->joints()[k];
      ASSERT_EQ(joint.child_link, static_cast<int>(k) + 1);
      ASSERT_LT(joint.parent_link, joint.child_link);
      ASSERT_EQ(model->links()[k + 1].parent_joint, static_cast<int>(k));
      ASSERT_NEAR(joint.type == kFixed ? 1 : joint.axis_J.norm(), 1, 1e-14);
      if (joint.mimic) {
        const Joint& source = model->joints()[static_cast<std::size_t>(joint.mimic->joint)];
        ASSERT_FALSE(source.mimic);
        ASSERT_GE(source.position_index, 0);
      }
      const bool has_position = joint.type != kFixed && !joint.mimic;
      ASSERT_EQ(joint.position_index, has_position ? next_position : -1);
      if (!has_position) continue;
      ASSERT_EQ(model->joint_of_position(next_position++), static_cast<int>(k));
    }
    ASSERT_EQ(model->position_count(), next_position);
  }
}

TEST(Model, ResolvesMimicChainsToTheirSource) {
  std::vector<Joint> joints = {named_joint("a", kRevolute, 0, 1), named_joint("b", kRevolute, 1, 2),
                               named_joint("c", kRevolute, 2, 3)};
  joints[0].mimic = follow(1, 2, 0.1);   // a = 2 b + 0.1
  joints[1].mimic = follow(2, -3, 0.2);  // b = -3 c + 0.2
  const auto model = Model::make("m", named_links({"l0", "l1", "l2", "l3"}), std::move(joints));
  ASSERT_TRUE(model) << model.error().message;
  const auto& a = model->joints()[0].mimic;
  EXPECT_EQ(a->joint, 2);
  EXPECT_DOUBLE_EQ(a->multiplier, -6);
  EXPECT_DOUBLE_EQ(a->offset, 0.5);
  EXPECT_EQ(model->position_count(), 1);
  // All three joints move with c, which is named once.
  EXPECT_EQ(model->moving_ancestors(3), std::vector<int>{2});
}

TEST(Model, DropsTheMimicOfAFixedJoint) {
  std::vector<Joint> joints = {named_joint("a", kFixed, 0, 1), named_joint("b", kFixed, 0, 2)};
  joints[1].mimic = follow(0);
  const auto model = Model::make("m", named_links({"l0", "l1", "l2"}), std::move(joints));
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_FALSE(model->joints()[1].mimic);
}

TEST(Model, FindsChainsAndMovingAncestors) {
  std::vector<Joint> joints = {named_joint("j1", kRevolute, 0, 1), named_joint("f", kFixed, 1, 2),
                               named_joint("j2", kRevolute, 2, 3),
                               named_joint("side", kRevolute, 1, 4)};
  const auto model = Model::make("m", named_links({"l0", "l1", "l2", "l3", "s"}), joints);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->chain(0, 3), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(model->chain(1, 3), (std::vector<int>{1, 2}));
  EXPECT_EQ(model->chain(2, 2), std::vector<int>{});
  EXPECT_EQ(model->moving_ancestors(3), (std::vector<int>{0, 2}));
  EXPECT_EQ(model->moving_ancestors(0), std::vector<int>{});
  expect_error(model->chain(3, 1), ErrorCode::kInvalidInput, {"'l1' is not below link 'l3'"});
  expect_error(model->chain(2, 4), ErrorCode::kInvalidInput, {"'s' is not below link 'l2'"});
  EXPECT_THROW((void)model->chain(0, 5), ContractViolation);
  EXPECT_THROW((void)model->chain(-1, 0), ContractViolation);
}

TEST(Model, RejectsTreesThatAreNone) {
  const auto make = [](const std::vector<std::string>& links, std::vector<Joint> joints) {
    return Model::make("m", named_links(links), std::move(joints));
  };
  const auto code = ErrorCode::kInvalidInput;
  expect_error(make({}, {}), code, {"'m' has no links"});
  expect_error(make({"a", "a"}, {}), code, {"link 'a' exists twice"});
  expect_error(make({"a", ""}, {}), code, {"a link has no name"});
  expect_error(make({"a", "b"}, {}), code, {"'a' and 'b' are both roots"});
  expect_error(
      make({"a", "b", "c"}, {named_joint("j", kFixed, 0, 1), named_joint("j", kFixed, 0, 2)}), code,
      {"joint 'j' exists twice"});
  expect_error(make({"a", "b"}, {named_joint("j", kFixed, 0, 2)}), code,
               {"joint 'j'", "link index 2"});
  expect_error(make({"a", "b"}, {named_joint("j", kFixed, -1, 1)}), code,
               {"joint 'j'", "link index -1"});
  expect_error(
      make({"a", "b", "c"}, {named_joint("j", kFixed, 0, 2), named_joint("k", kFixed, 1, 2)}), code,
      {"link 'c' is the child of two joints, 'j' and 'k'"});
  expect_error(make({"a"}, {named_joint("j", kFixed, 0, 0)}), code,
               {"link 'a' is part of a cycle"});
  expect_error(make({"a", "b"}, {named_joint("j", kFixed, 0, 1), named_joint("k", kFixed, 1, 0)}),
               code, {"part of a cycle"});
  expect_error(
      make({"r", "a", "b"}, {named_joint("j", kFixed, 1, 2), named_joint("k", kFixed, 2, 1)}), code,
      {"'a' is part of a cycle"});
}

struct BadJoint {
  const char* what;
  std::function<void(std::vector<Joint>&)> spoil;
  std::vector<std::string> parts;
};

void expect_rejected(const std::vector<BadJoint>& cases) {
  for (const BadJoint& c : cases) {
    SCOPED_TRACE(c.what);
    std::vector<Joint> joints = {named_joint("a", kRevolute, 0, 1),
                                 named_joint("b", kRevolute, 1, 2),
                                 named_joint("c", kRevolute, 2, 3)};
    c.spoil(joints);
    expect_error(Model::make("m", named_links({"l0", "l1", "l2", "l3"}), joints),
                 ErrorCode::kInvalidInput, c.parts);
  }
}

TEST(Model, RejectsAxesFramesAndLimitsThatCannotWork) {
  expect_rejected({
      {"zero axis", [](auto& j) { j[0].axis_J.setZero(); }, {"joint 'a'", "axis"}},
      {"NaN axis", [](auto& j) { j[0].axis_J.x() = kNan; }, {"joint 'a'", "axis"}},
      {"infinite axis", [](auto& j) { j[0].axis_J.x() = kInf; }, {"joint 'a'", "axis"}},
      {"NaN frame", [](auto& j) { j[1].X_PJ.translation().x() = kNan; }, {"joint 'b'", "frame"}},
      {"far frame", [](auto& j) { j[1].X_PJ.translation().z() = 1e9; }, {"joint 'b'", "1e8 m"}},
      {"skewed frame", [](auto& j) { j[1].X_PJ.linear() *= 2; }, {"joint 'b'", "frame"}},
      {"inverted", [](auto& j) { j[0].limits.lower = 2; }, {"joint 'a'", "2.0", "upper limit 1.0"}},
      {"NaN limit", [](auto& j) { j[0].limits.upper = kNan; }, {"joint 'a'", "nan"}},
      {"empty range",
       [](auto& j) { j[0].limits.lower = j[0].limits.upper = kInf; },
       {"joint 'a'", "no finite value"}},
      {"velocity", [](auto& j) { j[0].limits.velocity = 0; }, {"joint 'a'", "velocity limit 0.0"}},
      {"acceleration",
       [](auto& j) { j[0].limits.acceleration = kNan; },
       {"joint 'a'", "acceleration"}},
      {"jerk", [](auto& j) { j[0].limits.jerk = -1; }, {"joint 'a'", "jerk limit -1.0"}},
  });
}

TEST(Model, RejectsMimicsThatCannotWork) {
  expect_rejected({
      {"no source", [](auto& j) { j[0].mimic = follow(7); }, {"joint 'a'", "joint index 7"}},
      {"itself", [](auto& j) { j[0].mimic = follow(0); }, {"joint 'a'", "follows itself"}},
      {"ring",
       [](auto& j) {
         j[0].mimic = follow(1);
         j[1].mimic = follow(0);
       },
       {"follows itself"}},
      {"tail of a ring",
       [](auto& j) {
         j[0].mimic = follow(1);
         j[1].mimic = follow(2);
         j[2].mimic = follow(1);
       },
       {"follows itself"}},
      {"fixed source",
       [](auto& j) {
         j[0].mimic = follow(1);
         j[1].type = kFixed;
       },
       {"joint 'a'", "'b', which is fixed"}},
      {"NaN multiplier",
       [](auto& j) { j[0].mimic = follow(1, kNan); },
       {"joint 'a'", "multiplier"}},
      {"huge multiplier", [](auto& j) { j[0].mimic = follow(1, 1e308); }, {"joint 'a'", "1e8"}},
      {"product of large multipliers",
       [](auto& j) {
         j[0].mimic = follow(1, 1e5);
         j[1].mimic = follow(2, 1e5);
       },
       {"joint 'a'", "1e8"}},
      {"infinite offset",
       [](auto& j) { j[0].mimic = follow(1, 1, kInf); },
       {"joint 'a'", "offset"}},
  });
}

TEST(Model, IgnoresAxisAndLimitsOfFixedJoints) {
  std::vector<Joint> joints = {named_joint("a", kFixed, 0, 1, Eigen::Vector3d::Zero())};
  EXPECT_TRUE(Model::make("m", named_links({"l0", "l1"}), joints));
}

TEST(Model, SortsADeepChainWithoutRecursion) {
  constexpr int kDepth = 50000;
  std::vector<Link> links = {named_link("l0")};
  std::vector<Joint> joints;
  for (int i = 1; i <= kDepth; ++i) {
    const std::string name = std::to_string(i);
    links.push_back(named_link(name));
    joints.push_back(named_joint(name, kFixed, i - 1, i));
  }
  const auto model = Model::make("m", std::move(links), std::move(joints));
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->chain(0, kDepth)->size(), std::size_t{kDepth});
}

TEST(Model, SetLimitsChangesWhetherAJointIsContinuous) {
  std::vector<Joint> joints = {named_joint("a", kRevolute, 0, 1),
                               named_joint("p", JointType::kPrismatic, 1, 2)};
  auto model = Model::make("m", named_links({"l0", "l1", "l2"}), joints);
  ASSERT_TRUE(model);
  model->set_limits(0, {.velocity = 2});
  EXPECT_EQ(model->joints()[0].type, JointType::kContinuous);
  EXPECT_EQ(model->joints()[0].limits.velocity, 2);
  model->set_limits(0, {.lower = -2, .upper = 2});
  EXPECT_EQ(model->joints()[0].type, kRevolute);
  model->set_limits(1, {});
  EXPECT_EQ(model->joints()[1].type, JointType::kPrismatic);
  EXPECT_THROW(model->set_limits(2, {}), ContractViolation);
  EXPECT_THROW(model->set_limits(0, {.lower = 1, .upper = 0}), ContractViolation);
  EXPECT_THROW(model->set_limits(0, {.jerk = 0}), ContractViolation);
}

}  // namespace
}  // namespace tandem::robot
