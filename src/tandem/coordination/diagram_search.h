#pragma once
/// The least way through a coordination diagram.

#include <functional>
#include <limits>
#include <optional>

#include "tandem/coordination/diagram.h"

namespace tandem::coordination {

struct SearchOptions {
  bool monotone = false;  ///< No track goes back.
  double gap = 0.1;       ///< In [0, 1): by what part a shorter way may go unnoticed.
  double coarse = 0.2;    ///< [s] of local time: how finely everything is examined first, > 0.
  /// [s] Longer ways are of no use; where there seems to be no shorter one none is found.
  double longest = std::numeric_limits<double>::infinity();
};

/// What must not be crossed, parallel to an axis or a diagonal of the units.
struct Barrier {
  GridPoint a, b;
};

/// A polyline from (0, 0) to the goal, through free cells only.
struct DiagramWay {
  std::vector<GridPoint> points;
  double length = 0;  ///< [s] L-infinity.
};

struct SearchResult {
  std::optional<DiagramWay> way;
  bool is_separated = false;  ///< Blocked cells alone separate start and goal: there is no way.
  bool is_stopped = false;
};

/// Finds a way that is about the shortest in the L-infinity sense.
///
/// The straight line first. Then everything is examined coarsely. The shortest way over proven
/// squares is pulled taut, and the cells at its bends are divided as long as that shortens it. If
/// ways through cells that are free at their middles could be shorter by more than the gap, or if
/// there is none yet, the cells on those are halved, and so on down to single units.
/// Ref: docs/methods.md, "Coordination".
/// @param barriers  what the way must not cross: to find others.
SearchResult find_way(CoordinationDiagram& diagram, const SearchOptions& options,
                      std::span<const Barrier> barriers, const StopCondition& stop);

/// Hands over the shortest way, then others that pass an obstacle on another side.
/// @param use  returns the length from which on further ways are of no use [s].
/// @return false if there is none, or if it was stopped before the first.
bool explore_ways(CoordinationDiagram& diagram, const SearchOptions& options,
                  const StopCondition& stop, const std::function<double(const DiagramWay&)>& use);

}  // namespace tandem::coordination
