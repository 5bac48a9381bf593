#include "tandem/collision/ssv_checker.h"

#include <algorithm>

#include "tandem/collision/ssv_model.h"
#include "tandem/core/contract.h"
#include "tandem/geometry/distance.h"

namespace tandem::collision {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr auto kNoSlack = [](int, int) { return 0.0; };

}  // namespace

SsvScratch& own_scratch(const SsvModel& model, CollisionChecker::Scratch& scratch) {
  auto* own = dynamic_cast<SsvScratch*>(&scratch);
  expects(own && &own->model() == &model, "the scratch was made by this checker");
  return *own;
}

bool touches(SsvScratch& scratch, const SsvPair& pair) {
  if (scratch.spheres_apart(pair.a, pair.b, 0)) return false;
  bool hit = false;
  visit_near_shapes(scratch, pair, 0.0, kNoSlack, [&](int sa, int sb, double) {
    if (geometry::clearance(scratch.shape(sa), scratch.shape(sb)).distance > 0) return 0.0;
    hit = true;
    return -kInfinity;
  });
  return hit;
}

void improve(SsvScratch& scratch, int index, PairClearance& best) {
  const SsvPair& pair = scratch.model().pair(index);
  if (scratch.spheres_apart(pair.a, pair.b, best.distance)) return;
  visit_near_shapes(scratch, pair, best.distance, kNoSlack, [&](int sa, int sb, double) {
    const geometry::Clearance c = geometry::clearance(scratch.shape(sa), scratch.shape(sb));
    if (c.distance < best.distance) best = {index, c.distance, c.nhat_BA_W, c.p_WCa, c.p_WCb};
    return best.distance;
  });
}

SsvChecker::SsvChecker(std::shared_ptr<const world::Workcell> cell) : cell_(std::move(cell)) {
  expects(cell_ != nullptr, "a checker needs a cell");
  model_ = std::make_unique<const SsvModel>(*cell_);
  lever_arms_ = model_->lever_arms();
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
  double best = kInfinity;
  const double least_skipped =
      visit_near_shapes(own, bodies, needed, kNoSlack, [&](int sa, int sb, double) {
        best = std::min(best, geometry::clearance(own.shape(sa), own.shape(sb)).distance);
        return std::min(best, needed);
      });
  return std::min(best, least_skipped);
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
  for (const int pair : selection) {
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
  for (const int index : selection) {
    const SsvPair& pair = model_->pair(index);
    if (own.spheres_apart(pair.a, pair.b, within)) continue;
    visit_near_shapes(own, pair, within, kNoSlack, [&](int sa, int sb, double) {
      const geometry::Clearance c = geometry::clearance(own.shape(sa), own.shape(sb));
      if (c.distance < within) out.push_back({index, c.distance, c.nhat_BA_W, c.p_WCa, c.p_WCb});
      return within;
    });
  }
}

}  // namespace tandem::collision
