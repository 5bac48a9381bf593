#pragma once
/// Coordination by adaptive diagrams: the default.

#include <memory>

#include "tandem/coordination/diagram_search.h"

namespace tandem::coordination {

struct DiagramCoordinatorOptions {
  DiagramOptions diagram = {};
  SearchOptions search = {};
};

/// Two arms: the shortest way through their diagram, or the proof that there is none. More arms are
/// merged one after the other, each into the schedule of those before, in all orders of up to four
/// (of more: in the rotations of one), of which the least makespan counts; where all fail, all arms
/// are searched for at once, or two are shown to deadlock.
/// Ref: docs/methods.md, "Coordination".
std::unique_ptr<Coordinator> make_diagram_coordinator(
    const DiagramCoordinatorOptions& options = {});

/// Compiles all that this coordinator, and proofs of motions of several arms, ask of a cell of up
/// to four arms; what more arms ask is compiled when it is first asked.
void prepare_coordination(const collision::CompiledCell& compiled);

}  // namespace tandem::coordination
