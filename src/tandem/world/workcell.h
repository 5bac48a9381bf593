#pragma once
/// The cell: placed robots, named arms, obstacles, attached objects, allowed pairs, queries.

#include <compare>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tandem/geometry/shape.h"
#include "tandem/geometry/surface.h"
#include "tandem/robot/kinematics.h"
#include "tandem/robot/model.h"
#include "tandem/robot/srdf.h"
#include "tandem/world/scene.h"

namespace tandem::world {

/// A robot and where it stands. In the cell's model its names get the prefix "NAME/".
/// `where` of every spec is its place in a file ("cell.yaml:4:5"), put before messages about it;
/// empty if built in memory.
struct RobotSpec {
  /// What becomes of the collision meshes of links without volumes.
  enum class Meshes {
    kTriangles,  ///< The mesh itself.
    kConvex,     ///< Its hull: contains the mesh, and is faster.
  };

  std::string name;
  robot::Model model;
  robot::Semantics semantics;
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();  ///< Pose of the model's root link.
  /// Swept sphere volumes by link name, in L. A link without an entry gets its URDF geometry:
  /// spheres, boxes and cylinders as shapes, meshes as `meshes` says.
  std::map<std::string, std::vector<geometry::Shape>> volumes;
  /// Values of joints that no arm moves, by joint name [rad or m]; others stand at 0, clamped
  /// into their limits.
  std::map<std::string, double> fixed_positions;
  std::string where = {};
  Meshes meshes = Meshes::kTriangles;
  std::filesystem::path urdf = {}, srdf = {};  ///< For people: where it was read from.
};

struct ArmSpec {
  std::string name;
  std::string robot;
  std::string group;  ///< SRDF group whose movable joints the arm owns; empty: see `base`.
  std::string tip;    ///< Link name; empty: the group's tip.
  Eigen::Isometry3d X_LE = Eigen::Isometry3d::Identity();  ///< Tool frame in the tip link.
  /// Without a group: the arm owns the movable joints from this link down to `tip`.
  std::string base = {};
  std::string where = {};
};

struct ObstacleSpec {
  std::string name;
  std::vector<geometry::Shape> shapes_W;
  std::string where = {};
  std::vector<geometry::PlacedSurface> surfaces_W = {};
  Eigen::Isometry3d X_WO = Eigen::Isometry3d::Identity();  ///< Its frame, where it is carried from.
};

/// Geometry carried by a link, rigidly.
struct AttachedSpec {
  std::string name;
  std::string link;  ///< Cell name, e.g. "left/panda_hand".
  std::vector<geometry::Shape> shapes_L;
  std::vector<std::string> touching;  ///< Bodies it may touch, besides its own link.
  std::string where = {};
  std::vector<geometry::PlacedSurface> surfaces_L = {};
  Eigen::Isometry3d X_LO = Eigen::Isometry3d::Identity();  ///< Its own frame.
};

/// Where an arm shall go: joint values in arm order, a named state of its group, or a tool pose.
struct JointGoal {
  Eigen::VectorXd q;  ///< [rad or m]
};
struct StateGoal {
  std::string name;
};
struct PoseGoal {
  Eigen::Isometry3d X_WE = Eigen::Isometry3d::Identity();
};
using ArmGoal = std::variant<JointGoal, StateGoal, PoseGoal>;

/// One motion. An arm without a start stands where the query before left it; an arm without a goal
/// stays where it starts.
struct Query {
  std::string name;
  std::vector<std::optional<ArmGoal>> start;  ///< One entry per arm.
  std::vector<std::optional<ArmGoal>> goal;   ///< One entry per arm.
  SceneChanges changes = {};                  ///< Before the motion, where it starts.
};

/// Motions that follow each other. Its queries are called "LIST/QUERY".
struct QueryList {
  std::string name;
  std::vector<Query> queries;
};

struct QuerySpec {
  std::string name;
  std::map<std::string, ArmGoal> start, goal;  ///< By arm name.
  std::string where = {};
  SceneChanges changes = {};
};

struct QueryListSpec {
  std::string name;
  std::vector<QuerySpec> queries;  ///< Their names without that of the list.
  std::string where = {};
};

/// Everything that makes a cell, unchecked.
struct WorkcellSpec {
  std::string name;
  std::filesystem::path file;  ///< Where it was read from; empty if built in memory.
  std::vector<RobotSpec> robots;
  std::vector<ArmSpec> arms;
  std::vector<ObstacleSpec> obstacles;
  std::vector<AttachedSpec> attached;
  std::vector<AllowedPair> allowed;
  double padding = 0;  ///< [m] >= 0, swept around every robot link and attached object.
  std::map<std::string, double> body_padding;  ///< [m] by body name, instead of `padding`.
  std::vector<QuerySpec> queries;
  std::vector<QueryListSpec> lists = {};
};

/// One bit per arm.
using ArmMask = std::uint32_t;

struct Arm {
  std::string name;
  int robot;                 ///< Index into robots().
  std::string group;         ///< SRDF group; empty if it is a chain of links.
  std::vector<int> joints;   ///< Of the cell's model, base first.
  std::vector<int> columns;  ///< Their entries in a position vector.
  int tip_link;              ///< Link L of the cell's model.
  Eigen::Isometry3d X_LE;    ///< Tool frame.
  int offset;                ///< First entry in the cell's q.
  int dof() const { return static_cast<int>(joints.size()); }
};

/// Rigid geometry that moves with one link.
struct Body {
  std::string name;
  int link;                               ///< Of the cell's model; 0 is the world.
  std::vector<geometry::Shape> shapes_L;  ///< Unpadded.
  double padding;                         ///< [m]
  ArmMask moved_by;                       ///< Arms that can move it; 0 stands still.
  enum class Kind { kRobotLink, kObstacle, kAttached } kind;
  std::vector<geometry::PlacedSurface> surfaces_L = {};  ///< Unpadded, besides the shapes.
};

/// Two bodies that must not touch; indices into bodies(), a < b.
struct BodyPair {
  int a, b;
  ArmMask moved_by;  ///< Arms that can change the relative pose of a and b; never 0.
};

/// A pair that is not checked, and why: for people.
struct SkippedPair {
  int a, b;
  std::string reason;
};

/// Which pairs a question is about, by who moves.
struct PairScope {
  /// Every pair of the cell.
  static PairScope all() { return {}; }
  /// Arm i alone: with the world, itself and the arms in `standing`.
  static PairScope arm(int i, ArmMask standing = 0);
  /// Pairs that both arm i and arm j can move.
  static PairScope between(int i, int j);
  /// Pairs that two arms or more can move: what is left of `all` when every arm was asked alone.
  static PairScope several();

  ArmMask required = 0;             ///< Arms that must be able to move the pair...
  ArmMask permitted = ~ArmMask{0};  ///< ...and those that may;
  int least = 1;                    ///< so many of them can at least.

  auto operator<=>(const PairScope&) const = default;
};

/// Indices into pairs().
using PairSelection = std::vector<int>;

/// Immutable; share it between threads as shared_ptr<const Workcell>.
/// A configuration q of the cell stacks the joints of all arms in arm order.
class Workcell {
 public:
  /// Merges, resolves and checks a spec.
  /// @return kInvalidInput or kNotFound naming the entry, its value and the remedy: names that do
  /// not exist (with the nearest one that does) or exist twice, arms that share joints, arm joints
  /// without position, velocity or acceleration limit, link meshes that cannot be read, joint goals
  /// of the wrong size, queries that attach what is carried or detach what is not.
  static Result<std::shared_ptr<const Workcell>> make(WorkcellSpec spec);

  /// Where the objects of this cell are, as far as it is not where the file has them.
  const SceneState& scene() const { return scene_; }
  /// The cell of the same file with its objects where `scene` has them. Bodies keep their indices.
  /// @return kInvalidInput or kNotFound naming the object, link or body that is not as it should.
  Result<std::shared_ptr<const Workcell>> in_scene(SceneState scene) const;
  /// The cell of arm i alone: q has its joints, pairs() are select(PairScope::arm(i)) of this cell.
  /// Bodies keep their indices, moved_by the bits of the left_out() after its own. No queries.
  std::shared_ptr<const Workcell> arm_alone(int i) const;
  /// The scene after `changes` to this one, made with the arms at q.
  /// @return kNotFound for names, with the nearest; kInvalidInput for an object that is carried
  /// already, or that nothing carries, and for a link that no arm moves.
  Result<SceneState> scene_after(const SceneChanges& changes,
                                 const Eigen::Ref<const Eigen::VectorXd>& q) const;
  /// Where an obstacle or attached object is; kNotFound with the nearest name.
  Result<ObjectState> find_object(const std::string& name) const;

  const std::string& name() const { return spec_.name; }
  const WorkcellSpec& spec() const { return spec_; }
  const robot::Model& model() const { return model_; }

  const std::vector<Arm>& arms() const { return arms_; }
  int find_arm(std::string_view name) const;                      ///< -1 if there is none.
  const std::vector<Arm>& left_out() const { return left_out_; }  ///< See arm_alone.
  int dof() const { return dof_; }
  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }
  /// Limits by entry of q.
  const std::vector<robot::JointLimits>& limits() const { return limits_; }
  /// Joint names by entry of q, e.g. "left/panda_joint1".
  const std::vector<std::string>& joint_names() const { return joint_names_; }

  const std::vector<Body>& bodies() const { return bodies_; }
  int find_body(std::string_view name) const;  ///< -1 if there is none.
  const std::vector<BodyPair>& pairs() const { return pairs_; }
  const std::vector<SkippedPair>& skipped_pairs() const { return skipped_pairs_; }
  PairSelection select(const PairScope& scope) const;
  /// "left/panda_link5 and box_wall_1"
  std::string describe_pair(int pair) const;

  /// Model positions of configuration q: arm joints from q, all others fixed.
  /// `positions` is resized on first use.
  void positions(const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::VectorXd& positions) const;
  /// Poses of all links at q; `positions` is scratch.
  void forward_kinematics(const Eigen::Ref<const Eigen::VectorXd>& q, Eigen::VectorXd& positions,
                          robot::LinkPoses& X_WL) const;
  /// Tool pose of arm i from link poses.
  Eigen::Isometry3d tool_pose(int arm, const robot::LinkPoses& X_WL) const {
    const Arm& a = arms_[static_cast<std::size_t>(arm)];
    return X_WL[static_cast<std::size_t>(a.tip_link)] * a.X_LE;
  }

  const std::vector<Query>& queries() const { return queries_; }
  /// Throws ContractViolation if there is none; ask `find_query` about names from outside.
  const Query& query(std::string_view name) const;
  Result<const Query*> find_query(std::string_view name) const;  ///< kNotFound, nearest name.
  /// Further lists; `queries()` is not among them.
  const std::vector<QueryList>& lists() const { return lists_; }
  /// The queries of a list, `queries()` for "".   @return kNotFound with the nearest name.
  Result<const std::vector<Query>*> find_list(std::string_view name) const;
  /// The queries of the list that holds the query of this name; nullptr if none does.
  const std::vector<Query>* list_of(std::string_view query) const;
  /// Joint values of a named state of arm i's group; kNotFound with the nearest name.
  Result<Eigen::VectorXd> named_state(int arm, std::string_view name) const;

  /// kInfeasible naming the joint, its value and its limit if q leaves the position limits.
  Result<void> check_position_limits(const Eigen::Ref<const Eigen::VectorXd>& q) const;

 private:
  friend class WorkcellBuilder;
  Workcell() = default;

  WorkcellSpec spec_;
  robot::Model model_;
  std::vector<Arm> arms_;
  std::vector<Arm> left_out_;  ///< Arms of the cell that this is a part of.
  int dof_ = 0;
  Eigen::VectorXd lower_, upper_;
  std::vector<robot::JointLimits> limits_;
  std::vector<std::string> joint_names_;
  Eigen::VectorXd fixed_positions_;  ///< Model positions with every arm joint at 0.
  std::vector<Body> bodies_;
  std::vector<BodyPair> pairs_;
  std::vector<SkippedPair> skipped_pairs_;
  std::vector<Query> queries_;
  std::vector<QueryList> lists_;
  SceneState scene_;
};

/// The cell during a motion that `changes` precede, made with the arms at q: `cell` itself where
/// nothing changes. What was allowed during the motion before is not any more.
/// @return the errors of `scene_after` and `in_scene`.
Result<std::shared_ptr<const Workcell>> after_changes(const std::shared_ptr<const Workcell>& cell,
                                                      const SceneChanges& changes,
                                                      const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace tandem::world
