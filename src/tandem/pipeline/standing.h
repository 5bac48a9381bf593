#pragma once
/// Everything that speaks against standing somewhere: for people who mend a cell.

#include <vector>

#include "tandem/collision/checker.h"

namespace tandem::pipeline {

/// A joint outside its position limits.
struct LimitExcess {
  int entry;            ///< Of the cell's q.
  double value, limit;  ///< [rad or m]; `limit` is the one that is exceeded.
};

struct Standing {
  std::vector<LimitExcess> outside;                ///< In order of q.
  std::vector<collision::PairClearance> touching;  ///< Deepest first.
  bool ok() const { return outside.empty() && touching.empty(); }
};

/// @param q  of the cell.   NaN counts as outside; then nothing is said about touching pairs.
Standing examine(const collision::CollisionChecker& checker,
                 const Eigen::Ref<const Eigen::VectorXd>& q);

}  // namespace tandem::pipeline
