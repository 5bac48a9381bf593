#include "tandem/collision/ssv_box.h"

#include <algorithm>

#include "tandem/collision/ssv_descent.h"

namespace tandem::collision {

namespace {

using Eigen::Vector3d;
using Finding = PairOnBox::Finding;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Two spheres whose centres are nearer than this many times their travel are left to the halves of
/// the box: the exact distance would seldom prove them apart. Decides about speed only.
constexpr double kHopeful = 1.5;

/// How much nearer two bounding spheres may come on the box.
double node_slack(SsvScratch& scratch, const SsvPair& pair, int a, int b) {
  return scratch.travel(a, pair.shared) + scratch.travel(b, pair.shared) + kBoxRounding;
}

/// The descent into the pair. Once anything is unproven the rest is only searched for what touches
/// as placed.
class Descent {
 public:
  Descent(SsvScratch& scratch, const SsvPair& pair, double target, double enough)
      : scratch_(scratch), pair_(pair), target_(target), enough_(enough) {}

  double slack(int a, int b) const { return node_slack(scratch_, pair_, a, b); }
  double core_slack(int leaf, int side, int node) const {
    return scratch_.core_travel(leaf, pair_.shared, side) + scratch_.travel(node, pair_.shared) +
           kBoxRounding;
  }
  bool has_given_up() const { return finding != Finding::kApart; }
  bool settles(const NearNodes& near) {
    if (!(near.distance > 0) || !is_hopeless(near)) return false;
    finding = Finding::kUnproven;
    return true;
  }
  double visit(const NearNodes& near) {
    if (has_given_up() && near.distance > 0) return 0.0;
    const double kept = distance_over_box(near);
    if (kept == -kInfinity) {
      finding = Finding::kTouching;
      return -kInfinity;
    }
    if (!(kept > target_)) finding = Finding::kUnproven;
    bound = std::min(bound, kept);
    return has_given_up() ? 0.0 : target_;
  }

  Finding finding = Finding::kApart;
  double bound = kInfinity;

 private:
  bool is_hopeless(const NearNodes& near) const {
    return (scratch_.center(near.a) - scratch_.center(near.b)).norm() <
           target_ + kHopeful * slack(near.a, near.b);
  }
  double furthest(const Vector3d& n_W, int leaf, int side, bool rigid) const;
  double distance_over_box(const NearNodes& near) const;

  SsvScratch& scratch_;
  const SsvPair& pair_;
  double target_, enough_;
};

/// Upper bound of n.p over the box for all p of the core of a leaf.
double Descent::furthest(const Vector3d& n_W, int leaf, int side, bool rigid) const {
  const geometry::Shape& shape_W = scratch_.piece(leaf, side);
  if (rigid) return n_W.dot(shape_W.support(n_W));
  const int joint = scratch_.model().node(leaf).joint;
  const double top = n_W.dot(shape_W.support(n_W));
  const bool is_hull = shape_W.type() != geometry::CoreType::kCylinder;
  // Vertices that stay below where the furthest one is already say nothing.
  const double below = is_hull ? top - scratch_.core_travel(leaf, pair_.shared, side) : -kInfinity;
  double most = top, most_travel = 0;
  scratch_.for_each_vertex(leaf, side, [&](const Vector3d& v_W) {
    if (n_W.dot(v_W) < below) return;
    const double travel = scratch_.travel_along(n_W, joint, pair_.common, v_W);
    most = std::max(most, n_W.dot(v_W) + travel);
    most_travel = std::max(most_travel, travel);
  });
  return is_hull ? most : std::min(most, top + most_travel);  // The hull of a cylinder is wider.
}

/// Lower bound of the distance of two pieces over the box: that of the planes which support them
/// along the normal. Any unit normal gives a valid bound, the one as placed a good one.
double Descent::distance_over_box(const NearNodes& near) const {
  const geometry::Shape& a_W = scratch_.piece(near.a, 0);
  const geometry::Shape& b_W = scratch_.piece(near.b, 1);
  const geometry::Clearance c = geometry::clearance(a_W, b_W);
  if (!(c.distance > 0)) return -kInfinity;
  if (c.distance <= target_) return c.distance;
  // In all directions first: that is kept by leaf.
  const double any_way = c.distance - scratch_.core_travel(near.a, pair_.shared, 0) -
                         scratch_.core_travel(near.b, pair_.shared, 1) - kBoxRounding;
  if (any_way > enough_) return any_way;
  const double without_b = -furthest(-c.nhat_BA_W, near.a, 0, pair_.rigid_a) - a_W.radius() -
                           b_W.radius() - kBoxRounding;
  const double at_most = without_b - c.nhat_BA_W.dot(b_W.support(c.nhat_BA_W));
  if (at_most <= target_) return at_most;
  return without_b - furthest(c.nhat_BA_W, near.b, 1, pair_.rigid_b);
}

/// Looks for two pieces that overlap everywhere. A signed distance of convex pieces is the largest
/// gap between supporting planes; so it changes by no more than their points move.
struct OverlapQuery : PlacedQuery {
  double visit(const NearNodes& near) {
    const geometry::Shape& a_W = scratch.piece(near.a, 0);
    const geometry::Shape& b_W = scratch.piece(near.b, 1);
    const double distance = geometry::clearance(a_W, b_W).distance;
    if (!(distance < 0)) return 0.0;
    const double of_a = scratch.core_travel(near.a, pair.shared, 0) + kBoxRounding;
    found =
        distance + of_a < 0 && distance + of_a + scratch.core_travel(near.b, pair.shared, 1) < 0;
    return found ? -kInfinity : 0.0;
  }

  SsvScratch& scratch;
  const SsvPair& pair;
  bool found = false;
};

}  // namespace

PairOnBox examine_on_box(SsvScratch& scratch, const SsvPair& pair, double target, double enough) {
  const double taken = node_slack(scratch, pair, pair.a, pair.b);
  if (scratch.spheres_apart(pair.a, pair.b, taken + std::max(target, enough))) {
    return {Finding::kApart};
  }
  const double apart = scratch.sphere_distance(pair.a, pair.b);
  if (apart - taken > target) return {Finding::kApart, apart - taken};
  Descent descent(scratch, pair, target, std::max(target, enough));
  const double least_skipped = visit_near(scratch, pair, target, descent);
  return {descent.finding, std::min(descent.bound, least_skipped)};
}

bool touches_on_box(SsvScratch& scratch, const SsvPair& pair) {
  OverlapQuery query{{}, scratch, pair};
  visit_near(scratch, pair, 0.0, query);
  return query.found;
}

}  // namespace tandem::collision
