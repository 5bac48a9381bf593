#include "tandem/server/scene.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "small_cell.h"
#include "tandem/collision/ssv_checker.h"
#include "tandem/core/rng.h"
#include "tandem/io/workcell_yaml.h"
#include "tandem/motion/motion.h"
#include "tandem/pipeline/plan.h"
#include "test_data.h"

namespace tandem::server {
namespace {

using nlohmann::json;
using Cell = std::shared_ptr<const world::Workcell>;

double at(const json& list, std::size_t i) { return list.at(i).get<double>(); }

Eigen::Vector3d vector_of(const json& v) { return {at(v, 0), at(v, 1), at(v, 2)}; }

Eigen::Isometry3d pose_of(const json& pose) {
  const json& u = pose.at("quat_wxyz");
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = Eigen::Quaterniond(at(u, 0), at(u, 1), at(u, 2), at(u, 3)).toRotationMatrix();
  X.translation() = vector_of(pose.at("xyz"));
  return X;
}

/// Link poses as a page that knows nothing but the scene finds them.
std::vector<Eigen::Isometry3d> poses_by_scene(const json& scene, const Eigen::VectorXd& q) {
  std::vector<Eigen::Isometry3d> X_WL;
  for (const json& link : scene.at("links")) {
    if (!link.contains("joint")) {
      X_WL.push_back(Eigen::Isometry3d::Identity());
      continue;
    }
    const json& joint = link.at("joint");
    const int entry = joint.at("entry");
    const double value = joint.at("offset").get<double>() +
                         (entry < 0 ? 0.0 : joint.at("multiplier").get<double>() * q[entry]);
    Eigen::Isometry3d X_JL = Eigen::Isometry3d::Identity();
    const std::string type = joint.at("type");
    const Eigen::Vector3d axis = vector_of(joint.at("axis"));
    if (type == "prismatic") X_JL.translation() = value * axis;
    if (type == "revolute" || type == "continuous") {
      X_JL.linear() = Eigen::AngleAxisd(value, axis).toRotationMatrix();
    }
    const std::size_t parent = link.at("parent");
    X_WL.push_back(X_WL.at(parent) * pose_of(joint.at("pose")) * X_JL);
  }
  return X_WL;
}

Eigen::VectorXd random_q(const world::Workcell& cell, Rng& rng) {
  Eigen::VectorXd q(cell.dof());
  for (int j = 0; j < cell.dof(); ++j) {
    q[j] = rng.uniform(std::max(cell.lower()[j], -6.0), std::min(cell.upper()[j], 6.0));
  }
  return q;
}

void expect_poses(const Cell& cell) {
  const json scene = json::parse(describe_scene(*cell).json);
  ASSERT_EQ(scene.at("links").size(), cell->model().links().size());
  Rng rng(7);
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  for (int round = 0; round < 50; ++round) {
    const Eigen::VectorXd q = random_q(*cell, rng);
    cell->forward_kinematics(q, positions, X_WL);
    const auto by_scene = poses_by_scene(scene, q);
    for (std::size_t i = 0; i < X_WL.size(); ++i) {
      EXPECT_LT((by_scene[i].matrix() - X_WL[i].matrix()).norm(), 1e-12)
          << cell->model().links()[i].name;
    }
    for (std::size_t i = 0; i < cell->arms().size(); ++i) {
      const json& arm = scene.at("arms").at(i);
      const Eigen::Isometry3d X_WE =
          by_scene.at(arm.at("tip_link").get<std::size_t>()) * pose_of(arm.at("tool"));
      EXPECT_LT((X_WE.matrix() - cell->tool_pose(static_cast<int>(i), X_WL).matrix()).norm(),
                1e-12);
    }
  }
}

Cell load(const std::string& file, const std::vector<std::filesystem::path>& packages = {}) {
  auto cell = io::load_workcell(test::source_path(file), packages);
  EXPECT_TRUE(cell) << (cell ? "" : cell.error().message);
  return cell ? *cell : nullptr;
}

TEST(Scene, PosesOfLinksAndToolsAreTheCells) {
  expect_poses(test::small_cell());
  expect_poses(load("tests/apps/cell/workcell.yaml"));
  // With joints that no arm moves, and joints that follow others.
  expect_poses(load("scenarios/gearbox/workcell.yaml"));
}

TEST(Scene, MovedMimicsAndFixedPositionsKeepTheirDrive) {
  std::vector<robot::Link> links(5);
  std::vector<robot::Joint> joints(4);
  for (std::size_t i = 0; i < links.size(); ++i) {
    links[i].name = std::string("link") + std::to_string(i);
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    joints[i].name = "joint" + std::to_string(i);
    joints[i].type = i == 2 ? robot::JointType::kPrismatic : robot::JointType::kRevolute;
    joints[i].parent_link = static_cast<int>(i);
    joints[i].child_link = static_cast<int>(i) + 1;
    joints[i].axis_J = Eigen::Vector3d(0.3, 1, static_cast<double>(i)).normalized();
    joints[i].X_PJ.translation() = Eigen::Vector3d(0.1, 0.2, 0.3);
    joints[i].limits = {-1, 2, 1, 1};
  }
  joints[1].mimic = robot::Mimic{0, -0.5, 0.2};  // Follows an arm's joint.
  joints[3].mimic = robot::Mimic{2, 2.0, -0.1};  // Follows a joint that no arm moves.
  world::WorkcellSpec spec;
  spec.name = "mimics";
  world::RobotSpec robot;
  robot.name = "r";
  robot.model = *robot::Model::make("r", links, joints);
  robot.fixed_positions["joint2"] = 0.7;
  robot::Group group;
  group.name = "g";
  group.joints = {robot.model.find_joint("joint0")};
  group.tip_link = robot.model.find_link("link4");
  robot.semantics.groups = {group};
  spec.robots = {robot};
  spec.arms = {{"a", "r", "g", "", Eigen::Isometry3d::Identity()}};
  const auto cell = world::Workcell::make(std::move(spec));
  ASSERT_TRUE(cell) << cell.error().message;
  expect_poses(*cell);
}

TEST(Scene, BodiesHaveTheirShapes) {
  const Cell cell = test::small_cell();
  const json scene = json::parse(describe_scene(*cell).json);
  ASSERT_EQ(scene.at("bodies").size(), cell->bodies().size());
  for (std::size_t i = 0; i < cell->bodies().size(); ++i) {
    const world::Body& body = cell->bodies()[i];
    const json& shown = scene.at("bodies").at(i);
    EXPECT_EQ(shown.at("name"), body.name);
    EXPECT_EQ(shown.at("link"), body.link);
    EXPECT_EQ(shown.at("padding"), body.padding);
    EXPECT_EQ(shown.at("kind"), body.kind == world::Body::Kind::kObstacle ? "obstacle" : "robot");
    ASSERT_EQ(shown.at("shapes").size(), body.shapes_L.size());
    for (std::size_t k = 0; k < body.shapes_L.size(); ++k) {
      const geometry::Shape& shape = body.shapes_L[k];
      const json& s = shown.at("shapes").at(k);
      EXPECT_EQ(s.at("core"), geometry::to_string(shape.type()));
      EXPECT_EQ(vector_of(s.at("origin")), shape.origin());
      for (int u = 0; u < 3; ++u) {
        EXPECT_EQ(vector_of(s.at("extents").at(static_cast<std::size_t>(u))),
                  shape.extents().col(u));
      }
      EXPECT_EQ(s.at("radius"), shape.radius());
      EXPECT_EQ(s.at("core_radius"), shape.core_radius());
    }
  }
}

TEST(Scene, QueriesAreThoseOfAllLists) {
  auto spec = test::small_cell_spec();
  spec.lists = {{"tidy", {spec.queries[0]}}};
  const Cell cell = *world::Workcell::make(spec);
  EXPECT_EQ(json::parse(describe_scene(*cell).json).at("queries"),
            json({"cross", "back", "tidy/cross"}));
}

TEST(Scene, JointsHaveTheirLimitsAndNullForNone) {
  const Cell cell = test::small_cell();
  const json scene = json::parse(describe_scene(*cell).json);
  ASSERT_EQ(scene.at("joints").size(), 8U);
  EXPECT_EQ(scene.at("joints").at(0).at("name"), "left/joint1");
  EXPECT_EQ(scene.at("joints").at(0).at("lower"), -2.5);
  EXPECT_EQ(scene.at("joints").at(0).at("velocity"), 2.0);
  EXPECT_TRUE(scene.at("joints").at(0).at("jerk").is_null());
  EXPECT_EQ(scene.at("queries"), json({"cross", "back"}));
  EXPECT_EQ(scene.at("arms").at(1).at("first"), 4);
  EXPECT_EQ(scene.at("arms").at(1).at("dof"), 4);
}

/// What a page reads out of base64.
template <class Number>
std::vector<Number> numbers_of(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    bits = bits << 6 | static_cast<unsigned>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255);
  }
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

TEST(Scene, SurfacesAreTypedArrays) {
  const std::vector<Eigen::Vector3d> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.25}, {-3, 0.1, 7}};
  const std::vector<std::array<int, 3>> triangles = {{0, 1, 2}, {3, 2, 1}};
  Eigen::Isometry3d X_WS = Eigen::Isometry3d::Identity();
  X_WS.translation() = Eigen::Vector3d(4, 5, 6);
  X_WS.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  world::WorkcellSpec spec = test::small_cell_spec();
  spec.obstacles.push_back({"scan", {}});
  spec.obstacles.back().surfaces_W = {{*geometry::Surface::mesh(points, triangles, 0.01), X_WS},
                                      {*geometry::Surface::cloud(points, 0.02), X_WS}};
  const auto cell = world::Workcell::make(std::move(spec));
  ASSERT_TRUE(cell) << cell.error().message;
  const json scene = json::parse(describe_scene(**cell).json);
  const json& surfaces = scene.at("bodies").back().at("surfaces");
  ASSERT_EQ(surfaces.size(), 2U);
  for (const json& surface : surfaces) {
    EXPECT_LT((pose_of(surface.at("pose")).matrix() - X_WS.matrix()).norm(), 1e-12);
    const auto vertices = numbers_of<float>(surface.at("vertices"));
    ASSERT_EQ(vertices.size(), 12U);
    for (std::size_t i = 0; i < 12; ++i) {
      EXPECT_EQ(vertices[i], static_cast<float>(points[i / 3][static_cast<Eigen::Index>(i % 3)]));
    }
  }
  EXPECT_EQ(surfaces.at(0).at("radius"), 0.01);
  EXPECT_EQ(numbers_of<std::uint32_t>(surfaces.at(0).at("triangles")),
            (std::vector<std::uint32_t>{0, 1, 2, 3, 2, 1}));
  EXPECT_EQ(surfaces.at(1).at("radius"), 0.02);
  EXPECT_FALSE(surfaces.at(1).contains("triangles"));
  EXPECT_TRUE(scene.at("bodies").at(0).at("surfaces").empty());
}

Eigen::VectorXd home_of(const Cell& cell) {
  const auto values = json::parse(describe_scene(*cell).json).at("home").get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), std::ssize(values));
}

TEST(Scene, HomeIsWhereTheFirstQueryStarts) {
  for (const Cell& cell : {test::small_cell(), load("scenarios/gearbox/workcell.yaml")}) {
    const auto ends = pipeline::resolve(cell, cell->queries().front());
    ASSERT_TRUE(ends);
    EXPECT_EQ(home_of(cell), ends->start);
  }
}

TEST(Scene, HomeWithoutQueriesIsInsideTheLimits) {
  world::WorkcellSpec spec = test::small_cell_spec();
  spec.queries.clear();
  for (world::RobotSpec& robot : spec.robots) {
    auto joints = robot.model.joints();
    for (robot::Joint& joint : joints) joint.limits.lower = 0.25;
    robot.model = *robot::Model::make("small_arm", robot.model.links(), joints);
  }
  const auto cell = world::Workcell::make(std::move(spec));
  ASSERT_TRUE(cell) << cell.error().message;
  EXPECT_EQ(home_of(*cell), Eigen::VectorXd::Constant((*cell)->dof(), 0.25));
}

TEST(Scene, NamesThatAreNoTextAreShownAllTheSame) {
  world::WorkcellSpec spec = test::small_cell_spec();
  spec.name = "caf\xe9";
  const auto cell = world::Workcell::make(std::move(spec));
  ASSERT_TRUE(cell);
  EXPECT_EQ(json::parse(describe_scene(**cell).json).at("name"), "caf\xef\xbf\xbd");
}

TEST(Scene, MeshesOfFoundPackagesAreListedOnceAndOthersLeftOut) {
  TANDEM_SKIP_WITHOUT_DATA("robots/packages");
  robot::Link base;
  base.name = "base";
  const std::string file =
      test::data_path("robots/packages/moveit_resources_panda_description").string();
  base.visual.push_back({Eigen::Isometry3d::Identity(), robot::MeshGeometry{"a", file}});
  base.visual.push_back({Eigen::Isometry3d::Identity(), robot::MeshGeometry{"b", file}});
  base.visual.push_back({Eigen::Isometry3d::Identity(), robot::MeshGeometry{"package://x", ""}});
  base.visual.push_back({Eigen::Isometry3d::Identity(), robot::SphereGeometry{0.25}});
  world::WorkcellSpec spec = test::small_cell_spec();
  spec.robots.push_back(spec.robots.front());
  spec.robots.back().name = "third";
  spec.robots.back().semantics = {};
  spec.robots.back().volumes.clear();
  spec.robots.back().model = *robot::Model::make("third", {base}, {});
  spec.robots.back().X_WB.translation() = Eigen::Vector3d(0, 0, 5);
  const auto cell = world::Workcell::make(std::move(spec));
  ASSERT_TRUE(cell) << cell.error().message;
  const Scene scene = describe_scene(**cell);
  const json visuals = json::parse(scene.json).at("visuals");
  ASSERT_EQ(visuals.size(), 3U);
  EXPECT_EQ(scene.meshes, std::vector<std::filesystem::path>{file});
  EXPECT_EQ(visuals.at(0).at("mesh").at("index"), 0);
  EXPECT_EQ(visuals.at(1).at("mesh").at("index"), 0);
  EXPECT_EQ(visuals.at(2).at("sphere"), 0.25);
}

TEST(Clearance, IsTheCheckersAtEverySampleAndAtTheEnd) {
  const Cell cell = test::small_cell();
  const auto ends = pipeline::resolve(cell, cell->query("cross"));
  ASSERT_TRUE(ends);
  const motion::StraightEdge edge(ends->start, ends->goal);  // Takes 1 s.
  const json samples = json::parse(describe_clearance(collision::CompiledCell(cell), edge, 7.5));
  ASSERT_EQ(samples.size(), 9U);
  const collision::SsvChecker checker(cell);
  const auto scratch = checker.make_scratch();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = std::min(static_cast<double>(i) / 7.5, 1.0);
    const json& sample = samples.at(i);
    EXPECT_NEAR(sample.at("t").get<double>(), t, 1e-12);
    const auto nearest =
        checker.least_clearance(edge.at(t).q, cell->select(world::PairScope::all()), *scratch);
    EXPECT_NEAR(sample.at("distance").get<double>(), nearest.distance, 1e-9);
    EXPECT_EQ(sample.at("pair"), cell->describe_pair(nearest.pair));
    const Eigen::Vector3d a = vector_of(sample.at("a")), b = vector_of(sample.at("b"));
    EXPECT_NEAR((a - b).norm(), std::abs(nearest.distance), 1e-6);
  }
}

TEST(Clearance, LongMotionsHaveABoundedNumberOfSamples) {
  const Cell cell = test::small_cell();
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(cell->dof());
  const motion::StraightEdge edge(q, q);
  const json samples = json::parse(describe_clearance(collision::CompiledCell(cell), edge, 1e9));
  EXPECT_EQ(samples.size(), 2001U);
  EXPECT_EQ(samples.back().at("t"), 1.0);
}

}  // namespace
}  // namespace tandem::server
