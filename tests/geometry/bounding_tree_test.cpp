#include "tandem/geometry/bounding_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::geometry {
namespace {

using Eigen::Vector3d;
using Sphere = BoundingTree::Sphere;

std::vector<Sphere> random_spheres(Rng& rng, std::size_t count, double most_radius) {
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d center(rng.uniform(-1, 1), rng.uniform(-2, 2), rng.uniform(-0.1, 0.1));
    spheres.push_back({center, most_radius > 0 ? rng.uniform(0, most_radius) : 0.0});
  }
  return spheres;
}

/// Checks every promise of the header; returns the depth.
int check_tree(const std::vector<Sphere>& items, int leaf_size, const BoundingTree& tree) {
  EXPECT_EQ(tree.order().size(), items.size());
  std::vector<int> seen(items.size());
  for (const int i : tree.order()) ++seen.at(static_cast<std::size_t>(i));
  for (const int times : seen) EXPECT_EQ(times, 1);
  if (items.empty()) {
    EXPECT_TRUE(tree.nodes().empty());
    return 0;
  }
  std::size_t visited = 0;
  const std::function<int(int)> descend = [&](int n) {
    ++visited;
    const BoundingTree::Node& node = tree.nodes().at(static_cast<std::size_t>(n));
    EXPECT_GE(node.count, 1);
    for (int i = node.first; i < node.first + node.count; ++i) {
      const Sphere& item =
          items[static_cast<std::size_t>(tree.order()[static_cast<std::size_t>(i)])];
      EXPECT_LE((item.center - node.sphere.center).norm() + item.radius,
                node.sphere.radius * (1 + 1e-12) + 1e-12);
    }
    if (node.is_leaf()) {
      EXPECT_LE(node.count, leaf_size);
      return 1;
    }
    const BoundingTree::Node& left = tree.nodes().at(static_cast<std::size_t>(n + 1));
    const BoundingTree::Node& right = tree.nodes().at(static_cast<std::size_t>(node.right));
    EXPECT_EQ(left.first, node.first);
    EXPECT_EQ(right.first, left.first + left.count);
    EXPECT_EQ(left.count + right.count, node.count);
    return 1 + std::max(descend(n + 1), descend(node.right));
  };
  const int depth = descend(0);
  EXPECT_EQ(visited, tree.nodes().size());
  const double leaves = static_cast<double>(items.size()) / leaf_size;
  EXPECT_LE(depth, 2 + std::max(0.0, std::ceil(std::log2(leaves))));
  return depth;
}

TEST(BoundingTree, KeepsItsPromises) {
  Rng rng(1);
  for (const std::size_t count : {1, 2, 3, 4, 5, 7, 8, 9, 31, 100, 1000, 4097}) {
    for (const int leaf_size : {1, 2, 8}) {
      for (const double radius : {0.0, 0.1, 3.0}) {
        const std::vector<Sphere> items = random_spheres(rng, count, radius);
        check_tree(items, leaf_size, BoundingTree(items, leaf_size));
      }
    }
  }
}

TEST(BoundingTree, OfOneItemIsTheItem) {
  const std::vector<Sphere> items{{Vector3d(1, 2, 3), 0.25}};
  const BoundingTree tree(items);
  ASSERT_EQ(tree.nodes().size(), 1U);
  EXPECT_TRUE(tree.nodes()[0].is_leaf());
  EXPECT_EQ(tree.nodes()[0].sphere.center, items[0].center);
  EXPECT_EQ(tree.nodes()[0].sphere.radius, 0.25);
}

TEST(BoundingTree, OfNothingIsEmpty) {
  EXPECT_TRUE(BoundingTree().nodes().empty());
  check_tree({}, 1, BoundingTree(std::span<const Sphere>{}));
}

TEST(BoundingTree, StaysShallowWhereItemsCoincide) {
  const std::vector<Sphere> same(1000, Sphere{Vector3d(0.1, 0.2, 0.3), 0.0});
  EXPECT_EQ(check_tree(same, 1, BoundingTree(same)), 11);
  std::vector<Sphere> nested;
  for (int i = 0; i < 500; ++i) nested.push_back({Vector3d::Ones(), 0.01 * i});
  const BoundingTree tree(nested);
  EXPECT_LE(check_tree(nested, 1, tree), 10);
  EXPECT_NEAR(tree.nodes()[0].sphere.radius, 4.99, 1e-9);
}

TEST(BoundingTree, SpheresAreTight) {
  // All points on a sphere, and all in a cube: the smallest spheres are known.
  Rng rng(3);
  std::vector<Sphere> shell, cube;
  for (int i = 0; i < 300; ++i) {
    const Vector3d p(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    shell.push_back({p.normalized() + Vector3d(5, 0, 0), 0.1});
    cube.push_back({p, 0});
  }
  for (int i = 0; i < 8; ++i)
    cube.push_back({Vector3d(i & 1, i >> 1 & 1, i >> 2) * 2 - Vector3d::Ones(), 0});
  EXPECT_LT(BoundingTree(shell).nodes()[0].sphere.radius, 1.05 * 1.1);
  EXPECT_LT(BoundingTree(cube).nodes()[0].sphere.radius, 1.02 * std::sqrt(3));
  // Of two items the sphere is exact.
  const std::vector<Sphere> two{{Vector3d::Zero(), 1}, {Vector3d(3, 0, 0), 0.5}};
  EXPECT_NEAR(BoundingTree(two).nodes()[0].sphere.radius, 2.25, 1e-12);
}

TEST(BoundingTree, BuildsLargeTreesQuickly) {
  Rng rng(4);
  const std::vector<Sphere> items = random_spheres(rng, 100000, 0.01);
  const std::clock_t begin = std::clock();
  const BoundingTree tree(items);
  const double took = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  std::printf("100,000 items in %.3f s\n", took);
  check_tree(items, 1, tree);
}

TEST(BoundingTree, RefusesWrongUse) {
  const auto build = [](const Sphere& sphere, int leaf_size) {
    return BoundingTree(std::span(&sphere, 1), leaf_size);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(build({Vector3d::Zero(), 1}, 0), ContractViolation);
  EXPECT_THROW(build({Vector3d::Zero(), -1}, 1), ContractViolation);
  EXPECT_THROW(build({Vector3d::Zero(), nan}, 1), ContractViolation);
  EXPECT_THROW(build({Vector3d(0, nan, 0), 1}, 1), ContractViolation);
}

}  // namespace
}  // namespace tandem::geometry
