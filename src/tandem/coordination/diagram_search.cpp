#include "tandem/coordination/diagram_search.h"

#include <algorithm>
#include <cmath>

#include "tandem/coordination/raster.h"
#include "tandem/coordination/taut_way.h"
#include "tandem/core/contract.h"

namespace tandem::coordination {

namespace {

/// One call of find_way().
class WaySearch {
 public:
  WaySearch(CoordinationDiagram& diagram, const SearchOptions& options,
            std::span<const Barrier> barriers, const StopCondition& stop)
      : diagram_(diagram),
        options_(options),
        barriers_(barriers),
        stop_(stop),
        taut_(diagram, options, barriers) {}

  SearchResult run();

 private:
  bool is_straight();
  void try_sequences();
  bool narrow();
  void take_proven(const Raster& raster, const std::vector<int>& from_start);
  bool divide_in(const Corridor& corridor);
  void polish(DiagramWay& way);
  bool divide_at_bends(const DiagramWay& way);

  CoordinationDiagram& diagram_;
  const SearchOptions& options_;
  std::span<const Barrier> barriers_;
  const StopCondition& stop_;
  TautWay taut_;
  SearchResult result_;
  double unit_ = 0;    // [s] The shorter one.
  int size_ = 1;       // Of what is open at most.
  Corridor corridor_;  // In which shorter ways may be.
};

bool WaySearch::is_straight() {
  if (!barriers_.empty()) return false;
  const HalfLine line = *Lines({0, 0}, diagram_.goal()).begin();
  if (!diagram_.is_line_free(line, 1)) return false;
  result_.way = DiagramWay{{{0, 0}, diagram_.goal()},
                           std::max(diagram_.x().duration(), diagram_.y().duration())};
  return true;
}

/// Takes the shortest way over proven squares, if it is shorter than what is known.
/// @param from_start  steps over likely squares, which proven ones are.
void WaySearch::take_proven(const Raster& raster, const std::vector<int>& from_start) {
  Raster::Bound bound{.other_way = &from_start};
  if (result_.way) bound.most = result_.way->length * (1 + options_.gap) / (size_ * unit_);
  const auto left = raster.steps(Passage::kProven, false, options_.monotone, bound);
  if (left.front() < 0) return;
  std::vector<GridPoint> points;
  for (const int node : raster.descend(left, Passage::kProven, options_.monotone)) {
    points.push_back(raster.point(node));
  }
  auto way = taut_.pull_steps(points, raster.size());
  if (!result_.way || way.length < result_.way->length) result_.way = std::move(way);
}

/// Divides open cells in a corridor.
/// @return false if it was stopped.
bool WaySearch::divide_in(const Corridor& corridor) {
  const auto is_in = [&](const CoordinationDiagram::Cell& c) {
    const int last_column = (c.x1 - 1) / corridor.size, last_row = (c.y1 - 1) / corridor.size;
    for (int row = c.y0 / corridor.size; row <= last_row; ++row) {
      for (int column = c.x0 / corridor.size; column <= last_column; ++column) {
        if (corridor.squares[static_cast<std::size_t>(row * corridor.columns + column)])
          return true;
      }
    }
    return false;
  };
  const int count = static_cast<int>(diagram_.cells().size());
  const int size = std::max(1, corridor.size / 2);
  std::vector<int> inside;
  for (int leaf = 0; leaf < count; ++leaf) {
    if (!diagram_.at(leaf).is_leaf() || !diagram_.is_divisible(leaf, size)) continue;
    if (is_in(diagram_.at(leaf))) inside.push_back(leaf);
  }
  return diagram_.resolve(size, stop_, std::move(inside));
}

/// Looks at the present size, and halves it where that may pay.
/// @return whether there is more to find.
bool WaySearch::narrow() {
  constexpr double kSlack = 0.03;  // While no way is known, about as long ones are looked at too.
  const Raster raster(diagram_, size_, barriers_, corridor_);
  const double step = size_ * unit_;  // [s]
  Passage passage = Passage::kLikely;
  auto from_start = raster.steps(passage, true, options_.monotone,
                                 {result_.way ? result_.way->length * (1 + options_.gap) / step
                                              : std::numeric_limits<double>::infinity(),
                                  nullptr});
  if (from_start.back() >= 0) take_proven(raster, from_start);
  double most = 0;  // [steps]
  if (result_.way) {
    if (from_start.back() < 0) return false;
    const double target = result_.way->length * (1 - options_.gap);
    if (target <= (from_start.back() - 1) * step) return false;
    most = target / step + 1;
  } else if (from_start.back() >= 0) {
    if ((from_start.back() - 1) * step >= options_.longest) return false;
    most = from_start.back() * (1 + kSlack) + 1;
  } else {
    passage = Passage::kPossible;
    from_start = raster.steps(passage, true, options_.monotone);
    result_.is_separated = from_start.back() < 0;
    if (result_.is_separated) return false;
    most = from_start.back() + 1;
  }
  auto corridor = raster.corridor(
      from_start, raster.steps(passage, false, options_.monotone, {most, &from_start}), most);
  const std::size_t before = diagram_.cells().size();
  result_.is_stopped = !divide_in(corridor);
  if (result_.is_stopped) return false;
  // Until there is a way the shortest ones that there may be come first.
  if (!result_.way && diagram_.cells().size() > before) return true;
  if (size_ == 1) return false;
  corridor_ = result_.way ? std::move(corridor) : Corridor{};
  size_ /= 2;
  return true;
}

/// Divides open cells that the way bends around, where that may shorten it by something.
bool WaySearch::divide_at_bends(const DiagramWay& way) {
  const double worth = 0.1 * options_.gap * way.length / static_cast<double>(way.points.size());
  bool divided = false;
  for (std::size_t k = 1; k + 1 < way.points.size(); ++k) {
    const auto [x, y] = way.points[k];
    for (const auto& [px, py] : {std::pair{x, y}, {x - 1, y}, {x, y - 1}, {x - 1, y - 1}}) {
      const int leaf = diagram_.leaf_at(px, py);
      if (leaf < 0 || !diagram_.is_divisible(leaf)) continue;
      const int size = diagram_.at(leaf).size();
      if (size * unit_ < worth) continue;
      diagram_.resolve(std::max(1, size / 4), {}, {leaf});
      divided = true;
    }
  }
  return divided;
}

/// Divides open cells at the bends of the way and pulls it taut again, as long as that helps.
void WaySearch::polish(DiagramWay& way) {
  constexpr int kMostRounds = 16;
  for (int round = 0; round < kMostRounds && !stop_(); ++round) {
    if (!divide_at_bends(way)) return;
    way = taut_.pull(way.points, size_);
  }
}

/// One track after the other, in case that is shorter than what was found: nobody shall be slower.
void WaySearch::try_sequences() {
  const GridPoint goal = diagram_.goal();
  const double length = diagram_.x().duration() + diagram_.y().duration();
  if (!barriers_.empty() || result_.is_separated || result_.is_stopped) return;
  if (result_.way && result_.way->length <= length) return;
  for (const GridPoint corner : {GridPoint{goal.x, 0}, GridPoint{0, goal.y}}) {
    bool is_free = true;
    for (const auto& [a, b] : {std::pair{GridPoint{}, corner}, std::pair{corner, goal}}) {
      // Of the two lines beside a border one is inside.
      const Lines lines(a, b);
      const HalfLine& line = *lines.begin();
      const bool inside = line.ax <= 2 * goal.x && line.ay <= 2 * goal.y;
      is_free = is_free && diagram_.is_line_free(inside ? line : lines.line[1], 1);
    }
    if (!is_free) continue;
    result_.way = DiagramWay{{{0, 0}, corner, goal}, length};
    return;
  }
}

SearchResult WaySearch::run() {
  unit_ = std::min(diagram_.unit_x(), diagram_.unit_y());
  if (stop_()) return {{}, false, true};
  if (is_straight()) return result_;
  const int most = std::max(diagram_.goal().x, diagram_.goal().y);
  while (2 * size_ <= most && 2 * size_ * unit_ <= options_.coarse) size_ *= 2;
  if (!diagram_.resolve(size_, stop_)) return {{}, false, true};
  while (narrow()) {
  }
  if (result_.way) polish(*result_.way);
  try_sequences();
  return result_;
}

/// The diagonal from a bend outwards to what is not free, or to the border.
Barrier barrier_at(const CoordinationDiagram& diagram, GridPoint bend) {
  const auto is_free = [&](int x, int y) {
    const int leaf = diagram.leaf_at(x, y);
    return leaf >= 0 && diagram.at(leaf).state == CellState::kFree;
  };
  // Away from the first quadrant that is not free.
  int dx = -1, dy = -1;
  for (const auto& [x, y] : {std::pair{0, 0}, {-1, 0}, {0, -1}, {-1, -1}}) {
    if (is_free(bend.x + x, bend.y + y)) continue;
    dx = x == 0 ? -1 : 1;
    dy = y == 0 ? -1 : 1;
    break;
  }
  GridPoint end = bend;
  while (is_free(end.x + std::min(dx, 0), end.y + std::min(dy, 0))) {
    end.x += dx;
    end.y += dy;
  }
  return {bend, end};
}

bool is_same(const DiagramWay& a, const DiagramWay& b) { return a.points == b.points; }

}  // namespace

SearchResult find_way(CoordinationDiagram& diagram, const SearchOptions& options,
                      std::span<const Barrier> barriers, const StopCondition& stop) {
  expects(options.gap >= 0 && options.gap < 1, "the gap is a part of the length");
  expects(options.coarse > 0, "the coarse size is positive");
  return WaySearch(diagram, options, barriers, stop).run();
}

bool explore_ways(CoordinationDiagram& diagram, const SearchOptions& options,
                  const StopCondition& stop, const std::function<double(const DiagramWay&)>& use) {
  auto first = find_way(diagram, options, {}, stop);
  if (!first.way) return false;
  std::vector<DiagramWay> ways{std::move(*first.way)};
  SearchOptions others = options;
  others.longest = std::min(options.longest, use(ways[0]));
  // One bend's barrier after the other: each closes the side on which the way passes there.
  const std::vector<GridPoint> bends(ways[0].points.begin() + 1, ways[0].points.end() - 1);
  for (const GridPoint bend : bends) {
    if (others.longest <= ways[0].length || stop()) break;
    const Barrier barrier = barrier_at(diagram, bend);
    auto other = find_way(diagram, others, {&barrier, 1}, stop);
    if (!other.way || other.way->length >= others.longest) continue;
    if (std::ranges::any_of(ways, [&](const DiagramWay& w) { return is_same(w, *other.way); })) {
      continue;
    }
    ways.push_back(std::move(*other.way));
    others.longest = std::min(others.longest, use(ways.back()));
  }
  return true;
}

}  // namespace tandem::coordination
