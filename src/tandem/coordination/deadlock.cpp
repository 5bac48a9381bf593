#include "tandem/coordination/deadlock.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "tandem/core/contract.h"

namespace tandem::coordination {

namespace {

/// The leaves that touch `seed` or each other, and satisfy `belongs`.
template <class Belongs>
std::vector<int> connected(const CoordinationDiagram& diagram, int seed, Belongs&& belongs,
                           std::vector<char>& is_found) {
  std::vector<int> found, neighbours;
  if (!belongs(seed)) return found;
  found.push_back(seed);
  is_found[static_cast<std::size_t>(seed)] = 1;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const auto& c = diagram.at(found[k]);
    diagram.leaves_touching(c.x0, c.y0, c.x1, c.y1, neighbours);
    for (const int leaf : neighbours) {
      if (is_found[static_cast<std::size_t>(leaf)] || !belongs(leaf)) continue;
      is_found[static_cast<std::size_t>(leaf)] = 1;
      found.push_back(leaf);
    }
  }
  return found;
}

/// What touches most of the wall, and where.
void name_pair(const CoordinationDiagram& diagram, Deadlock& deadlock) {
  const auto area = [&](const CoordinationDiagram::Cell& c) {
    return static_cast<double>(c.x1 - c.x0) * (c.y1 - c.y0);
  };
  std::map<int, double> areas;
  for (const int leaf : deadlock.wall) areas[diagram.at(leaf).pair] += area(diagram.at(leaf));
  deadlock.pair =
      std::ranges::max_element(areas, {}, [](const auto& entry) { return entry.second; })->first;
  deadlock.x0 = deadlock.y0 = std::numeric_limits<double>::infinity();
  for (const int leaf : deadlock.wall) {
    const auto& c = diagram.at(leaf);
    if (c.pair != deadlock.pair) continue;
    deadlock.x0 = std::min(deadlock.x0, diagram.at_x(c.x0));
    deadlock.x1 = std::max(deadlock.x1, diagram.at_x(c.x1));
    deadlock.y0 = std::min(deadlock.y0, diagram.at_y(c.y0));
    deadlock.y1 = std::max(deadlock.y1, diagram.at_y(c.y1));
  }
}

}  // namespace

std::optional<Deadlock> find_deadlock(const CoordinationDiagram& diagram) {
  const auto is_blocked = [&](int leaf) { return diagram.at(leaf).state == CellState::kBlocked; };
  const GridPoint end = diagram.goal();
  const int start = diagram.leaf_at(0, 0), goal = diagram.leaf_at(end.x - 1, end.y - 1);
  const std::size_t count = diagram.cells().size();
  std::vector<char> reached(count);
  const auto region =
      connected(diagram, start, [&](int leaf) { return !is_blocked(leaf); }, reached);
  if (reached[static_cast<std::size_t>(goal)]) return std::nullopt;
  // One component of what borders on the region holds it back alone.
  std::vector<char> known(count);
  std::vector<int> neighbours;
  for (const int leaf : region.empty() ? std::vector{start} : region) {
    const auto& c = diagram.at(leaf);
    diagram.leaves_touching(c.x0, c.y0, c.x1, c.y1, neighbours);
    for (const int seed : neighbours) {
      if (!is_blocked(seed) || known[static_cast<std::size_t>(seed)]) continue;
      Deadlock deadlock;
      deadlock.wall = connected(diagram, seed, is_blocked, known);
      std::vector<char> in_wall(count), beside(count);
      for (const int part : deadlock.wall) in_wall[static_cast<std::size_t>(part)] = 1;
      connected(
          diagram, start, [&](int l) { return !in_wall[static_cast<std::size_t>(l)]; }, beside);
      if (beside[static_cast<std::size_t>(goal)]) continue;
      name_pair(diagram, deadlock);
      return deadlock;
    }
  }
  throw std::logic_error("a region that ends is held back by a wall");
}

std::string describe(const CoordinationDiagram& diagram, const Deadlock& deadlock) {
  expects(diagram.x().arms().size() == 1 && diagram.y().arms().size() == 1,
          "a deadlock is described of two arms");
  const auto name = [&](const Track& track) {
    return diagram.cell().arms()[static_cast<std::size_t>(track.arms()[0])].name;
  };
  char text[128];
  std::snprintf(text, sizeof text, " from %.3f to %.3f s and ", deadlock.x0, deadlock.x1);
  std::string where = name(diagram.x()) + text + name(diagram.y());
  std::snprintf(text, sizeof text, " from %.3f to %.3f s", deadlock.y0, deadlock.y1);
  return "deadlock, proven: on these paths no timing brings both arms to their goals, not even "
         "going back. " +
         diagram.cell().describe_pair(deadlock.pair) + " stand in each other's way, " + where +
         text + " of their own motions; other paths are needed";
}

}  // namespace tandem::coordination
