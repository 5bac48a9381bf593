#pragma once
/// A diagram seen on a grid of squares, and how far its corners are from one of them.

#include "tandem/coordination/diagram_search.h"

namespace tandem::coordination {

/// Which squares a way may lead through.
enum class Passage {
  kProven,    ///< All of it is free.
  kLikely,    ///< Some of it is free, or open without touching at its middle.
  kPossible,  ///< Not all of it is blocked.
};

/// Squares of `size` units, the last ones cut off at the border.
class Raster {
 public:
  Raster(const CoordinationDiagram& diagram, int size, std::span<const Barrier> barriers);

  int size() const { return size_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  bool is_passable(int column, int row, Passage passage) const {
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return false;
    const std::uint8_t bits = squares_[static_cast<std::size_t>(row * columns_ + column)];
    return (bits >> static_cast<int>(passage) & 1) != 0;
  }
  /// Whether the step by (dc, dr) in {-1, 0, 1}^2 from a node leads along a passable square, or
  /// through it; no step is none.
  bool is_step(int c, int r, int dc, int dr, Passage passage) const {
    const int column = std::min(c, c + dc), row = std::min(r, r + dr);
    if ((dc == 0 && dr == 0) || is_passable(column, row, passage)) return true;
    if (dc == 0) return is_passable(column - 1, row, passage);
    return dr == 0 && is_passable(column, row - 1, passage);
  }
  int nodes() const { return (columns_ + 1) * (rows_ + 1); }
  int node(int column, int row) const { return row * (columns_ + 1) + column; }
  GridPoint point(int node) const {
    const GridPoint goal = diagram_.goal();
    return {std::min(goal.x, node % (columns_ + 1) * size_),
            std::min(goal.y, node / (columns_ + 1) * size_)};
  }

  /// Steps from the start (forward) or to the goal along edges and diagonals of passable squares,
  /// by node; -1 where no way leads.
  std::vector<int> steps(Passage passage, bool forward, bool monotone) const;
  /// The nodes of a shortest way from the start by its steps to the goal, which are not -1 there.
  std::vector<int> descend(const std::vector<int>& steps, Passage passage, bool monotone) const;

 private:
  static constexpr std::uint8_t bit(Passage passage) {
    return static_cast<std::uint8_t>(1 << static_cast<int>(passage));
  }

  template <class F>
  void for_each_move(int node, Passage passage, F&& f) const;

  const CoordinationDiagram& diagram_;
  int size_, columns_, rows_;
  std::vector<std::uint8_t> squares_;  ///< Bits by passage.
};

}  // namespace tandem::coordination
