#pragma once
/// The pairs with many standing bodies, by where these stand. Private to this folder.

#include "tandem/collision/box_tree.h"
#include "tandem/collision/ssv_model.h"

namespace tandem::collision {

/// What finds the standing bodies that are near something, where there are many. A selection of all
/// pairs is looked through by it.
class SsvField {
 public:
  SsvField() = default;
  explicit SsvField(const SsvModel& model);

  /// Whether it finds the pairs of the selection: of all pairs, each once.
  bool serves(std::size_t selected) const { return pair_count_ > 0 && selected == pair_count_; }

  /// Pairs of two bodies that both move.
  const std::vector<int>& moving_pairs() const { return moving_pairs_; }

  /// Calls f(pair) for pairs of moving and standing bodies, at least for those whose spheres are
  /// nearer than `limit()` [m], which may fall. @return whether f has ended it by returning true.
  /// @param center  of the root of a body, as placed.
  template <class Center, class Limit, class F>
  bool visit(const SsvModel& model, Center&& center, Limit&& limit, F&& f) const {
    for (std::size_t m = 0; m < moving_.size(); ++m) {
      const SsvBody& body = model.body(moving_[m]);
      const Eigen::Vector3d p = center(body.root);
      const double radius = model.node(body.root).radius;
      const auto is_far = [&](const BoxTree::Node& node) {
        // How deep things are does not follow from a distance from a box.
        const double reach = radius + std::max(limit(), 0.0);
        return node.box.squaredExteriorDistance(p) > reach * reach;
      };
      const auto look = [&](int first, int count) {
        for (int i = first; i < first + count; ++i) {
          const auto s = static_cast<std::size_t>(tree_.order[static_cast<std::size_t>(i)]);
          const int pair = pair_of_[m * standing_count_ + s];
          if (pair >= 0 && f(pair)) return true;
        }
        return false;
      };
      if (visit_tree(std::span<const BoxTree::Node>(tree_.nodes), is_far, look)) return true;
    }
    return false;
  }

 private:
  static constexpr std::size_t kFewStanding = 64;  // Are looked through one by one.

  BoxTree tree_;  // Over the standing bodies.
  std::size_t standing_count_ = 0;
  std::vector<int> moving_;   // Bodies.
  std::vector<int> pair_of_;  // By moving, then by standing body; -1: is not checked.
  std::vector<int> moving_pairs_;
  std::size_t pair_count_ = 0;  // 0: it serves nobody.
};

}  // namespace tandem::collision
