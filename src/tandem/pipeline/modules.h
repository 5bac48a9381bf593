#pragma once
/// The modules a preset is made of. Internal to pipeline/.

#include <memory>

#include "tandem/collision/compiled_cell.h"
#include "tandem/core/stop.h"
#include "tandem/pipeline/plan.h"
#include "tandem/planning/planner.h"
#include "tandem/shortening/shortener.h"
#include "tandem/trajectory/time_optimizer.h"

namespace tandem::pipeline {

struct Modules {
  std::unique_ptr<planning::PathPlanner> planner;
  std::unique_ptr<planning::PathSimplifier> simplifier;
  std::unique_ptr<trajectory::TimeOptimizer> timing;
  std::unique_ptr<planning::Validity> validity;
  std::unique_ptr<shortening::Shortener> shortener;
  shortening::ShorteningOptions shortening;
  bool batches = true;  ///< Whether the curve is proven by batches.
  bool repair = true;   ///< Whether a curve that touches something is repaired or an error.
};

/// @param compiled  must outlive the modules.   @param stop  ends a long proof of an edge, too.
Modules make_modules(Preset preset, const collision::CompiledCell& compiled,
                     const StopCondition& stop);

/// Compiles what these modules would compile when they are first asked, so that no plan has to.
void prepare_modules(Preset preset, const collision::CompiledCell& compiled);

/// Adds the wall time of its scope to a report's entry.
class ModuleTimer {
 public:
  explicit ModuleTimer(double& seconds) : seconds_(seconds) {}
  ~ModuleTimer() { seconds_ += std::chrono::duration<double>(Clock::now() - begin_).count(); }
  ModuleTimer(const ModuleTimer&) = delete;
  ModuleTimer& operator=(const ModuleTimer&) = delete;

 private:
  double& seconds_;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace tandem::pipeline
