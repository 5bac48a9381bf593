#include "tandem/geometry/bounding_tree.h"

#include <algorithm>
#include <limits>

#include "tandem/core/contract.h"

namespace tandem::geometry {

namespace {

using Eigen::Vector3d;
using Sphere = BoundingTree::Sphere;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The smallest sphere around two.
Sphere around(const Sphere& a, const Sphere& b) {
  const Vector3d p_AB = b.center - a.center;
  const double apart = p_AB.norm();
  if (apart + b.radius <= a.radius) return a;
  if (apart + a.radius <= b.radius) return b;
  const double radius = 0.5 * (apart + a.radius + b.radius);
  return {a.center + ((radius - a.radius) / apart) * p_AB, radius};
}

/// An item that takes its index along when it is sorted.
struct Entry {
  Sphere sphere;
  int index;
};

class Builder {
 public:
  Builder(std::span<Entry> entries, int leaf_size, std::vector<BoundingTree::Node>& nodes)
      : entries_(entries), leaf_size_(leaf_size), nodes_(nodes) {}

  /// Adds the subtree of `count` items from `first` on.   @return its root.
  int build(int first, int count) {
    const auto node = nodes_.size();
    const auto entries = entries_.subspan(index(first), index(count));
    nodes_.push_back({entries[0].sphere, -1, first, count});
    if (count <= leaf_size_) {
      if (count > 1) nodes_[node].sphere = enclose(entries);
      return static_cast<int>(node);
    }
    const int half = count / 2;
    halve(entries);
    const int left = build(first, half);
    const int right = build(first + half, count - half);
    nodes_[node].right = right;
    const Sphere joined = around(nodes_[index(left)].sphere, nodes_[index(right)].sphere);
    const Sphere own = enclose(entries);
    nodes_[node].sphere = own.radius < joined.radius ? own : joined;
    return static_cast<int>(node);
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  /// Sorts into halves by the centres along the axis on which these lie widest.
  static void halve(std::span<Entry> entries) {
    Vector3d low = entries[0].sphere.center, high = low;
    for (const Entry& entry : entries) {
      low = low.cwiseMin(entry.sphere.center);
      high = high.cwiseMax(entry.sphere.center);
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    std::ranges::nth_element(entries,
                             entries.begin() + static_cast<std::ptrdiff_t>(entries.size() / 2), {},
                             [axis](const Entry& entry) { return entry.sphere.center[axis]; });
  }

  /// A small sphere around the items, from the middle of their box on.
  /// Ref: Badoiu, Clarkson, Smaller core-sets for balls (2003).
  static Sphere enclose(std::span<const Entry> entries) {
    constexpr std::size_t kLeastRounds = 2, kMostRounds = 40, kWork = 384;
    const std::size_t rounds = std::clamp(kWork / entries.size(), kLeastRounds, kMostRounds);
    Sphere best{Vector3d::Zero(), kInfinity};
    Vector3d center = middle(entries);
    for (std::size_t round = 1; round <= rounds; ++round) {
      double radius = -1;
      Vector3d towards = center;
      for (const auto& [sphere, _] : entries) {
        const double reach = (sphere.center - center).norm() + sphere.radius;
        if (reach <= radius) continue;
        radius = reach;
        towards = sphere.center;
      }
      if (radius < best.radius) best = {center, radius};
      const double apart = (towards - center).norm();
      if (apart == 0) break;  // That item alone needs this radius.
      const double step = 0.5 * radius / (static_cast<double>(round) + 1);
      center += (std::min(step, apart) / apart) * (towards - center);
    }
    return best;
  }

  static Vector3d middle(std::span<const Entry> entries) {
    Vector3d low = Vector3d::Constant(kInfinity), high = -low;
    for (const auto& [sphere, _] : entries) {
      low = low.cwiseMin(sphere.center - Vector3d::Constant(sphere.radius));
      high = high.cwiseMax(sphere.center + Vector3d::Constant(sphere.radius));
    }
    return 0.5 * low + 0.5 * high;
  }

  std::span<Entry> entries_;
  int leaf_size_;
  std::vector<BoundingTree::Node>& nodes_;
};

}  // namespace

BoundingTree::BoundingTree(std::span<const Sphere> items, int leaf_size) {
  expects(leaf_size >= 1, "a leaf holds at least one item");
  expects(items.size() <= static_cast<std::size_t>(std::numeric_limits<int>::max() / 2),
          "items and nodes are numbered by int");
  for (const Sphere& item : items) {
    expects(item.center.allFinite() && item.radius >= 0 && item.radius < 1e300,
            "items are spheres with a finite centre and a finite radius >= 0");
  }
  if (items.empty()) return;
  std::vector<Entry> entries;
  entries.reserve(items.size());
  for (const Sphere& item : items) entries.push_back({item, static_cast<int>(entries.size())});
  Builder(entries, leaf_size, nodes_).build(0, static_cast<int>(items.size()));
  nodes_.shrink_to_fit();
  order_.reserve(items.size());
  for (const Entry& entry : entries) order_.push_back(entry.index);
}

}  // namespace tandem::geometry
