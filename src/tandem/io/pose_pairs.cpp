#include <algorithm>

#include "tandem/core/names.h"
#include "tandem/io/problem_robots.h"

namespace tandem::io {

namespace {

using geometry::Shape;
using pipeline::BenchProblem;

Eigen::Isometry3d read_pose(const JsonReader& object) {
  object.expect_keys({"xyz", "quat_wxyz"});
  return read_placement(object["xyz"], object["quat_wxyz"], false);
}

/// The shape in the keys shape, size and pose.
Shape read_shape(const JsonReader& object) {
  const std::string kind = object["shape"].text();
  const JsonReader size = object["size"];
  const Eigen::Isometry3d X = read_pose(object["pose"]);
  const auto edge = [&size](const char* key) { return size[key].positive(); };
  const auto made = [&]() -> Result<Shape> {
    if (kind == "box") {
      size.expect_keys({"x", "y", "z"});
      return Shape::box(X, {edge("x"), edge("y"), edge("z")});
    }
    if (kind == "cylinder") {
      size.expect_keys({"radius", "length"});
      return Shape::cylinder(X, edge("radius"), edge("length"));
    }
    if (kind != "sphere") object["shape"].refuse("box, cylinder or sphere");
    size.expect_keys({"radius"});
    return Shape::sphere(X.translation(), edge("radius"));
  }();
  if (!made) object.complain(made.error().message);
  return *made;
}

/// Compares the URDF's hand with the one that the file's poses are meant for: flange, hand and
/// fingers are the links MODEL_hand, its parent and its children. Fingers that can move are put
/// where the file has them.
void check_hand(const JsonReader& hand, const std::string& model, world::RobotSpec& robot) {
  constexpr double kTolerance = 1e-6;  // [m, and of rotation matrices]
  hand.expect_keys({"flange_to_hand", "finger_opening_each"}, {"grasp_point_in_hand_xyz"});
  const Eigen::Isometry3d X_FH = read_pose(hand["flange_to_hand"]);
  const double opening = hand["finger_opening_each"].non_negative();
  const int link = robot.model.find_link(model + "_hand");
  if (link <= 0) {
    hand.complain("the URDF of robot model '" + model + "' has no link '" + model +
                  "_hand'; give one with the hand");
  }
  const std::string remedy = "; give a URDF whose hand sits as in the file";
  const auto& joints = robot.model.joints();
  const int above = robot.model.links()[static_cast<std::size_t>(link)].parent_joint;
  if (!joints[static_cast<std::size_t>(above)].X_PJ.isApprox(X_FH, kTolerance)) {
    hand["flange_to_hand"].complain("the URDF of robot model '" + model +
                                    "' holds the hand in another pose" + remedy);
  }
  for (const robot::Joint& joint : joints) {
    const std::string& child = robot.model.links()[static_cast<std::size_t>(joint.child_link)].name;
    if (joint.parent_link != link || child.find("finger") == std::string::npos) continue;
    if (joint.position_index >= 0) {
      robot.fixed_positions.emplace(joint.name, opening);
    } else if (!joint.mimic &&
               std::abs(joint.X_PJ.translation().head<2>().norm() - opening) > kTolerance) {
      hand["finger_opening_each"].complain("the URDF of robot model '" + model + "' has '" + child +
                                           "' elsewhere" + remedy);
    }
  }
}

/// The joint names of the file, "panda0_joint1", as the model has them: "panda_joint1".
std::vector<std::string> model_joints(const JsonReader& list, const std::string& robot,
                                      const std::string& model) {
  std::vector<std::string> names;
  for (const JsonReader& item : list.items()) {
    const std::string name = item.name();
    if (!name.starts_with(robot)) item.refuse("a name that begins with the robot's, " + robot);
    names.push_back(model + name.substr(robot.size()));
  }
  return names;
}

class PairReader {
 public:
  PairReader(const JsonReader& root, const ProblemRobots& files) : root_(root), library_(files) {}

  std::vector<BenchProblem> read() {
    root_.expect_keys({"name", "robots", "obstacles", "poses", "pairs", "limits"},
                      {"source", "poses_left_out_of_pairs", "notes"});
    spec_.name = root_["name"].name();
    for (const JsonReader& robot : root_["robots"].items()) read_robot(robot);
    for (const JsonReader& obstacle : root_["obstacles"].items()) {
      obstacle.expect_keys({"name", "shape", "size", "pose"});
      spec_.obstacles.push_back(
          {obstacle["name"].name(), {read_shape(obstacle)}, obstacle.where()});
    }
    cell_ = std::make_shared<const ProblemCell>(root_, std::move(spec_), joints_);
    read_poses();
    return read_pairs();
  }

 private:
  void read_robot(const JsonReader& object) {
    object.expect_keys({"name", "model", "base", "joints", "attachments"}, {"hand"});
    const std::string name = object["name"].name(), model = object["model"].name();
    for (const auto& [other, size] : sizes_) {
      if (other == name) object["name"].refuse("a name that no other robot has");
    }
    world::RobotSpec robot = library_.robot(object["model"], model);
    robot.name = name;
    robot.X_WB = read_pose(object["base"]);
    if (object.has("hand")) check_hand(object["hand"], model, robot);
    const std::vector<std::string> names = model_joints(object["joints"], name, model);
    const std::vector<int> joints = find_joints(object["joints"], names, robot.model);
    const auto count = static_cast<Eigen::Index>(joints.size());
    const JsonReader limits = root_["limits"]["joint_position_limits"];
    set_limits(joints, read_position_limits(limits, count), robot.model);
    std::vector<world::ArmSpec> arms = arms_of(object["joints"], joints, robot);
    for (world::ArmSpec& arm : arms) {
      arm.name = arms.size() == 1 ? name : name + "_" + arm.name;
      spec_.arms.push_back(arm);
    }
    for (const JsonReader& attached : object["attachments"].items()) read_attached(attached, robot);
    for (const std::string& joint : names) joints_.push_back(name + "/" + joint);
    sizes_.emplace_back(name, count);
    spec_.robots.push_back(std::move(robot));
  }

  void read_attached(const JsonReader& object, const world::RobotSpec& robot) {
    object.expect_keys({"name", "link", "shape", "size", "pose"}, {"axis"});
    const std::string link = object["link"].name();
    if (robot.model.find_link(link) < 0) {
      std::vector<std::string> known;
      for (const robot::Link& l : robot.model.links()) known.push_back(l.name);
      object["link"].complain("the robot has no link '" + link + "'" + name_hint(link, known));
    }
    world::AttachedSpec attached;
    attached.name = object["name"].name();
    attached.link = robot.name + "/" + link;
    attached.shapes_L = {read_shape(object)};
    attached.where = object.where();
    spec_.attached.push_back(std::move(attached));
  }

  void read_poses() {
    std::vector<std::string> robots;
    for (const auto& [name, size] : sizes_) robots.push_back(name);
    for (const std::string& pose : root_["poses"].keys()) {
      const JsonReader object = root_["poses"][pose];
      object.expect_keys(robots);
      Eigen::VectorXd q(cell_->dof());
      Eigen::Index offset = 0;
      for (const auto& [name, size] : sizes_) {
        q.segment(offset, size) = object[name].vector(size, "one per joint");
        offset += size;
      }
      poses_[pose] = cell_->configuration(q);
    }
  }

  const Eigen::VectorXd& pose(const JsonReader& name) const {
    const auto found = poses_.find(name.name());
    if (found != poses_.end()) return found->second;
    std::vector<std::string> known;
    for (const auto& [pose, q] : poses_) known.push_back(pose);
    name.complain("there is no pose '" + name.name() + "'" + name_hint(name.name(), known));
  }

  std::vector<BenchProblem> read_pairs() const {
    std::vector<BenchProblem> problems;
    for (const JsonReader& pair : root_["pairs"].items()) {
      const std::vector<JsonReader> ends = pair.items();
      if (ends.size() != 2) pair.refuse("two poses: from where, to where");
      BenchProblem problem;
      problem.set = root_["name"].name();
      problem.ends = {ends[0].name() + " -> " + ends[1].name(), pose(ends[0]), pose(ends[1])};
      problem.cell = [cell = cell_, query = problem.ends] { return cell->with({}, query); };
      problems.push_back(std::move(problem));
    }
    return problems;
  }

  const JsonReader& root_;
  RobotLibrary library_;
  world::WorkcellSpec spec_;
  std::vector<std::string> joints_;                          // As in the cell, in file order.
  std::vector<std::pair<std::string, Eigen::Index>> sizes_;  // Robots and their joints.
  std::shared_ptr<const ProblemCell> cell_;
  std::map<std::string, Eigen::VectorXd> poses_;
};

}  // namespace

std::vector<BenchProblem> read_pose_pairs(const JsonReader& root, const ProblemRobots& robots) {
  return PairReader(root, robots).read();
}

}  // namespace tandem::io
