#include "tandem/io/problem_robots.h"

#include <algorithm>
#include <cmath>

#include "tandem/core/names.h"
#include "tandem/robot/srdf.h"
#include "tandem/robot/urdf.h"

namespace tandem::io {

namespace {

namespace fs = std::filesystem;
using robot::Model;

/// The value, or the end of reading with the error placed at `at`.
template <class T>
T checked(const JsonReader& at, Result<T> result) {
  if (!result) at.complain(result.error().message);
  return std::move(*result);
}

const fs::path* file_of(const std::map<std::string, fs::path>& files, const std::string& model) {
  for (const std::string& key : {model, std::string()}) {
    if (const auto file = files.find(key); file != files.end()) return &file->second;
  }
  return nullptr;
}

/// Whether one of two joints moves the other.
bool related(const Model& model, int a, int b) {
  const auto above = [&model](int joint) -> const std::vector<int>& {
    return model.moving_ancestors(model.joints()[static_cast<std::size_t>(joint)].child_link);
  };
  return std::ranges::count(above(a), b) > 0 || std::ranges::count(above(b), a) > 0;
}

/// The joints by branch of the tree, branches in the order of their first joints.
std::vector<std::vector<int>> branches(const Model& model, const std::vector<int>& joints) {
  std::vector<std::vector<int>> found;
  for (const int joint : joints) {
    std::vector<int> merged;
    std::size_t home = found.size();
    for (std::size_t b = 0; b < found.size(); ++b) {
      if (std::ranges::none_of(found[b], [&](int o) { return related(model, o, joint); })) continue;
      home = std::min(home, b);
      merged.insert(merged.end(), found[b].begin(), found[b].end());
      found[b].clear();
    }
    merged.push_back(joint);
    if (home == found.size()) found.emplace_back();
    found[home] = std::move(merged);
  }
  std::erase_if(found, [](const auto& branch) { return branch.empty(); });
  return found;
}

/// The chain of links that the joints of a branch move.
world::ArmSpec chain_of(const JsonReader& list, const Model& model, std::vector<int> branch) {
  std::ranges::sort(branch);  // Parents come before their children.
  const auto joint = [&](int j) -> const robot::Joint& {
    return model.joints()[static_cast<std::size_t>(j)];
  };
  const int base = joint(branch.front()).parent_link, tip = joint(branch.back()).child_link;
  std::vector<int> moving;
  if (const auto chain = model.chain(base, tip)) {
    std::ranges::copy_if(*chain, std::back_inserter(moving),
                         [&](int j) { return joint(j).position_index >= 0; });
  }
  if (moving != branch) {
    list.complain("the joints from '" + joint(branch.front()).name + "' to '" +
                  joint(branch.back()).name +
                  "' are no chain, and no group of the SRDF has just these; add such a group");
  }
  const auto name = [&](int link) { return model.links()[static_cast<std::size_t>(link)].name; };
  world::ArmSpec arm;
  arm.name = arm.tip = name(tip);
  arm.base = name(base);
  return arm;
}

}  // namespace

world::RobotSpec RobotLibrary::robot(const JsonReader& name, const std::string& model) {
  if (const auto known = read_.find(model); known != read_.end()) return known->second;
  if (!read_.empty() && (files_.urdf.contains("") || files_.srdf.contains(""))) {
    name.complain("the file has more than one model, '" + read_.begin()->first + "' and '" + model +
                  "'; give each its own files, as MODEL=FILE");
  }
  const fs::path* urdf = file_of(files_.urdf, model);
  if (!urdf) name.complain("there is no URDF for robot model '" + model + "'; give one");
  world::RobotSpec robot;
  robot.name = model;
  robot.where = urdf->string();
  const auto packages = robot::PackagePath::with_environment(files_.packages);
  robot.model = checked(name, robot::load_urdf(*urdf, packages));
  if (const fs::path* srdf = file_of(files_.srdf, model)) {
    robot.semantics = checked(name, robot::load_srdf(*srdf, robot.model));
  }
  robot.fixed_positions = files_.joints;
  return read_.emplace(model, std::move(robot)).first->second;
}

PositionLimits read_position_limits(const JsonReader& object, Eigen::Index count) {
  const PositionLimits limits{object["lower"].vector(count, "one per joint"),
                              object["upper"].vector(count, "one per joint")};
  for (Eigen::Index j = 0; j < count; ++j) {
    if (limits.lower[j] > limits.upper[j]) {
      object["lower"].items()[static_cast<std::size_t>(j)].refuse("at most the upper limit, " +
                                                                  std::to_string(limits.upper[j]));
    }
  }
  return limits;
}

std::vector<int> find_joints(const JsonReader& list, const std::vector<std::string>& names,
                             const Model& model) {
  std::vector<std::string> known;
  for (const robot::Joint& joint : model.joints()) {
    if (joint.position_index >= 0) known.push_back(joint.name);
  }
  std::vector<int> joints;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int joint = model.find_joint(names[i]);
    if (joint < 0 || model.joints()[static_cast<std::size_t>(joint)].position_index < 0) {
      list.items()[i].complain("robot '" + model.name() + "' has no movable joint '" + names[i] +
                               "'" + name_hint(names[i], known));
    }
    if (std::ranges::count(joints, joint) > 0) {
      list.items()[i].complain("joint '" + names[i] + "' stands twice; keep one");
    }
    joints.push_back(joint);
  }
  if (joints.empty()) list.refuse("at least one joint");
  return joints;
}

void set_limits(const std::vector<int>& joints, const PositionLimits& limits, Model& model) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    robot::JointLimits own = model.joints()[static_cast<std::size_t>(joints[i])].limits;
    own.lower = limits.lower[static_cast<Eigen::Index>(i)];
    own.upper = limits.upper[static_cast<Eigen::Index>(i)];
    if (!std::isfinite(own.velocity)) own.velocity = kAssumedVelocity;
    if (!std::isfinite(own.acceleration)) own.acceleration = kAssumedAcceleration;
    model.set_limits(joints[i], own);
  }
}

std::vector<world::ArmSpec> arms_of(const JsonReader& list, const std::vector<int>& joints,
                                    const world::RobotSpec& robot) {
  std::vector<world::ArmSpec> arms;
  for (const std::vector<int>& branch : branches(robot.model, joints)) {
    const auto group = std::ranges::find_if(robot.semantics.groups, [&](const robot::Group& g) {
      return std::ranges::is_permutation(g.joints, branch);
    });
    if (group != robot.semantics.groups.end() && group->tip_link >= 0) {
      arms.emplace_back();
      arms.back().name = arms.back().group = group->name;
    } else {
      arms.push_back(chain_of(list, robot.model, branch));
    }
    arms.back().robot = robot.name;
  }
  return arms;
}

ProblemCell::ProblemCell(const JsonReader& root, world::WorkcellSpec spec,
                         const std::vector<std::string>& joints)
    : spec_(std::move(spec)) {
  const auto cell = checked(root, world::Workcell::make(spec_));
  for (const std::string& name : cell->joint_names()) {
    order_.push_back(static_cast<int>(std::ranges::find(joints, name) - joints.begin()));
  }
  for (const world::Arm& arm : cell->arms()) arms_.emplace_back(arm.name, arm.dof());
}

Eigen::VectorXd ProblemCell::configuration(const Eigen::VectorXd& of_file) const {
  return of_file(order_);
}

Result<std::shared_ptr<const world::Workcell>> ProblemCell::with(
    const std::vector<world::ObstacleSpec>& obstacles, const pipeline::ResolvedQuery& ends) const {
  world::WorkcellSpec spec = spec_;
  spec.obstacles.insert(spec.obstacles.end(), obstacles.begin(), obstacles.end());
  world::QuerySpec& query = spec.queries.emplace_back();
  query.name = ends.name;
  Eigen::Index offset = 0;
  for (const auto& [arm, dof] : arms_) {
    query.start[arm] = world::JointGoal{ends.start.segment(offset, dof)};
    query.goal[arm] = world::JointGoal{ends.goal.segment(offset, dof)};
    offset += dof;
  }
  return world::Workcell::make(std::move(spec));
}

Eigen::Isometry3d read_placement(const JsonReader& position, const JsonReader& quaternion,
                                 bool w_last) {
  constexpr double kUnitTolerance = 1e-3;
  const Eigen::Vector4d q = quaternion.vector(4, w_last ? "x, y, z, w" : "w, x, y, z");
  if (!(std::abs(q.norm() - 1) <= kUnitTolerance)) {
    quaternion.complain("the quaternion has length " + std::to_string(q.norm()) + ", it must be 1");
  }
  const Eigen::Quaterniond rotation = w_last ? Eigen::Quaterniond(q[3], q[0], q[1], q[2])
                                             : Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = rotation.normalized().toRotationMatrix();
  X.translation() = position.vector(3, "x, y, z");
  return X;
}

}  // namespace tandem::io
