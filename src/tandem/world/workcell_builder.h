#pragma once
/// How Workcell::make works. Not part of the public interface.

#include <unordered_map>

#include "tandem/core/bounds.h"
#include "tandem/world/link_geometry.h"
#include "tandem/world/workcell.h"

namespace tandem::world {

/// Turns a spec into a cell, step by step; each step needs the ones before it.
class WorkcellBuilder {
 public:
  explicit WorkcellBuilder(WorkcellSpec spec) : cell_(new Workcell()) {
    cell_->spec_ = std::move(spec);
  }
  /// For the same cell in another scene.
  explicit WorkcellBuilder(const Workcell& cell);

  Result<std::shared_ptr<const Workcell>> build();
  Result<std::shared_ptr<const Workcell>> build_in(SceneState scene);
  std::shared_ptr<const Workcell> build_alone(int arm);
  Result<std::shared_ptr<const Workcell>> build_with(ObstacleSpec obstacle);
  Result<std::shared_ptr<const Workcell>> build_without(const std::string& obstacle);

 private:
  // workcell_builder.cpp
  Result<void> check_names() const;
  Result<void> place_robots();
  Result<void> resolve_arms();
  Result<void> resolve_arm(const ArmSpec& spec);
  Result<Arm> find_group(const ArmSpec& spec, int robot) const;
  Result<Arm> find_chain(const ArmSpec& spec, int robot) const;
  Result<int> find_link(const ArmSpec& spec, int robot, const std::string& link) const;
  Result<void> stack_joint(const Arm& arm, int joint);
  Result<void> fix_positions();
  Result<void> resolve_queries();
  Result<void> resolve_list(const std::vector<QuerySpec>& specs, const std::string& prefix,
                            std::vector<Query>& queries) const;
  Result<void> check_changes() const;
  Result<std::vector<std::optional<ArmGoal>>> resolve_goals(
      const std::map<std::string, ArmGoal>& goals, const std::string& where) const;
  Result<void> check_goal(int arm, const ArmGoal& goal) const;

  // workcell_bodies.cpp
  Result<void> add_robot_bodies(const RobotSpec& robot);
  Result<void> add_obstacles();
  Result<void> add_attached();
  Result<void> add_body(Body body, const std::string& where);
  Result<void> check_body_padding() const;
  double padding_of(const std::string& body, double otherwise) const;
  Result<void> skip_pairs();
  Result<void> skip_disabled(const RobotSpec& robot);
  Result<void> skip_allowed(const std::string& a, const std::string& b, const std::string& reason,
                            const std::string& where);
  /// Bodies by whether their pairs have to be made.
  using Marked = std::vector<bool>;
  void make_pairs(const Marked& fresh);
  void sort_pair(int a, int b, bool list_standing, std::vector<BodyPair>& pairs,
                 std::vector<SkippedPair>& skipped) const;
  /// Arms with a joint on the way through the tree from one link to the other.
  ArmMask arms_between(int link_a, int link_b) const;
  Result<int> body_named(const std::string& name, const std::string& where) const;

  // workcell_scene.cpp
  Result<void> check_scene() const;
  void place_objects(const SceneState& before, Marked& changed);
  bool place_object(const std::string& name);
  void place_object(const std::string& name, const ObjectState& home,
                    const std::vector<geometry::Shape>& shapes,
                    const std::vector<geometry::PlacedSurface>& surfaces);

  // workcell_alone.cpp
  void own_joints();
  void keep_joints(int offset, int dof);

  int owner(int joint) const;  ///< Arm that moves the joint, itself or by mimicry; -1 if none.

  std::shared_ptr<Workcell> cell_;
  std::vector<int> owner_;  // By joint, mimics excluded.
  std::unordered_map<std::string, int> body_index_;
  std::map<std::pair<int, int>, std::string> skipped_;  // Body indices, a < b.
  LinkGeometryReader link_geometry_;
};

/// The error of an entry of the spec, with its place in the file.
inline std::unexpected<Error> refuse(ErrorCode code, const std::string& where,
                                     const std::string& message) {
  return fail(code, where.empty() ? message : where + ": " + message);
}

/// A rotation and a translation that is no mistake.
inline bool is_rigid(const Eigen::Isometry3d& X) {
  return X.matrix().allFinite() && X.translation().cwiseAbs().maxCoeff() <= kFarthest &&
         (X.linear() * X.linear().transpose()).isIdentity(1e-6) && X.linear().determinant() > 0;
}

}  // namespace tandem::world
