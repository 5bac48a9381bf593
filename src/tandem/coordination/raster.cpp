#include "tandem/coordination/raster.h"

#include <algorithm>

namespace tandem::coordination {

Raster::Raster(const CoordinationDiagram& diagram, int size, std::span<const Barrier> barriers)
    : diagram_(diagram),
      size_(size),
      columns_((diagram.goal().x + size - 1) / size),
      rows_((diagram.goal().y + size - 1) / size) {
  // A square is proven if no leaf in it is anything else, and possible if one is not blocked.
  std::vector<std::uint8_t> unproven(static_cast<std::size_t>(columns_ * rows_));
  squares_.assign(unproven.size(), 0);
  for (const CoordinationDiagram::Cell& c : diagram.cells()) {
    if (!c.is_leaf()) continue;
    const int last_column = (c.x1 - 1) / size, last_row = (c.y1 - 1) / size;
    for (int row = c.y0 / size; row <= last_row; ++row) {
      for (int column = c.x0 / size; column <= last_column; ++column) {
        const auto k = static_cast<std::size_t>(row * columns_ + column);
        unproven[k] |= c.state != CellState::kFree;
        if (c.state == CellState::kBlocked) continue;
        squares_[k] |= bit(Passage::kPossible);
        if (!c.touches) squares_[k] |= bit(Passage::kLikely);
      }
    }
  }
  for (std::size_t k = 0; k < squares_.size(); ++k) {
    if (!unproven[k]) squares_[k] |= bit(Passage::kProven);
  }
  for (const Barrier& barrier : barriers) {
    const int length =
        std::max(std::abs(barrier.b.x - barrier.a.x), std::abs(barrier.b.y - barrier.a.y));
    for (int k = 0; k <= length; ++k) {  // It is parallel to an axis or a diagonal.
      const int x = barrier.a.x + (barrier.b.x - barrier.a.x) * k / std::max(1, length);
      const int y = barrier.a.y + (barrier.b.y - barrier.a.y) * k / std::max(1, length);
      for (const int dx : {0, -1}) {
        for (const int dy : {0, -1}) {
          if (x + dx < 0 || y + dy < 0) continue;
          const int column = (x + dx) / size, row = (y + dy) / size;
          if (column >= columns_ || row >= rows_) continue;
          squares_[static_cast<std::size_t>(row * columns_ + column)] = 0;
        }
      }
    }
  }
}

/// Calls f(node, dc, dr) for every step from a node.
template <class F>
void Raster::for_each_move(int node, Passage passage, F&& f) const {
  const int c = node % (columns_ + 1), r = node / (columns_ + 1);
  const bool ne = is_passable(c, r, passage), nw = is_passable(c - 1, r, passage);
  const bool se = is_passable(c, r - 1, passage), sw = is_passable(c - 1, r - 1, passage);
  const int up = columns_ + 1;
  if (ne) f(node + up + 1, 1, 1);
  if (ne || se) f(node + 1, 1, 0);
  if (ne || nw) f(node + up, 0, 1);
  if (se) f(node - up + 1, 1, -1);
  if (nw) f(node + up - 1, -1, 1);
  if (sw || nw) f(node - 1, -1, 0);
  if (sw || se) f(node - up, 0, -1);
  if (sw) f(node - up - 1, -1, -1);
}

std::vector<int> Raster::steps(Passage passage, bool forward, bool monotone) const {
  std::vector<int> steps(static_cast<std::size_t>(nodes()), -1);
  std::vector<int> queue{forward ? 0 : nodes() - 1};
  queue.reserve(steps.size());
  steps[static_cast<std::size_t>(queue.front())] = 0;
  for (std::size_t k = 0; k < queue.size(); ++k) {
    const int from = queue[k];
    const int next = steps[static_cast<std::size_t>(from)] + 1;
    for_each_move(from, passage, [&](int to, int dc, int dr) {
      if (monotone && (forward ? std::min(dc, dr) < 0 : std::max(dc, dr) > 0)) return;
      if (steps[static_cast<std::size_t>(to)] >= 0) return;
      steps[static_cast<std::size_t>(to)] = next;
      queue.push_back(to);
    });
  }
  return steps;
}

std::vector<int> Raster::descend(const std::vector<int>& steps, Passage passage,
                                 bool monotone) const {
  std::vector<int> way{0};
  while (steps[static_cast<std::size_t>(way.back())] > 0) {
    const int left = steps[static_cast<std::size_t>(way.back())];
    int best = -1;  // The first: both forward rather than one, forward rather than back.
    for_each_move(way.back(), passage, [&](int to, int dc, int dr) {
      if (monotone && std::min(dc, dr) < 0) return;
      if (best < 0 && steps[static_cast<std::size_t>(to)] == left - 1) best = to;
    });
    way.push_back(best);
  }
  return way;
}

}  // namespace tandem::coordination
