#pragma once
/// What the SSV checker and the certificate share: the cell compiled for fast placement.

#include <algorithm>
#include <cstdint>

#include "tandem/collision/link_frame.h"
#include "tandem/collision/ssv_checker.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

class SsvField;

/// A joint that an arm moves, with everything rigid below it. Its frame J turns with the joint and
/// has the joint's axis as z. Joint -1 is the world, J = W.
struct SsvJoint {
  int parent;
  int depth;               ///< Joints from the world up to here, this one included.
  Eigen::Isometry3d X_PJ;  ///< In the parent's frame, at joint value 0.
  bool prismatic;
  int column;         ///< Entry of q;
  double multiplier;  ///< the joint's value is multiplier * q[column] + offset.
  double offset;
};

/// A bounding sphere in the tree of a body. A leaf is one convex piece: a shape, or a piece of a
/// surface. Of a cloud nothing else is kept: its points are balls.
struct SsvNode {
  Eigen::Vector3d p_JC;
  double radius;
  std::int16_t joint;
  bool is_ball;      ///< A leaf that fills its sphere.
  bool has_anchors;  ///< See SsvModel.
  int slot;          ///< Where a scratch keeps it; -1 if it is not worth it or stands still.
  int right;         ///< The right child; the left one follows its parent. Of leaves see below.
  int piece;         ///< Of a leaf: index into shapes, or of the piece in its surface.

  bool is_leaf() const { return right <= 0; }
  bool is_shape() const { return right == 0; }
  int surface() const { return -right - 1; }  ///< Of a leaf that is no shape.
};

/// A padded shape, and the rounded box around it.
struct SsvShape {
  geometry::Shape shape_J;
  int slot;                                 ///< Where a scratch keeps it; -1 if it stands still.
  std::vector<Eigen::Vector3d> vertices_J;  ///< Of the core's hull.
  Eigen::Matrix3d R_BJ;                     ///< The box's axes are rows.
  Eigen::Vector3d p_JBo, half;              ///< Centre and half edges of the box around the core.
};

/// A placed mesh or cloud.
struct SsvSurface {
  std::shared_ptr<const geometry::Surface> surface;
  Eigen::Isometry3d X_JS;
  double padding;                    ///< [m]
  Eigen::Vector3d center_S, half_S;  ///< Of the box around its vertices.
};

/// Its nodes, shapes and surfaces are contiguous.
struct SsvBody {
  int joint;
  int root;  ///< Node.
  int first_shape, shape_count;
  int first_surface, surface_count;
  bool is_solid;  ///< A surface of it is closed: something may lie inside without touching it.

  /// A few shapes, whose nodes follow the root: descending their tree saves nothing.
  bool is_small() const { return surface_count == 0 && shape_count <= 16; }
};

struct SsvPair {
  int a, b;  ///< Roots of the bodies' trees.
  int body_a, body_b;
  int common;             ///< The last joint above both bodies: what moves both alike.
  int shared;             ///< Depth of `common`.
  bool rigid_a, rigid_b;  ///< The body stands still in the frame of `common`.
  bool solid;             ///< One of the bodies is.
};

/// Nothing in it is larger for a piece of a surface than its two nodes.
///
/// Anchors decide what lies inside closed meshes. Pieces that touch each other lie on one side of a
/// surface that none of them touches; so one of every such group is marked, the anchor, and one
/// point of its core decides for all of them.
struct SsvModel {
  static constexpr int kMostDepth = 32;  ///< Of a body's tree.

  std::vector<SsvJoint> joints;  ///< Parents first.
  std::vector<SsvNode> nodes;
  std::vector<SsvBody> bodies;
  std::vector<SsvShape> shapes;
  std::vector<SsvSurface> surfaces;
  std::vector<SsvPair> pairs;
  int dof = 0;
  int depth = 0;  ///< Of the deepest joint.
  int node_slots = 0, shape_slots = 0;
  std::shared_ptr<const SsvField> field;  ///< Of the pairs.

  std::vector<LinkFrame> frames;  ///< By link of the cell.
  bool with_anchors = false;
  int taken_over = 0;  ///< Bodies that were compiled before, see SsvKnown.

  /// @param like  of a cell that may have bodies in common with this one.
  explicit SsvModel(const world::Workcell& cell, const SsvChecker* like = nullptr);
  const SsvPair& pair(int index) const {
    expects(0 <= index && index < static_cast<int>(pairs.size()),
            "a selection holds indices into pairs()");
    return pairs[static_cast<std::size_t>(index)];
  }
  const SsvBody& body(int index) const { return bodies[static_cast<std::size_t>(index)]; }
  /// Past the last node of the tree below one.
  int node_end(int index) const {
    while (!node(index).is_leaf()) index = node(index).right;
    return index + 1;
  }
  const SsvNode& node(int index) const { return nodes[static_cast<std::size_t>(index)]; }
  const SsvShape& shape(int index) const { return shapes[static_cast<std::size_t>(index)]; }
  int depth_of(int joint) const {
    return joint < 0 ? 0 : joints[static_cast<std::size_t>(joint)].depth;
  }
  /// A point of the core of a leaf, in J.
  Eigen::Vector3d core_point(const SsvNode& leaf) const;
  /// What the core of a leaf is swept by, padding included [m].
  double sweep(const SsvNode& leaf) const;

 private:
  void add_pairs(const world::Workcell& cell);
};

/// Compiles the geometry of a body whose frame L stands in J as given; anchors cost some time.
void add_body(const world::Body& body, int joint, const Eigen::Isometry3d& X_JL, bool with_anchors,
              SsvModel& model);

}  // namespace tandem::collision
