#include "tandem/collision/ssv_checker.h"

#include <algorithm>

#include "tandem/collision/ssv_descent.h"
#include "tandem/collision/ssv_field.h"

namespace tandem::collision {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Distance of two pieces as placed, where bounds have not found it yet [m].
double piece_distance(SsvScratch& scratch, const NearNodes& near) {
  if (near.is_exact) return near.distance;
  return geometry::distance(scratch.piece(near.a, 0), scratch.piece(near.b, 1));
}

/// Leaves only the nearest of what says nearly the same: pieces of a surface that one piece of the
/// other body is near to, in about the same direction.
void thin_out(std::vector<FoundClearance>& found) {
  constexpr double kSameDirection = 0.9;  // Cosine.
  std::ranges::stable_sort(found, {}, [](const FoundClearance& f) { return f.clearance.distance; });
  std::size_t kept = 0;
  for (const FoundClearance& f : found) {
    const bool known = std::any_of(
        found.begin(), found.begin() + static_cast<std::ptrdiff_t>(kept), [&](const auto& nearer) {
          return nearer.leaf == f.leaf &&
                 nearer.clearance.nhat_BA_W.dot(f.clearance.nhat_BA_W) > kSameDirection;
        });
    if (!known) found[kept++] = f;
  }
  found.resize(kept);
}

}  // namespace

void add_shape_clearances(SsvScratch& scratch, int index, double within,
                          std::vector<PairClearance>& out) {
  struct All : PlacedQuery {
    All(SsvScratch& of, int pair, double up_to, std::vector<PairClearance>& all)
        : scratch(of), index(pair), within(up_to), out(all) {}
    double visit(const NearNodes& near) {
      const geometry::Clearance c =
          geometry::clearance(scratch.piece(near.a, 0), scratch.piece(near.b, 1));
      if (!(c.distance < within)) return within;
      const PairClearance clearance{index, c.distance, c.nhat_BA_W, c.p_WCa, c.p_WCb};
      const bool of_a = !scratch.model().node(near.a).is_shape();
      if (of_a || !scratch.model().node(near.b).is_shape()) {
        scratch.found.push_back({clearance, of_a ? near.b : near.a});
      } else {
        out.push_back(clearance);
      }
      return within;
    }
    SsvScratch& scratch;
    int index;
    double within;
    std::vector<PairClearance>& out;
  };
  scratch.found.clear();
  const SsvPair& pair = scratch.model().pair(index);
  visit_near(scratch, pair, within, All(scratch, index, within, out));
  thin_out(scratch.found);
  for (const FoundClearance& found : scratch.found) out.push_back(found.clearance);
  if (!pair.solid) return;
  PairClearance inside;
  inside.distance = 0;
  improve_inside(scratch, index, inside);
  if (inside.pair >= 0) out.push_back(inside);
}

SsvScratch& own_scratch(const SsvModel& model, CollisionChecker::Scratch& scratch) {
  auto* own = dynamic_cast<SsvScratch*>(&scratch);
  expects(own && &own->model() == &model, "the scratch was made by this checker");
  return *own;
}
bool pieces_touch(SsvScratch& scratch, const SsvPair& pair) {
  struct Touch : PlacedQuery {
    explicit Touch(SsvScratch& of) : scratch(of) {}
    double visit(const NearNodes& near) {
      hit = !(piece_distance(scratch, near) > 0);
      return hit ? -kInfinity : 0.0;
    }
    SsvScratch& scratch;
    bool hit = false;
  };
  Touch touch(scratch);
  visit_near(scratch, pair, 0.0, touch);
  return touch.hit || (pair.solid && is_inside(scratch, pair));
}

void improve(SsvScratch& scratch, int index, PairClearance& best) {
  struct Nearest : PlacedQuery {
    Nearest(SsvScratch& of, int pair, PairClearance& improved)
        : scratch(of), index(pair), best(improved) {}
    double visit(const NearNodes& near) {
      const geometry::Clearance c =
          geometry::clearance(scratch.piece(near.a, 0), scratch.piece(near.b, 1));
      if (c.distance < best.distance) best = {index, c.distance, c.nhat_BA_W, c.p_WCa, c.p_WCb};
      return best.distance;
    }
    SsvScratch& scratch;
    int index;
    PairClearance& best;
  };
  const SsvPair& pair = scratch.model().pair(index);
  if (scratch.spheres_apart(pair.a, pair.b, best.distance)) return;
  visit_near(scratch, pair, best.distance, Nearest(scratch, index, best));
  if (pair.solid) improve_inside(scratch, index, best);
}

namespace {

/// Calls f(pair) for pairs of the cell, by its field: at least for those whose bounding spheres are
/// nearer than `limit()` [m], which may fall. @return whether f has ended it by returning true.
template <class Limit, class F>
bool for_each_near(SsvScratch& scratch, Limit&& limit, F&& f) {
  const SsvModel& model = scratch.model();
  return std::ranges::any_of(model.field->moving_pairs(), f) ||
         model.field->visit(model, [&](int node) { return scratch.center(node); }, limit, f);
}

/// The pairs of a selection that may be nearer than `within`, in its order.
world::PairSelection near_pairs(SsvScratch& scratch, const world::PairSelection& selection,
                                double within) {
  if (!scratch.model().field->serves(selection.size()) || !std::ranges::is_sorted(selection)) {
    return selection;
  }
  world::PairSelection pairs;
  const auto collect = [&](int pair) {
    pairs.push_back(pair);
    return false;
  };
  for_each_near(scratch, [&] { return within; }, collect);
  std::ranges::sort(pairs);
  return pairs;
}

/// The pair with the least distance of all, by the field.
PairClearance nearest_of_all(SsvScratch& scratch) {
  PairClearance best;
  best.distance = kInfinity;
  const auto look = [&](int pair) {
    improve(scratch, pair, best);
    return false;
  };
  // What is so near first [m]; else much is measured before something near is found.
  for (double within = 0.05;; within = within < 50 ? 4 * within : kInfinity) {
    for_each_near(scratch, [&] { return std::min(best.distance, within); }, look);
    if (best.distance <= within) return best;
  }
}

}  // namespace

SsvChecker::SsvChecker(std::shared_ptr<const world::Workcell> cell, const SsvChecker* like)
    : cell_(std::move(cell)) {
  expects(cell_ != nullptr, "a checker needs a cell");
  model_ = std::make_unique<const SsvModel>(*cell_, like);
}

SsvChecker::~SsvChecker() = default;

std::unique_ptr<CollisionChecker::Scratch> SsvChecker::make_scratch() const {
  return std::make_unique<SsvScratch>(*model_);
}

void SsvChecker::place(const Eigen::Ref<const Eigen::VectorXd>& q,
                       CollisionChecker::Scratch& scratch) const {
  own_scratch(*model_, scratch).place(q);
}

double SsvChecker::pair_distance(int pair, double needed,
                                 CollisionChecker::Scratch& scratch) const {
  SsvScratch& own = own_scratch(*model_, scratch);
  const SsvPair& bodies = model_->pair(pair);
  const double apart = own.sphere_distance(bodies.a, bodies.b);
  if (apart > needed) return apart;
  struct Least : PlacedQuery {
    Least(SsvScratch& of, double up_to) : scratch(of), needed(up_to) {}
    double visit(const NearNodes& near) {
      best = std::min(best, piece_distance(scratch, near));
      return std::min(best, needed);
    }
    SsvScratch& scratch;
    double needed, best = kInfinity;
  };
  Least least(own, needed);
  const double skipped = visit_near(own, bodies, needed, least);
  if (!bodies.solid) return std::min(least.best, skipped);
  PairClearance inside;
  inside.distance = std::min(least.best, skipped);
  improve_inside(own, pair, inside);
  return inside.distance;
}

bool SsvChecker::is_free(const Eigen::Ref<const Eigen::VectorXd>& q,
                         const world::PairSelection& selection,
                         CollisionChecker::Scratch& scratch) const {
  place(q, scratch);
  SsvScratch& own = own_scratch(*model_, scratch);
  // Neighbouring configurations tend to collide in the same pair.
  if (own.last_hit < selection.size() && touches(own, model_->pair(selection[own.last_hit]))) {
    return false;
  }
  if (model_->field->serves(selection.size())) {
    const auto hits = [&](int pair) {
      if (!touches(own, model_->pair(pair))) return false;
      own.last_hit = static_cast<std::size_t>(pair);
      return true;
    };
    return !for_each_near(own, [] { return 0.0; }, hits);
  }
  for (std::size_t i = 0; i < selection.size(); ++i) {
    if (touches(own, model_->pair(selection[i]))) {
      own.last_hit = i;
      return false;
    }
  }
  return true;
}

PairClearance SsvChecker::least_clearance(const Eigen::Ref<const Eigen::VectorXd>& q,
                                          const world::PairSelection& selection,
                                          CollisionChecker::Scratch& scratch) const {
  place(q, scratch);
  SsvScratch& own = own_scratch(*model_, scratch);
  if (model_->field->serves(selection.size())) return nearest_of_all(own);
  PairClearance best;
  best.distance = kInfinity;
  // The pair that looks nearest first: most others then fail at their bounding spheres.
  int first = -1;
  double least = kInfinity;
  for (const int pair : selection) {
    const SsvPair& bodies = model_->pair(pair);
    if (const double apart = own.sphere_distance(bodies.a, bodies.b); apart < least) {
      least = apart;
      first = pair;
    }
  }
  if (first >= 0) improve(own, first, best);
  for (const int pair : selection) improve(own, pair, best);
  return best;
}

void SsvChecker::clearances(const Eigen::Ref<const Eigen::VectorXd>& q,
                            const world::PairSelection& selection, double within,
                            CollisionChecker::Scratch& scratch,
                            std::vector<PairClearance>& out) const {
  place(q, scratch);
  SsvScratch& own = own_scratch(*model_, scratch);
  out.clear();
  for (const int pair : near_pairs(own, selection, within)) {
    PairClearance nearest;
    nearest.distance = within;
    improve(own, pair, nearest);
    if (nearest.pair >= 0) out.push_back(nearest);
  }
}

void SsvChecker::shape_clearances(const Eigen::Ref<const Eigen::VectorXd>& q,
                                  const world::PairSelection& selection, double within,
                                  CollisionChecker::Scratch& scratch,
                                  std::vector<PairClearance>& out) const {
  place(q, scratch);
  SsvScratch& own = own_scratch(*model_, scratch);
  out.clear();
  for (const int index : near_pairs(own, selection, within)) {
    if (!own.spheres_apart(model_->pair(index).a, model_->pair(index).b, within)) {
      add_shape_clearances(own, index, within, out);
    }
  }
}

}  // namespace tandem::collision
