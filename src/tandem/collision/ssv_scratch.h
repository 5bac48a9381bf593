#pragma once
/// One placement of a compiled cell.

#include <limits>
#include <optional>
#include <span>

#include "tandem/collision/ssv_model.h"

namespace tandem::collision {

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

/// A clearance from a piece of a surface.
struct FoundClearance {
  PairClearance clearance;
  int leaf;  ///< The other body's.
};

/// Poses, spheres and shapes are computed when first asked for. Its memory grows with what moves,
/// surfaces excepted; what stands still is read from the model.
class SsvScratch final : public CollisionChecker::Scratch {
 public:
  explicit SsvScratch(const SsvModel& model);

  const SsvModel& model() const { return model_; }
  void place(const Eigen::Ref<const Eigen::VectorXd>& q);

  /// Pose of frame J of a joint >= 0.
  const Eigen::Isometry3d& pose(int joint) {
    const auto j = static_cast<std::size_t>(joint);
    if (pose_time_[j] < now_) place_joint(j);
    return X_WJ_[j];
  }
  /// Centre of a node's sphere in W. Inline in every loop over pairs, where most of them end: as a
  /// call it costs the exact checker a fifth.
  [[gnu::always_inline]] Eigen::Vector3d center(int node) {
    const SsvNode& n = model_.node(node);
    if (n.slot < 0) return n.joint < 0 ? n.p_JC : in_world(n.joint, n.p_JC);
    const auto slot = static_cast<std::size_t>(n.slot);
    if (center_time_[slot] < now_) place_node(n);
    return p_WC_[slot];
  }
  /// Point P, fixed in the frame of a joint, in W.
  Eigen::Vector3d in_world(int joint, const Eigen::Vector3d& p_JP) {
    if (joint < 0) return p_JP;
    const Eigen::Isometry3d& X_WJ = pose(joint);
    return X_WJ.linear() * p_JP + X_WJ.translation();
  }
  /// A leaf's piece in W. That of a surface is valid until this is asked for another one with the
  /// same `side`, 0 or 1.
  const geometry::Shape& piece(int leaf, int side) {
    const SsvNode& n = model_.node(leaf);
    if (!n.is_shape()) return surface_piece(leaf, side);
    const SsvShape& shape = model_.shape(n.piece);
    if (shape.slot < 0) return shape.shape_J;
    const auto slot = static_cast<std::size_t>(shape.slot);
    if (shape_time_[slot] < now_) place_shape(n, shape);
    return shape_W_[slot];
  }
  /// Calls f(vertex in W) for the vertices of a hull of the core of a leaf.
  template <class F>
  void for_each_vertex(int leaf, int side, F&& f) {
    const SsvNode& n = model_.node(leaf);
    if (n.is_shape()) {
      for (const Eigen::Vector3d& v_J : model_.shape(n.piece).vertices_J) f(in_world(n.joint, v_J));
      return;
    }
    const geometry::Shape& piece_W = piece(leaf, side);
    f(piece_W.origin());
    for (int i = 0; i < piece_W.size_count(); ++i) f(piece_W.origin() + piece_W.extents().col(i));
  }

  /// Distance of the bounding spheres of two nodes [m].
  double sphere_distance(int i, int j) {
    return (center(i) - center(j)).norm() - model_.node(i).radius - model_.node(j).radius;
  }
  /// Whether two bounding spheres are further apart than `margin` [m].
  bool spheres_apart(int i, int j, double margin) {
    const double reach = model_.node(i).radius + model_.node(j).radius + margin;
    return reach < 0 || (center(i) - center(j)).squaredNorm() > reach * reach;
  }
  /// Distance of the bounding sphere of `node` to the rounded box of a leaf that is a shape [m].
  double box_distance(int node, int leaf);

  /// How far the entries of q may be from the placed ones [rad or m]; travel() refers to it.
  void set_deviation(const Eigen::Ref<const Eigen::VectorXd>& D);
  /// Upper bound of how far the centre of `node` moves by the joints below depth `shared` [m].
  double travel(int node, int shared) {
    const SsvNode& n = model_.node(node);
    if (model_.depth_of(n.joint) <= shared) return 0;
    if (n.slot < 0) return travel_of_point(center(node), n.joint, shared);
    const auto slot = static_cast<std::size_t>(n.slot);
    if (travel_time_[slot] < now_) bound_travel(node);
    return travel_[slot * static_cast<std::size_t>(model_.depth) +
                   static_cast<std::size_t>(shared)];
  }
  /// The same of a point fixed on `joint`.
  double travel_of_point(const Eigen::Vector3d& p_WP, int joint, int shared);
  /// The same of every point of the core of a leaf.
  double core_travel(int leaf, int shared, int side);
  /// Upper bound of how far point P of `joint` moves along +-n by the joints below `common` [m].
  /// Ref: docs/methods.md, "Continuous-time certificate".
  double travel_along(const Eigen::Vector3d& n_W, int joint, int common,
                      const Eigen::Vector3d& p_WP);

  /// d distance / d q of a clearance as placed, dof entries, overwritten.
  void gradient(const PairClearance& clearance, std::span<double> out);

  /// Bytes that it holds beside the buffers of the certificate, about.
  std::size_t memory() const;

  std::size_t last_hit = 0;  ///< Position in a selection: the next query begins there.
  CertificateBuffers certificate;
  std::vector<FoundClearance> found;  ///< Work space of shape_clearances().

 private:
  /// The piece of a surface that was built last, by side.
  struct BuiltPiece {
    int leaf = -1;
    std::uint64_t time = 0;
    std::optional<geometry::Shape> shape_W;
  };

  /// core_travel() that was computed last of a shape.
  struct CoreTravel {
    std::uint64_t time = 0;
    int shared = 0;
    double travel = 0;  ///< [m]
  };

  void add_gradient(const Eigen::Vector3d& n_W, const Eigen::Vector3d& p_WP, int joint, int common,
                    std::span<double> out);
  void place_joint(std::size_t j);
  void place_node(const SsvNode& node);
  void place_shape(const SsvNode& leaf, const SsvShape& shape);
  const geometry::Shape& surface_piece(int leaf, int side);
  void bound_travel(int node);
  double bound_core_travel(int leaf, int shared, int side);
  double travel_by(std::size_t j, const Eigen::Vector3d& p_WP) const;

  const SsvModel& model_;
  // Everything has the time that it was computed at.
  std::uint64_t now_ = 1;
  Eigen::VectorXd q_;
  std::vector<Eigen::Isometry3d> X_WJ_;
  std::vector<Eigen::Vector3d> p_WC_;
  std::vector<geometry::Shape> shape_W_;
  BuiltPiece built_[2];
  std::vector<double> D_, chord_, turn_;  // By joint, see set_deviation.
  std::vector<double> travel_;            // Slots x depth.
  std::vector<CoreTravel> core_travel_;   // By slot of shapes.
  std::vector<std::uint64_t> pose_time_, center_time_, shape_time_, travel_time_;
};

/// The scratch, if it was made for this model; else throws ContractViolation.
SsvScratch& own_scratch(const SsvModel& model, CollisionChecker::Scratch& scratch);
/// Whether two bodies with bounding spheres that overlap touch.
bool pieces_touch(SsvScratch& scratch, const SsvPair& pair);
/// Whether the bodies of a pair touch as placed.
inline bool touches(SsvScratch& scratch, const SsvPair& pair) {
  return !scratch.spheres_apart(pair.a, pair.b, 0) && pieces_touch(scratch, pair);
}
/// Whether a part of one body lies inside a closed mesh of the other.
/// For parts that touch none of its triangles, see SsvModel about anchors; of others perhaps.
bool is_inside(SsvScratch& scratch, const SsvPair& pair);
/// Replaces `best` by what lies deepest inside a closed mesh of the other body of pair `index`, if
/// that is deeper. The depth is a lower bound of the true one.
void improve_inside(SsvScratch& scratch, int index, PairClearance& best);
/// Appends all clearances of shapes of a pair as placed, see SsvChecker::shape_clearances.
void add_shape_clearances(SsvScratch& scratch, int index, double within,
                          std::vector<PairClearance>& out);
/// Replaces `best` by the clearance of pair `index` as placed, if that is less.
void improve(SsvScratch& scratch, int index, PairClearance& best);

}  // namespace tandem::collision
