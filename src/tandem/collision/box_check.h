#pragma once
/// What is known of all configurations of a box at once.

#include <span>
#include <vector>

#include "tandem/collision/batch_checker.h"

namespace tandem::collision {

enum class BoxVerdict {
  kFree,      ///< Proven: no pair touches anywhere in the box.
  kTouching,  ///< Proven: one pair touches everywhere in it.
  kOpen,      ///< Neither.
};

struct BoxFinding {
  BoxVerdict verdict = BoxVerdict::kFree;
  int pair = -1;  ///< That touches everywhere, or is not proven apart, touching ones first.
  bool touches_at_center = false;  ///< `pair` does.
  int mover = -1;                  ///< The body of `pair` that may move further in the box.
};

/// Examines the box of all configurations with |q_j - center_j| <= D_j.
/// @param center,D  dof; D >= 0 [rad or m].
/// @param pairs     indices into pairs(); looked at in this order.
/// @param unproven  if the box is open, the pairs not proven apart are appended, `pair` first:
/// those that boxes inside of this one still need to be asked about.
BoxFinding examine_box(const SsvChecker& checker, const Eigen::Ref<const Eigen::VectorXd>& center,
                       const Eigen::Ref<const Eigen::VectorXd>& D, std::span<const int> pairs,
                       CollisionChecker::Scratch& scratch, std::vector<int>& unproven);

/// Boxes that are examined in one go.
int boxes_at_once();

/// Examines up to boxes_at_once() boxes |q - Q.col(i)| <= D.col(i), in single precision. Verdicts
/// are proofs as those of examine_box. Somewhat smaller boxes than there are free or touch, and a
/// centre that touches by less than BatchChecker::margin() may not be seen to. Shapes without a
/// vector kernel are asked of the exact checker.
/// @param Q,D   dof x n, n >= 0, finite; centres inside the joint limits, half edges not negative.
/// @param pairs,scratch  made by `checker`.
/// @param items those of `pairs` to ask about, as an earlier call left them; all, if none are
/// given.
/// @param out   one per column, overwritten.
/// @param open  overwritten: the items that boxes inside of the open ones still need to be asked
/// about.
void examine_boxes(const BatchChecker& checker, const Eigen::Ref<const Eigen::MatrixXd>& Q,
                   const Eigen::Ref<const Eigen::MatrixXd>& D, const BatchPairs& pairs,
                   std::span<const int> items, BatchChecker::Scratch& scratch,
                   std::vector<BoxFinding>& out, std::vector<int>& open);

}  // namespace tandem::collision
