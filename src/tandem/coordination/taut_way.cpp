#include "tandem/coordination/taut_way.h"

#include <algorithm>
#include <cmath>

namespace tandem::coordination {

namespace {

int sign(std::int64_t value) { return (value > 0) - (value < 0); }

int side(GridPoint o, GridPoint a, GridPoint b) {
  return sign(static_cast<std::int64_t>(a.x - o.x) * (b.y - o.y) -
              static_cast<std::int64_t>(a.y - o.y) * (b.x - o.x));
}

bool is_in_box(GridPoint a, GridPoint b, GridPoint p) {
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

/// Whether two closed segments share a point.
bool intersect(GridPoint a, GridPoint b, const Barrier& c) {
  const int abc = side(a, b, c.a), abd = side(a, b, c.b);
  const int cda = side(c.a, c.b, a), cdb = side(c.a, c.b, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && is_in_box(a, b, c.a)) || (abd == 0 && is_in_box(a, b, c.b)) ||
         (cda == 0 && is_in_box(c.a, c.b, a)) || (cdb == 0 && is_in_box(c.a, c.b, b));
}

}  // namespace

Lines::Lines(GridPoint a, GridPoint b) {
  line[0] = line[1] = {2 * a.x, 2 * a.y, 2 * b.x, 2 * b.y};
  if (a.x != b.x && a.y != b.y) return;
  count = 2;
  for (const int i : {0, 1}) {
    const int shift = i == 0 ? 1 : -1;
    (a.x == b.x ? line[i].ax : line[i].ay) += shift;
    (a.x == b.x ? line[i].bx : line[i].by) += shift;
  }
}

bool is_way_free(const CoordinationDiagram& diagram, GridPoint a, GridPoint b) {
  const GridPoint goal = diagram.goal();
  return std::ranges::any_of(Lines(a, b), [&](const HalfLine& line) {
    const bool is_inside =
        line.ax >= 0 && line.ay >= 0 && line.ax <= 2 * goal.x && line.ay <= 2 * goal.y;
    return is_inside && diagram.visit_crossed(line, [&](int leaf) {
      return diagram.at(leaf).state == CellState::kFree;
    });
  });
}

/// 0 where no shortest way bends: what is not free has no convex corner there.
int TautWay::slope_at(GridPoint p) const {
  const bool ne = is_free(diagram_.leaf_at(p.x, p.y));
  const bool sw = is_free(diagram_.leaf_at(p.x - 1, p.y - 1));
  const bool nw = is_free(diagram_.leaf_at(p.x - 1, p.y));
  const bool se = is_free(diagram_.leaf_at(p.x, p.y - 1));
  if (nw && se && !(ne && sw)) return -1;
  if (ne && sw && !(nw && se)) return 1;
  return 0;
}

bool TautWay::is_visible(GridPoint a, GridPoint b) const {
  return std::ranges::none_of(barriers_, [&](const Barrier& c) { return intersect(a, b, c); }) &&
         is_way_free(diagram_, a, b);
}

double TautWay::distance(GridPoint a, GridPoint b) const {
  return std::max(std::abs(diagram_.at_x(a.x) - diagram_.at_x(b.x)),
                  std::abs(diagram_.at_y(a.y) - diagram_.at_y(b.y)));
}

void TautWay::add(GridPoint p, int slope) {
  const std::int64_t key = (static_cast<std::int64_t>(p.x) << 32) | p.y;
  if (known_.insert(key).second) vertices_.push_back({p, slope});
}

void TautWay::add_corners_near(GridPoint p, int reach) {
  diagram_.leaves_touching(p.x - reach, p.y - reach, p.x + reach, p.y + reach, leaves_);
  for (const int leaf : leaves_) {
    if (is_free(leaf) || !known_leaves_.insert(leaf).second) continue;
    const auto& c = diagram_.at(leaf);
    for (const GridPoint corner :
         {GridPoint{c.x0, c.y0}, {c.x1, c.y0}, {c.x0, c.y1}, {c.x1, c.y1}}) {
      const int slope = slope_at(corner);
      if (slope != 0) add(corner, slope);
    }
  }
}

void TautWay::expand(int from, double g) {
  const Vertex u = vertices_[static_cast<std::size_t>(from)];
  const GridPoint goal = diagram_.goal();
  const auto is_taut = [](const Vertex& v, int dx, int dy) {
    return v.slope == 0 || v.slope * sign(dx) * sign(dy) >= 0;
  };
  for (std::size_t i = 1; i < vertices_.size(); ++i) {
    if (is_done_[i]) continue;
    const Vertex& v = vertices_[i];
    const int dx = v.p.x - u.p.x, dy = v.p.y - u.p.y;
    if (options_.monotone && (dx < 0 || dy < 0)) continue;
    if (!is_taut(u, dx, dy) || !is_taut(v, dx, dy)) continue;
    const double g_v = g + distance(u.p, v.p);
    queue_.push_back({g_v + distance(v.p, goal), g_v, from, static_cast<int>(i)});
    std::push_heap(queue_.begin(), queue_.end());
  }
}

/// The way over fewer of its points: from each to the furthest that is visible, by doubling steps.
std::vector<GridPoint> TautWay::without_detours(const std::vector<GridPoint>& points) const {
  std::vector<GridPoint> kept{points.front()};
  for (std::size_t at = 0; at + 1 < points.size();) {
    std::size_t next = at + 1;
    for (std::size_t step = 1; step > 0;) {
      if (next + step < points.size() && is_visible(points[at], points[next + step])) {
        next += step;
        step *= 2;
      } else {
        step /= 2;
      }
    }
    kept.push_back(points[next]);
    at = next;
  }
  return kept;
}

DiagramWay TautWay::pull(const std::vector<GridPoint>& points, int reach) {
  vertices_.clear();
  known_.clear();
  known_leaves_.clear();
  add(points.front(), 0);
  add(points.back(), 0);
  for (const GridPoint p : points) add(p, 0);
  for (const GridPoint p : points) add_corners_near(p, reach);
  parent_.assign(vertices_.size(), -1);
  is_done_.assign(vertices_.size(), 0);
  is_done_[0] = 1;
  queue_.clear();
  expand(0, 0.0);
  while (!queue_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end());
    const Entry entry = queue_.back();
    queue_.pop_back();
    const auto to = static_cast<std::size_t>(entry.to);
    if (is_done_[to]) continue;
    if (!is_visible(vertices_[static_cast<std::size_t>(entry.from)].p, vertices_[to].p)) continue;
    is_done_[to] = 1;
    parent_[to] = entry.from;
    if (entry.to == 1) break;
    expand(entry.to, entry.g);
  }
  DiagramWay way;
  for (int k = 1; k >= 0; k = parent_[static_cast<std::size_t>(k)]) {
    way.points.push_back(vertices_[static_cast<std::size_t>(k)].p);
  }
  std::ranges::reverse(way.points);
  for (std::size_t k = 1; k < way.points.size(); ++k) {
    way.length += distance(way.points[k - 1], way.points[k]);
  }
  return way;
}

}  // namespace tandem::coordination
