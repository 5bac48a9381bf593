#pragma once
/// What the batch checker, its compiler and its kernels share. Private to this folder.
///
/// Everything is seen from frame C: its origin lies amid the robots, so that single precision is
/// spent where they move, and its axes are those of most standing boxes, so that these are
/// axis-aligned.

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "tandem/collision/batch_checker.h"

namespace tandem::collision {

using Vector3f3 = std::array<float, 3>;

/// A joint that an arm moves, with everything rigid below it, turning about (or sliding along) z of
/// its frame J. Joint -1 is the world, J = C. Parents come first.
struct BatchJoint {
  int parent;
  int depth;   ///< Joints from the world up to here, this one included.
  int column;  ///< Of q: the joint's value is multiplier * q[column] + offset.
  bool prismatic;
  double multiplier, offset;
  double lower, upper;        ///< Limits of the value.
  Eigen::Isometry3d X_PJ;     ///< At value 0.
  std::array<float, 9> R_PJ;  ///< The same by columns,
  Vector3f3 p_PJ;
};

/// A sphere that contains a node of the hierarchy, the margin included.
struct BatchSphere {
  Vector3f3 p_JC;
  float radius;
};

/// Which kernel tells the distance of a core. Opaque ones have only the box around them.
enum class BatchCore : std::uint8_t { kPoint, kSegment, kBox, kCylinder, kPolytope, kOpaque };

/// A padded shape as a rounded box: tight around the core along its own axes.
struct BatchShape {
  BatchCore core;
  bool aligned;  ///< Stands still, with the axes of C: of a segment or box.
  int joint;
  int slot;                        ///< Among the shapes that move.
  Vector3f3 p_JC;                  ///< Centre of the box.
  std::array<float, 9> R_BJ;       ///< Its axes are rows; a segment lies along the first.
  Vector3f3 half;                  ///< [m]
  float outer, inner;              ///< Radius plus and minus the margin [m].
  float inverse;                   ///< Of a segment: one over its half length squared [1/m^2].
  float circumradius;              ///< Of the core's box about its centre [m].
  float span;                      ///< Most distance of the core from its body's centre [m],
  float offset;                    ///< and from its group's.
  int first_vertex, vertex_count;  ///< Of a polytope, in BatchModel::vertices.
  float bound() const { return circumradius + outer; }
  bool operator==(const BatchShape&) const = default;
};

struct BatchBody {
  int joint;
  int first_shape, shape_count;
  BatchSphere sphere;
  float offset = 0;         ///< Of its centre from its group's [m].
  bool is_spheres = false;  ///< All its shapes.
  /// Standing bodies: the box along C's axes around all cores, and their largest radius.
  Vector3f3 p_CB{}, half{};
  float outer = 0;
};

/// Where in the values of one or two joints nothing of two groups touches: cells of equal size
/// between the joints' limits. See joint_map.h.
struct JointRooms;
struct JointMap {
  static constexpr int kSide = 64;
  static constexpr std::size_t at(int u, int v) { return static_cast<std::size_t>(u * kSide + v); }

  int group_a, group_b;
  std::array<int, 2> joints;  ///< The same one twice: there is no second axis, v = 0.
  std::array<float, 2> low, cells_per_unit;
  std::shared_ptr<const JointRooms> rooms;
  /// By cell: -1, or how many rings of cells around a cell are proven to be free as it is.
  const std::int8_t* room;
};

struct JointMaps {
  std::vector<JointMap> all;
};

struct BatchModel {
  std::vector<BatchJoint> joints;
  std::vector<BatchShape> shapes;
  std::vector<Vector3f3> vertices;  ///< From the centre of a shape's box, along its axes.
  std::vector<BatchBody> bodies;
  std::vector<BatchSphere>
      groups;                    ///< By joint: around all bodies rigid with it; radius < 0: none.
  std::vector<int> group_sizes;  ///< Bodies of each.
  /// By joint, then by depth of the joints above: most distance of the group's centre to their
  /// axes [m], over all configurations inside the limits (prismatic: 1).
  std::vector<float> levers;
  /// Known to none while they are being proven.
  std::shared_ptr<const JointMaps> joint_maps = std::make_shared<const JointMaps>();
  int moving_shapes = 0;
  int depth = 0;  ///< Of the deepest joint.
  int dof = 0;
  float margin = 0;  ///< [m]
  Eigen::Isometry3d X_CW;

  explicit BatchModel(const world::Workcell& cell);
  /// Fills the spans of a body's shapes, and its own and their offsets.
  void measure_spans(BatchBody& body);
  int common_joint(int a, int b) const;
  int depth_of(int joint) const {
    return joint < 0 ? 0 : joints[static_cast<std::size_t>(joint)].depth;
  }
};

/// One pair of bodies of an item; of a standing body the shapes that the other one may reach.
struct BatchBodyPair {
  int pair;                      ///< Of the cell.
  int a, b;                      ///< Bodies; where one stands still it is b.
  int first_shape, shape_count;  ///< In BatchPairs::standing_shapes.
};

/// Pairs between a group and a standing body, or between two groups.
struct BatchItem {
  int group_a, group_b;  ///< Joints; group_b = -1: body `standing`.
  int standing;
  int common, shared;          ///< Last joint above both, and its depth.
  float reach;                 ///< Sum of radii [m].
  const JointMap* joint_map;   ///< nullptr: none.
  int first, count;            ///< In BatchPairs::body_pairs.
  Vector3f3 center{}, half{};  ///< Of the standing body's box.
};

/// A node of the tree over the items of one group with standing bodies, see BoxTree.
struct BatchNode {
  Vector3f3 center, half;  ///< Of the box around the rounded boxes of all bodies below.
  int skip, first, count;  ///< Items.
};

/// The items of one group with standing bodies. Without nodes they are few.
struct BatchGroupItems {
  int group;
  int first, count;
  std::vector<BatchNode> nodes;
};

struct BatchPairs {
  const BatchModel* model;
  std::vector<int> joints;         ///< Those to place, parents first.
  std::vector<BatchItem> items;    ///< First those with the world, by group,
  std::size_t standing_items = 0;  ///< so many of them.
  std::vector<BatchGroupItems> standing_groups;
  std::vector<BatchBodyPair> body_pairs;
  std::vector<int> standing_shapes;
};

/// @param within  [m], see BatchChecker::compile.
BatchPairs compile_pairs(const BatchModel& model, const world::Workcell& cell,
                         const world::PairSelection& selection, double within);

/// A shape that stands still in some frame P, and a sphere around it.
struct StandingShape {
  geometry::Shape shape_P;
  Eigen::Vector3d center_P;
  double bound;  ///< [m]
};

/// Where a sphere may be over all configurations inside the joint limits.
class Reach {
 public:
  /// Of the group or body of sphere `node` at `joint`, moved by the joints below `common`, in whose
  /// frame P it is seen.
  Reach(const BatchModel& model, int joint, int common, const BatchSphere& node);
  /// Whether it may come within `within` [m]. Never wrongly false.
  bool may_touch(const StandingShape& standing, double within) const;

 private:
  bool is_bounded_ = false;
  // In a ball, and in a capsule.
  Eigen::Vector3d ball_center_, low_, high_;
  double ball_radius_, radius_;
};

/// Fills BatchModel::levers.
void bound_levers(BatchModel& model);

/// A nearly smallest sphere around spheres. Ref: Badoiu, Clarkson (2003).
struct Ball {
  Eigen::Vector3d center;
  double radius;
};
Ball enclosing_ball(const std::vector<Ball>& balls);

}  // namespace tandem::collision
