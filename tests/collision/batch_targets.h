#pragma once
/// What tests of the batch checker go through: instruction sets, and kinds of cells.

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <vector>

#include "collision/random_cell.h"

namespace tandem::test {

/// Runs `f` once for each instruction set that this machine and this build have.
template <class F>
void for_each_target(F&& f) {
  hwy::DisableTargets(0);
  for (std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS; targets != 0;
       targets &= targets - 1) {
    const std::int64_t target = targets & -targets;
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    f();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

/// Cells whose links are made of single kinds of shapes, or of everything.
inline std::vector<RandomCellOptions> kinds_of_cells() {
  std::vector<RandomCellOptions> all(1);
  for (int core = 0; core < 7; ++core) {
    RandomCellOptions options;
    options.cores = {static_cast<geometry::CoreType>(core)};
    all.push_back(options);
  }
  RandomCellOptions revolute;
  revolute.prismatic = false;
  revolute.padding = 0;
  all.push_back(revolute);
  RandomCellOptions surfaces;
  surfaces.surface_pieces = 120;
  all.push_back(surfaces);
  return all;
}

}  // namespace tandem::test
