#pragma once
/// What the SSV checker and the certificate share: the cell compiled for fast placement.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "tandem/collision/ssv_checker.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

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
  double lower, upper;  ///< Limits of the joint's value.
};

/// A bounding sphere of a body or of a shape.
struct SsvNode {
  int joint;
  Eigen::Vector3d p_JC;
  double radius;
};

/// A padded shape, and the rounded box around it.
struct SsvShape {
  geometry::Shape shape_J;
  std::vector<Eigen::Vector3d> vertices_J;  ///< Of the core's hull.
  Eigen::Matrix3d R_BJ;                     ///< The box's axes are rows.
  Eigen::Vector3d p_JBo, half;              ///< Centre and half edges of the box around the core.
};

struct SsvBody {
  int joint;
  int first_shape, shape_count;
};

struct SsvPair {
  int a, b;
  int common;             ///< The last joint above both bodies: what moves both alike.
  int shared;             ///< Depth of `common`.
  bool rigid_a, rigid_b;  ///< The body stands still in the frame of `common`.
};

/// Nodes are numbered bodies first, then shapes.
struct SsvModel {
  std::vector<SsvJoint> joints;  ///< Parents first.
  std::vector<SsvNode> nodes;
  std::vector<SsvBody> bodies;
  std::vector<SsvShape> shapes;
  std::vector<SsvPair> pairs;
  int dof = 0;
  int depth = 0;  ///< Of the deepest joint.

  explicit SsvModel(const world::Workcell& cell);
  const SsvPair& pair(int index) const {
    expects(0 <= index && index < static_cast<int>(pairs.size()),
            "a selection holds indices into pairs()");
    return pairs[static_cast<std::size_t>(index)];
  }
  int shape_node(int shape) const { return static_cast<int>(bodies.size()) + shape; }
  int depth_of(int joint) const {
    return joint < 0 ? 0 : joints[static_cast<std::size_t>(joint)].depth;
  }
  /// bodies x dof, see SsvChecker::lever_arm.
  Eigen::MatrixXd lever_arms() const;
};

/// Work space of certify().
struct CertificateBuffers {
  struct Interval {
    double t0, t1;
    int first, count;  ///< Its unproven pairs in `pairs`.
  };
  Eigen::VectorXd q, D;
  std::vector<Interval> level, next_level;  ///< Intervals of equal length, in order of time.
  std::vector<int> pairs, next_pairs;
};

/// One placement of the cell. Poses, spheres and shapes are computed when first asked for.
class SsvScratch final : public CollisionChecker::Scratch {
 public:
  explicit SsvScratch(const SsvModel& model);

  const SsvModel& model() const { return model_; }
  void place(const Eigen::Ref<const Eigen::VectorXd>& q);

  const Eigen::Vector3d& center(int node) {
    const auto n = static_cast<std::size_t>(node);
    if (center_time_[n] < now_) place_node(n);
    return p_WC_[n];
  }
  const geometry::Shape& shape(int shape) {
    const auto s = static_cast<std::size_t>(shape);
    if (shape_time_[s] < now_) place_shape(s);
    return shape_W_[s];
  }
  /// Distance of the bounding spheres of two nodes [m].
  double sphere_distance(int i, int j) {
    return (center(i) - center(j)).norm() - model_.nodes[static_cast<std::size_t>(i)].radius -
           model_.nodes[static_cast<std::size_t>(j)].radius;
  }
  /// Whether two bounding spheres are further apart than `margin` [m].
  bool spheres_apart(int i, int j, double margin) {
    const double reach = model_.nodes[static_cast<std::size_t>(i)].radius +
                         model_.nodes[static_cast<std::size_t>(j)].radius + margin;
    return reach < 0 || (center(i) - center(j)).squaredNorm() > reach * reach;
  }
  /// Distance of the bounding sphere of `node` to the rounded box of `shape` [m].
  double box_distance(int node, int shape);
  /// Pose of frame J of a joint >= 0.
  const Eigen::Isometry3d& pose(int joint) {
    const auto j = static_cast<std::size_t>(joint);
    if (pose_time_[j] < now_) place_joint(j);
    return X_WJ_[j];
  }

  /// How far the entries of q may be from the placed ones [rad or m]; travel() refers to it.
  void set_deviation(const Eigen::Ref<const Eigen::VectorXd>& D);
  /// Upper bound of how far the centre of `node` moves by the joints below depth `shared` [m].
  double travel(int node, int shared) {
    const int depth = model_.depth_of(model_.nodes[static_cast<std::size_t>(node)].joint);
    if (depth <= shared) return 0;
    const auto n = static_cast<std::size_t>(node);
    if (travel_time_[n] < now_) bound_travel(n);
    return travel_[n * static_cast<std::size_t>(model_.depth) + static_cast<std::size_t>(shared)];
  }
  /// Upper bound of how far point P of `joint` moves along +-n by the joints below `common` [m].
  /// Ref: docs/methods.md, "Continuous-time certificate".
  double travel_along(const Eigen::Vector3d& n_W, int joint, int common,
                      const Eigen::Vector3d& p_WP);

  std::size_t last_hit = 0;  ///< Position in a selection: the next query begins there.
  CertificateBuffers certificate;

 private:
  void place_joint(std::size_t j);
  void place_node(std::size_t n);
  void place_shape(std::size_t s);
  void bound_travel(std::size_t n);

  const SsvModel& model_;
  // What stands still has time kAlways, everything else the time it was computed at.
  static constexpr std::uint64_t kAlways = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t now_ = 1;
  Eigen::VectorXd q_;
  std::vector<Eigen::Isometry3d> X_WJ_;
  std::vector<Eigen::Vector3d> p_WC_;
  std::vector<geometry::Shape> shape_W_;
  std::vector<double> D_, chord_, turn_;  // By joint, see set_deviation.
  std::vector<double> travel_;            // Nodes x depth.
  std::vector<std::uint64_t> pose_time_, center_time_, shape_time_, travel_time_;
};

/// The scratch, if it was made for this model; else throws ContractViolation.
SsvScratch& own_scratch(const SsvModel& model, CollisionChecker::Scratch& scratch);
/// Whether the bodies of a pair touch as placed.
bool touches(SsvScratch& scratch, const SsvPair& pair);
/// Replaces `best` by the clearance of pair `index` as placed, if that is less.
void improve(SsvScratch& scratch, int index, PairClearance& best);

/// Visits the shape pairs of `pair` that bounding volumes do not prove to be further apart than
/// `limit` after `slack(node_a, node_b)` [m] is taken off.
/// @param visit  (shape_a, shape_b, lower bound) -> the limit from here on; -infinity ends it.
/// @return the least lower bound of those not visited, slack taken off.
template <class Slack, class Visit>
double visit_near_shapes(SsvScratch& scratch, const SsvPair& pair, double limit, Slack&& slack,
                         Visit&& visit) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const SsvModel& model = scratch.model();
  // The outer body is the one that stands still, if any: its rounded boxes are cheap and tight.
  const int outer = pair.rigid_a ? pair.a : pair.b, inner = pair.rigid_a ? pair.b : pair.a;
  const bool rigid = pair.rigid_a || pair.rigid_b;
  const SsvBody& body_o = model.bodies[static_cast<std::size_t>(outer)];
  const SsvBody& body_i = model.bodies[static_cast<std::size_t>(inner)];
  double least = kInfinity;
  const auto bound = [&](int node_i, int shape_o) {
    const int node_o = model.shape_node(shape_o);
    const double taken = slack(node_i, node_o);
    double distance = scratch.sphere_distance(node_i, node_o);
    if (rigid && distance - taken <= limit) {
      distance = std::max(distance, scratch.box_distance(node_i, shape_o));
    }
    return std::pair(distance, distance - taken);
  };
  for (int so = body_o.first_shape; so < body_o.first_shape + body_o.shape_count; ++so) {
    if (body_i.shape_count > 1) {
      if (const double lower = bound(inner, so).second; lower > limit) {
        least = std::min(least, lower);
        continue;
      }
    }
    for (int si = body_i.first_shape; si < body_i.first_shape + body_i.shape_count; ++si) {
      const auto [distance, lower] = bound(model.shape_node(si), so);
      if (lower > limit) {
        least = std::min(least, lower);
        continue;
      }
      limit = pair.rigid_a ? visit(so, si, distance) : visit(si, so, distance);
      if (limit == -kInfinity) return least;
    }
  }
  return least;
}

}  // namespace tandem::collision
