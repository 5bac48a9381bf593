#include "tandem/robot/srdf.h"

#include "robots.h"

namespace tandem::robot {
namespace {

using test::expect_error;
using test::named_joint;
using test::named_link;

/// base - j1 - l1 - j2 - l2 - fix - tool - grip - finger_a, and finger_b that follows; arm2 beside.
Model arm() {
  std::vector<Link> links;
  for (const char* name : {"base", "l1", "l2", "tool", "finger_a", "finger_b", "m1"}) {
    links.push_back(named_link(name));
  }
  std::vector<Joint> joints = {named_joint("j1", JointType::kRevolute, 0, 1),
                               named_joint("j2", JointType::kRevolute, 1, 2),
                               named_joint("fix", JointType::kFixed, 2, 3),
                               named_joint("grip", JointType::kPrismatic, 3, 4),
                               named_joint("follow", JointType::kPrismatic, 3, 5),
                               named_joint("k1", JointType::kRevolute, 0, 6)};
  joints[4].mimic = Mimic{3};
  return *Model::make("arm", links, joints);
}

Result<Semantics> parse(const std::string& body) {
  return parse_srdf("<robot name='arm'>\n" + body + "\n</robot>", "arm.srdf", arm());
}

std::vector<std::string> joint_names(const Model& model, const Group& group) {
  std::vector<std::string> names;
  for (const int joint : group.joints) {
    names.push_back(model.joints()[static_cast<std::size_t>(joint)].name);
  }
  return names;
}

using Names = std::vector<std::string>;

TEST(Srdf, LoadsAllRobots) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  for (const test::RobotFiles& files : test::robot_files()) {
    if (files.srdf.empty()) continue;
    SCOPED_TRACE(files.urdf);
    const Model model = test::load(files.urdf);
    const auto semantics = load_srdf(test::robot_path(files.srdf), model);
    ASSERT_TRUE(semantics) << semantics.error().message;
    EXPECT_GE(semantics->groups.size(), 2u);
    EXPECT_GE(semantics->states.size(), 2u);
    EXPECT_GE(semantics->disabled_pairs.size(), 12u);
    for (const DisabledPair& pair : semantics->disabled_pairs) {
      EXPECT_GE(model.find_link(pair.link_a), 0);
      EXPECT_GE(model.find_link(pair.link_b), 0);
    }
    for (const DisabledPair& pair : semantics->ignored_pairs) {
      EXPECT_TRUE(model.find_link(pair.link_a) < 0 || model.find_link(pair.link_b) < 0);
    }
    const bool is_baxter = files.urdf.starts_with("baxter");
    EXPECT_EQ(semantics->ignored_pairs.empty(), !is_baxter);
    // Every state has a value for every joint of its group.
    for (const NamedState& state : semantics->states) {
      const Group* group = semantics->find_group(state.group);
      ASSERT_TRUE(group);
      EXPECT_EQ(state.values.size(), group->joints.size()) << state.name;
    }
  }
}

TEST(Srdf, ResolvesTheGroupsOfKnownRobots) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  struct Case {
    const char *urdf, *srdf, *group, *tip, *first, *last;
    std::size_t dof;
  };
  for (const Case& c :
       {Case{"dual_panda/dual_panda.urdf", "dual_panda/panda.srdf", "left_panda_arm",
             "left_panda_link8", "left_panda_joint1", "left_panda_joint7", 7},
        {"dual_ur5e/dual_ur5e.urdf", "dual_ur5e/dual_ur5e.srdf", "right_arm", "right_tool0",
         "right_shoulder_pan_joint", "right_wrist_3_joint", 6},
        {"fr3_duo/fr3_duo.urdf", "fr3_duo/fr3_duo.srdf", "right_arm", "right_fr3v2_hand_tcp",
         "right_fr3v2_joint1", "right_fr3v2_joint7", 7},
        {"baxter_mbm/baxter.urdf", "baxter_mbm/baxter.srdf", "left_arm", "left_gripper", "left_s0",
         "left_w2", 7},
        {"baxter_mbm/baxter.urdf", "baxter_mbm/baxter.srdf", "both_arms", "", "", "", 14}}) {
    SCOPED_TRACE(std::string(c.urdf) + " " + c.group);
    const Model model = test::load(c.urdf);
    const Semantics semantics = test::load_semantics(c.srdf, model);
    const Group* group = semantics.find_group(c.group);
    ASSERT_TRUE(group);
    EXPECT_EQ(group->joints.size(), c.dof);
    EXPECT_EQ(group->tip_link, *c.tip ? model.find_link(c.tip) : -1);
    if (!*c.tip) continue;
    EXPECT_EQ(joint_names(model, *group).front(), c.first);
    EXPECT_EQ(joint_names(model, *group).back(), c.last);
  }
}

TEST(Srdf, ReadsChainsJointsLinksAndGroupsInAnyOrder) {
  const Model model = arm();
  const auto semantics = parse(
      "<group name='all'><group name='both'/><link name='finger_b'/></group>"
      "<group name='both'><group name='left'/><group name='right'/></group>"
      "<group name='left'><chain base_link='base' tip_link='tool'/></group>"
      "<group name='right'><joint name='k1'/></group>"
      "<group name='list'><joint name='j2'/><joint name='j1'/><link name='tool'/></group>"
      "<group name='hand'><link name='finger_a'/><link name='finger_b'/>"
      "<passive_joint name='follow'/></group>"
      "<group name='tip_only'><link name='l2'/></group>"
      "<group name='empty'/>");
  ASSERT_TRUE(semantics) << semantics.error().message;
  const auto group = [&](const char* name) { return *semantics->find_group(name); };
  EXPECT_EQ(joint_names(model, group("left")), (Names{"j1", "j2"}));
  EXPECT_EQ(group("left").tip_link, model.find_link("tool"));
  EXPECT_EQ(joint_names(model, group("right")), Names{"k1"});
  EXPECT_EQ(group("right").tip_link, model.find_link("m1"));
  EXPECT_EQ(joint_names(model, group("both")), (Names{"j1", "j2", "k1"}));
  EXPECT_EQ(group("both").tip_link, -1);
  EXPECT_EQ(joint_names(model, group("all")), (Names{"j1", "j2", "k1"}));
  EXPECT_EQ(joint_names(model, group("list")), (Names{"j1", "j2"}));
  EXPECT_EQ(group("list").tip_link, model.find_link("tool"));
  EXPECT_EQ(joint_names(model, group("hand")), Names{"grip"});
  EXPECT_EQ(group("hand").tip_link, -1);
  EXPECT_EQ(joint_names(model, group("tip_only")), Names{"j2"});
  EXPECT_EQ(joint_names(model, group("empty")), Names{});
  EXPECT_EQ(semantics->groups.front().name, "all");
  EXPECT_EQ(semantics->find_group("none"), nullptr);
}

TEST(Srdf, ReadsStatesPairsAndIgnoresTheRest) {
  const auto semantics = parse(
      "<virtual_joint name='v' type='floating' parent_frame='world' child_link='base'/>"
      "<group name='g'><joint name='v'/><joint name='j1'/><joint name='grip'/></group>"
      "<group_state name='home' group='g'><joint name='j1' value=' -0.5 '/>"
      "<joint name='grip' value='1e-2'/><joint name='follow' value='1'/><joint name='fix' "
      "value='0'/>"
      "<joint name='v' value='0 0 0 0 0 0 1'/></group_state>"
      "<end_effector name='e' group='nothing' parent_link='nothing'/><passive_joint name='x'/>"
      "<disable_collisions link1='l1' link2='l2' reason='Adjacent'/>"
      "<disable_collisions link1='l1' link2='tool'/>"
      "<disable_collisions link1='l1' link2='camera' reason='Never'/>");
  ASSERT_TRUE(semantics) << semantics.error().message;
  const NamedState* home = semantics->find_state("g", "home");
  ASSERT_TRUE(home);
  EXPECT_EQ(home->values, (std::map<std::string, double>{{"j1", -0.5}, {"grip", 0.01}}));
  EXPECT_EQ(semantics->find_state("g", "away"), nullptr);
  EXPECT_EQ(semantics->find_state("h", "home"), nullptr);
  ASSERT_EQ(semantics->disabled_pairs.size(), 2u);
  EXPECT_EQ(semantics->disabled_pairs[0].link_b, "l2");
  EXPECT_EQ(semantics->disabled_pairs[0].reason, "Adjacent");
  EXPECT_EQ(semantics->disabled_pairs[1].reason, "");
  ASSERT_EQ(semantics->ignored_pairs.size(), 1u);
  EXPECT_EQ(semantics->ignored_pairs[0].link_b, "camera");
}

TEST(Srdf, ChecksPairsThatAreEnabledAgain) {
  const auto semantics = parse(
      "<disable_collisions link1='l1' link2='l2'/><disable_collisions link1='l1' link2='tool'/>"
      "<enable_collisions link1='l2' link2='l1'/>");
  ASSERT_TRUE(semantics) << semantics.error().message;
  ASSERT_EQ(semantics->disabled_pairs.size(), 1u);
  EXPECT_EQ(semantics->disabled_pairs[0].link_b, "tool");
}

struct Malformed {
  const char* what;
  std::string body;
  std::vector<std::string> parts;
};

void expect_malformed(const std::vector<Malformed>& cases) {
  for (const Malformed& c : cases) {
    SCOPED_TRACE(c.what);
    expect_error(parse(c.body), ErrorCode::kInvalidInput, c.parts);
  }
}

TEST(Srdf, RejectsMalformedGroups) {
  const std::string g = "<group name='g'><joint name='j1'/></group>\n";
  expect_malformed({
      {"no XML", "<group", {"not well-formed"}},
      {"group nameless", "<group/>", {"arm.srdf:2", "<group>", "name"}},
      {"group twice", g + g, {"arm.srdf:3", "group 'g'", "line 2"}},
      {"unknown joint",
       "<group name='g'>\n<joint name='j3'/></group>",
       {"arm.srdf:3", "no joint 'j3'", "robot 'arm'", "did you mean 'j"}},
      {"unknown link",
       "<group name='g'>\n<link name='tol'/></group>",
       {"arm.srdf:3", "no link 'tol'", "did you mean 'tool'"}},
      {"unknown base",
       "<group name='g'>\n<chain base_link='bse' tip_link='l1'/></group>",
       {"arm.srdf:3", "group 'g': <chain>", "'bse'"}},
      {"chain without tip",
       "<group name='g'>\n<chain base_link='base'/></group>",
       {"arm.srdf:3", "tip_link"}},
      {"chain upwards",
       "<group name='g'>\n<chain base_link='tool' tip_link='l1'/></group>",
       {"arm.srdf:3", "'l1' is not below link 'tool'"}},
      {"unknown group",
       "<group name='g'>\n<group name='h'/></group>",
       {"arm.srdf:3", "no group 'h'"}},
      {"itself", "<group name='g'>\n<group name='g'/></group>", {"arm.srdf:3", "contains itself"}},
      {"ring",
       "<group name='g'><group name='h'/></group>\n<group name='h'><group name='g'/></group>",
       {"arm.srdf:3", "contains itself"}},
      {"strange part", "<group name='g'>\n<chian/></group>", {"arm.srdf:3", "<chian>", "chain"}},
  });
}

TEST(Srdf, RejectsMalformedStatesAndPairs) {
  const std::string g = "<group name='g'><joint name='j1'/></group>\n";
  expect_malformed({
      {"state of no group",
       g + "<group_state name='s' group='h'/>",
       {"arm.srdf:3", "group_state 's'", "no group 'h'"}},
      {"state groupless", g + "<group_state name='s'/>", {"arm.srdf:3", "attribute group"}},
      {"state twice",
       g + "<group_state name='s' group='g'/>\n<group_state name='s' group='g'/>",
       {"arm.srdf:4", "'s'", "already"}},
      {"state of unknown joint",
       g + "<group_state name='s' group='g'>\n<joint name='x' value='0'/></group_state>",
       {"arm.srdf:4", "no joint 'x'"}},
      {"state of a joint outside",
       g + "<group_state name='s' group='g'>\n<joint name='j2' value='0'/></group_state>",
       {"arm.srdf:4", "'j2' is not in group 'g'"}},
      {"state with a word",
       g + "<group_state name='s' group='g'>\n<joint name='j1' value='up'/></group_state>",
       {"arm.srdf:4", "value=\"up\"", "number"}},
      {"state with NaN",
       g + "<group_state name='s' group='g'>\n<joint name='j1' value='nan'/></group_state>",
       {"arm.srdf:4", "nan"}},
      {"state valueless",
       g + "<group_state name='s' group='g'>\n<joint name='j1'/></group_state>",
       {"arm.srdf:4", "attribute value"}},
      {"value twice",
       g + "<group_state name='s' group='g'><joint name='j1' value='0'/>\n"
           "<joint name='j1' value='1'/></group_state>",
       {"arm.srdf:4", "already"}},
      {"pair of one", "<disable_collisions link1='l1'/>", {"arm.srdf:2", "link2"}},
  });
}

TEST(Srdf, RejectsOtherFiles) {
  expect_error(parse_srdf("<srdf/>", "arm.srdf", arm()), ErrorCode::kInvalidInput,
               {"arm.srdf", "<robot>", "<srdf>"});
  expect_error(load_srdf("/no/such.srdf", arm()), ErrorCode::kNotFound, {"/no/such.srdf"});
}

}  // namespace
}  // namespace tandem::robot
