#pragma once
/// What `tandem check` says about a workcell.

#include <string>
#include <vector>

#include "tandem/world/workcell.h"

namespace tandem::app {

/// Whether a query's ends can be stood at.
struct QueryCheck {
  std::string name;
  bool feasible = true;
  std::string reason;  ///< Of an infeasible one.
};

/// @param pairs  whether to list every pair.
std::string check_text(const world::Workcell& cell, const std::vector<QueryCheck>& queries,
                       bool pairs);
std::string check_json(const world::Workcell& cell, const std::vector<QueryCheck>& queries,
                       bool pairs);

}  // namespace tandem::app
