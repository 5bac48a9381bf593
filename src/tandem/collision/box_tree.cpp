#include "tandem/collision/box_tree.h"

#include <algorithm>
#include <numeric>

namespace tandem::collision {

namespace {

using Eigen::AlignedBox3d;

/// One call of the constructor.
class Builder {
 public:
  Builder(BoxTree& tree, std::span<const AlignedBox3d> boxes, int most)
      : tree_(tree), boxes_(boxes), most_(most) {}

  void build(int first, int count) {
    const std::size_t node = tree_.nodes.size();
    tree_.nodes.push_back({});
    AlignedBox3d around, centers;
    for (int i = first; i < first + count; ++i) {
      around.extend(box(i));
      centers.extend(box(i).center());
    }
    const bool leaf = count <= most_;
    if (!leaf) {
      Eigen::Index axis = 0;
      centers.sizes().maxCoeff(&axis);
      const auto begin = tree_.order.begin() + first;
      std::nth_element(begin, begin + count / 2, begin + count, [&](int a, int b) {
        return center(a)[axis] != center(b)[axis] ? center(a)[axis] < center(b)[axis] : a < b;
      });
      build(first, count / 2);
      build(first + count / 2, count - count / 2);
    }
    tree_.nodes[node] = {around, static_cast<int>(tree_.nodes.size()), first, leaf ? count : 0};
  }

 private:
  const AlignedBox3d& box(int i) const {
    return boxes_[static_cast<std::size_t>(tree_.order[static_cast<std::size_t>(i)])];
  }
  Eigen::Vector3d center(int thing) const {
    return boxes_[static_cast<std::size_t>(thing)].center();
  }

  BoxTree& tree_;
  std::span<const AlignedBox3d> boxes_;
  int most_;
};

}  // namespace

BoxTree::BoxTree(std::span<const AlignedBox3d> boxes, int most) : order(boxes.size()) {
  std::iota(order.begin(), order.end(), 0);
  if (!boxes.empty()) Builder(*this, boxes, most).build(0, static_cast<int>(boxes.size()));
}

}  // namespace tandem::collision
