#include "tandem/coordination/diagram_search.h"

#include <gtest/gtest.h>

#include <functional>

#include "conformance/coordination_cells.h"
#include "tandem/coordination/deadlock.h"

namespace tandem::coordination {
namespace {

using Eigen::VectorXd;

/// Steps of `h` [s] on a dense grid of samples, eight directions, each of the two corners and the
/// middle of every step free: the makespan but for the grid. Negative if there is no way.
double dense_makespan(const test::CoordinationCase& c, double h) {
  const double T[] = {c.arms[0].duration(), c.arms[1].duration()};
  const int n[] = {static_cast<int>(std::ceil(T[0] / h)), static_cast<int>(std::ceil(T[1] / h))};
  const auto scratch = c.checker->make_scratch();
  const auto pairs = pairs_between_arms(c.checker->cell());
  VectorXd q(c.checker->cell().dof());
  const int columns = n[0] + 1;
  std::vector<char> is_free(static_cast<std::size_t>(columns * (n[1] + 1)));
  for (int j = 0; j <= n[1]; ++j) {
    for (int i = 0; i <= n[0]; ++i) {
      c.arms[0].position(std::min(T[0], i * h), q.head(c.arms[0].dof()));
      c.arms[1].position(std::min(T[1], j * h), q.tail(c.arms[1].dof()));
      is_free[static_cast<std::size_t>(j * columns + i)] = c.checker->is_free(q, pairs, *scratch);
    }
  }
  std::vector<int> steps(is_free.size(), -1), queue{0};
  steps[0] = 0;
  for (std::size_t k = 0; k < queue.size(); ++k) {
    const int i = queue[k] % columns, j = queue[k] / columns;
    for (int di = -1; di <= 1; ++di) {
      for (int dj = -1; dj <= 1; ++dj) {
        if (i + di < 0 || j + dj < 0 || i + di > n[0] || j + dj > n[1]) continue;
        const auto to = static_cast<std::size_t>((j + dj) * columns + i + di);
        if (steps[to] >= 0 || !is_free[to]) continue;
        steps[to] = steps[static_cast<std::size_t>(queue[k])] + 1;
        queue.push_back(static_cast<int>(to));
      }
    }
  }
  return steps.back() < 0 ? -1 : steps.back() * h;
}

/// The arms' tracks and diagram of a case.
struct Diagram {
  explicit Diagram(const test::CoordinationCase& c, const DiagramOptions& options = {})
      : problem(c.problem()), x(problem, 0), y(problem, 1), diagram(problem, x, y, options) {}
  CoordinationProblem problem;
  Track x, y;
  CoordinationDiagram diagram;
};

/// Calls f for cases of two arms in which the straight line is not free.
void for_each_hard_case(const std::function<void(const test::CoordinationCase&)>& f) {
  for (const auto& c : test::disc_cases()) {
    if (c.arms.size() == 2 && c.name != "apart") f(c);
  }
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const auto c = test::swinging_arms(seed);
    if (!c) continue;
    Diagram d(*c);
    const auto& goal = d.diagram.goal();
    if (!d.diagram.is_line_free({0, 0, 2 * goal.x, 2 * goal.y}, 1)) f(*c);
  }
}

TEST(FindWay, IsAsShortAsADenseGridSays) {
  constexpr double kStep = 0.016;
  int compared = 0, impossible = 0;
  double sum = 0, worst = 0, sum_default = 0, worst_default = 0;
  for_each_hard_case([&](const test::CoordinationCase& c) {
    SCOPED_TRACE(c.name);
    const double dense = dense_makespan(c, kStep);
    Diagram fine(c, {.finest = 0.003}), usual(c);
    const auto found = find_way(fine.diagram, {.gap = 0.005, .coarse = 0.05}, {}, {});
    const auto quick = find_way(usual.diagram, {}, {}, {});
    if (dense < 0) {
      ++impossible;
      EXPECT_FALSE(found.way);
      EXPECT_FALSE(quick.way);
      return;
    }
    if (!found.way || !quick.way) return;  // Perhaps too narrow for a proof: counted below.
    ++compared;
    // Samples cut corners that proofs do not, by no more than some steps.
    EXPECT_GE(found.way->length, dense - 6 * kStep);
    EXPECT_GE(quick.way->length, dense - 6 * kStep);
    const double ratio = found.way->length / dense, ratio_default = quick.way->length / dense;
    sum += ratio;
    worst = std::max(worst, ratio);
    sum_default += ratio_default;
    worst_default = std::max(worst_default, ratio_default);
  });
  std::printf(
      "%d compared, %d impossible; length by dense: mean %.4f worst %.4f; quick %.4f %.4f\n",
      compared, impossible, sum / compared, worst, sum_default / compared, worst_default);
  EXPECT_GT(compared, 20);
  EXPECT_LT(sum / compared, 1.015);
  EXPECT_LT(worst, 1.06);
  EXPECT_LT(sum_default / compared, 1.05);
  EXPECT_LT(worst_default, 1.15);
}

TEST(FindWay, MonotoneWaysDoNotGoBackAndExistOnlyWhereNoneMust) {
  for_each_hard_case([&](const test::CoordinationCase& c) {
    SCOPED_TRACE(c.name);
    Diagram any(c), monotone(c);
    const auto found = find_way(monotone.diagram, {.monotone = true}, {}, {});
    const auto free = find_way(any.diagram, {}, {}, {});
    EXPECT_TRUE(!c.goes_back || (free.way && !found.way));
    if (!found.way) return;
    ASSERT_TRUE(free.way);
    for (std::size_t k = 1; k < found.way->points.size(); ++k) {
      EXPECT_GE(found.way->points[k].x, found.way->points[k - 1].x);
      EXPECT_GE(found.way->points[k].y, found.way->points[k - 1].y);
    }
  });
}

/// Up to `most` ways.
std::vector<DiagramWay> ways_through(CoordinationDiagram& diagram, std::size_t most) {
  std::vector<DiagramWay> ways;
  explore_ways(diagram, {}, {}, [&](const DiagramWay& way) {
    ways.push_back(way);
    return ways.size() < most ? std::numeric_limits<double>::infinity() : 0.0;
  });
  return ways;
}

TEST(ExploreWays, HandsOverShorterOnesThanItsUserHasUseForOnly) {
  int others = 0;
  for_each_hard_case([&](const test::CoordinationCase& c) {
    SCOPED_TRACE(c.name);
    Diagram d(c);
    const auto all = ways_through(d.diagram, 10);
    if (all.size() < 2) return;
    ++others;
    const double longest = 0.5 * (all[0].length + all[1].length);
    Diagram again(c);
    int used = 0;
    EXPECT_TRUE(explore_ways(again.diagram, {}, {}, [&](const DiagramWay& way) {
      if (++used > 1) {
        EXPECT_LT(way.length, longest);
      }
      return longest;
    }));
    EXPECT_GE(used, 1);
    Diagram once(c);
    used = 0;
    explore_ways(once.diagram, {}, {}, [&](const DiagramWay& way) {
      ++used;
      EXPECT_EQ(way.points, all[0].points);
      return way.length;
    });
    EXPECT_EQ(used, 1);
  });
  EXPECT_GT(others, 5);
}

TEST(ExploreWays, PassOnTheOtherSide) {
  const auto c = test::crossing();
  Diagram d(c);
  const auto ways = ways_through(d.diagram, 3);
  ASSERT_GE(ways.size(), 2u);
  // "a" first in one, "b" first in the other: above and below the middle of the diagram.
  const GridPoint middle{d.diagram.goal().x / 2, d.diagram.goal().y / 2};
  const auto above = [&](const DiagramWay& way) {
    for (std::size_t k = 1; k < way.points.size(); ++k) {
      const auto [ax, ay] = way.points[k - 1];
      const auto [bx, by] = way.points[k];
      if (ax <= middle.x && bx >= middle.x && bx > ax) {
        return ay + (by - ay) * double(middle.x - ax) / (bx - ax) > middle.y;
      }
    }
    return false;
  };
  EXPECT_NE(above(ways[0]), above(ways[1]));
}

/// No blocked cell of the wall has a free sample, and without it start and goal are apart: flooded
/// on single units, which the wall's cells are made of.
TEST(FindDeadlock, WallsBlockEverywhereAndSeparate) {
  int deadlocks = 0;
  Rng rng(3);
  for_each_hard_case([&](const test::CoordinationCase& c) {
    SCOPED_TRACE(c.name);
    Diagram d(c);
    const auto found = find_way(d.diagram, {}, {}, {});
    const auto deadlock = find_deadlock(d.diagram);
    EXPECT_TRUE(!c.deadlocks || deadlock);
    EXPECT_EQ(found.is_separated, deadlock.has_value());
    if (!deadlock) return;
    ++deadlocks;
    EXPECT_FALSE(found.way);
    EXPECT_LT(dense_makespan(c, 0.02), 0);
    const auto& diagram = d.diagram;
    const auto scratch = c.checker->make_scratch();
    const auto goal = diagram.goal();
    std::vector<char> walled(static_cast<std::size_t>(goal.x * goal.y));
    VectorXd q(c.checker->cell().dof());
    for (const int leaf : deadlock->wall) {
      const auto& cell = diagram.at(leaf);
      for (int y = cell.y0; y < cell.y1; ++y) {
        for (int x = cell.x0; x < cell.x1; ++x)
          walled[static_cast<std::size_t>(y * goal.x + x)] = 1;
      }
      for (int k = 0; k < 6; ++k) {
        const double u = rng.uniform(), v = rng.uniform();
        c.arms[0].position(diagram.at_x(cell.x0) * (1 - u) + u * diagram.at_x(cell.x1),
                           q.head(c.arms[0].dof()));
        c.arms[1].position(diagram.at_y(cell.y0) * (1 - v) + v * diagram.at_y(cell.y1),
                           q.tail(c.arms[1].dof()));
        ASSERT_FALSE(c.checker->is_free(q, {cell.pair}, *scratch));
      }
    }
    std::vector<GridPoint> open{{0, 0}};
    ASSERT_FALSE(walled.front());
    walled.front() = 2;
    while (!open.empty()) {
      const auto [x, y] = open.back();
      open.pop_back();
      for (int dx = -1; dx <= 1; ++dx) {
        for (int dy = -1; dy <= 1; ++dy) {
          if (x + dx < 0 || y + dy < 0 || x + dx >= goal.x || y + dy >= goal.y) continue;
          char& mark = walled[static_cast<std::size_t>((y + dy) * goal.x + x + dx)];
          if (mark == 0) open.push_back({x + dx, y + dy});
          if (mark == 0) mark = 2;
        }
      }
    }
    EXPECT_EQ(walled.back(), 0) << "the goal is reached around the wall";
    const std::string text = describe(diagram, *deadlock);
    EXPECT_NE(text.find(c.checker->cell().describe_pair(deadlock->pair)), std::string::npos);
  });
  std::printf("%d deadlocks\n", deadlocks);
  EXPECT_GT(deadlocks, 3);
}

}  // namespace
}  // namespace tandem::coordination
