#include "tandem/io/problem_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tandem/core/rng.h"
#include "test_data.h"
#include "workcell_files.h"

namespace tandem::io {
namespace {

using pipeline::BenchProblem;
using test::source_path;
using Problems = std::vector<BenchProblem>;

ProblemRobots robot_files(const std::string& name, bool srdf) {
  ProblemRobots robots;
  robots.urdf[""] = source_path("tests/io/problems/" + name + ".urdf");
  if (srdf) robots.srdf[""] = source_path("tests/io/problems/" + name + ".srdf");
  return robots;
}

Problems load(const std::filesystem::path& file, const ProblemRobots& robots) {
  auto problems = load_problems(file, robots);
  if (!problems) throw std::runtime_error(problems.error().message);
  return std::move(*problems);
}

Problems torso_problems() {
  return load(source_path("tests/io/problems/torso_sets.json"), robot_files("torso", true));
}
Problems planar_problems() {
  return load(source_path("tests/io/problems/planar_pairs.json"), robot_files("planar", false));
}

std::shared_ptr<const world::Workcell> cell_of(const BenchProblem& problem) {
  auto cell = problem.cell();
  if (!cell) throw std::runtime_error(cell.error().message);
  return *cell;
}

const geometry::Shape& shape_of(const world::Workcell& cell, const std::string& body) {
  return cell.bodies().at(static_cast<std::size_t>(cell.find_body(body))).shapes_L.at(0);
}

TEST(ProblemSets, AreReadInTheOrderOfNamesWithTheirVerdicts) {
  const Problems problems = torso_problems();
  ASSERT_EQ(problems.size(), 3u);
  const auto said = [&](std::size_t i) {
    return problems[i].set + "/" + problems[i].ends.name + (problems[i].valid ? "" : " invalid");
  };
  EXPECT_EQ(said(0), "crates/1");
  EXPECT_EQ(said(1), "posts/1");
  EXPECT_EQ(said(2), "posts/7 invalid");
}

TEST(ProblemSets, HaveAnArmPerBranchAndTheFilesJointOrderIsTranslated) {
  const Problems problems = torso_problems();
  const auto cell = cell_of(problems[1]);
  ASSERT_EQ(cell->arms().size(), 2u);
  EXPECT_EQ(cell->arms()[0].name, "right");
  EXPECT_EQ(cell->arms()[0].group, "right");
  EXPECT_EQ(cell->arms()[1].name, "left");
  const std::vector<std::string> names{"torso/right_shoulder", "torso/right_elbow",
                                       "torso/left_shoulder", "torso/left_elbow"};
  EXPECT_EQ(cell->joint_names(), names);
  EXPECT_EQ(cell->lower(), Eigen::Vector4d(-2.0, -2.1, -2.2, -2.3));
  EXPECT_EQ(cell->upper(), Eigen::Vector4d(2.0, 2.1, 2.2, 2.3));
  EXPECT_EQ(cell->limits()[0].velocity, 1.5);  // The URDF's.
  EXPECT_EQ(cell->limits()[0].acceleration, kAssumedAcceleration);
  EXPECT_EQ(problems[1].ends.start, Eigen::Vector4d(-0.9, 0.1, 0.9, -0.1));
  EXPECT_EQ(problems[1].ends.goal, Eigen::Vector4d(0.1, 0.2, -0.1, -0.2));
  const auto query = pipeline::resolve(cell, cell->query("1"));
  ASSERT_TRUE(query) << query.error().message;
  EXPECT_EQ(query->start, problems[1].ends.start);
  EXPECT_EQ(query->goal, problems[1].ends.goal);
}

TEST(ProblemSets, WithoutAnSrdfArmsAreChains) {
  const Problems problems =
      load(source_path("tests/io/problems/torso_sets.json"), robot_files("torso", false));
  const auto cell = cell_of(problems[0]);
  ASSERT_EQ(cell->arms().size(), 2u);
  EXPECT_EQ(cell->arms()[0].name, "right_fore");
  EXPECT_EQ(cell->joint_names()[2], "torso/left_shoulder");
}

TEST(ProblemSets, ObstaclesAreModelledAsTheSetSays) {
  const Problems problems = torso_problems();
  const auto crates = cell_of(problems[0]), posts = cell_of(problems[1]);
  const geometry::Shape& post = shape_of(*posts, "post");
  EXPECT_EQ(post.type(), geometry::CoreType::kSegment);
  EXPECT_EQ(post.radius(), 0.05);
  EXPECT_NEAR(post.bounding_radius(), 0.25, 1e-12);
  const geometry::Shape& can = shape_of(*crates, "can");
  EXPECT_EQ(can.type(), geometry::CoreType::kBox);
  EXPECT_NEAR(can.volume(), 0.1 * 0.1 * 0.4, 1e-12);
  // Turned about y by 2 acos(0.8): the can's axis.
  const Eigen::Vector3d axis(0.96, 0, 0.28);
  EXPECT_NEAR(can.support(axis).dot(axis) - Eigen::Vector3d(0.8, 0.1, 0.7).dot(axis), 0.2, 1e-12);
  EXPECT_NEAR(shape_of(*posts, "shelf").volume(), 0.2 * 0.3 * 0.1, 1e-12);
  EXPECT_EQ(shape_of(*cell_of(problems[2]), "ball").type(), geometry::CoreType::kPoint);
}

TEST(ProblemSets, FixedJointsStandWhereAsked) {
  ProblemRobots robots = robot_files("torso", true);
  robots.joints["neck"] = 0.5;
  const auto file = source_path("tests/io/problems/torso_sets.json");
  const auto cell = cell_of(load(file, robots).front());
  EXPECT_EQ(cell->spec().robots[0].fixed_positions.at("neck"), 0.5);
  robots.joints["nek"] = 0.5;
  const auto refused = load_problems(file, robots);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("did you mean 'neck'?"), std::string::npos);
}

TEST(PosePairs, ArePlacedRobotsWithWhatTheyCarry) {
  const Problems problems = planar_problems();
  ASSERT_EQ(problems.size(), 3u);
  EXPECT_EQ(problems[1].set, "facing");
  EXPECT_EQ(problems[1].ends.name, "away -> home");
  EXPECT_EQ(problems[1].ends.start, Eigen::Vector4d(-1.2, -0.3, 1.3, 0.4));
  EXPECT_EQ(problems[1].ends.goal, Eigen::Vector4d(1.2, 0.3, -1.2, -0.3));
  const auto cell = cell_of(problems[1]);
  ASSERT_EQ(cell->arms().size(), 2u);
  EXPECT_EQ(cell->arms()[1].name, "planar1");
  EXPECT_EQ(cell->joint_names()[2], "planar1/planar_joint1");
  EXPECT_EQ(cell->upper(), Eigen::Vector4d(2.8, 2.5, 2.8, 2.5));
  EXPECT_EQ(cell->limits()[0].velocity, kAssumedVelocity);  // The URDF has none.
  const world::Body& rod = cell->bodies().at(static_cast<std::size_t>(cell->find_body("rod")));
  EXPECT_EQ(rod.kind, world::Body::Kind::kAttached);
  EXPECT_EQ(cell->model().links()[static_cast<std::size_t>(rod.link)].name, "planar0/planar_hand");
  EXPECT_EQ(rod.shapes_L[0].type(), geometry::CoreType::kCylinder);
  // The file's hand opens its fingers; the robot without a hand in the file has them closed.
  EXPECT_EQ(cell->spec().robots[0].fixed_positions.at("planar_grip"), 0.03);
  EXPECT_TRUE(cell->spec().robots[1].fixed_positions.empty());
  EXPECT_GE(cell->find_body("wall"), 0);
}

TEST(PosePairs, ModelsMayHaveFilesOfTheirOwn) {
  ProblemRobots robots;
  robots.urdf["planar"] = source_path("tests/io/problems/planar.urdf");
  const auto file = source_path("tests/io/problems/planar_pairs.json");
  EXPECT_TRUE(load_problems(file, robots));
  robots.urdf = {{"other", source_path("tests/io/problems/planar.urdf")}};
  const auto refused = load_problems(file, robots);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("planar_pairs.json:5:32: robots[0].model: there is no "
                                         "URDF for robot model 'planar'"),
            std::string::npos)
      << refused.error().message;
}

/// One change of a fixture file, the text at which the refusal stands, and what it says.
struct Damage {
  const char* file;
  const char* from;
  const char* to;
  const char* at;
  const char* says;
};

void PrintTo(const Damage& damage, std::ostream* out) {
  *out << damage.file << ": " << damage.from << " -> " << damage.to;
}

/// ":LINE:COLUMN: " of a byte.
std::string place(const std::string& text, std::size_t at) {
  int line = 1, column = 1;
  for (std::size_t i = 0; i < at; ++i) {
    column = text[i] == '\n' ? 1 : column + 1;
    line += text[i] == '\n';
  }
  std::stringstream text_of_place;
  text_of_place << ":" << line << ":" << column << ": ";
  return text_of_place.str();
}

class DamagedProblems : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedProblems, AreRefusedWithPlaceAndReason) {
  const test::TemporaryFolder folder;
  const Damage& damage = GetParam();
  const std::string name = damage.file;
  std::string text = test::read_text(source_path("tests/io/problems/" + name + ".json"));
  const std::size_t from = text.find(damage.from);
  ASSERT_NE(from, std::string::npos);
  text.replace(from, std::string(damage.from).size(), damage.to);
  const std::size_t at = text.find(damage.at);
  ASSERT_NE(at, std::string::npos);
  const auto file = folder.write(name + ".json", text);
  const bool sets = name == "torso_sets";
  const auto problems = load_problems(file, robot_files(sets ? "torso" : "planar", sets));
  ASSERT_FALSE(problems);
  const std::string& message = problems.error().message;
  EXPECT_TRUE(message.starts_with(file.string() + place(text, at)))
      << message << "\nshould stand at " << place(text, at);
  EXPECT_NE(message.find(damage.says), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    Sets, DamagedProblems,
    ::testing::Values(
        Damage{"torso_sets", "\"robot\"", "\"robo\"", "\"robo\"", "did you mean 'robot'?"},
        Damage{"torso_sets", "\"right_elbow\"", "\"right_elbw\"", "\"right_elbw\"",
               "joints[1]: robot 'torso' has no movable joint 'right_elbw'; did you mean"},
        Damage{"torso_sets", "\"right_elbow\"", "\"spine\"", "\"spine\"", "no movable joint"},
        Damage{"torso_sets", "right_elbow\"", "right_shoulder\"", "\"right_shoulder\", \"left",
               "stands twice"},
        Damage{"torso_sets", "[-2.0, -2.1, ", "[-2.0, 2.2, ", "2.2, -2.2", "lower[1] is 2.2"},
        Damage{"torso_sets", "-2.2, -2.3]", "-2.2]", "[-2.0", "lower is a list of 3"},
        Damage{"torso_sets", "\"capsule\"", "\"ball\"", "\"ball\"",
               "sets.posts.cylinder_as is \"ball\", expected capsule, box or cylinder"},
        Damage{"torso_sets", "\"valid\": true", "\"valid\": 1", "1, \"start", "true or false"},
        Damage{"torso_sets", "[[0.1, 0.2, -0.1, -0.2]]", "[]", "[],", "exactly one goal"},
        Damage{"torso_sets", "[[0.1, 0.2", "[[0.1", "[0.1,", "list of 3, expected 4 numbers"},
        Damage{"torso_sets", "\"radius\": 0.05", "\"radius\": -0.05", "-0.05,",
               "radius is -0.05, expected a number above 0"},
        Damage{"torso_sets", "\"length\"", "\"lenght\"", "\"lenght\"", "'length'"},
        Damage{"torso_sets", "[0, 0, 0.6, 0.8]", "[0, 0, 0.6, 0.9]", "[0, 0, 0.6, 0.9]",
               "the quaternion has length 1.08"},
        Damage{"torso_sets", "[0, 0, 0.6, 0.8]", "[0, 0, 0, 0]", "[0, 0, 0, 0]", "length 0.0"},
        Damage{"torso_sets", "\"box\", \"position", "\"cone\", \"position", "\"cone\"",
               "box, cylinder or sphere"},
        Damage{"torso_sets", "[0.2, 0.3, 0.1]", "[0.2, 0, 0.1]", "0, 0.1]", "size[1] is 0"},
        Damage{"torso_sets", "\"shelf\"", "\"post\"", "\"post\", \"type\": \"box",
               "no other obstacle of the problem"},
        Damage{"torso_sets", "\"index\": 7", "\"index\": 1", "1, \"valid\": false",
               "no other problem of the set"},
        Damage{"torso_sets", "\"index\": 7", "\"index\": 7, \"index\": 8", "\"index\": 8", "twice"},
        Damage{"torso_sets", "0.45, 0.75", "0.45, 1e999", ", 0.4], \"quat", "1e999"},
        Damage{"torso_sets", "0.45, 0.75", "0.45, NaN", "NaN", "not JSON"},
        Damage{"torso_sets", "}}}\n", "}}\n#", "#", "not JSON"}));

INSTANTIATE_TEST_SUITE_P(
    Pairs, DamagedProblems,
    ::testing::Values(
        Damage{"planar_pairs", "\"planar1\", \"model\"", "\"planar0\", \"model\"",
               "\"planar0\", \"model\": \"planar\", \"base\": {\"xyz\": [0.7", "no other robot"},
        Damage{"planar_pairs", "\"planar0_joint1\"", "\"joint1\"", "\"joint1\"",
               "a name that begins with the robot's, planar0"},
        Damage{"planar_pairs", "\"planar0_joint1\"", "\"planar0_joint3\"", "\"planar0_joint3\"",
               "no movable joint 'planar_joint3'"},
        Damage{"planar_pairs", "\"link\": \"planar_hand\"", "\"link\": \"planar_palm\"",
               "\"planar_palm\"", "the robot has no link 'planar_palm'"},
        Damage{"planar_pairs", "\"xyz\": [0.32, 0, 0]", "\"xyz\": [0.3, 0, 0]",
               "{\"xyz\": [0.3, 0, 0]", "holds the hand in another pose; give a URDF"},
        Damage{"planar_pairs", "_each\": 0.03", "_each\": 0.05", "{\n \"name", "planar_grip"},
        Damage{"planar_pairs", "\"x\": 0.1", "\"x\": 0", "0, \"y\"", "obstacles[0].size.x is 0"},
        Damage{"planar_pairs", "[1.2, 0.3]", "[1.2]", "[1.2]", "poses.home.planar0 is a list of 1"},
        Damage{"planar_pairs", "\"planar1\": [-1.2, -0.3]", "\"planar2\": [-1.2, -0.3]",
               "\"planar2\"", "unknown key poses.home.planar2"},
        Damage{"planar_pairs", "[\"home\", \"away\"]", "[\"home\", \"hom\"]", "\"hom\"",
               "pairs[0][1]: there is no pose 'hom'; did you mean 'home'?"},
        Damage{"planar_pairs", "[\"home\", \"away\"]", "[\"home\"]", "[\"home\"]", "two poses"},
        Damage{"planar_pairs", "\"pairs\":", "\"sets\":", "\"limits\"", "unknown key limits"},
        Damage{"planar_pairs", "[-2.8, -2.5]", "[-2.8]", "[-2.8]", "lower is a list of 1"}));

TEST(ProblemFile, HostileTextIsRefusedOrReadButNeverFatal) {
  const test::TemporaryFolder folder;
  Rng rng(3);
  int refused = 0;
  for (const char* name : {"torso_sets", "planar_pairs"}) {
    const bool sets = std::string(name) == "torso_sets";
    const auto robots = robot_files(sets ? "torso" : "planar", sets);
    const std::string text =
        test::read_text(source_path("tests/io/problems/" + std::string(name) + ".json"));
    for (int i = 0; i < 150; ++i) {
      std::string changed = text;
      changed[rng.index(text.size())] = static_cast<char>(rng.index(256));
      if (i % 3 == 0) changed.resize(rng.index(text.size() - 2));
      refused += !load_problems(folder.write("p.json", changed), robots);
    }
  }
  EXPECT_GT(refused, 150);
  for (const std::string& text :
       {std::string(1000000, '['), std::string("{\"sets\":") + std::string(100000, '{'),
        std::string(), std::string("null"), std::string("[]"), std::string("{}")}) {
    const auto problems = load_problems(folder.write("p.json", text), robot_files("torso", true));
    ASSERT_FALSE(problems);
    EXPECT_EQ(problems.error().code, ErrorCode::kInvalidInput);
  }
  const auto missing = load_problems(folder / "none.json", {});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
}

TEST(ProblemFile, NeedsItsRobots) {
  const auto file = source_path("tests/io/problems/torso_sets.json");
  const auto none = load_problems(file, {});
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("no URDF for robot model 'torso'"), std::string::npos);
  const auto gone = load_problems(file, {{{"", "gone.urdf"}}, {}, {}, {}});
  ASSERT_FALSE(gone);
  EXPECT_NE(gone.error().message.find("gone.urdf"), std::string::npos);
}

}  // namespace
}  // namespace tandem::io
