#pragma once
/// A way through free cells, pulled taut.

#include <unordered_set>

#include "tandem/coordination/diagram_search.h"

namespace tandem::coordination {

/// A shortest way bends at convex corners of what is not free only. This is A* in the visibility
/// graph of the corners near a way that is known.
class TautWay {
 public:
  TautWay(const CoordinationDiagram& diagram, const SearchOptions& options,
          std::span<const Barrier> barriers)
      : diagram_(diagram), options_(options), barriers_(barriers) {}

  /// The shortest way over `points` and the corners no further than `reach` units from one of them.
  /// @param points  of a way through free cells, start first, goal last.
  DiagramWay pull(const std::vector<GridPoint>& points, int reach);
  /// The same after points that are not needed were left out.
  DiagramWay pull_steps(const std::vector<GridPoint>& points, int reach) {
    return pull(without_detours(points), reach);
  }

 private:
  /// A point at which a way may bend.
  struct Vertex {
    GridPoint p;
    int slope;  ///< Sign of dx dy of ways through it that are taut; 0: any.
  };
  struct Entry {
    double f, g;
    int from, to;
    bool operator<(const Entry& other) const {
      return f != other.f ? f > other.f : g != other.g ? g < other.g : to > other.to;
    }
  };

  bool is_free(int leaf) const { return leaf >= 0 && diagram_.at(leaf).state == CellState::kFree; }
  int slope_at(GridPoint p) const;
  bool is_visible(GridPoint a, GridPoint b) const;
  std::vector<GridPoint> without_detours(const std::vector<GridPoint>& points) const;
  void add(GridPoint p, int slope);
  void add_corners_near(GridPoint p, int reach);
  double distance(GridPoint a, GridPoint b) const;
  void expand(int from, double g);

  const CoordinationDiagram& diagram_;
  const SearchOptions& options_;
  std::span<const Barrier> barriers_;
  std::vector<Vertex> vertices_;
  std::unordered_set<std::int64_t> known_;
  std::vector<int> leaves_;
  std::unordered_set<int> known_leaves_;
  std::vector<Entry> queue_;
  std::vector<int> parent_;
  std::vector<char> is_done_;
};

/// The lines that stand for the one from a to b: itself, or if it is parallel to an axis those just
/// beside it, of which one must be free.
struct Lines {
  HalfLine line[2];
  int count = 1;

  Lines(GridPoint a, GridPoint b);
  const HalfLine* begin() const { return line; }
  const HalfLine* end() const { return line + count; }
};

/// Whether the straight way between two points leads through free cells only.
bool is_way_free(const CoordinationDiagram& diagram, GridPoint a, GridPoint b);

}  // namespace tandem::coordination
