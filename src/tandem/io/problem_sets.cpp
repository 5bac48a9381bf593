#include <algorithm>
#include <set>

#include "tandem/io/problem_robots.h"

namespace tandem::io {

namespace {

using geometry::Shape;
using pipeline::BenchProblem;

/// What a set says a cylinder stands for.
enum class CylinderAs { kCylinder, kCapsule, kBox };

CylinderAs read_cylinder_as(const JsonReader& value) {
  const std::string name = value.text();
  if (name == "capsule") return CylinderAs::kCapsule;
  if (name == "box") return CylinderAs::kBox;
  if (name != "cylinder") value.refuse("capsule, box or cylinder");
  return CylinderAs::kCylinder;
}

Result<Shape> make_cylinder(const Eigen::Isometry3d& X_WO, double radius, double length,
                            CylinderAs as) {
  const Eigen::Vector3d half = 0.5 * length * X_WO.linear().col(2), center = X_WO.translation();
  switch (as) {
    case CylinderAs::kCapsule:
      return Shape::capsule(center - half, center + half, radius);
    case CylinderAs::kBox:
      return Shape::box(X_WO, {2 * radius, 2 * radius, length});
    case CylinderAs::kCylinder:
      break;
  }
  return Shape::cylinder(X_WO, radius, length);
}

Eigen::Vector3d read_size(const JsonReader& list) {
  for (const JsonReader& edge : list.items()) edge.positive();
  return list.vector(3, "edge lengths along x, y, z");
}

world::ObstacleSpec read_obstacle(const JsonReader& object, CylinderAs as) {
  const std::string type = object["type"].text();
  std::vector<std::string> keys{"name", "type", "position", "quat_xyzw"};
  if (type == "box") {
    keys.push_back("size");
  } else if (type == "sphere") {
    keys.push_back("radius");
  } else if (type == "cylinder") {
    keys.insert(keys.end(), {"radius", "length"});
  } else {
    object["type"].refuse("box, cylinder or sphere");
  }
  object.expect_keys(keys);
  const Eigen::Isometry3d X_WO = read_placement(object["position"], object["quat_xyzw"], true);
  const Result<Shape> shape =
      type == "box" ? Shape::box(X_WO, read_size(object["size"]))
      : type == "sphere"
          ? Shape::sphere(X_WO.translation(), object["radius"].positive())
          : make_cylinder(X_WO, object["radius"].positive(), object["length"].positive(), as);
  if (!shape) object.complain(shape.error().message);
  return {object["name"].name(), {*shape}, object.where()};
}

/// Refuses a second obstacle of one name: a cell could not tell them apart.
std::vector<world::ObstacleSpec> read_obstacles(const JsonReader& list, CylinderAs as) {
  std::vector<world::ObstacleSpec> obstacles;
  for (const JsonReader& item : list.items()) {
    world::ObstacleSpec obstacle = read_obstacle(item, as);
    if (std::ranges::find(obstacles, obstacle.name, &world::ObstacleSpec::name) !=
        obstacles.end()) {
      item["name"].refuse("a name that no other obstacle of the problem has");
    }
    obstacles.push_back(std::move(obstacle));
  }
  return obstacles;
}

BenchProblem read_problem(const JsonReader& object, const std::string& set, CylinderAs as,
                          const std::shared_ptr<const ProblemCell>& cell) {
  object.expect_keys({"index", "valid", "start", "goals", "obstacles"},
                     {"start_valid", "goal_valid"});
  for (const char* key : {"start_valid", "goal_valid"}) {
    if (object.has(key)) object[key].boolean();
  }
  const std::vector<JsonReader> goals = object["goals"].items();
  if (goals.size() != 1) object["goals"].refuse("exactly one goal configuration");
  const auto configuration = [&](const JsonReader& q) {
    return cell->configuration(q.vector(cell->dof(), "one per joint"));
  };
  BenchProblem problem;
  problem.set = set;
  problem.valid = object["valid"].boolean();
  problem.ends = {std::to_string(object["index"].count()), configuration(object["start"]),
                  configuration(goals.front())};
  problem.cell = [cell, ends = problem.ends, obstacles = read_obstacles(object["obstacles"], as)] {
    return cell->with(obstacles, ends);
  };
  return problem;
}

std::shared_ptr<const ProblemCell> read_cell(const JsonReader& root, const ProblemRobots& files) {
  const JsonReader list = root["joints"];
  std::vector<std::string> names;
  for (const JsonReader& joint : list.items()) names.push_back(joint.name());
  const std::string name = root["robot"].name();
  world::WorkcellSpec spec;
  spec.name = name;
  spec.robots.push_back(RobotLibrary(files).robot(root["robot"], name));
  world::RobotSpec& robot = spec.robots.back();
  const std::vector<int> joints = find_joints(list, names, robot.model);
  set_limits(joints, read_position_limits(root, static_cast<Eigen::Index>(joints.size())),
             robot.model);
  spec.arms = arms_of(list, joints, robot);
  for (std::string& joint : names) joint.insert(0, robot.name + "/");
  return std::make_shared<const ProblemCell>(root, std::move(spec), names);
}

}  // namespace

std::vector<BenchProblem> read_problem_sets(const JsonReader& root, const ProblemRobots& robots) {
  root.expect_keys({"robot", "joints", "lower", "upper", "sets"});
  const auto cell = read_cell(root, robots);
  std::vector<BenchProblem> problems;
  for (const std::string& name : root["sets"].keys()) {
    const JsonReader set = root["sets"][name];
    set.expect_keys({"cylinder_as", "problems"});
    const CylinderAs as = read_cylinder_as(set["cylinder_as"]);
    std::set<std::string> seen;
    for (const JsonReader& item : set["problems"].items()) {
      problems.push_back(read_problem(item, name, as, cell));
      if (!seen.insert(problems.back().ends.name).second) {
        item["index"].refuse("a number that no other problem of the set has");
      }
    }
  }
  return problems;
}

}  // namespace tandem::io
