#pragma once
/// Boxes of configurations, many at once.

#include <vector>

#include "tandem/collision/batch_checker.h"

namespace tandem::collision {

/// What is known of a box of configurations.
struct BoxProof {
  enum class Verdict : std::uint8_t {
    kFree,      ///< Proven for every configuration in it, faces included.
    kTouching,  ///< Something touches at its centre.
    kOpen,      ///< Neither is known; smaller boxes may tell.
  };
  Verdict verdict = Verdict::kOpen;
  /// If free: every pair keeps at least this distance [m], never more than
  /// BatchChecker::kClearanceCap.
  double least_clearance = 0;
  double excess = 0;  ///< If open: how many times smaller the box would have to be, about.
};

/// Asks about the boxes |q - Q.col(i)| <= D.col(i), as far as they are inside the joint limits.
/// Centres that touch by more than BatchChecker::margin() are found to, but for shapes without a
/// vector kernel.
/// @param Q,D  dof x n, n >= 0, finite; centres inside the joint limits, half edges not negative.
/// @param pairs,scratch  made by `checker`.
/// @param want_clearance  whether to fill in more than verdicts, at some more cost.
/// @param out  one per column, overwritten; its memory is used again.
/// Ref: docs/methods.md, "Batches".
void prove_boxes(const BatchChecker& checker, const Eigen::Ref<const Eigen::MatrixXd>& Q,
                 const Eigen::Ref<const Eigen::MatrixXd>& D, const BatchPairs& pairs,
                 bool want_clearance, BatchChecker::Scratch& scratch, std::vector<BoxProof>& out);

}  // namespace tandem::collision
