#pragma once
/// What `tandem check` says about a workcell.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tandem/collision/pair_suggestion.h"
#include "tandem/pipeline/plan.h"
#include "tandem/pipeline/standing.h"

namespace tandem::app {

/// Whether a query's ends can be stood at.
struct QueryCheck {
  std::string name;
  std::string reason;  ///< Why its ends have no joint values; else empty.
  std::optional<pipeline::ResolvedQuery> ends;
  pipeline::Standing start, goal;
  /// The cell during its motion, where it has one of its own; its pairs are those of `touching`.
  const world::Workcell& cell_or(const world::Workcell& cell) const {
    return ends && ends->cell ? *ends->cell : cell;
  }
  bool feasible() const { return ends && start.ok() && goal.ok(); }
};

/// What speaks against the query, one sentence each.
std::vector<std::string> problems(const world::Workcell& cell, const QueryCheck& query);

/// How many pieces of which kind a body has: "box", "triangle mesh", ...
std::map<std::string, int> piece_counts(const world::Body& body);
/// "robot link", "obstacle", "attached".
const char* to_string(world::Body::Kind kind);
const std::string& body_name(const world::Workcell& cell, int body);
/// Skipped pairs by reason.
std::map<std::string, int> skipped_by_reason(const world::Workcell& cell);
/// What could be better, one sentence each.
std::vector<std::string> advice(const world::Workcell& cell);

/// @param pairs  whether to list every pair.
std::string check_text(const world::Workcell& cell, const std::vector<QueryCheck>& queries,
                       bool pairs);
std::string check_json(const world::Workcell& cell, const std::vector<QueryCheck>& queries,
                       bool pairs);

/// Pairs that a robot need not check, found in `samples` samples.
struct RobotSuggestion {
  const world::RobotSpec* robot;
  std::vector<collision::PairSuggestion> pairs;
};
/// SRDF elements under a comment per robot.
std::string suggestions_text(const std::vector<RobotSuggestion>& robots, int samples,
                             std::uint64_t seed);
std::string suggestions_json(const std::vector<RobotSuggestion>& robots, int samples,
                             std::uint64_t seed);

}  // namespace tandem::app
