#include "tandem/coordination/raster.h"

#include <algorithm>

namespace tandem::coordination {

Raster::Raster(const CoordinationDiagram& diagram, int size, std::span<const Barrier> barriers,
               const Corridor& within)
    : diagram_(diagram),
      size_(size),
      columns_((diagram.goal().x + size - 1) / size),
      rows_((diagram.goal().y + size - 1) / size),
      stride_(columns_ + 2),
      squares_(static_cast<std::size_t>(stride_ * (rows_ + 2))) {
  enter_cells();
  for (const Barrier& barrier : barriers) enter_barrier(barrier);
  if (within.size > 0) leave_only(within);
}

/// A square is proven if no leaf in it is anything else, and possible if one is not blocked.
void Raster::enter_cells() {
  constexpr std::uint8_t kAll =
      bit(Passage::kProven) | bit(Passage::kLikely) | bit(Passage::kPossible);
  for (int row = 0; row < rows_; ++row) {
    std::fill_n(squares_.begin() + static_cast<std::ptrdiff_t>(square(0, row)), columns_,
                bit(Passage::kProven));
  }
  for (const CoordinationDiagram::Cell& c : diagram_.cells()) {
    if (!c.is_leaf()) continue;
    const bool is_free = c.state == CellState::kFree, is_blocked = c.state == CellState::kBlocked;
    const std::uint8_t keep = is_free ? kAll : kAll & ~bit(Passage::kProven);
    std::uint8_t add = is_blocked ? 0 : bit(Passage::kPossible);
    if (!is_blocked && !c.touches) add |= bit(Passage::kLikely);
    const int first = c.x0 / size_, count = (c.x1 - 1) / size_ - first + 1;
    const int last_row = (c.y1 - 1) / size_;
    for (int row = c.y0 / size_; row <= last_row; ++row) {
      std::uint8_t* of_row = &squares_[square(first, row)];
      for (int k = 0; k < count; ++k) {
        of_row[k] = static_cast<std::uint8_t>((of_row[k] & keep) | add);
      }
    }
  }
}

/// It is parallel to an axis or a diagonal.
void Raster::enter_barrier(const Barrier& barrier) {
  const int length =
      std::max(std::abs(barrier.b.x - barrier.a.x), std::abs(barrier.b.y - barrier.a.y));
  for (int k = 0; k <= length; ++k) {
    const int x = barrier.a.x + (barrier.b.x - barrier.a.x) * k / std::max(1, length);
    const int y = barrier.a.y + (barrier.b.y - barrier.a.y) * k / std::max(1, length);
    for (const int dx : {0, -1}) {
      for (const int dy : {0, -1}) {
        if (x + dx < 0 || y + dy < 0) continue;
        const int column = (x + dx) / size_, row = (y + dy) / size_;
        if (column < columns_ && row < rows_) squares_[square(column, row)] = 0;
      }
    }
  }
}

void Raster::leave_only(const Corridor& within) {
  const int ratio = within.size / size_;
  for (int row = 0; row < rows_; ++row) {
    const char* outer = &within.squares[static_cast<std::size_t>(row / ratio * within.columns)];
    for (int column = 0; column < columns_; column += ratio) {
      if (outer[column / ratio]) continue;
      std::fill_n(&squares_[square(column, row)], std::min(ratio, columns_ - column), 0);
    }
  }
}

/// Calls f(node, dc, dr) for every step from a node.
template <class F>
void Raster::for_each_move(int node, Passage passage, F&& f) const {
  const std::uint8_t* below = &squares_[static_cast<std::size_t>(node)];
  const std::uint8_t mask = bit(passage);
  const bool sw = (below[0] & mask) != 0, se = (below[1] & mask) != 0;
  const bool nw = (below[stride_] & mask) != 0, ne = (below[stride_ + 1] & mask) != 0;
  if (ne) f(node + stride_ + 1, 1, 1);
  if (ne || se) f(node + 1, 1, 0);
  if (ne || nw) f(node + stride_, 0, 1);
  if (se) f(node - stride_ + 1, 1, -1);
  if (nw) f(node + stride_ - 1, -1, 1);
  if (sw || nw) f(node - 1, -1, 0);
  if (sw || se) f(node - stride_, 0, -1);
  if (sw) f(node - stride_ - 1, -1, -1);
}

std::vector<int> Raster::steps(Passage passage, bool forward, bool monotone,
                               const Bound& bound) const {
  struct Entry {
    int node, c, r;
  };
  std::vector<int> steps(static_cast<std::size_t>(nodes()), -1);
  const Entry from_entry = forward ? Entry{0, 0, 0} : Entry{nodes() - 1, columns_, rows_};
  const int end_c = forward ? columns_ : 0, end_r = forward ? rows_ : 0;
  const auto is_within = [&](const Entry& to, int so_far) {
    int left = std::max(std::abs(end_c - to.c), std::abs(end_r - to.r));
    if (bound.other_way) {
      left = (*bound.other_way)[static_cast<std::size_t>(to.node)];
      if (left < 0) return false;
    }
    return so_far + left <= bound.most;
  };
  if (!is_within(from_entry, 0)) return steps;
  std::vector<Entry> queue{from_entry};
  steps[static_cast<std::size_t>(from_entry.node)] = 0;
  for (std::size_t k = 0; k < queue.size(); ++k) {
    const Entry from = queue[k];
    const int next = steps[static_cast<std::size_t>(from.node)] + 1;
    for_each_move(from.node, passage, [&](int to, int dc, int dr) {
      if (monotone && (forward ? std::min(dc, dr) < 0 : std::max(dc, dr) > 0)) return;
      if (steps[static_cast<std::size_t>(to)] >= 0) return;
      const Entry entry{to, from.c + dc, from.r + dr};
      if (!is_within(entry, next)) return;
      steps[static_cast<std::size_t>(to)] = next;
      queue.push_back(entry);
    });
  }
  return steps;
}

Corridor Raster::corridor(const std::vector<int>& from_start, const std::vector<int>& to_goal,
                          double most) const {
  Corridor corridor{size_, columns_, std::vector<char>(squares_.size())};
  for (int row = 0; row <= rows_; ++row) {
    for (int column = 0; column <= columns_; ++column) {
      const auto k = static_cast<std::size_t>(node(column, row));
      if (from_start[k] < 0 || to_goal[k] < 0 || from_start[k] + to_goal[k] > most) continue;
      for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row); ++r) {
        for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column); ++c) {
          corridor.squares[static_cast<std::size_t>(r * columns_ + c)] = 1;
        }
      }
    }
  }
  return corridor;
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
