#include "tandem/collision/ssv_known.h"

#include <gtest/gtest.h>

#include "collision/random_cell.h"
#include "tandem/world/obstacles.h"

namespace tandem::collision {
namespace {

using Cell = std::shared_ptr<const world::Workcell>;

void expect_same_nodes(const SsvModel& a, const SsvModel& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t n = 0; n < a.nodes.size(); ++n) {
    const SsvNode &x = a.nodes[n], &y = b.nodes[n];
    ASSERT_EQ(x.p_JC, y.p_JC);
    ASSERT_EQ(x.radius, y.radius);
    ASSERT_EQ(std::tie(x.joint, x.is_ball, x.has_anchors, x.slot, x.right, x.piece),
              std::tie(y.joint, y.is_ball, y.has_anchors, y.slot, y.right, y.piece));
  }
}

/// What is taken over must not tell from what is compiled anew.
void expect_same(const SsvModel& a, const SsvModel& b) {
  ASSERT_NO_FATAL_FAILURE(expect_same_nodes(a, b));
  ASSERT_EQ(std::tie(a.node_slots, a.shape_slots), std::tie(b.node_slots, b.shape_slots));
  ASSERT_EQ(a.shapes.size(), b.shapes.size());
  for (std::size_t s = 0; s < a.shapes.size(); ++s) {
    const SsvShape &x = a.shapes[s], &y = b.shapes[s];
    ASSERT_EQ(x.slot, y.slot);
    ASSERT_EQ(x.vertices_J, y.vertices_J);
    ASSERT_EQ(x.shape_J.origin(), y.shape_J.origin());
    ASSERT_EQ(x.shape_J.radius(), y.shape_J.radius());
  }
  ASSERT_EQ(a.surfaces.size(), b.surfaces.size());
  for (std::size_t s = 0; s < a.surfaces.size(); ++s) {
    ASSERT_EQ(a.surfaces[s].surface, b.surfaces[s].surface);
    ASSERT_EQ(a.surfaces[s].X_JS.matrix(), b.surfaces[s].X_JS.matrix());
    ASSERT_EQ(a.surfaces[s].padding, b.surfaces[s].padding);
  }
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t n = 0; n < a.bodies.size(); ++n) {
    const SsvBody &x = a.bodies[n], &y = b.bodies[n];
    ASSERT_EQ(std::tie(x.joint, x.root, x.first_shape, x.shape_count, x.first_surface,
                       x.surface_count, x.is_solid),
              std::tie(y.joint, y.root, y.first_shape, y.shape_count, y.first_surface,
                       y.surface_count, y.is_solid));
  }
}

/// @return how many bodies of `after` were taken over from `before`.
int taken_over(const Cell& before, const Cell& after) {
  const SsvChecker known(before);
  const SsvModel model(*after, &known);
  expect_same(model, SsvModel(*after));
  return model.taken_over;
}

Cell moved(const Cell& cell, const std::string& object, const std::string& link) {
  world::SceneState scene = cell->scene();
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation().z() = 0.7;
  scene.objects[object] = {link, X, {}, {}};
  return *cell->in_scene(std::move(scene));
}

TEST(SsvKnown, TakesOverWhatStayedTheSameAndNothingElse) {
  for (const int pieces : {0, 200}) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      SCOPED_TRACE(seed);
      test::RandomCellOptions options;
      options.surface_pieces = pieces;
      const Cell cell = *world::Workcell::make(test::random_cell_spec(seed, options));
      const int all = static_cast<int>(cell->bodies().size());
      EXPECT_EQ(taken_over(cell, cell), all);
      EXPECT_EQ(taken_over(cell, moved(cell, "obstacle1", "world")), all - 1);
      // Removing the last closed mesh would leave no anchors, which are part of what is compiled.
      const Cell fewer = *world::without_obstacle(*cell, "obstacle0");
      const int kept = taken_over(cell, fewer);
      EXPECT_TRUE(kept == all - 1 || kept == 0) << kept;
      options.padding *= 2;
      const Cell padded = *world::Workcell::make(test::random_cell_spec(seed, options));
      EXPECT_LE(taken_over(cell, padded), options.obstacles);
    }
  }
}

}  // namespace
}  // namespace tandem::collision
