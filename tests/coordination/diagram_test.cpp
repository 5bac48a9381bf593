#include "tandem/coordination/diagram.h"

#include <gtest/gtest.h>

#include "conformance/coordination_cells.h"
#include "tandem/core/contract.h"

namespace tandem::coordination {
namespace {

using Eigen::VectorXd;

struct Tally {
  long free = 0, blocked = 0, open = 0, samples = 0;
};

/// Samples corners and insides of all leaves: a free one has no colliding sample, a blocked one no
/// free one, and both of the pair that it names.
void expect_true_cells(const test::CoordinationCase& c, const CoordinationDiagram& diagram,
                       Rng& rng, Tally& tally) {
  const auto scratch = c.checker->make_scratch();
  const auto pairs = pairs_between(c.checker->cell(), diagram.x(), diagram.y());
  const PlacesEdge motion(c.arms, VectorXd::Zero(2), VectorXd::Ones(2));
  VectorXd q(c.checker->cell().dof());
  long area = 0;
  for (const auto& cell : diagram.cells()) {
    if (!cell.is_leaf()) continue;
    area += static_cast<long>(cell.x1 - cell.x0) * (cell.y1 - cell.y0);
    if (cell.state == CellState::kOpen) ++tally.open;
    if (cell.state != CellState::kFree && cell.state != CellState::kBlocked) continue;
    (cell.state == CellState::kFree ? tally.free : tally.blocked)++;
    for (int k = 0; k < 12; ++k) {
      const bool corner = k < 4;
      const double u = corner ? k % 2 : rng.uniform(), v = corner ? k / 2 : rng.uniform();
      const double x = diagram.at_x(cell.x0) + u * (diagram.at_x(cell.x1) - diagram.at_x(cell.x0));
      const double y = diagram.at_y(cell.y0) + v * (diagram.at_y(cell.y1) - diagram.at_y(cell.y0));
      c.arms[0].position(x, q.head(c.arms[0].dof()));
      c.arms[1].position(y, q.tail(c.arms[1].dof()));
      ++tally.samples;
      if (cell.state == CellState::kFree) {
        ASSERT_TRUE(c.checker->is_free(q, pairs, *scratch)) << c.name << " " << x << " " << y;
      } else {
        ASSERT_FALSE(c.checker->is_free(q, {cell.pair}, *scratch))
            << c.name << " " << x << " " << y;
      }
    }
  }
  EXPECT_EQ(area, static_cast<long>(diagram.goal().x) * diagram.goal().y) << "leaves tile it";
}

TEST(CoordinationDiagram, CellsHoldInDenseSamplesOfDiscs) {
  Rng rng(1);
  Tally tally;
  for (const auto& c : test::disc_cases()) {
    if (c.arms.size() != 2) continue;
    const auto problem = c.problem();
    const Track x(problem, 0), y(problem, 1);
    CoordinationDiagram diagram(problem, x, y, {.finest = 0.005});
    ASSERT_TRUE(diagram.resolve(4, {}));
    expect_true_cells(c, diagram, rng, tally);
  }
  EXPECT_GT(tally.free, 500);
  EXPECT_GT(tally.blocked, 500);
}

TEST(CoordinationDiagram, CellsHoldInDenseSamplesOfArms) {
  Rng rng(2);
  Tally tally;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const auto c = test::swinging_arms(seed);
    if (!c) continue;
    const auto problem = c->problem();
    const Track x(problem, 0), y(problem, 1);
    CoordinationDiagram diagram(problem, x, y, {.finest = rng.uniform(0.002, 0.03)});
    ASSERT_TRUE(diagram.resolve(1 + static_cast<int>(rng.index(8)), {}));
    expect_true_cells(*c, diagram, rng, tally);
  }
  std::printf("%ld free, %ld blocked, %ld open, %ld samples\n", tally.free, tally.blocked,
              tally.open, tally.samples);
  EXPECT_GT(tally.free, 1000);
  EXPECT_GT(tally.blocked, 1000);
}

TEST(CoordinationDiagram, OpenCellsAreAThinBorder) {
  const auto c = test::crossing();
  const auto problem = c.problem();
  const Track x(problem, 0), y(problem, 1);
  CoordinationDiagram diagram(problem, x, y, {.finest = 0.002});
  ASSERT_TRUE(diagram.resolve(1, {}));
  long open = 0, blocked = 0;
  for (const auto& cell : diagram.cells()) {
    const long area = static_cast<long>(cell.x1 - cell.x0) * (cell.y1 - cell.y0);
    if (cell.is_leaf() && cell.state == CellState::kOpen) open += area;
    if (cell.state == CellState::kBlocked) blocked += area;
  }
  // The discs touch where |(2x-1, 2y-1)| in metres is at most 0.2: an ellipse-like hole whose
  // border is some 0.4 s long.
  EXPECT_LT(static_cast<double>(open) * diagram.unit_x(), 2.0);
  EXPECT_GT(static_cast<double>(blocked) * diagram.unit_x() * diagram.unit_y(), 0.01);
}

TEST(CoordinationDiagram, LinesMeetTheLeavesThatSamplesFind) {
  const auto c = test::crossing();
  const auto problem = c.problem();
  const Track x(problem, 0), y(problem, 1);
  CoordinationDiagram diagram(problem, x, y, {.finest = 0.013});
  ASSERT_TRUE(diagram.resolve(1, {}));
  const GridPoint goal = diagram.goal();
  Rng rng(4);
  for (int n = 0; n < 500; ++n) {
    const auto any = [&](int most) {
      return static_cast<int>(rng.index(static_cast<std::size_t>(2 * most + 1)));
    };
    const HalfLine line{any(goal.x), any(goal.y), any(goal.x), any(goal.y)};
    std::vector<char> crossed(diagram.cells().size());
    diagram.visit_crossed(line,
                          [&](int leaf) { return crossed[static_cast<std::size_t>(leaf)] = 1; });
    for (int k = 0; k < 300; ++k) {
      const double s = rng.uniform();
      const double px = 0.5 * (line.ax + s * (line.bx - line.ax));
      const double py = 0.5 * (line.ay + s * (line.by - line.ay));
      const double to_grid = std::min(std::abs(px - std::round(px)), std::abs(py - std::round(py)));
      if (to_grid < 1e-6) continue;
      const int leaf = diagram.leaf_at(static_cast<int>(px), static_cast<int>(py));
      ASSERT_GE(leaf, 0);
      EXPECT_TRUE(crossed[static_cast<std::size_t>(leaf)]) << n;
    }
  }
}

TEST(CoordinationDiagram, RefusesSharedArmsAndBadSizes) {
  const auto c = test::crossing();
  const auto problem = c.problem();
  const Track x(problem, 0), y(problem, 1);
  EXPECT_THROW(CoordinationDiagram(problem, x, x), ContractViolation);
  EXPECT_THROW(CoordinationDiagram(problem, x, y, {.finest = 0}), ContractViolation);
}

}  // namespace
}  // namespace tandem::coordination
