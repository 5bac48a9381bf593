#pragma once
/// Paths of the small cell, for tests of shorteners.

#include <gtest/gtest.h>

#include "small_cell.h"
#include "tandem/collision/compiled_cell.h"
#include "tandem/planning/composite.h"
#include "tandem/planning/validity.h"
#include "tandem/shortening/shortener.h"

namespace tandem::shortening {

class PlannedPaths : public testing::Test {
 protected:
  /// Around the wall, with at least `count` waypoints.
  motion::JointPath planned(std::uint64_t seed, int count = 12) const {
    const auto validity = planning::make_batch_validity(batch_, selection_);
    Eigen::VectorXd start(8), goal(8);
    start << 1.0, -0.2, 0.3, 0, 0.9, -0.3, 0.4, 0;
    goal << -0.8, -0.2, 0.3, 0, -0.9, -0.3, 0.4, 0;
    const planning::PathProblem problem{start, goal, cell_->lower(), cell_->upper()};
    const auto path = planning::make_composite_planner()->plan(problem, *validity, seed,
                                                               StopCondition::after(30));
    return motion::interpolated(path.value(), count);
  }
  Shortening shorten(const motion::JointPath& path, const ShorteningOptions& options,
                     const StopCondition& stop = {}) const {
    return shortener_->shorten(compiled_, world::PairScope::all(), path, options, stop);
  }

  std::shared_ptr<const world::Workcell> cell_ = test::small_cell();
  collision::CompiledCell compiled_{cell_};
  const collision::BatchChecker& batch_ = compiled_.batch();
  world::PairSelection selection_ = compiled_.selection(world::PairScope::all());
  collision::BatchChecker::Pairs pairs_ = compiled_.pairs(world::PairScope::all());
  std::unique_ptr<Shortener> shortener_ = make_structured_shortener();
};

}  // namespace tandem::shortening
