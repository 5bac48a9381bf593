#pragma once
/// A tree of bounding spheres over things that do not move against each other.

#include <Eigen/Core>
#include <span>
#include <vector>

namespace tandem::geometry {

/// Binary, over items given by spheres that contain them. Immutable.
class BoundingTree {
 public:
  struct Sphere {
    Eigen::Vector3d center;  ///< [m]
    double radius;           ///< [m]
  };
  struct Node {
    Sphere sphere;     ///< Contains the spheres of its items.
    int right;         ///< The right child; the left one follows its parent. -1 for a leaf.
    int first, count;  ///< Its items: order()[first], ..., order()[first + count - 1].
    bool is_leaf() const { return right < 0; }
  };

  BoundingTree() = default;
  /// @param leaf_size  most items of a leaf, >= 1.   O(n log n).
  explicit BoundingTree(std::span<const Sphere> items, int leaf_size = 1);

  /// The root first; empty without items.
  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<int>& order() const { return order_; }

 private:
  std::vector<Node> nodes_;
  std::vector<int> order_;
};

}  // namespace tandem::geometry
