#pragma once
/// Decoupled planning: each arm alone, then their motions coordinated. Internal to pipeline/.

#include "tandem/collision/compiled_cell.h"
#include "tandem/core/stop.h"
#include "tandem/pipeline/plan.h"

namespace tandem::pipeline {

/// What is tried, in this order, until a motion of all arms is found. Ref: docs/methods.md, "The
/// ladder".
enum class Rung {
  kCoordinated,  ///< The motions of all arms, each planned alone, are coordinated.
  kCandidates,   ///< Further motions of each arm, and other sets of them, are.
  kPrioritized,  ///< Arms are planned one after the other around those before them.
  kCentralized,  ///< All arms together.
};

/// Its name in PlanReport::rungs: "coordinated", "candidates", ...
const char* to_string(Rung rung);

struct LadderOptions {
  Rung first = Rung::kCoordinated, last = Rung::kCentralized;
  int candidates = 3;  ///< Motions per arm, > 0.
};

/// Plans every arm alone at the same time, one thread each, and coordinates their motions; what
/// cannot be coordinated climbs the ladder. With Preset::kPaper there is no ladder, and no repair.
/// `ends` were checked. The rung that led to the motion is in `report`.
/// @return kCoordination if the arms block each other, naming what blocks; the errors of `plan`.
/// Ref: the paper, "Decoupled Planning with Fixed-Path Coordination".
Result<motion::CellMotion> plan_decoupled(const collision::CompiledCell& compiled,
                                          const ResolvedQuery& ends, const PlanOptions& options,
                                          const StopCondition& stop, PlanReport& report,
                                          const LadderOptions& ladder = {});

/// Decoupled where the arms hardly hinder each other, centralized where they do.
/// Ref: docs/methods.md, "The ladder".
Result<motion::CellMotion> plan_auto(const collision::CompiledCell& compiled,
                                     const ResolvedQuery& ends, const PlanOptions& options,
                                     const StopCondition& stop, PlanReport& report);

}  // namespace tandem::pipeline
