#pragma once
/// What is known of all configurations of a box at once.

#include <span>
#include <vector>

#include "tandem/collision/ssv_checker.h"

namespace tandem::collision {

enum class BoxVerdict {
  kFree,      ///< Proven: no pair touches anywhere in the box.
  kTouching,  ///< Proven: one pair touches everywhere in it.
  kOpen,      ///< Neither.
};

struct BoxFinding {
  BoxVerdict verdict = BoxVerdict::kFree;
  int pair =
      -1;  ///< That touches everywhere, or one that is not proven apart, touching ones first.
  bool touches_at_center = false;  ///< `pair` does.
  /// How far the middles of the two bodies of `pair` may move in the box, about [m].
  double travel_a = 0, travel_b = 0;
};

/// Examines the box of all configurations with |q_j - center_j| <= D_j.
/// @param center,D  dof; D >= 0 [rad or m].
/// @param pairs     indices into pairs(); looked at in this order.
/// @param unproven  if the box is open, the pairs not proven apart are appended, `pair` first:
/// those
///                  that boxes inside of this one still need to be asked about.
BoxFinding examine_box(const SsvChecker& checker, const Eigen::Ref<const Eigen::VectorXd>& center,
                       const Eigen::Ref<const Eigen::VectorXd>& D, std::span<const int> pairs,
                       CollisionChecker::Scratch& scratch, std::vector<int>& unproven);

}  // namespace tandem::collision
