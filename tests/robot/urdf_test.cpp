#include "tandem/robot/urdf.h"

#include <fstream>
#include <locale>
#include <sstream>

#include "robots.h"

namespace tandem::robot {
namespace {

using test::expect_error;

Result<Model> parse(const std::string& text) { return parse_urdf(text, "arm.urdf", "/nowhere"); }

/// Two links and the joint `attributes`, `body` that connects them, which begins in line 4.
std::string with_joint(const std::string& type, const std::string& body) {
  return "<robot name='r'>\n<link name='a'/>\n<link name='b'/>\n<joint name='j' type='" + type +
         "'>\n<parent link='a'/>\n<child link='b'/>\n" + body + "\n</joint>\n</robot>\n";
}

/// One link whose body begins in line 3.
std::string with_link(const std::string& body) {
  return "<robot name='r'>\n<link name='a'>\n" + body + "\n</link>\n</robot>\n";
}

const char* kLimit = "<limit lower='-1' upper='2' velocity='3' effort='4'/>";

TEST(Urdf, LoadsAllRobots) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  for (const test::RobotFiles& files : test::robot_files()) {
    SCOPED_TRACE(files.urdf);
    const auto model =
        load_urdf(test::robot_path(files.urdf), PackagePath({test::robot_path("packages")}));
    EXPECT_TRUE(model) << model.error().message;
  }
}

TEST(Urdf, ResolvesMeshesOfTheGivenPackages) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  for (const char* urdf :
       {"dual_panda/dual_panda.urdf", "dual_ur5e/dual_ur5e.urdf", "fr3_duo/fr3_duo.urdf"}) {
    SCOPED_TRACE(urdf);
    const Model with = test::load(urdf);
    const auto without = load_urdf(test::robot_path(urdf));
    ASSERT_TRUE(without) << without.error().message;
    int meshes = 0;
    for (std::size_t k = 0; k < with.links().size(); ++k) {
      for (std::size_t i = 0; i < with.links()[k].collision.size(); ++i) {
        const auto* mesh = std::get_if<MeshGeometry>(&with.links()[k].collision[i].shape);
        if (!mesh) continue;
        ++meshes;
        EXPECT_TRUE(std::filesystem::is_regular_file(mesh->path)) << mesh->uri;
        const auto& bare = std::get<MeshGeometry>(without->links()[k].collision[i].shape);
        EXPECT_EQ(bare.uri, mesh->uri);
        EXPECT_EQ(bare.path, "");
      }
    }
    EXPECT_GT(meshes, 10);
  }
}

TEST(Urdf, ReadsAJointInFull) {
  const auto model = parse(
      with_joint("revolute", std::string("<origin xyz=' 1 -2.5e-1\t+3 ' rpy='0.1 0.2 0.3'/>") +
                                 "<axis xyz='0 0 -2'/>" + kLimit));
  ASSERT_TRUE(model) << model.error().message;
  const Joint& joint = model->joints()[0];
  EXPECT_EQ(joint.type, JointType::kRevolute);
  EXPECT_EQ(joint.axis_J, -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(joint.X_PJ.translation(), Eigen::Vector3d(1, -0.25, 3));
  EXPECT_EQ(joint.limits.lower, -1);
  EXPECT_EQ(joint.limits.upper, 2);
  EXPECT_EQ(joint.limits.velocity, 3);
  EXPECT_EQ(joint.limits.acceleration, std::numeric_limits<double>::infinity());
}

TEST(Urdf, FillsInWhatMayBeAbsent) {
  const auto continuous = parse(with_joint("continuous", "<limit lower='-1' upper='1'/>"));
  ASSERT_TRUE(continuous) << continuous.error().message;
  const Joint& joint = continuous->joints()[0];
  EXPECT_EQ(joint.axis_J, Eigen::Vector3d::UnitX());
  EXPECT_EQ(joint.X_PJ.matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(joint.limits.lower, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(joint.limits.upper, std::numeric_limits<double>::infinity());
  EXPECT_EQ(joint.limits.velocity, std::numeric_limits<double>::infinity());
  const auto finger = parse(with_joint("prismatic", "<limit upper='0.04' velocity='0'/>"));
  ASSERT_TRUE(finger) << finger.error().message;
  EXPECT_EQ(finger->joints()[0].limits.lower, 0);
  EXPECT_EQ(finger->joints()[0].limits.upper, 0.04);
  EXPECT_EQ(finger->joints()[0].limits.velocity, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(parse(with_joint("fixed", "<axis xyz='0 0 0'/><mimic joint='j'/>")));
}

TEST(Urdf, IgnoresElementsOfOthers) {
  const auto model = parse(
      "<?xml version='1.0'?><!-- by hand --><robot name='r' xmlns:xacro='x'><link name='a'>"
      "<self_collide>true</self_collide></link><material name='m'/>"
      "<ros2_control name='c' type='system'><joint name='zz'/></ros2_control>"
      "<gazebo reference='zz'><link name='a'/></gazebo>"
      "<transmission name='t'><joint name='zz'/></transmission><unheard_of/></robot>");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->links().size(), 1u);
}

TEST(Urdf, ReadsNumbersWhateverTheLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale(), new Comma));
  const auto model = parse(with_joint("revolute", "<limit lower='-1.5' upper='2.5'/>"));
  const auto wrong = parse(with_joint("revolute", "<limit lower='-1,5' upper='2,5'/>"));
  std::locale::global(before);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->joints()[0].limits.lower, -1.5);
  expect_error(wrong, ErrorCode::kInvalidInput, {"arm.urdf:7", "-1,5"});
}

struct Malformed {
  const char* what;
  std::string text;
  std::vector<std::string> parts;
  ErrorCode code = ErrorCode::kInvalidInput;
};

void expect_malformed(const std::vector<Malformed>& cases) {
  for (const Malformed& c : cases) {
    SCOPED_TRACE(c.what);
    std::vector<std::string> parts = c.parts;
    parts.push_back("arm.urdf");
    expect_error(parse(c.text), c.code, parts);
  }
}

TEST(Urdf, RejectsMalformedJoints) {
  const std::string limit = kLimit;
  const auto revolute = [&](const std::string& body) { return with_joint("revolute", body); };
  expect_malformed({
      {"no limit", revolute(""), {"arm.urdf:4", "joint 'j'", "<limit>", "continuous"}},
      {"no limit", with_joint("prismatic", ""), {":4:", "joint 'j'", "prismatic", "<limit>"}},
      {"no bounds", revolute("<limit velocity='1'/>"), {":7:", "joint 'j': <limit>", "lower"}},
      {"inverted", revolute("<limit lower='2' upper='1'/>"), {":7:", "lower=\"2\"", "upper=\"1\""}},
      {"inverted, no lower",
       revolute("<limit upper='-2'/>"),
       {":7:", "lower=\"0\"", "upper=\"-2\""}},
      {"inverted, absent", revolute("<limit lower='2'/>"), {":7:", "lower=\"2\"", "upper=\"0\""}},
      {"word", revolute("<limit lower='abc' upper='1'/>"), {":7:", "lower=\"abc\"", "number"}},
      {"empty", revolute("<limit lower='' upper='1'/>"), {":7:", "lower"}},
      {"blank", revolute("<limit lower=' ' upper='1'/>"), {":7:", "lower=\" \"", "number"}},
      {"tail", revolute("<limit lower='1.0.0' upper='1'/>"), {":7:", "1.0.0"}},
      {"NaN", revolute("<limit lower='nan' upper='1'/>"), {":7:", "nan", "finite"}},
      {"infinite", revolute("<limit lower='-inf' upper='1'/>"), {":7:", "-inf", "finite"}},
      {"too large", revolute("<limit lower='-1e999' upper='1'/>"), {":7:", "-1e999"}},
      {"xacro left", revolute("<limit lower='${-pi}' upper='1'/>"), {":7:", "${-pi}"}},
      {"negative speed",
       revolute("<limit lower='0' upper='1' velocity='-1'/>"),
       {":7:", "velocity=\"-1\"", "positive"}},
      {"zero axis", revolute(limit + "\n<axis xyz='0 0 0'/>"), {":8:", "<axis>", "0 0 0"}},
      {"two numbers", revolute(limit + "\n<axis xyz='0 1'/>"), {":8:", "\"0 1\"", "three"}},
      {"four numbers", revolute(limit + "\n<axis xyz='0 1 0 0'/>"), {":8:", "0 1 0 0", "three"}},
      {"far origin",
       revolute(limit + "\n<origin xyz='0 -1e308 0'/>"),
       {":8:", "<origin>", "-1e308", "1e8 m"}},
      {"NaN origin", revolute(limit + "\n<origin xyz='0 nan 0'/>"), {":8:", "<origin>", "nan"}},
      {"NaN angle", revolute(limit + "\n<origin rpy='0 0 inf'/>"), {":8:", "rpy", "inf"}},
      {"quaternion",
       revolute(limit + "\n<origin quat_xyzw='0 0 0 1'/>"),
       {":8:", "quat_xyzw"},
       ErrorCode::kUnsupported},
      {"mimic of nothing",
       revolute(limit + "\n<mimic joint='k'/>"),
       {":8:", "joint 'j'", "no joint 'k'"}},
      {"mimic nameless", revolute(limit + "\n<mimic/>"), {":8:", "attribute joint"}},
      {"mimic of itself", revolute(limit + "\n<mimic joint='j'/>"), {"joint 'j'", "itself"}},
      {"mimic NaN", revolute(limit + "\n<mimic joint='j' multiplier='x'/>"), {":8:", "multiplier"}},
      {"floating",
       with_joint("floating", ""),
       {":4:", "joint 'j'", "floating"},
       ErrorCode::kUnsupported},
      {"planar", with_joint("planar", ""), {":4:", "planar"}, ErrorCode::kUnsupported},
      {"type", with_joint("revolut", ""), {":4:", "revolut", "continuous"}},
      {"no type", "<robot name='r'><link name='a'/><joint name='j'/></robot>", {"attribute type"}},
  });
}

TEST(Urdf, RejectsMalformedTrees) {
  const auto robot = [](const std::string& body) {
    return "<robot name='r'>\n" + body + "</robot>";
  };
  const auto joint = [](const char* name, const char* parent, const char* child) {
    return std::string("<joint name='") + name + "' type='fixed'><parent link='" + parent +
           "'/><child link='" + child + "'/></joint>\n";
  };
  const std::string links = "<link name='a'/>\n<link name='b'/>\n<link name='c'/>\n";
  expect_malformed({
      {"no file", "", {"not well-formed"}},
      {"not XML", "robot", {"not well-formed"}},
      {"open", "<robot name='r'>\n<link name='a'>\n</robot>", {"arm.urdf:2", "not well-formed"}},
      {"another root", "<sdf/>", {"<robot>", "<sdf>"}},
      {"nameless", "<robot><link name='a'/></robot>", {"attribute name"}},
      {"no links", robot(""), {"no links"}},
      {"link nameless", robot("<link/>"), {"arm.urdf:2", "<link>", "attribute name"}},
      {"link name empty", robot("<link name=''/>"), {"arm.urdf:2", "attribute name"}},
      {"link twice",
       robot("<link name='a'/>\n<link name='a'/>"),
       {"arm.urdf:3", "link 'a'", "line 2"}},
      {"joint twice",
       robot(links + joint("j", "a", "b") + joint("j", "b", "c")),
       {"arm.urdf:6", "joint 'j'", "line 5"}},
      {"several roots", robot(links + joint("j", "a", "b")), {"'a' and 'c' are both roots"}},
      {"cycle", robot(links + joint("j", "b", "c") + joint("k", "c", "b")), {"'b'", "cycle"}},
      {"all a cycle",
       robot(links + joint("j", "a", "b") + joint("k", "b", "c") + joint("l", "c", "a")),
       {"cycle"}},
      {"two parents",
       robot(links + joint("j", "a", "b") + joint("k", "c", "b")),
       {"link 'b'", "'j' and 'k'"}},
      {"unknown parent",
       robot(links + joint("j", "aa", "b")),
       {"arm.urdf:5", "joint 'j': <parent>", "no link 'aa'", "did you mean 'a'"}},
      {"no child",
       robot(links + "<joint name='j' type='fixed'><parent link='a'/></joint>"),
       {"arm.urdf:5", "joint 'j'", "<child>"}},
      {"xacro",
       "<robot name='r'>\n<xacro:include filename='x'/></robot>",
       {"arm.urdf:2", "xacro"},
       ErrorCode::kUnsupported},
  });
}

TEST(Urdf, RejectsMalformedLinks) {
  const auto shape = [](const std::string& text) {
    return with_link("<collision>\n<geometry>\n" + text + "\n</geometry>\n</collision>");
  };
  expect_malformed({
      {"no geometry", with_link("<collision/>"), {"arm.urdf:3", "link 'a'", "<geometry>"}},
      {"no shape", shape(""), {":4:", "link 'a': <geometry>", "box", "nothing"}},
      {"capsule",
       shape("<capsule radius='1' length='1'/>"),
       {":4:", "capsule"},
       ErrorCode::kUnsupported},
      {"negative radius", shape("<sphere radius='-1'/>"), {":5:", "radius=\"-1\"", "positive"}},
      {"zero radius", shape("<sphere radius='0'/>"), {":5:", "radius=\"0\"", "positive"}},
      {"no radius", shape("<sphere/>"), {":5:", "<sphere>", "radius"}},
      {"NaN radius", shape("<cylinder radius='nan' length='1'/>"), {":5:", "nan"}},
      {"negative length", shape("<cylinder radius='1' length='-1'/>"), {":5:", "length=\"-1\""}},
      {"flat box", shape("<box size='1 0 1'/>"), {":5:", "1 0 1", "positive"}},
      {"box of two", shape("<box size='1 1'/>"), {":5:", "three"}},
      {"mesh nameless", shape("<mesh/>"), {":5:", "<mesh>", "filename"}},
      {"mesh flat", shape("<mesh filename='x' scale='1 1 0'/>"), {":5:", "scale", "zero"}},
      {"visual too", with_link("<visual><geometry><box/></geometry></visual>"), {":3:", "size"}},
      {"no mass", with_link("<inertial/>"), {":3:", "<inertial>", "<mass>"}},
      {"no inertia", with_link("<inertial><mass value='1'/></inertial>"), {":3:", "<inertia>"}},
      {"negative mass",
       with_link("<inertial><mass value='-1'/><inertia ixx='1' iyy='1' izz='1'/></inertial>"),
       {":3:", "negative"}},
      {"inertia NaN",
       with_link("<inertial><mass value='1'/><inertia ixx='nan' iyy='1' izz='1'/></inertial>"),
       {":3:", "<inertia>", "ixx=\"nan\""}},
  });
}

// Elements are found by a walk of our own through the text, whatever stands between them.
TEST(Urdf, NamesLineAndColumn) {
  const std::string strange =
      "<?xml version='1.0'?><!-- <link name='x'> --><!DOCTYPE robot>\n"
      "<robot name='r'> <gazebo><![CDATA[ <link> ]]></gazebo>\n"
      "  <a note='> <b' other=\"'<c>'\"/> <link name='a'/>";
  expect_malformed({
      {"among others", strange + " <link name='a'/></robot>", {"arm.urdf:3:51: link 'a'"}},
      {"after tabs", strange + "\n\t\t<link/></robot>", {"arm.urdf:4:3: robot 'r': <link>"}},
      {"after carriage returns",
       strange + "\r\n <link/></robot>",
       {"arm.urdf:4:2: robot 'r': <link>"}},
      {"deep",
       strange + "<link name='b'><collision><geometry><box size='1'/>" +
           "</geometry></collision></link></robot>",
       {"arm.urdf:3:86: link 'b': <box>", "size=\"1\""}},
      {"root", "\n <sdf/>", {"arm.urdf:2:2: ", "<sdf>"}},
      {"no XML",
       "<robot name='r'>\n  <link name='a'>\n</robot>",
       {"arm.urdf:2:3: not well-formed"}},
      {"tree",
       strange + "\n  <link name='b'/></robot>",
       {"arm.urdf:4:3: links 'a' and 'b'", "roots"}},
      {"empty tree", "<robot name='r'>\n</robot>", {"arm.urdf:1:1: robot 'r' has no links"}},
  });
}

TEST(Urdf, RefusesWhatIsTooLargeOrTooDeep) {
  std::string many = "<robot name='r'>";
  for (int i = 0; i < 10'001; ++i) many.append("<link name='l").append(std::to_string(i)) += "'/>";
  const std::string deep(100'000, '<');
  std::string nested;
  for (int i = 0; i < 100'000; ++i) nested += "<a>";
  expect_malformed({{"links", many + "</robot>", {"arm.urdf:1:", "over 10000 <link> elements"}},
                    {"brackets", deep, {"not well-formed"}},
                    {"levels", nested, {"not well-formed"}}});
}

TEST(Urdf, ReportsFilesThatCannotBeRead) {
  expect_error(load_urdf("/no/such.urdf"), ErrorCode::kNotFound, {"/no/such.urdf"});
  expect_error(load_urdf(testing::TempDir()), ErrorCode::kIo, {"folder"});
  expect_error(load_urdf("/dev/zero"), ErrorCode::kInvalidInput, {"larger"});  // It never ends.
}

TEST(Urdf, SurvivesDamagedFiles) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  std::ifstream stream(test::robot_path("panda_mbm/panda.urdf"));
  std::ostringstream content;
  content << stream.rdbuf();
  const std::string text = content.str();
  ASSERT_GT(text.size(), 1000u);
  Rng rng(43);
  int refused = 0;
  for (int round = 0; round < 1000; ++round) {
    std::string damaged = text;
    for (std::size_t hits = 1 + rng.index(3); hits > 0; --hits) {
      const std::size_t at = rng.index(damaged.size());
      if (rng.index(4) == 0) {
        damaged.erase(at, rng.index(200));
      } else {
        damaged[at] = static_cast<char>(rng.index(256));
      }
    }
    const auto model = parse_urdf(damaged, "damaged.urdf", "/nowhere");
    if (model) continue;
    ++refused;
    EXPECT_TRUE(model.error().message.starts_with("damaged.urdf:")) << model.error().message;
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace tandem::robot
