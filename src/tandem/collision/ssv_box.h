#pragma once
/// One pair over a box of configurations around the placed one.

#include "tandem/collision/ssv_scratch.h"

namespace tandem::collision {

/// Covers the rounding of poses and distances, the iterative kernels of cylinders included [m].
inline constexpr double kBoxRounding = 2e-9;

struct PairOnBox {
  enum class Finding {
    kApart,     ///< Everywhere.
    kUnproven,  ///< Apart as placed.
    kTouching,  ///< As placed.
  };
  Finding finding;
  double bound = std::numeric_limits<double>::infinity();  ///< [m] What it keeps, if kApart.
};

/// The pair over all q within the scratch's deviation of the placed one. What lies inside a closed
/// mesh without touching it is not asked for.
/// @param target  what the pair must keep to be apart [m].
/// @param enough  a bound above this need not be computed: infinity stands for it [m].
PairOnBox examine_on_box(SsvScratch& scratch, const SsvPair& pair, double target, double enough);

/// Whether two pieces of the pair overlap by more than they move on the box: they touch everywhere.
bool touches_on_box(SsvScratch& scratch, const SsvPair& pair);

}  // namespace tandem::collision
