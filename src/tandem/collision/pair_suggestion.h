#pragma once
/// Pairs of a robot's links that need no check: a proposal for a person to review.

#include <cstdint>
#include <string>
#include <vector>

#include "tandem/core/stop.h"
#include "tandem/world/workcell.h"

namespace tandem::collision {

/// Why a pair needs no check; the words are MoveIt's.
enum class SuggestionReason {
  kAdjacent,  ///< No link with geometry stands between them.
  kDefault,   ///< They touch where every joint is at 0, or at its limit nearest to it.
  kAlways,    ///< They touched in every sample.
  kNever,     ///< They touched in no sample.
};

/// "Adjacent", "Default", "Always", "Never".
const char* to_string(SuggestionReason reason);

struct PairSuggestion {
  std::string link_a, link_b;
  SuggestionReason reason;
};

struct SuggestionOptions {
  int samples = 10'000;  ///< >= 1
  std::uint64_t seed = 1;
  StopCondition stop = {};
};

/// Samples configurations of the robot alone, all its joints moving within their limits (a
/// continuous joint within one turn). Pairs that its semantics disable already, and those that no
/// joint moves, are left out. "Never" and "Always" are what the samples say, no proof.
/// @return in the order of the model's links; kCancelled or kTimeout; or the error of making a cell
/// of the robot.
Result<std::vector<PairSuggestion>> suggest_disabled_pairs(const world::RobotSpec& robot,
                                                           const SuggestionOptions& options = {});

}  // namespace tandem::collision
