#include "tandem/world/obstacles.h"

#include <gtest/gtest.h>

#include <set>

#include "collision/random_cell.h"

namespace tandem::world {
namespace {

using Names = std::set<std::pair<std::string, std::string>>;

Names names_of(const Workcell& cell) {
  Names names;
  for (const BodyPair& pair : cell.pairs()) {
    const std::string& a = cell.bodies()[static_cast<std::size_t>(pair.a)].name;
    const std::string& b = cell.bodies()[static_cast<std::size_t>(pair.b)].name;
    names.insert(std::minmax(a, b));
  }
  return names;
}

std::shared_ptr<const Workcell> cell_with(int obstacles) {
  return test::random_cell(3, {.obstacles = obstacles});
}

TEST(Obstacles, ComingAndGoingMakesTheSamePairsAsAFile) {
  const auto five = cell_with(5), six = cell_with(6);
  const auto grown = with_obstacle(*five, six->spec().obstacles.back());
  ASSERT_TRUE(grown) << grown.error().message;
  EXPECT_EQ((*grown)->bodies().back().name, "obstacle5");
  EXPECT_EQ(names_of(**grown), names_of(*six));
  EXPECT_EQ((*grown)->skipped_pairs().size(), six->skipped_pairs().size());
  const auto shrunk = without_obstacle(**grown, "obstacle5");
  ASSERT_TRUE(shrunk) << shrunk.error().message;
  EXPECT_EQ(names_of(**shrunk), names_of(*five));
  // One in the middle: those behind it move up.
  const auto without = without_obstacle(*six, "obstacle2");
  ASSERT_TRUE(without);
  Names expected = names_of(*six);
  std::erase_if(expected, [](const auto& pair) {
    return pair.first == "obstacle2" || pair.second == "obstacle2";
  });
  EXPECT_EQ(names_of(**without), expected);
  EXPECT_TRUE((*without)->in_scene({}));
  EXPECT_TRUE(std::ranges::is_sorted(
      (*without)->pairs(), {}, [](const BodyPair& pair) { return std::pair(pair.a, pair.b); }));
}

TEST(Obstacles, RefusalsNameTheObstacle) {
  const auto cell = cell_with(3);
  ObstacleSpec taken = cell->spec().obstacles.front();
  const auto twice = with_obstacle(*cell, taken);
  ASSERT_FALSE(twice);
  EXPECT_NE(twice.error().message.find("'obstacle0'"), std::string::npos);
  const auto unknown = without_obstacle(*cell, "obstacle7");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kNotFound);
  EXPECT_NE(unknown.error().message.find("did you mean"), std::string::npos)
      << unknown.error().message;
  const auto carrying = cell->in_scene({.objects = {{"obstacle1", {"r0/link6"}}}});
  ASSERT_TRUE(carrying) << carrying.error().message;
  const auto carried = without_obstacle(**carrying, "obstacle1");
  ASSERT_FALSE(carried);
  EXPECT_NE(carried.error().message.find("carries"), std::string::npos);
  WorkcellSpec spec = test::random_cell_spec(3, {.obstacles = 3});
  spec.allowed = {{"obstacle1", "r0/link4", "on purpose"}};
  const auto used = without_obstacle(*test::make_cell(spec), "obstacle1");
  ASSERT_FALSE(used);
  EXPECT_NE(used.error().message.find("allowed"), std::string::npos);
}

TEST(Obstacles, PairsOfManyStandingBodiesAreNotListed) {
  WorkcellSpec spec = test::random_cell_spec(3, {.obstacles = 0});
  for (int i = 0; i < 2000; ++i) {
    ObstacleSpec ball;
    ball.name = "ball" + std::to_string(i);
    ball.shapes_W = {*geometry::Shape::sphere({0.01 * i, 5, 5}, 0.01)};
    spec.obstacles.push_back(ball);
  }
  const auto cell = test::make_cell(spec);
  const auto moving = static_cast<std::size_t>(
      std::ranges::count_if(cell->bodies(), [](const Body& body) { return body.moved_by != 0; }));
  EXPECT_GE(cell->pairs().size(), 2000 * moving);
  EXPECT_LT(cell->pairs().size() + cell->skipped_pairs().size(), 2001 * moving + 500);
}

}  // namespace
}  // namespace tandem::world
