#pragma once
/// What the literature does, on the same interface: for comparison.

#include <memory>

#include "tandem/coordination/coordinator.h"

namespace tandem::coordination {

struct GridOptions {
  double step = 0.05;  ///< [s] Side of a square of the grid, > 0.
};

/// One arm at a time in the shared workspace. An arm is in it while the other, somewhere on its
/// motion, could touch it (or is not proven not to): the least zone that there can be. More arms
/// are merged in their order.
std::unique_ptr<Coordinator> make_exclusive_coordinator(const GridOptions& options = {});

/// The scheduler on the SW-closure of the collision regions of a grid: no arm goes back, and none
/// enters a place from which it could only wait for ever. Both arms advance where they can, else
/// one of them; of the two ways to prefer an arm the shorter one. More arms are merged in their
/// order.
/// Ref: O'Donnell, Lozano-Perez, Deadlock-free and collision-free coordination of two robot
/// manipulators (1989); Lipski, Papadimitriou, A fast algorithm for testing for safety (1981).
std::unique_ptr<Coordinator> make_sw_closure_coordinator(const GridOptions& options = {});

/// Shortest ways on which no arm goes back: what linear interpolation with C1 timing runs along.
/// Ref: Beuke et al., Online motion planning for dual arm industrial robots (2018).
std::unique_ptr<Coordinator> make_monotone_coordinator();

}  // namespace tandem::coordination
