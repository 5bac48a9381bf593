#pragma once
/// A tree of boxes over many things that stand still. Private to this folder.

#include <Eigen/Geometry>
#include <span>
#include <vector>

namespace tandem::collision {

/// Nodes in the order of visits: those below one follow it, up to `skip`.
struct BoxTree {
  struct Node {
    Eigen::AlignedBox3d box;
    int skip;          ///< The next node that is not below this one.
    int first, count;  ///< Of a leaf: its things, in `order`; count = 0 for others.
  };
  std::vector<Node> nodes;
  std::vector<int> order;  ///< Of the things.

  /// @param boxes  around the things.   @param most  things in a leaf, at least 1.
  BoxTree(std::span<const Eigen::AlignedBox3d> boxes, int most);
  BoxTree() = default;
};

/// Calls f(first, count) for leaves, `BoxTree::order` or what is sorted like it, unless
/// `is_far(node)` says that there is nothing in it to visit. @return whether f has ended it by
/// returning true.
template <class Node, class IsFar, class F>
bool visit_tree(std::span<const Node> nodes, IsFar&& is_far, F&& f) {
  const auto count = static_cast<int>(nodes.size());
  for (int n = 0; n < count;) {
    const Node& node = nodes[static_cast<std::size_t>(n)];
    if (is_far(node)) {
      n = node.skip;
      continue;
    }
    if (node.count > 0 && f(node.first, node.count)) return true;
    ++n;
  }
  return false;
}

}  // namespace tandem::collision
