#pragma once
/// Collision checks of many configurations at once, and of straight edges with a proof.

#include <cstdint>
#include <memory>

#include "tandem/collision/ssv_checker.h"
#include "tandem/core/stop.h"

namespace tandem::collision {

struct BatchModel;
struct BatchPairs;
struct JointMaps;

/// What is known of a straight edge.
struct EdgeProof {
  bool is_free = false;  ///< Proven for every point of the edge, both ends included.
  /// Every pair keeps at least this distance all along [m], if free; a lower bound, and never more
  /// than BatchChecker::kClearanceCap.
  double least_clearance = 0;
};

/// Pairs of shapes that are near each other, by configuration.
struct NearShapes {
  std::vector<PairClearance> clearances;
  /// The same for the same two shapes in every configuration; kNoKey for pieces of surfaces.
  std::vector<std::uint64_t> keys;
  static constexpr std::uint64_t kNoKey = ~std::uint64_t{0};
  std::vector<double> gradients;   ///< d distance / d q, dof entries each [m/rad or -].
  std::vector<std::size_t> first;  ///< Of each configuration, and the end.

  Eigen::Map<const Eigen::VectorXd> gradient(std::size_t i, Eigen::Index dof) const {
    return {gradients.data() + i * static_cast<std::size_t>(dof), dof};
  }
};

/// The fast path of SsvChecker: several configurations in the lanes of one vector, in single
/// precision, for the instruction set found at run time.
///
/// Single precision decides what is further from touching than `margin()`; the rest, and pairs of
/// shapes without a vector kernel, are asked of the exact checker, pair by pair. So verdicts on
/// configurations are those of SsvChecker, and an accepted edge is proven. Immutable and
/// thread-safe; what changes lives in a Scratch, one per thread.
/// Ref: docs/methods.md, "Batches".
class BatchChecker {
 public:
  /// Work space, and the pair that was hit last.
  class Scratch;
  struct ScratchDeleter {
    void operator()(Scratch* scratch) const;
  };
  using ScratchPtr = std::unique_ptr<Scratch, ScratchDeleter>;
  /// A selection of pairs, compiled: immutable, share it between threads.
  using Pairs = std::shared_ptr<const BatchPairs>;

  static constexpr double kClearanceCap = 0.02;  ///< [m]

  /// @param exact  decides what single precision cannot; must outlive the checker.
  /// @param known  of this or another cell: what it holds of the same links is not proven anew.
  explicit BatchChecker(const SsvChecker& exact, const JointMaps* known = nullptr);
  ~BatchChecker();
  BatchChecker(const BatchChecker&) = delete;
  BatchChecker& operator=(const BatchChecker&) = delete;

  const SsvChecker& exact() const { return exact_; }
  const world::Workcell& cell() const { return exact_.cell(); }

  /// Pairs that no configuration inside the joint limits brings nearer than `within` [m], at least
  /// kClearanceCap, are left out.
  Pairs compile(const world::PairSelection& selection, double within = kClearanceCap) const;
  Pairs compile(const world::PairScope& scope) const { return compile(cell().select(scope)); }
  ScratchPtr make_scratch() const;
  /// What was proven ahead of time, for checkers of other cells.
  const std::shared_ptr<const JointMaps>& joint_maps() const;

  /// Whether every column of Q (dof x n, n >= 0, finite) is free. Most colliding blocks end at the
  /// first pair found. Allocates nothing.
  bool are_free(const Eigen::Ref<const Eigen::MatrixXd>& Q, const BatchPairs& pairs,
                Scratch& scratch) const;

  /// Whether the straight edge from a to b is free, with a proof; the same answer for (b, a). Only
  /// edges that come nearer than `margin()` may be free and rejected.
  /// @param a,b  dof, finite, inside the joint limits.
  bool is_edge_free(const Eigen::Ref<const Eigen::VectorXd>& a,
                    const Eigen::Ref<const Eigen::VectorXd>& b, const BatchPairs& pairs,
                    Scratch& scratch, const StopCondition& stop = {}) const;
  /// The same with the clearance that was proven, at some more cost.
  EdgeProof prove_edge(const Eigen::Ref<const Eigen::VectorXd>& a,
                       const Eigen::Ref<const Eigen::VectorXd>& b, const BatchPairs& pairs,
                       Scratch& scratch, const StopCondition& stop = {}) const;

  /// All pairs of shapes nearer than `within` [m] at the columns of Q (dof x n, n >= 0, finite):
  /// those of SsvChecker::shape_clearances, in another order, but for pairs left out of `pairs`.
  /// Exact; vectors only find which shapes are near.
  /// @param out  overwritten; its memory is used again.
  void shape_clearances(const Eigen::Ref<const Eigen::MatrixXd>& Q, const BatchPairs& pairs,
                        double within, Scratch& scratch, NearShapes& out) const;
  /// The least distance of every column, or `within` [m] where nothing is nearer.
  /// @param out  n, overwritten [m].
  void least_clearances(const Eigen::Ref<const Eigen::MatrixXd>& Q, const BatchPairs& pairs,
                        double within, Scratch& scratch, Eigen::Ref<Eigen::VectorXd> out) const;

  /// Bound of the rounding of a distance in single precision [m].
  double margin() const;

 private:
  EdgeProof examine(const Eigen::Ref<const Eigen::VectorXd>& a,
                    const Eigen::Ref<const Eigen::VectorXd>& b, const BatchPairs& pairs,
                    bool want_clearance, Scratch& scratch, const StopCondition& stop) const;
  EdgeProof prove_exactly(const BatchPairs& pairs, Scratch& scratch,
                          const StopCondition& stop) const;

  const SsvChecker& exact_;
  std::vector<int> leaves_;  ///< Of the exact model, by shape; -1: a surface.
  /// Calls f(first column) for every block of columns with what is near in it in scratch.near.
  template <class F>
  void for_each_block(const Eigen::Ref<const Eigen::MatrixXd>& Q, const BatchPairs& pairs,
                      double within, Scratch& scratch, F&& f) const;

  std::unique_ptr<BatchModel> model_;
};

}  // namespace tandem::collision
