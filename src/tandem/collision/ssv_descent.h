#pragma once
/// Simultaneous descent of the trees of two bodies.

#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>

#include "tandem/collision/ssv_scratch.h"
#include "tandem/geometry/distance.h"

namespace tandem::collision {

/// Nodes of the two bodies of a pair.
struct NearNodes {
  int a, b;
  double distance;  ///< Lower bound of their distance as placed [m];
  double lower;     ///< the same with the slack taken off.
  bool is_exact;    ///< Both are pieces, and `distance` is theirs.
};

/// What a descent asks about the bodies as placed: nothing moves. Derive, hide what differs.
struct PlacedQuery {
  /// How much nearer two bounding spheres may come [m],
  double slack(int, int) const { return 0; }
  /// and the core of a leaf to a bounding sphere.
  double core_slack(int /*leaf*/, int /*side*/, int /*node*/) const { return 0; }
  /// Whether only what touches as placed matters from here on.
  static constexpr bool has_given_up() { return false; }
  /// Whether a pair of nodes needs no descent.
  bool settles(const NearNodes&) const { return false; }
};

namespace detail {

/// Bounds the distance of nodes of one pair: by their spheres, by the form of leaves where that may
/// say more.
template <class Query>
class NodeBounds {
 public:
  NodeBounds(SsvScratch& scratch, const SsvPair& pair, Query& query)
      : scratch_(scratch), model_(scratch.model()), pair_(pair), query_(query) {}

  NearNodes operator()(int a, int b, double limit) {
    const SsvNode &node_a = model_.node(a), &node_b = model_.node(b);
    const double distance = scratch_.sphere_distance(a, b);
    NearNodes near{a, b, distance, distance - query_.slack(a, b), node_a.is_ball && node_b.is_ball};
    if (near.lower > limit || near.is_exact) return near;
    if (node_a.is_leaf() && !node_a.is_ball) tighten(near, a, 0, b, pair_.rigid_a);
    if (near.lower > limit) return near;
    if (node_b.is_leaf() && !node_b.is_ball) tighten(near, b, 1, a, pair_.rigid_b);
    return near;
  }

 private:
  void tighten(NearNodes& near, int leaf, int side, int node, bool rigid) {
    const SsvNode &of_leaf = model_.node(leaf), &other = model_.node(node);
    if (rigid && of_leaf.is_shape()) {  // Its rounded box is cheap and tight.
      raise(near, scratch_.box_distance(node, leaf), query_.slack(near.a, near.b));
      return;
    }
    // Of two shapes the distance itself costs little more.
    if (other.is_leaf() && other.is_shape() && of_leaf.is_shape() && !other.is_ball) return;
    if (!other.is_ball && other.radius >= of_leaf.radius) return;  // To be divided first.
    const double to_center =
        geometry::distance_to_point(scratch_.piece(leaf, side), scratch_.center(node));
    raise(near, to_center - other.radius,
          rigid ? query_.slack(near.a, near.b) : query_.core_slack(leaf, side, node));
    near.is_exact = other.is_ball;
  }
  static void raise(NearNodes& near, double distance, double slack) {
    near.distance = std::max(near.distance, distance);
    near.lower = std::max(near.lower, distance - slack);
  }

  SsvScratch& scratch_;
  const SsvModel& model_;
  const SsvPair& pair_;
  Query& query_;
};

/// What is left out of a descent, and how near that is.
template <class Query>
struct Pruning {
  const Query& query;
  double limit;
  double least = std::numeric_limits<double>::infinity();

  bool operator()(const NearNodes& near) {
    if (!((query.has_given_up() ? near.distance : near.lower) > limit)) return false;
    least = std::min(least, near.lower);
    return true;
  }
};

/// For bodies of a few shapes: every leaf of the one that stands still, if any, against the whole
/// other body and then against its leaves. Inner nodes over furniture, boards that stand apart, are
/// large spheres that prune next to nothing.
template <class Query>
double visit_leaves(SsvScratch& scratch, const SsvPair& pair, double limit, Query& query) {
  const SsvModel& model = scratch.model();
  NodeBounds bounds(scratch, pair, query);
  Pruning<Query> is_pruned{query, limit};
  const SsvBody& body_o = model.body(pair.rigid_a ? pair.body_a : pair.body_b);
  const SsvBody& body_i = model.body(pair.rigid_a ? pair.body_b : pair.body_a);
  const auto nodes = [&](int inner, int outer) {
    return pair.rigid_a ? bounds(outer, inner, is_pruned.limit)
                        : bounds(inner, outer, is_pruned.limit);
  };
  for (int outer = body_o.root; outer < body_o.root + 2 * body_o.shape_count - 1; ++outer) {
    if (!model.node(outer).is_leaf()) continue;
    if (body_i.shape_count > 1) {
      const NearNodes whole = nodes(body_i.root, outer);
      if (is_pruned(whole) || query.settles(whole)) continue;
    }
    for (int inner = body_i.root; inner < body_i.root + 2 * body_i.shape_count - 1; ++inner) {
      if (!model.node(inner).is_leaf()) continue;
      const NearNodes near = nodes(inner, outer);
      if (is_pruned(near) || query.settles(near)) continue;
      is_pruned.limit = query.visit(near);
      if (is_pruned.limit == -std::numeric_limits<double>::infinity()) return is_pruned.least;
    }
  }
  return is_pruned.least;
}

}  // namespace detail

/// Visits the pieces of `pair` that bounding volumes do not prove to be further apart than `limit`,
/// the nearest first.
/// @param query  like PlacedQuery, with `double visit(const NearNodes&)` for two leaves: the limit
/// from here on; -infinity ends the descent.
/// @return the least lower bound of those not visited.
template <class Query>
double visit_near(SsvScratch& scratch, const SsvPair& pair, double limit, Query&& query) {
  const SsvModel& model = scratch.model();
  if (model.body(pair.body_a).is_small() && model.body(pair.body_b).is_small()) {
    return detail::visit_leaves(scratch, pair, limit, query);
  }
  detail::NodeBounds bounds(scratch, pair, query);
  detail::Pruning<std::remove_reference_t<Query>> is_pruned{query, limit};
  // Every pair of nodes is replaced by at most two of the next level of one tree.
  std::array<NearNodes, 2 * SsvModel::kMostDepth> open;
  std::size_t count = 1;
  open[0] = bounds(pair.a, pair.b, is_pruned.limit);
  while (count > 0) {
    const NearNodes near = open[--count];
    if (is_pruned(near) || query.settles(near)) continue;
    const SsvNode &a = model.node(near.a), &b = model.node(near.b);
    if (a.is_leaf() && b.is_leaf()) {
      is_pruned.limit = query.visit(near);
      if (is_pruned.limit == -std::numeric_limits<double>::infinity()) return is_pruned.least;
      continue;
    }
    const bool divide_a = b.is_leaf() || (!a.is_leaf() && a.radius >= b.radius);
    const double limit_now = is_pruned.limit;
    NearNodes first =
        divide_a ? bounds(near.a + 1, near.b, limit_now) : bounds(near.a, near.b + 1, limit_now);
    NearNodes second =
        divide_a ? bounds(a.right, near.b, limit_now) : bounds(near.a, b.right, limit_now);
    if (second.distance < first.distance) std::swap(first, second);
    if (!is_pruned(second)) open[count++] = second;
    if (!is_pruned(first)) open[count++] = first;
  }
  return is_pruned.least;
}

}  // namespace tandem::collision
