#include "tandem/pipeline/modules.h"

#include "tandem/planning/composite.h"
#include "tandem/planning/ompl/ompl_planning.h"
#include "tandem/planning/simplifier.h"
#include "tandem/shortening/nlopt/slsqp_shortener.h"
#include "tandem/trajectory/nlopt/slsqp_time_optimizer.h"

namespace tandem::pipeline {

namespace {

/// Longest unchecked piece of an edge, as a fraction of one arm's L1 extent.
/// Ref: the paper, "Planner Parameters".
constexpr double kPaperSegmentFraction = 0.001;

double paper_resolution(const world::Workcell& cell) {
  // The paper halves the fraction for two arms: the same length as for each arm alone.
  return kPaperSegmentFraction * planning::l1_extent(cell.lower(), cell.upper()) /
         static_cast<double>(cell.arms().size());
}

}  // namespace

Modules make_modules(Preset preset, const collision::CompiledCell& compiled,
                     const StopCondition& stop) {
  Modules modules;
  switch (preset) {
    case Preset::kDefault:
      modules.planner = planning::make_composite_planner();
      modules.simplifier = planning::make_simplifier();
      modules.validity = planning::make_batch_validity_by_arm(compiled, stop);
      modules.shortener = shortening::make_structured_shortener();
      modules.shortening.prove_edges = true;
      modules.shortening.tolerance = 3e-3;  // Lengths change by less than 0.1 %.
      modules.shortening.edges = 10;        // Likewise; long paths take more.
      modules.timing = trajectory::make_barrier_optimizer();
      modules.repair = true;
      break;
    case Preset::kPaper:
      modules.planner = planning::make_ompl_rrt_connect();
      modules.simplifier = planning::make_ompl_simplifier();
      modules.validity = planning::make_sampled_validity(
          compiled.exact(), compiled.selection(world::PairScope::all()),
          paper_resolution(compiled.cell()));
      modules.shortener = shortening::make_slsqp_shortener();
      modules.shortening.weights.joints = 0;
      modules.shortening.joint_limits = false;
      modules.timing = trajectory::make_slsqp_time_optimizer();
      modules.batches = false;
      modules.repair = false;
      break;
  }
  return modules;
}

void prepare_modules(Preset preset, const collision::CompiledCell& compiled) {
  (void)make_modules(preset, compiled, {}).validity->by_arm();
}

}  // namespace tandem::pipeline
