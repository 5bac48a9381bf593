#pragma once
/// Robots and arms of a problem file. Not part of the public interface.

#include "tandem/io/json_reader.h"
#include "tandem/io/problem_file.h"
#include "tandem/world/workcell.h"

namespace tandem::io {

/// Reads each robot's files once.
class RobotLibrary {
 public:
  explicit RobotLibrary(const ProblemRobots& files) : files_(files) {}
  /// The robot called `model` with the joint values that were asked for; `name` places the errors.
  /// Throws BadJson.
  world::RobotSpec robot(const JsonReader& name, const std::string& model);

 private:
  const ProblemRobots& files_;
  std::map<std::string, world::RobotSpec> read_;
};

/// Position limits by joint.
struct PositionLimits {
  Eigen::VectorXd lower, upper;
};
/// Keys `lower` and `upper` of an object, one value per joint. Throws BadJson.
PositionLimits read_position_limits(const JsonReader& object, Eigen::Index count);

/// Indices of the joints into the model. Throws BadJson for names that are not movable joints.
std::vector<int> find_joints(const JsonReader& list, const std::vector<std::string>& names,
                             const robot::Model& model);
/// Gives the joints these position limits, and those limits that they lack.
void set_limits(const std::vector<int>& joints, const PositionLimits& limits, robot::Model& model);
/// One arm per branch of the joints, in their order. Throws BadJson.
std::vector<world::ArmSpec> arms_of(const JsonReader& list, const std::vector<int>& joints,
                                    const world::RobotSpec& robot);

/// What the problems of a file share: all but some obstacles and the query.
class ProblemCell {
 public:
  /// @param joints  joint names as in the cell ("panda/panda_joint1"), in the order of the file.
  /// Throws BadJson, placed at `root`, if the cell cannot be made.
  ProblemCell(const JsonReader& root, world::WorkcellSpec spec,
              const std::vector<std::string>& joints);

  Eigen::Index dof() const { return static_cast<Eigen::Index>(order_.size()); }
  /// A configuration of the cell from one of the file.
  Eigen::VectorXd configuration(const Eigen::VectorXd& of_file) const;
  Result<std::shared_ptr<const world::Workcell>> with(
      const std::vector<world::ObstacleSpec>& obstacles, const pipeline::ResolvedQuery& ends) const;

 private:
  world::WorkcellSpec spec_;
  std::vector<int> order_;                                  // Entry of the file by entry of q.
  std::vector<std::pair<std::string, Eigen::Index>> arms_;  // Name and joints.
};

/// A pose with a position, and a quaternion whose w comes last or first. Throws BadJson.
Eigen::Isometry3d read_placement(const JsonReader& position, const JsonReader& quaternion,
                                 bool w_last);

/// The two kinds of file. Throw BadJson.
std::vector<pipeline::BenchProblem> read_problem_sets(const JsonReader& root,
                                                      const ProblemRobots& robots);
std::vector<pipeline::BenchProblem> read_pose_pairs(const JsonReader& root,
                                                    const ProblemRobots& robots);

}  // namespace tandem::io
