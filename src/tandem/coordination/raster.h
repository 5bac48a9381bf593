#pragma once
/// A diagram seen on a grid of squares, and how far its corners are from one of them.

#include <limits>

#include "tandem/coordination/diagram_search.h"

namespace tandem::coordination {

/// Which squares a way may lead through.
enum class Passage {
  kProven,    ///< All of it is free.
  kLikely,    ///< Some of it is free, or open without touching at its middle.
  kPossible,  ///< Not all of it is blocked.
};

/// Some squares of a raster.
struct Corridor {
  int size = 0;  ///< [units] Of a square; 0: all there are.
  int columns = 0;
  std::vector<char> squares = {};
};

/// Squares of `size` units, the last ones cut off at the border.
class Raster {
 public:
  /// @param within  of squares of a multiple of `size`: nothing outside is passable.
  Raster(const CoordinationDiagram& diagram, int size, std::span<const Barrier> barriers,
         const Corridor& within = {});

  int size() const { return size_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  bool is_passable(int column, int row, Passage passage) const {
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return false;
    return (squares_[square(column, row)] & bit(passage)) != 0;
  }
  /// Whether the step by (dc, dr) in {-1, 0, 1}^2 from a node leads along a passable square, or
  /// through it; no step is none.
  bool is_step(int c, int r, int dc, int dr, Passage passage) const {
    const int column = std::min(c, c + dc), row = std::min(r, r + dr);
    if ((dc == 0 && dr == 0) || is_passable(column, row, passage)) return true;
    if (dc == 0) return is_passable(column - 1, row, passage);
    return dr == 0 && is_passable(column, row - 1, passage);
  }
  int nodes() const { return node(columns_, rows_) + 1; }  ///< Some of them are no corners.
  int node(int column, int row) const { return row * stride_ + column; }
  GridPoint point(int node) const {
    const GridPoint goal = diagram_.goal();
    return {std::min(goal.x, node % stride_ * size_), std::min(goal.y, node / stride_ * size_)};
  }

  /// Which nodes steps() looks at.
  struct Bound {
    double most = std::numeric_limits<double>::infinity();  ///< Of whole ways [steps].
    const std::vector<int>* other_way = nullptr;  ///< Steps to the other end, by node; -1: none.
  };
  /// Steps from the start (forward) or to the goal along edges and diagonals of passable squares,
  /// by node; -1 where no way leads, or none within the bound.
  std::vector<int> steps(Passage passage, bool forward, bool monotone,
                         const Bound& bound = {std::numeric_limits<double>::infinity(),
                                               nullptr}) const;
  /// The squares with a node from which a way of up to `most` steps leads to both ends.
  Corridor corridor(const std::vector<int>& from_start, const std::vector<int>& to_goal,
                    double most) const;
  /// The nodes of a shortest way from the start by its steps to the goal, which are not -1 there.
  std::vector<int> descend(const std::vector<int>& steps, Passage passage, bool monotone) const;

 private:
  static constexpr std::uint8_t bit(Passage passage) {
    return static_cast<std::uint8_t>(1 << static_cast<int>(passage));
  }
  /// A ring of squares that are not passable lies around the others.
  std::size_t square(int column, int row) const {
    return static_cast<std::size_t>((row + 1) * stride_ + column + 1);
  }
  void enter_cells();
  void enter_barrier(const Barrier& barrier);
  void leave_only(const Corridor& within);

  template <class F>
  void for_each_move(int node, Passage passage, F&& f) const;

  const CoordinationDiagram& diagram_;
  int size_, columns_, rows_;
  int stride_;  ///< Of squares, and of nodes: each with the index of the square below and left.
  std::vector<std::uint8_t> squares_;  ///< Bits by passage.
};

}  // namespace tandem::coordination
