#include <gtest/gtest.h>

#include "collision/batch_targets.h"
#include "tandem/collision/batch_boxes.h"
#include "tandem/collision/compiled_cell.h"

namespace tandem::collision {
namespace {

using Eigen::VectorXd;
using test::for_each_target;
using world::PairScope;
using world::PairSelection;

world::ObstacleSpec small_box(Rng& rng, const std::string& name) {
  world::ObstacleSpec obstacle;
  obstacle.name = name;
  Eigen::Isometry3d X = test::random_pose(rng, 1.3);
  if (X.translation().norm() < 0.5) X.translation() *= 0.7 / X.translation().norm();
  const Eigen::Vector3d size(rng.uniform(0.02, 0.1), rng.uniform(0.02, 0.1),
                             rng.uniform(0.02, 0.1));
  obstacle.shapes_W = {*geometry::Shape::box(X, size, rng.index(2) == 0 ? 0.0 : 0.01)};
  return obstacle;
}

/// A cell with more obstacles than are looked through one by one.
world::WorkcellSpec full_cell_spec(std::uint64_t seed, int obstacles) {
  world::WorkcellSpec spec = test::random_cell_spec(seed, {.obstacles = 4});
  Rng rng(seed + 1000);
  for (int i = 0; i < obstacles; ++i) {
    spec.obstacles.push_back(small_box(rng, "box" + std::to_string(i)));
  }
  return spec;
}

struct Halves {
  PairSelection first, second;
};
Halves halves_of(const PairSelection& all) {
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  return {{all.begin(), middle}, {middle, all.end()}};
}

/// The same question of halves of the pairs is answered pair by pair.
TEST(ManyObstacles, AreFoundAsPairsAreOneByOne) {
  int free = 0, touching = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const SsvChecker checker(test::make_cell(full_cell_spec(seed, 150)));
    const auto scratch = checker.make_scratch();
    const PairSelection all = checker.cell().select(PairScope::all());
    const auto [first, second] = halves_of(all);
    Rng rng(seed);
    for (int round = 0; round < 150; ++round) {
      const VectorXd q = test::random_configuration(rng, checker.cell());
      const bool is_free = checker.is_free(q, all, *scratch);
      EXPECT_EQ(is_free,
                checker.is_free(q, first, *scratch) && checker.is_free(q, second, *scratch));
      (is_free ? free : touching) += 1;
      const double least = checker.least_clearance(q, all, *scratch).distance;
      EXPECT_EQ(least, std::min(checker.least_clearance(q, first, *scratch).distance,
                                checker.least_clearance(q, second, *scratch).distance));
      const double within = rng.uniform(0.01, 0.4);
      std::vector<PairClearance> near, near_first, near_second;
      checker.clearances(q, all, within, *scratch, near);
      checker.clearances(q, first, within, *scratch, near_first);
      checker.clearances(q, second, within, *scratch, near_second);
      near_first.insert(near_first.end(), near_second.begin(), near_second.end());
      ASSERT_EQ(near.size(), near_first.size());
      for (std::size_t i = 0; i < near.size(); ++i) {
        EXPECT_EQ(near[i].pair, near_first[i].pair);
        EXPECT_EQ(near[i].distance, near_first[i].distance);
      }
      std::vector<PairClearance> shapes, shapes_first, shapes_second;
      checker.shape_clearances(q, all, within, *scratch, shapes);
      checker.shape_clearances(q, first, within, *scratch, shapes_first);
      checker.shape_clearances(q, second, within, *scratch, shapes_second);
      EXPECT_EQ(shapes.size(), shapes_first.size() + shapes_second.size());
    }
  }
  EXPECT_GT(free, 50);
  EXPECT_GT(touching, 50);
}

TEST(ManyObstacles, BatchesAnswerAsTheExactChecker) {
  for_each_target([] {
    int free = 0, touching = 0, accepted = 0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const CompiledCell compiled(test::make_cell(full_cell_spec(seed, 150)));
      const SsvChecker& exact = compiled.exact();
      const BatchChecker& batch = compiled.batch();
      const auto exact_scratch = exact.make_scratch();
      const auto scratch = batch.make_scratch();
      const PairSelection& all = compiled.selection(PairScope::all());
      const auto pairs = compiled.pairs(PairScope::all());
      const auto [first, second] = halves_of(all);
      const auto is_free = [&](const VectorXd& q) {
        return exact.is_free(q, first, *exact_scratch) && exact.is_free(q, second, *exact_scratch);
      };
      Rng rng(seed);
      VectorXd near(1);
      for (int round = 0; round < 300; ++round) {
        const VectorXd q = test::random_configuration(rng, exact.cell());
        const bool expected = is_free(q);
        ASSERT_EQ(batch.are_free(q, *pairs, *scratch), expected);
        (expected ? free : touching) += 1;
        batch.least_clearances(q, *pairs, 0.02, *scratch, near);
        EXPECT_NEAR(near[0], std::min(0.02, exact.least_clearance(q, all, *exact_scratch).distance),
                    1e-9);
        const VectorXd to = q + 0.1 * (test::random_configuration(rng, exact.cell()) - q);
        std::vector<BoxProof> box;
        prove_boxes(batch, q, 0.5 * (to - q).cwiseAbs(), *pairs, true, *scratch, box);
        const bool edge = batch.is_edge_free(q, to, *pairs, *scratch);
        accepted += edge;
        for (int k = 0; k <= 40; ++k) {
          const VectorXd p = q + k / 40.0 * (to - q);
          const bool in_box = k <= 20 && box[0].verdict == BoxProof::Verdict::kFree;
          ASSERT_TRUE(!(edge || in_box) || is_free(p));
        }
      }
    }
    EXPECT_GT(free, 100);
    EXPECT_GT(touching, 100);
    EXPECT_GT(accepted, 40);
  });
}

}  // namespace
}  // namespace tandem::collision
