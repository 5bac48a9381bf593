#include "tandem/io/workcell_yaml.h"

#include <numbers>

#include "documented_cell.h"
#include "tandem/robot/urdf.h"

namespace tandem::io {
namespace {

using test::documented_yaml;
using test::DocumentedCell;
using test::Fault;
using test::kAbsent;
using test::line_of;
using test::TemporaryFolder;
using test::with;
using test::write_robots;
using world::Workcell;

TEST_F(DocumentedCell, Loads) {
  const auto loaded = load(text_);
  ASSERT_TRUE(loaded) << loaded.error().message;
  const Workcell& cell = **loaded;
  EXPECT_EQ(cell.name(), "pick_and_place");
  EXPECT_EQ(cell.spec().file, folder_ / "cell.yaml");
  EXPECT_EQ(cell.dof(), 14);

  // Limits: the workcell's over the file's over the URDF's.
  EXPECT_EQ(cell.limits()[0].velocity, 2.0);
  EXPECT_EQ(cell.limits()[0].acceleration, 7.0);
  EXPECT_EQ(cell.limits()[0].jerk, 3000.0);
  EXPECT_EQ(cell.limits()[1].acceleration, 10.0);
  EXPECT_EQ(cell.limits()[7].acceleration, 10.0);
  EXPECT_FALSE(std::isfinite(cell.limits()[7].jerk));

  const auto& robots = cell.spec().robots;
  EXPECT_TRUE(robots[0].X_WB.translation().isApprox(Eigen::Vector3d(0, 0.5, 0)));
  EXPECT_TRUE((robots[0].X_WB.linear() * Eigen::Vector3d::UnitX())
                  .isApprox(-Eigen::Vector3d::UnitY(), 1e-12));
  EXPECT_EQ(robots[0].fixed_positions.at("panda_finger_joint1"), 0.03);

  const world::Arm& left = cell.arms()[0];
  EXPECT_EQ(cell.model().links()[static_cast<std::size_t>(left.tip_link)].name, "left/panda_hand");
  EXPECT_EQ(left.X_LE.translation().z(), 0.1034);
  EXPECT_EQ(cell.arms()[1].group, "");
  EXPECT_EQ(cell.arms()[1].dof(), 7);

  const auto body = [&](const char* name) {
    const int index = cell.find_body(name);
    EXPECT_GE(index, 0) << name;
    return cell.bodies()[static_cast<std::size_t>(std::max(index, 0))];
  };
  EXPECT_EQ(body("table").padding, 0.0);
  EXPECT_EQ(body("gear").padding, 0.0);
  EXPECT_EQ(body("camera").padding, 0.005);
  EXPECT_EQ(body("left/panda_link3").padding, 0.005);
  // What an arm carries is given in its tool frame, 0.1034 m from the hand.
  EXPECT_NEAR(body("gear").shapes_L[0].origin().z(), 0.1034, 1e-15);
  EXPECT_EQ(body("gear").link, cell.model().find_link("left/panda_hand"));
  EXPECT_EQ(body("camera").link, cell.model().find_link("right/panda_hand"));
  ASSERT_EQ(body("shelf").shapes_L.size(), 3u);
  EXPECT_TRUE(body("shelf").shapes_L[1].origin().isApprox(Eigen::Vector3d(0.8, 0, 0.8)));
  EXPECT_EQ(body("left/panda_link5").shapes_L.size(), 2u);

  ASSERT_EQ(cell.queries().size(), 2u);
  const world::Query& pick = cell.query("pick");
  EXPECT_EQ(std::get<world::JointGoal>(*pick.start[1]).q[3], -2.356);
  const auto& pose = std::get<world::PoseGoal>(*pick.goal[0]).X_WE;
  EXPECT_TRUE(pose.linear().isApprox(Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix()));
  EXPECT_FALSE(pick.goal[1]);
  EXPECT_FALSE(cell.query("back").start[0]);
}

TEST_F(DocumentedCell, HasEveryShapeAsWritten) {
  const std::string shapes = documented_yaml().at(1);
  std::string text = text_;
  text.insert(
      text.find("obstacles:\n") + 11, "  - name: all\n    " + [&] {
        std::string indented = shapes;
        for (std::size_t at = 0; (at = indented.find('\n', at)) + 1 < indented.size();) {
          indented.insert(++at, "    ");
        }
        return indented;
      }());
  const auto loaded = load(text);
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto& read =
      (*loaded)->bodies()[static_cast<std::size_t>((*loaded)->find_body("all"))].shapes_L;
  using Eigen::Vector3d;
  using geometry::Shape;
  Eigen::Isometry3d up = Eigen::Isometry3d::Identity(), turned;
  up.translation() = Vector3d(0, 0, 0.1);
  turned = up * Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX());
  const std::vector<Shape> expected{
      *Shape::sphere({0, 0, 0.1}, 0.05),
      *Shape::capsule({0, 0, 0}, {0, 0, 0.3}, 0.05),
      *Shape::rounded_triangle({0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}, 0.01),
      *Shape::rounded_rectangle(turned, {0.3, 0.2}, 0.01),
      *Shape::box(up, {0.3, 0.2, 0.1}, 0.01),
      *Shape::cylinder(up, 0.05, 0.3, 0.01)};
  ASSERT_EQ(read.size(), expected.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].type(), expected[i].type()) << i;
    EXPECT_TRUE(read[i].origin().isApprox(expected[i].origin(), 1e-12)) << i;
    EXPECT_TRUE(read[i].extents().isApprox(expected[i].extents(), 1e-12)) << i;
    EXPECT_EQ(read[i].radius(), expected[i].radius()) << i;
    EXPECT_EQ(read[i].core_radius(), expected[i].core_radius()) << i;
  }
}

TEST_F(DocumentedCell, TurnsRollPitchYawAsAUrdfDoes) {
  const auto loaded = load(with(text_, "rpy_deg: [0, 0, -90]", "rpy_deg: [10, 20, 30]"));
  ASSERT_TRUE(loaded) << loaded.error().message;
  const double d = std::numbers::pi / 180;
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  // About fixed axes: x first, then y, then z.
  for (const Eigen::Vector3d& v : {x, y, z}) {
    const Eigen::Vector3d rolled = Eigen::AngleAxisd(10 * d, x) * v;
    const Eigen::Vector3d pitched = Eigen::AngleAxisd(20 * d, y) * rolled;
    const Eigen::Vector3d yawed = Eigen::AngleAxisd(30 * d, z) * pitched;
    EXPECT_TRUE(((*loaded)->spec().robots[0].X_WB.linear() * v).isApprox(yawed, 1e-12));
  }
}

TEST_F(DocumentedCell, MayUseAnchorsPlusSignsAndExponents) {
  std::string text = with(text_, "{size: [2, 2, 0.1], xyz: [0, 0, -0.06]}",
                          "{size: &size [+2, 2e0, .1], xyz: [0, 0, -6.0E-2]}");
  text = with(text, "{size: [0.1, 0.03, 0.03]", "{size: *size");
  const auto loaded = load(text);
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto& camera =
      (*loaded)->bodies()[static_cast<std::size_t>((*loaded)->find_body("camera"))];
  EXPECT_NEAR(camera.shapes_L[0].volume(), 0.4, 1e-12);
}

const std::vector<Fault> kFaults = {
    {"name: pick_and_place", "nam: pick_and_place", "nam: p", {"'nam'", "did you mean 'name'"}},
    {"name: pick_and_place\n", "", "packages", {"'name' is missing"}},
    {"name: pick_and_place", "name: ", "name:", {"name must be a word", "nothing"}},
    {"name: pick_and_place", "name: [a]", "name: [", {"name must be a word", "a list"}},
    {"packages: [packages] ",
     "packages: [missing] ",
     "packages: [",
     {"packages[0]", "missing"},
     kAbsent},
    {"packages: [packages] ", "packages: [cell.yaml] ", "packages: [", {"not a folder"}},
    {"  - name: left\n    urdf: robots/panda.urdf",
     "  - name: left\n    urdf: robots/pand.urdf",
     "robots/pand.urdf",
     {"urdf", "pand.urdf", "relative"},
     kAbsent},
    {"  - name: left\n    urdf: robots/panda.urdf",
     "  - name: left\n    urdf: robots",
     "urdf: robots\n",
     {"a folder, not a file"}},
    {"  - name: left\n    urdf: robots/panda.urdf\n",
     "  - name: left\n",
     "name: left\n",
     {"'urdf' is missing"}},
    {"  - name: left\n    urdf",
     "  - name: left\n    name: twice\n    urdf",
     "name: twice",
     {"'name' is repeated", "first in line 4"}},
    {"      panda_joint1: {velocity: 2.0",
     "      panda_jiont1: {velocity: 2.0",
     "panda_jiont1",
     {"'panda_jiont1'", "mean 'panda_joint1'"},
     kAbsent},
    {"velocity: 2.0", "velocity: -2.0", "velocity: -2.0", {"velocity is -2.0", "above 0"}},
    {"velocity: 2.0", "velocity: fast", "velocity: fast", {"velocity is 'fast'", "a number"}},
    {"velocity: 2.0", "velocity: 2.0 rad/s", "velocity: 2.0", {"'2.0 rad/s'"}},
    {"velocity: 2.0", "velocity: .inf", "velocity: .inf", {"'.inf'"}},
    {"velocity: 2.0", "velocity: inf", "velocity: inf", {"'inf'", "finite"}},
    {"velocity: 2.0", "velocity: nan", "velocity: nan", {"'nan'", "finite"}},
    {"velocity: 2.0", "velocity: 1e999", "velocity: 1e999", {"'1e999'"}},
    {"velocity: 2.0", "velocity: 0x10", "velocity: 0x10", {"'0x10'"}},
    {"velocity: 2.0", "velocty: 2.0", "velocty", {"mean 'velocity'"}},
    {"velocity: 2.0", "lower: 2, upper: 1", "lower: 2", {"lower limit 2", "upper limit 1"}},
    {"panda_joint1: {v", "panda_hand_joint: {v", "panda_hand_joint", {"is fixed"}},
    {"base: {xyz: [0, 0.5, 0],", "base: {xyz: [0, 0.5],", "[0, 0.5]", {"xyz has 2 numbers", "3"}},
    {"base: {xyz: [0, 0.5, 0],",
     "base: {xyz: [0, 1e308, 0],",
     "[0, 1e308, 0]",
     {"1e8 m", "metres"}},
    {"panda_joint1: {v",
     "panda_joint1: {upper: 1e9, v",
     "name: left, robot",
     {"limit of 1e+09", "1e8"}},
    {"velocity: 2.0", "velocity: 1e308", "name: left, robot", {"velocity limit of 1e+308", "1e12"}},
    {"base: {xyz: [0, 0.5, 0],", "base: {xyz: [0, a, 0],", "[0, a, 0]", {"xyz[1] is 'a'"}},
    {"base: {xyz: [0, 0.5, 0],", "base: {xyz: 5,", "xyz: 5", {"xyz must be a list of numbers"}},
    {"base: {xyz: [0, 0.5, 0],", "base: {quat_wxyz: [1, 0, 0, 0],", "base: {quat", {"keep one"}},
    {"rpy_deg: [0, 0, -90]", "rpy: [0, 0, -90]", "rpy: [", {"'rpy'", "rpy_deg"}},
    {"rpy_deg: [0, 0, -90]", "quat_wxyz: [1, 1, 0, 0]", "[1, 1, 0, 0]", {"length 1.41", "w, x"}},
    {"joints: {panda_finger_joint1: 0.03}",
     "joints: {panda_finger_joint: 0.03}",
     "- name: left\n",
     {"'panda_finger_joint'", "mean 'panda_finger_joint1'"},
     kAbsent},
    {"joints: {panda_finger_joint1: 0.03}",
     "joints: {panda_joint1: 0.03}",
     "- name: left\n",
     {"moved by arm 'left'"}},
    {"robot: left, group: panda_arm",
     "robot: lfet, group: panda_arm",
     "robot: lfet",
     {"arm 'left'", "mean 'left'"},
     kAbsent},
    {"group: panda_arm", "group: panda_am", "panda_am", {"mean 'panda_arm'"}, kAbsent},
    {"group: panda_arm", "tol: x", "tol: x", {"'tol'", "mean 'tool'"}},
    {"group: panda_arm",
     "base: panda_link0, group: panda_arm",
     "base: panda_link0, group",
     {"both 'group' and 'base'"}},
    {"group: panda_arm, tip: panda_hand, ", "", "name: left, robot", {"needed: group, base"}},
    {"base: panda_link0, tip: panda_hand",
     "base: panda_link0",
     "base: panda_link0}",
     {"'tip' is missing"}},
    {"name: right, robot: right, base",
     "name: left, robot: right, base",
     "base: panda_link0",
     {"arm 'left'", "rename"}},
    {"size: [2, 2, 0.1]", "size: [2, 2, 0]", "[2, 2, 0]", {"size[2] is 0", "above 0"}},
    {"size: [2, 2, 0.1]", "size: [2, 2]", "[2, 2]", {"size has 2 numbers"}},
    {"size: [2, 2, 0.1]", "sise: [2, 2, 0.1]", "sise", {"'sise'", "mean 'size'"}},
    {"size: [2, 2, 0.1],", "size: [2, 2, 0.1], rounding: -1,", "rounding", {"not be negative"}},
    {"{name: table, box: {", "{name: table, bx: {", "bx: {", {"'bx'", "mean 'box'"}},
    {"{name: table, box: {",
     "{name: table, sphere: {center: [0, 0, 0], radius: 1}, box: {",
     "table",
     {"both 'sphere' and 'box'"}},
    {"name: table, ", "", "- {box:", {"'name' is missing"}},
    {"name: table", "name: shelf", "- name: shelf", {"'shelf'", "rename"}},
    {", to: [0, -0.5, 0.8], radius: 0.02", ", radius: 0.02", "from:", {"'to' is missing"}},
    {"[0, -0.5, 0.8], radius: 0.02", "[0, -0.5, 0.8], radius: 0", "from:", {"radius is 0"}},
    {"name: gear, arm: left", "name: gear, arm: lefd", "arm: lefd", {"mean 'left'"}, kAbsent},
    {"name: gear, arm: left", "name: gear, link: a, arm: left", "link: a", {"'arm' and 'link'"}},
    {"name: gear, arm: left", "name: gear", "name: gear,", {"needed: arm, link"}},
    {"touching: [left/panda_hand]",
     "touching: [panda_hand]",
     "name: gear",
     {"'panda_hand'", "ROBOT/LINK"},
     kAbsent},
    {"link: right/panda_hand",
     "link: right/panda_hnd",
     "panda_hnd",
     {"'camera'", "mean 'right/panda_hand'"},
     kAbsent},
    {", reason: the hand rests on the base", "", "a: left/panda_link0", {"'reason' is missing"}},
    {"a: left/panda_link0",
     "a: left/panda_lnk0",
     "panda_lnk0",
     {"mean 'left/panda_link0'"},
     kAbsent},
    {"default: 0.005", "default: -0.005", "default:", {"default is -0.005", "negative"}},
    {"bodies: {gear: 0.0}", "bodies: {gera: 0.0}", "", {"'gera'", "mean 'gear'"}, kAbsent},
    {"padding: {default", "padding: {defualt", "defualt", {"mean 'default'"}},
    {"start: {left: {state: ready},",
     "start: {left: {state: raedy},",
     "- name: pick\n",
     {"start of query 'pick'", "arm 'left'", "mean 'ready'"},
     kAbsent},
    {"start: {left: {state: ready},", "start: {", "- name: pick\n", {"no start for arm 'left'"}},
    {"start: {left: {state: ready},",
     "start: {left: {state: ready, joints: [0]},",
     "start: {",
     {"both 'joints' and 'state'"}},
    {"start: {left: {state: ready},", "start: {left: {},", "start: {", {"needed: joints, state"}},
    {"-2.356, 0, 1.571, 0.785]", "-2.356, 0, 1.571]", "- name: pick\n", {"7 joints", "6 values"}},
    {"[0, -0.785, 0, -2.356",
     "[0, -0.785, ~, -2.356",
     "start: {",
     {"joints[2] must be a number", "nothing"}},
    {"goal: {left: {pose", "goal: {lefd: {pose", "", {"'lefd'", "mean 'left'"}, kAbsent},
    {"goal: {left: {pose", "gaol: {left: {pose", "gaol", {"'gaol'", "mean 'goal'"}},
    {"  - name: back\n", "  - name: pick\n", "- name: pick\n    goal", {"query 'pick'"}},
    {"  - name: back\n", "  - name: !!str back\n", "!!str", {"tag", "not supported"}},
    {"  - name: back\n", "  - name: *nothing\n", "*nothing", {"not YAML"}},
    {"  - name: back\n", "  - name: &a [*a]\n", "&a", {"alias inside its own anchor"}},
    {"  - name: back\n", "  - [a: b]: back\n", "[a: b]", {"a key must be a word"}},
    {"    goal: {left: {state: ready}}\n",
     "    goal: {left: {state: ready}}\n---\nname: two\n",
     "name: two\n",
     {"second document"}},
    {"  - name: back\n", "  - name: [back\n", "", {"not YAML"}},
};

TEST_F(DocumentedCell, SpoiltIsRefusedWithPlaceAndRemedy) {
  for (const Fault& fault : kFaults) expect_refused(fault);
}

TEST_F(DocumentedCell, NamesTheColumn) {
  const auto loaded = load(with(text_, "velocity: 2.0", "velocity: -2.0"));
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().message.find("cell.yaml:10:32: velocity is -2.0"), std::string::npos)
      << loaded.error().message;
}

// Every line missing, one at a time: an error or a smaller cell, never a crash.
TEST_F(DocumentedCell, SurvivesMissingLinesAndTruncation) {
  int refused = 0, loaded = 0;
  std::vector<std::string> lines;
  std::stringstream stream(text_);
  for (std::string line; std::getline(stream, line);) lines.push_back(line + "\n");
  for (std::size_t skip = 0; skip < lines.size(); ++skip) {
    std::string without, until;
    for (std::size_t i = 0; i < lines.size(); ++i) without += i == skip ? "" : lines[i];
    for (std::size_t i = 0; i < skip; ++i) until += lines[i];
    until += lines[skip].substr(0, lines[skip].size() / 2);
    for (const std::string& text : {without, until}) {
      const auto cell = load(text);
      ++(cell ? loaded : refused);
      if (!cell) {
        EXPECT_EQ(cell.error().message.find((folder_ / "").string()), 0u);
      }
    }
  }
  EXPECT_GT(refused, 40);
  EXPECT_GT(loaded, 2);
}

TEST(WorkcellFile, ThatCannotBeReadIsNamed) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::filesystem::path& file, ErrorCode code, const char* says) {
    const auto loaded = load_workcell(file);
    ASSERT_FALSE(loaded);
    EXPECT_EQ(loaded.error().code, code);
    EXPECT_EQ(loaded.error().message.find(file.string()), 0u) << loaded.error().message;
    EXPECT_NE(loaded.error().message.find(says), std::string::npos) << loaded.error().message;
  };
  expect(folder / "missing.yaml", ErrorCode::kNotFound, "no such file");
  expect(folder / "", ErrorCode::kIo, "folder");
  expect("/dev/zero", ErrorCode::kInvalidInput, "larger");  // It never ends.
  expect(folder.write("empty.yaml", ""), ErrorCode::kInvalidInput, "empty");
  expect(folder.write("comment.yaml", "# nothing\n"), ErrorCode::kInvalidInput, "empty");
  expect(folder.write("null.yaml", "---\n"), ErrorCode::kInvalidInput, "map of keys");
  expect(folder.write("list.yaml", "- a\n"), ErrorCode::kInvalidInput, "map of keys");
  expect(folder.write("word.yaml", "hello\n"), ErrorCode::kInvalidInput, "map of keys");
  expect(folder.write("binary.yaml", std::string("\0\1\2\377", 4)), ErrorCode::kInvalidInput, "");
  expect(folder.write("tab.yaml", "name:\n\t- x\n"), ErrorCode::kInvalidInput, "not YAML");
}

TEST(WorkcellFile, ThatExplodesIsRefused) {
  const TemporaryFolder folder;
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 10; ++i) {
    const std::string here = std::to_string(i), below = std::to_string(i - 1);
    bomb.append("a").append(here).append(": &a").append(here).append(" [");
    for (int k = 0; k < 10; ++k) bomb.append(k ? ", *a" : "*a").append(below);
    bomb.append("]\n");
  }
  const auto wide = load_workcell(folder.write("bomb.yaml", bomb));
  ASSERT_FALSE(wide);
  EXPECT_NE(wide.error().message.find("million"), std::string::npos) << wide.error().message;

  const auto deep = load_workcell(
      folder.write("deep.yaml", "name: " + std::string(100000, '[') + std::string(100000, ']')));
  ASSERT_FALSE(deep);
  std::string tower = "a0: &a0 [x]\n";
  for (int i = 1; i < 5000; ++i) {
    const std::string here = std::to_string(i), below = std::to_string(i - 1);
    tower.append("a").append(here).append(": &a").append(here);
    tower.append(" [*a").append(below).append("]\n");
  }
  const auto high = load_workcell(folder.write("tower.yaml", tower));
  ASSERT_FALSE(high);
  EXPECT_NE(high.error().message.find("nested too deeply"), std::string::npos);
}

TEST_F(DocumentedCell, PassesOnTheErrorsOfItsFiles) {
  struct Inner {
    const char *file, *text, *says;
  };
  const Inner inner[] = {
      {"robots/panda.urdf", "<robot name='x'>", "panda.urdf"},
      {"robots/panda.srdf", "<robot name='x'><group name='g'><link name='y'/></group></robot>",
       "panda.srdf"},
      {"robots/joint_limits.yaml", "joint_limits: {nobody: {}}", "joint_limits.yaml"},
      {"robots/panda.volumes.yaml", "links: {nobody: []}", "panda.volumes.yaml:1:9: "},
  };
  for (const Inner& fault : inner) {
    SCOPED_TRACE(fault.file);
    write_robots(folder_);
    ASSERT_TRUE(load(text_));
    folder_.write(fault.file, fault.text);
    const auto loaded = load(text_);
    ASSERT_FALSE(loaded);
    EXPECT_NE(loaded.error().message.find(fault.says), std::string::npos) << loaded.error().message;
  }
}

TEST_F(DocumentedCell, TakesObstaclesFromMoveitScenes) {
  const char* const ball = "n\n* ball\n1\nsphere\n0.1\n1 2 3\n0 0 0 1\n0 0 0 0\n.\n";
  folder_.write("scenes/ball.scene", ball);
  folder_.write("can.scene", "n\n* can\n1\ncylinder\n0.1 1\n9 0 0\n0 0 0 1\n0 0 0 0\n.\n");
  for (const char* scenes :
       {"scene: scenes/ball.scene\n", "scene: [can.scene, scenes/ball.scene]\n"}) {
    const auto loaded = load(text_ + scenes);
    ASSERT_TRUE(loaded) << loaded.error().message;
    const world::ObstacleSpec& last = (*loaded)->spec().obstacles.back();
    EXPECT_EQ(last.name, "ball");
    EXPECT_EQ(last.shapes_W.at(0).origin(), Eigen::Vector3d(1, 2, 3));
    EXPECT_GE((*loaded)->find_body("table"), 0);
  }
  const auto refused = [&](const std::string& scenes) {
    const auto loaded = load(text_ + scenes);
    return loaded ? "" : loaded.error().message;
  };
  EXPECT_NE(refused("scene: gone.scene\n").find("there is no '"), std::string::npos);
  EXPECT_NE(refused("scene: [can.scene, can.scene]\n").find("'can'"), std::string::npos);
  folder_.write("can.scene", "n\n* can\n1\ncylinder\n0.1 x\n0 0 0\n0 0 0 1\n0 0 0 0\n.\n");
  EXPECT_NE(refused("scene: can.scene\n").find("can.scene:5:5: a size is 'x'"), std::string::npos);
}

TEST_F(DocumentedCell, NeedsItsMeshesWithoutVolumes) {
  const auto loaded = load(with(text_,
                                "volumes: robots/panda.volumes.yaml\n    joint_limits: "
                                "[robots/joint_limits.yaml]\n    limits",
                                "joint_limits: [robots/joint_limits.yaml]\n    limits"));
  ASSERT_FALSE(loaded);
  const std::string& message = loaded.error().message;
  EXPECT_EQ(message.find((folder_ / "cell.yaml").string() + ":4:5: "), 0u) << message;
  for (const char* said : {"robot 'left'", "link 'panda_link0'", "panda_link0.stl", "volumes:"}) {
    EXPECT_NE(message.find(said), std::string::npos) << message;
  }
}

TEST(VolumesFile, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  write_robots(folder);
  const auto model = robot::load_urdf(folder / "robots/panda.urdf");
  ASSERT_TRUE(model) << model.error().message;
  struct Case {
    std::string text, says;
  };
  const Case cases[] = {
      {"link: {}", "v.yaml:1:1: unknown key 'link'; did you mean 'links'?"},
      {"links: []", "v.yaml:1:8: links must be a map of keys, it is a list"},
      {"links:\n  panda_link9: []", "v.yaml:2:3: robot 'panda' has no link 'panda_link9'; did"},
      {"links:\n  panda_hand: {}", "v.yaml:2:15: panda_hand must be a list"},
      {"links:\n  panda_hand:\n    - ball: 1", "v.yaml:3:7: unknown key 'ball'"},
      {"links:\n  panda_hand:\n    - {}", "v.yaml:3:7: one of these keys is needed: sphere"},
      {"links:\n  panda_hand:\n    - sphere: {radius: 1}", "v.yaml:3:15: the key 'center'"},
      {"links:\n  panda_hand:\n    - sphere: {center: [0, 0, 0], radius: 0}", "radius is 0"},
      {"links:\n  panda_hand: []\n  panda_hand: []", "v.yaml:3:3: the key 'panda_hand' is repea"},
  };
  for (const Case& one : cases) {
    const auto volumes = load_volumes(folder.write("v.yaml", one.text), *model);
    ASSERT_FALSE(volumes) << one.text;
    EXPECT_NE(volumes.error().message.find(one.says), std::string::npos) << volumes.error().message;
  }
  const auto volumes = load_volumes(folder / "robots/panda.volumes.yaml", *model);
  ASSERT_TRUE(volumes) << volumes.error().message;
  EXPECT_EQ(volumes->size(), 3u);
  EXPECT_EQ(volumes->at("panda_link5").size(), 2u);
  EXPECT_EQ(volumes->at("panda_hand")[0].type(), geometry::CoreType::kSegment);
}

/// A cell of one robot from the test data.
std::string data_cell(const std::string& robot, const std::string& arms) {
  return "name: data\nrobots:\n  - {name: r, " + robot + "}\narms:\n" + arms;
}

/// Every link has its meshes: as triangles, or as hulls.
void expect_meshes(const std::string& robot, const std::string& arms, const std::string& link) {
  const TemporaryFolder folder;
  const std::vector<std::filesystem::path> packages = {test::data_path("robots/packages")};
  const auto load = [&](const std::string& text) {
    return load_workcell(folder.write("cell.yaml", text), packages);
  };
  const auto exact = load(data_cell(robot, arms));
  ASSERT_TRUE(exact) << exact.error().message;
  const auto convex = load(data_cell(robot + ", meshes: convex", arms));
  ASSERT_TRUE(convex) << convex.error().message;
  ASSERT_EQ((*exact)->bodies().size(), (*convex)->bodies().size());
  for (std::size_t i = 0; i < (*exact)->bodies().size(); ++i) {
    const world::Body &mesh = (*exact)->bodies()[i], &hull = (*convex)->bodies()[i];
    EXPECT_TRUE(hull.surfaces_L.empty()) << hull.name;
    EXPECT_EQ(mesh.shapes_L.size() + mesh.surfaces_L.size(), hull.shapes_L.size()) << hull.name;
  }
  const int index = (*exact)->find_body(link);
  ASSERT_GE(index, 0);
  EXPECT_FALSE((*exact)->bodies()[static_cast<std::size_t>(index)].surfaces_L.empty());

  const auto lost = load_workcell(folder / "cell.yaml");
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().code, ErrorCode::kNotFound);
  for (const char* said : {"cell.yaml:3:5: ", "mesh 'package://", "--package-path"}) {
    EXPECT_NE(lost.error().message.find(said), std::string::npos) << lost.error().message;
  }
}

TEST(RealRobots, DualPandaUsesItsMeshes) {
  TANDEM_SKIP_WITHOUT_DATA("robots/dual_panda");
  const std::string base = test::data_path("robots/dual_panda").string();
  expect_meshes("urdf: " + base + "/dual_panda.urdf, srdf: " + base +
                    "/panda.srdf, joint_limits: [" + base + "/joint_limits.yaml]",
                "  - {name: left, robot: r, group: left_panda_arm}\n"
                "  - {name: right, robot: r, group: right_panda_arm}\n",
                "r/left_panda_link0");
}

TEST(RealRobots, DualUr5eUsesItsMeshes) {
  TANDEM_SKIP_WITHOUT_DATA("robots/dual_ur5e");
  const std::string base = test::data_path("robots/dual_ur5e").string();
  expect_meshes("urdf: " + base + "/dual_ur5e.urdf, srdf: " + base +
                    "/dual_ur5e.srdf, joint_limits: [" + base + "/joint_limits.yaml]",
                "  - {name: left, robot: r, group: left_arm}\n"
                "  - {name: right, robot: r, group: right_arm}\n",
                "r/left_forearm_link");
}

TEST(RealRobots, SpherizedPandaNeedsNoVolumes) {
  TANDEM_SKIP_WITHOUT_DATA("robots/panda_mbm");
  const std::string base = test::data_path("robots/panda_mbm").string();
  std::string limits;
  for (int i = 1; i <= 7; ++i) {
    limits += (i > 1 ? ", panda_joint" : "panda_joint") + std::to_string(i) + ": {acceleration: 5}";
  }
  const TemporaryFolder folder;
  const auto loaded = load_workcell(folder.write(
      "cell.yaml", data_cell("urdf: " + base + "/panda_spherized.urdf, srdf: " + base +
                                 "/panda.srdf, limits: {" + limits + "}",
                             "  - {name: arm, robot: r, group: panda_arm}\n"
                             "obstacles: [{name: ball, sphere: {center: [1, 0, 0], radius: 0.1}}]\n"
                             "queries: [{name: go, start: {arm: {state: ready}}, "
                             "goal: {arm: {state: extended}}}]\n")));
  ASSERT_TRUE(loaded) << loaded.error().message;
  const Workcell& cell = **loaded;
  EXPECT_EQ(cell.dof(), 7);
  EXPECT_GE(cell.bodies().size(), 11u);
  EXPECT_GT(cell.pairs().size(), 10u);
  EXPECT_TRUE(cell.named_state(0, "transport"));
  const auto skipped = [&](const char* a, const char* b) {
    for (const world::SkippedPair& pair : cell.skipped_pairs()) {
      if (pair.a == std::min(cell.find_body(a), cell.find_body(b)) &&
          pair.b == std::max(cell.find_body(a), cell.find_body(b))) {
        return pair.reason;
      }
    }
    return std::string();
  };
  EXPECT_EQ(skipped("r/panda_link1", "r/panda_link2"), "disabled by SRDF: Adjacent");
  EXPECT_EQ(skipped("r/panda_link0", "ball"), "no arm moves them");
}

}  // namespace
}  // namespace tandem::io
