#pragma once
/// The adaptive, certified coordination diagram of two tracks.

#include "tandem/collision/box_check.h"
#include "tandem/coordination/track.h"

namespace tandem::coordination {

enum class CellState : std::uint8_t {
  kUnknown,  ///< Not examined.
  kFree,     ///< Proven: no pair touches anywhere in it, its border included.
  kBlocked,  ///< Proven: one pair touches everywhere in it.
  kOpen,     ///< Examined, neither proven.
};

struct DiagramOptions {
  double finest = 0.004;  ///< Cells are not divided below about this much local time [s], > 0.
  double largest = 0.4;  ///< Longer cells are divided before anything is asked about them [s], > 0.
};

/// A point of the diagram in units of its finest cells.
struct GridPoint {
  int x = 0, y = 0;
  friend bool operator==(const GridPoint&, const GridPoint&) = default;
};

/// A straight line in half units, so that it can run between two grid lines.
struct HalfLine {
  int ax = 0, ay = 0, bx = 0, by = 0;
};

/// Cells of [0, T_x] x [0, T_y] are divided where a question needs it, and examined when asked
/// about. All corners are whole numbers of units, so that geometry is exact.
/// Not thread-safe; equal questions in equal order give equal diagrams.
/// Ref: docs/methods.md, "Coordination".
class CoordinationDiagram {
 public:
  static constexpr int kMostUnits = 16384;  ///< Of one axis.

  struct Cell {
    int x0, y0, x1, y1;  ///< [units]
    int width, height;   ///< Powers of two; the cell is cut off at the border of the diagram.
    CellState state = CellState::kUnknown;  ///< Of inner ones too, if they are too large to ask.
    int pair =
        -1;  ///< Index into pairs(): that touches everywhere if blocked, an unproven if open.
    int child = -1;            ///< The first of two halves that follow each other; -1 of a leaf.
    int first = 0, count = 0;  ///< Of what its halves are asked about.
    bool touches = false;      ///< At its middle.
    bool divides_x = false;    ///< By travel: the axis along which it would be divided.

    bool is_leaf() const { return child < 0; }
    int size() const { return std::max(x1 - x0, y1 - y0); }
  };

  /// @param problem, x, y  must outlive the diagram; the tracks share no arm.
  CoordinationDiagram(const CoordinationProblem& problem, const Track& x, const Track& y,
                      const DiagramOptions& options = {});

  const Track& x() const { return x_; }
  const Track& y() const { return y_; }
  GridPoint goal() const { return {units_[0], units_[1]}; }
  double unit_x() const { return unit_[0]; }  ///< [s]
  double unit_y() const { return unit_[1]; }
  double at_x(int units) const { return units == units_[0] ? x_.duration() : units * unit_[0]; }
  double at_y(int units) const { return units == units_[1] ? y_.duration() : units * unit_[1]; }
  const world::Workcell& cell() const { return problem_.cell(); }
  const CoordinationProblem& problem() const { return problem_; }

  const std::vector<Cell>& cells() const { return cells_; }  ///< Leaves and inner ones, root first.
  const Cell& at(int index) const { return cells_[static_cast<std::size_t>(index)]; }
  /// The leaf that holds the unit cell with its lower corner at (x, y); -1 outside.
  int leaf_at(int x, int y) const;
  /// Leaves whose closed rectangles meet the closed rectangle of these corners.
  void leaves_touching(int x0, int y0, int x1, int y1, std::vector<int>& leaves) const;
  /// Calls f(leaf) for leaves whose interior the line meets, in no order, until f returns false.
  /// @return whether all calls returned true.
  template <class F>
  bool visit_crossed(const HalfLine& line, F&& f) const {
    int open[64];  // A pair of halves per division, of 14 along each axis.
    int count = 0;
    open[count++] = 0;
    while (count > 0) {
      const int index = open[--count];
      const Cell& c = at(index);
      if (!meets(line, c)) continue;
      if (c.is_leaf()) {
        if (!f(index)) return false;
        continue;
      }
      open[count++] = c.child + 1;
      open[count++] = c.child;
    }
    return true;
  }
  static bool meets(const HalfLine& line, const Cell& c);

  /// Whether the leaf is open and larger than `size` units, so that it can still be divided.
  bool is_divisible(int leaf, int size = 1) const {
    const Cell& c = at(leaf);
    return c.state == CellState::kOpen && c.size() > size;
  }
  /// Examines unknown leaves, many at once.
  /// @return false if it was stopped; then some of them stay unknown.
  bool examine(std::span<const int> leaves, const StopCondition& stop = {});
  /// Halves an open leaf of more than one unit; its halves are unknown.
  void divide(int leaf);
  /// Examines and divides leaves until they are free, blocked, or open and at most `size` units:
  /// all of them, or those at and below `from`.
  /// @return false if it was stopped.
  bool resolve(int size, const StopCondition& stop) { return resolve(size, stop, {0}); }
  bool resolve(int size, const StopCondition& stop, std::vector<int> from);
  /// The same for what the line meets, up to the first that is not free.
  /// @return whether all are free.
  bool is_line_free(const HalfLine& line, int size);

  /// Leaves in the order in which they were examined.
  const std::vector<int>& examined() const { return examined_; }
  long evaluations() const { return static_cast<long>(examined_.size()); }  ///< Boxes examined.

 private:
  /// What a track may do in an interval, kept by interval.
  struct Boxes {
    std::vector<int> slot;
    std::vector<Eigen::VectorXd> center, D;
  };
  std::size_t box(int axis, int from, int to, int width);
  void examine_block(std::span<const int> leaves);
  void halve(int leaf, bool along_x);
  std::span<const int> items_of(std::span<const int> leaves);

  const CoordinationProblem& problem_;
  const Track &x_, &y_;
  int units_[2];
  double unit_[2];
  std::vector<Cell> cells_;
  const collision::BatchChecker& checker_;
  collision::BatchChecker::Pairs pairs_;
  collision::BatchChecker::ScratchPtr scratch_;
  Boxes boxes_[2];
  Eigen::MatrixXd centers_, D_;
  std::vector<collision::BoxFinding> findings_;
  std::vector<int> items_;  ///< Not proven on open cells, list after list.
  std::vector<int> asked_, open_, examined_;
};

/// The pairs that the meeting of two tracks is about: those that arms of both can move, and no
/// other arm.
world::PairSelection pairs_between(const world::Workcell& cell, const Track& x, const Track& y);
/// The same, compiled; once if one of the tracks is of one arm.
collision::BatchChecker::Pairs compiled_pairs(const collision::CompiledCell& compiled,
                                              world::ArmMask x, world::ArmMask y);

}  // namespace tandem::coordination
