#include "tandem/pipeline/standing.h"

#include <algorithm>

#include "tandem/core/contract.h"

namespace tandem::pipeline {

Standing examine(const collision::CollisionChecker& checker,
                 const Eigen::Ref<const Eigen::VectorXd>& q) {
  const world::Workcell& cell = checker.cell();
  expects(q.size() == cell.dof(), "q has one entry per joint of the cell's arms");
  Standing standing;
  for (int i = 0; i < cell.dof(); ++i) {
    if (cell.lower()[i] <= q[i] && q[i] <= cell.upper()[i]) continue;
    standing.outside.push_back(
        {i, q[i], q[i] > cell.upper()[i] ? cell.upper()[i] : cell.lower()[i]});
  }
  if (!q.allFinite()) return standing;
  const auto scratch = checker.make_scratch();
  checker.clearances(q, cell.select(world::PairScope::all()), 0.0, *scratch, standing.touching);
  std::erase_if(standing.touching, [](const auto& c) { return c.distance > 0; });
  std::ranges::stable_sort(standing.touching, {}, &collision::PairClearance::distance);
  return standing;
}

}  // namespace tandem::pipeline
