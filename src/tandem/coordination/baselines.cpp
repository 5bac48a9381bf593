#include "tandem/coordination/baselines.h"

#include <algorithm>
#include <deque>

#include "tandem/coordination/diagram_coordinator.h"
#include "tandem/coordination/merge.h"
#include "tandem/coordination/raster.h"
#include "tandem/core/contract.h"

namespace tandem::coordination {

namespace {

/// Squares of a grid that must not be entered.
class Squares {
 public:
  Squares(int columns, int rows)
      : columns_(columns), rows_(rows), set_(static_cast<std::size_t>(columns * rows)) {}
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  std::size_t index(int c, int r) const { return static_cast<std::size_t>(r * columns_ + c); }
  bool at(int c, int r) const {
    return c < 0 || r < 0 || c >= columns_ || r >= rows_ || set_[index(c, r)];
  }
  void set(int c, int r) { set_[index(c, r)] = 1; }

 private:
  int columns_, rows_;
  std::vector<char> set_;
};

Squares unproven(const Raster& raster) {
  Squares squares(raster.columns(), raster.rows());
  for (int r = 0; r < raster.rows(); ++r) {
    for (int c = 0; c < raster.columns(); ++c) {
      if (!raster.is_passable(c, r, Passage::kProven)) squares.set(c, r);
    }
  }
  return squares;
}

/// What an arm's zone forbids: where both arms are in it.
Squares exclusive(const Squares& touching) {
  std::vector<char> in_column(static_cast<std::size_t>(touching.columns()));
  std::vector<char> in_row(static_cast<std::size_t>(touching.rows()));
  for (int r = 0; r < touching.rows(); ++r) {
    for (int c = 0; c < touching.columns(); ++c) {
      if (!touching.at(c, r)) continue;
      in_column[static_cast<std::size_t>(c)] = in_row[static_cast<std::size_t>(r)] = 1;
    }
  }
  Squares zones(touching.columns(), touching.rows());
  for (int r = 0; r < zones.rows(); ++r) {
    for (int c = 0; c < zones.columns(); ++c) {
      if (in_column[static_cast<std::size_t>(c)] && in_row[static_cast<std::size_t>(r)]) {
        zones.set(c, r);
      }
    }
  }
  return zones;
}

/// Fills a connected region: a square with one of the region above it and one right of it.
/// @return whether anything was added.
bool fill_region(Squares& squares, const std::vector<std::pair<int, int>>& region) {
  std::vector<int> top(static_cast<std::size_t>(squares.columns()), -1);
  std::vector<int> right(static_cast<std::size_t>(squares.rows()), -1);
  for (const auto& [c, r] : region) {
    int& t = top[static_cast<std::size_t>(c)];
    int& e = right[static_cast<std::size_t>(r)];
    t = std::max(t, r);
    e = std::max(e, c);
  }
  bool added = false;
  for (int r = 0; r < squares.rows(); ++r) {
    for (int c = 0; c < right[static_cast<std::size_t>(r)]; ++c) {
      if (r >= top[static_cast<std::size_t>(c)] || squares.at(c, r)) continue;
      squares.set(c, r);
      added = true;
    }
  }
  return added;
}

/// The region of squares that share corners with (c, r).
std::vector<std::pair<int, int>> region_of(const Squares& squares, int c, int r,
                                           std::vector<char>& is_known) {
  std::vector<std::pair<int, int>> region{{c, r}};
  is_known[squares.index(c, r)] = 1;
  for (std::size_t k = 0; k < region.size(); ++k) {
    for (int dc = -1; dc <= 1; ++dc) {
      for (int dr = -1; dr <= 1; ++dr) {
        const int x = region[k].first + dc, y = region[k].second + dr;
        if (x < 0 || y < 0 || x >= squares.columns() || y >= squares.rows()) continue;
        if (!squares.at(x, y) || is_known[squares.index(x, y)]) continue;
        is_known[squares.index(x, y)] = 1;
        region.emplace_back(x, y);
      }
    }
  }
  return region;
}

/// The SW-closure. The borders at which one motion has ended count as walls, apart from each other:
/// nothing gets past what touches one of them.
Squares sw_closure(const Squares& touching) {
  const int columns = touching.columns(), rows = touching.rows();
  Squares squares(columns + 1, rows + 1);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      if (touching.at(c, r)) squares.set(c, r);
    }
  }
  for (int c = 0; c + 1 < columns; ++c) squares.set(c, rows);
  for (int r = 0; r + 1 < rows; ++r) squares.set(columns, r);
  for (bool added = true; added;) {
    added = false;
    std::vector<char> is_known(static_cast<std::size_t>((columns + 1) * (rows + 1)));
    for (int r = 0; r <= rows && !added; ++r) {
      for (int c = 0; c <= columns && !added; ++c) {
        if (!squares.at(c, r) || is_known[squares.index(c, r)]) continue;
        added = fill_region(squares, region_of(squares, c, r, is_known));
      }
    }
  }
  Squares inside(columns, rows);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      if (squares.at(c, r)) inside.set(c, r);
    }
  }
  return inside;
}

struct Step {
  int dc, dr;
};

bool is_step_free(const Squares& squares, int c, int r, const Step& step) {
  if (step.dc != 0 && step.dr != 0) return !squares.at(c, r);
  if (step.dc != 0) return c < squares.columns() && !(squares.at(c, r) && squares.at(c, r - 1));
  return r < squares.rows() && !(squares.at(c, r) && squares.at(c - 1, r));
}

using GridWay = std::vector<std::pair<int, int>>;

/// Advances both, or the preferred one, or the other; ends where none can.
GridWay advance(const Squares& squares, bool prefers_x) {
  const Step steps[] = {
      {1, 1}, prefers_x ? Step{1, 0} : Step{0, 1}, prefers_x ? Step{0, 1} : Step{1, 0}};
  GridWay way{{0, 0}};
  while (true) {
    const auto [c, r] = way.back();
    const auto step =
        std::ranges::find_if(steps, [&](const Step& s) { return is_step_free(squares, c, r, s); });
    if (step == std::end(steps)) return way;
    way.emplace_back(c + step->dc, r + step->dr);
  }
}

GridWay scheduled(const Squares& touching) {
  const Squares closure = sw_closure(touching);
  GridWay best;
  for (const bool prefers_x : {true, false}) {
    GridWay way = advance(closure, prefers_x);
    if (way.back() != std::pair{closure.columns(), closure.rows()}) continue;
    if (best.empty() || way.size() < best.size()) best = std::move(way);
  }
  return best;
}

/// A shortest way on which no arm goes back: steps back from the goal.
GridWay shortest(const Squares& squares) {
  const int columns = squares.columns(), rows = squares.rows();
  constexpr int kNone = std::numeric_limits<int>::max() / 2;
  std::vector<int> left(static_cast<std::size_t>((columns + 1) * (rows + 1)), kNone);
  const auto at = [&](int c, int r) -> int& {
    return left[static_cast<std::size_t>(r * (columns + 1) + c)];
  };
  constexpr Step kSteps[] = {{1, 1}, {1, 0}, {0, 1}};
  at(columns, rows) = 0;
  for (int r = rows; r >= 0; --r) {
    for (int c = columns; c >= 0; --c) {
      for (const Step& s : kSteps) {
        if (is_step_free(squares, c, r, s)) {
          at(c, r) = std::min(at(c, r), at(c + s.dc, r + s.dr) + 1);
        }
      }
    }
  }
  if (at(0, 0) >= kNone) return {};
  GridWay way{{0, 0}};
  while (way.back() != std::pair{columns, rows}) {
    const auto [c, r] = way.back();
    const auto step = std::ranges::find_if(kSteps, [&](const Step& s) {
      return is_step_free(squares, c, r, s) && at(c + s.dc, r + s.dr) == at(c, r) - 1;
    });
    way.emplace_back(c + step->dc, r + step->dr);
  }
  return way;
}

class GridCoordinator final : public Coordinator {
 public:
  using Rule = GridWay (*)(const Squares& touching);
  GridCoordinator(const char* name, Rule rule, const GridOptions& options)
      : name_(name), rule_(rule), options_(options) {
    expects(options.step > 0, "squares have a side");
  }

  Result<Schedule> coordinate(const CoordinationProblem& problem, std::uint64_t /*seed*/,
                              const StopCondition& stop) const override {
    const auto scratch = problem.exact().make_scratch();
    if (const auto ends = check_problem(problem, *scratch); !ends) {
      return std::unexpected(ends.error());
    }
    std::deque<Track> tracks;  // Keeps references valid.
    const Track* merged = &tracks.emplace_back(problem, 0);
    for (int arm = 1; arm < static_cast<int>(problem.arms.size()); ++arm) {
      const Track& next = tracks.emplace_back(problem, arm);
      // Units of a fraction of a square, so that little of a motion's end shares its square.
      CoordinationDiagram diagram(problem, *merged, next, {.finest = options_.step / kUnits});
      if (!diagram.resolve(kUnits, stop)) {
        return std::unexpected(stop.error("coordinating by " + std::string(name_)));
      }
      const Raster raster(diagram, kUnits, {});
      const GridWay way = rule_(unproven(raster));
      if (way.empty()) return std::unexpected(failure(diagram));
      std::vector<GridPoint> points;
      for (const auto& [c, r] : way) points.push_back(raster.point(raster.node(c, r)));
      merged = &tracks.emplace_back(merge(diagram, points));
    }
    return schedule_of(*merged);
  }

 private:
  static constexpr int kUnits = 8;

  /// Names what is first in the way.
  Error failure(const CoordinationDiagram& diagram) const {
    const auto& cells = diagram.cells();
    const auto cell = std::ranges::find_if(
        cells, [](const auto& c) { return c.is_leaf() && c.state != CellState::kFree; });
    Eigen::VectorXd place =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(diagram.problem().arms.size()));
    const auto put = [&](const Track& track, double t) {
      const Eigen::VectorXd of_track = track.place(t);
      for (std::size_t i = 0; i < track.arms().size(); ++i) {
        place[track.arms()[i]] = of_track[static_cast<Eigen::Index>(i)];
      }
    };
    put(diagram.x(), diagram.at_x(cell->x0));
    put(diagram.y(), diagram.at_y(cell->y0));
    return {ErrorCode::kCoordination, std::string(name_) +
                                          " finds no schedule; first in the way are " +
                                          describe_blocking(diagram.cell(), cell->pair, place)};
  }

  const char* name_;
  Rule rule_;
  GridOptions options_;
};

}  // namespace

std::unique_ptr<Coordinator> make_exclusive_coordinator(const GridOptions& options) {
  return std::make_unique<GridCoordinator>(
      "exclusive use of the shared workspace",
      +[](const Squares& touching) { return shortest(exclusive(touching)); }, options);
}

std::unique_ptr<Coordinator> make_sw_closure_coordinator(const GridOptions& options) {
  return std::make_unique<GridCoordinator>("the SW-closure", &scheduled, options);
}

std::unique_ptr<Coordinator> make_monotone_coordinator() {
  DiagramCoordinatorOptions options;
  options.search.monotone = true;
  return make_diagram_coordinator(options);
}

}  // namespace tandem::coordination
