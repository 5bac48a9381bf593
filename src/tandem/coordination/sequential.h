#pragma once
/// One arm after the other.

#include <memory>

#include "tandem/coordination/coordinator.h"

namespace tandem::coordination {

/// Runs the arms one after the other, each at planned speed while the others stand: the first order
/// that is free, of all orders by place. All makespans are the sum of the durations.
std::unique_ptr<Coordinator> make_sequential_coordinator();

}  // namespace tandem::coordination
