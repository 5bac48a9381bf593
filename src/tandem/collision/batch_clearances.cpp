// Distances of what the vectors find near, by the exact checker's placement.

#include <algorithm>
#include <bit>
#include <cmath>

#include "tandem/collision/batch_checker.h"
#include "tandem/collision/batch_work.h"
#include "tandem/collision/ssv_descent.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

namespace {

constexpr std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Lower bound of the distance of two shapes in a lane [m]; of cores that overlap nothing is known.
double lower_bound(const NearLanes& near, int lane) {
  constexpr float kOverlap = 1e-10F;  // [m^2]
  const float squared = near.squared.lane[lane];
  if (!(squared > kOverlap)) return -std::numeric_limits<double>::infinity();
  return std::sqrt(static_cast<double>(squared)) - static_cast<double>(near.outer);
}

bool has_surface(const SsvModel& model, const SsvPair& pair) {
  return model.body(pair.body_a).surface_count > 0 || model.body(pair.body_b).surface_count > 0;
}

/// The two shapes as the exact checker knows them, that of body A of their pair first.
struct Leaves {
  int a, b;
};

Leaves leaves_of(const NearLanes& near, const std::vector<int>& leaves, const BatchModel& batch,
                 const SsvPair& pair) {
  const BatchBody& body_a = batch.bodies[index(pair.body_a)];
  const bool in_order =
      body_a.first_shape <= near.a && near.a < body_a.first_shape + body_a.shape_count;
  const int a = leaves[index(near.a)], b = leaves[index(near.b)];
  return in_order ? Leaves{a, b} : Leaves{b, a};
}

}  // namespace

template <class F>
void BatchChecker::for_each_block(const Eigen::Ref<const Eigen::MatrixXd>& Q,
                                  const BatchPairs& pairs, double within, Scratch& scratch,
                                  F&& f) const {
  expects(pairs.model == model_.get() && &scratch.model == model_.get(),
          "pairs and scratch were made by this checker");
  expects(Q.rows() == model_->dof, "Q has a row per joint of the cell's arms");
  expects(Q.allFinite() && within >= 0, "Q is finite, and distances are asked up to one >= 0");
  const int lanes = batch_lanes();
  const float up_to = std::nextafter(static_cast<float>(within), 1e9F);
  scratch.stride = Q.outerStride();
  for (Eigen::Index first = 0; first < Q.cols(); first += lanes) {
    scratch.Q = Q.data() + first * scratch.stride;
    scratch.count = static_cast<int>(std::min<Eigen::Index>(lanes, Q.cols() - first));
    find_near(pairs, up_to, scratch);
    f(first);
  }
}

void BatchChecker::shape_clearances(const Eigen::Ref<const Eigen::MatrixXd>& Q,
                                    const BatchPairs& pairs, double within, Scratch& scratch,
                                    NearShapes& out) const {
  const SsvModel& model = exact_.model();
  SsvScratch& placed = own_scratch(model, *scratch.exact_scratch);
  out.clearances.clear();
  out.keys.clear();
  out.first.assign(1, 0);
  for_each_block(Q, pairs, within, scratch, [&](Eigen::Index first) {
    for (int lane = 0; lane < scratch.count; ++lane) {
      placed.place(Q.col(first + lane));
      const std::size_t begin = out.clearances.size();
      int last_surface = -1;  // Candidates of one pair follow each other.
      for (const NearLanes& near : scratch.near) {
        if ((near.lanes >> lane & 1U) == 0) continue;
        const SsvPair& pair = model.pair(near.pair);
        if (has_surface(model, pair)) {
          if (near.pair != last_surface) {
            add_shape_clearances(placed, near.pair, within, out.clearances);
          }
          last_surface = near.pair;
          continue;
        }
        const Leaves leaves = leaves_of(near, leaves_, *model_, pair);
        const geometry::Clearance c =
            geometry::clearance(placed.piece(leaves.a, 0), placed.piece(leaves.b, 1));
        if (!(c.distance < within)) continue;
        out.clearances.push_back({near.pair, c.distance, c.nhat_BA_W, c.p_WCa, c.p_WCb});
        out.keys.resize(out.clearances.size() - 1, NearShapes::kNoKey);
        out.keys.push_back(static_cast<std::uint64_t>(near.a) << 32U |
                           static_cast<std::uint64_t>(near.b));
      }
      out.keys.resize(out.clearances.size(), NearShapes::kNoKey);
      out.gradients.resize(out.clearances.size() * index(model.dof));
      for (std::size_t i = begin; i < out.clearances.size(); ++i) {
        placed.gradient(out.clearances[i],
                        {&out.gradients[i * index(model.dof)], index(model.dof)});
      }
      out.first.push_back(out.clearances.size());
    }
  });
}

void BatchChecker::least_clearances(const Eigen::Ref<const Eigen::MatrixXd>& Q,
                                    const BatchPairs& pairs, double within, Scratch& scratch,
                                    Eigen::Ref<Eigen::VectorXd> out) const {
  expects(out.size() == Q.cols(), "one distance per column");
  const SsvModel& model = exact_.model();
  SsvScratch& placed = own_scratch(model, *scratch.exact_scratch);
  std::vector<std::pair<double, const NearLanes*>> nearest;
  for_each_block(Q, pairs, within, scratch, [&](Eigen::Index first) {
    for (int lane = 0; lane < scratch.count; ++lane) {
      nearest.clear();
      for (const NearLanes& near : scratch.near) {
        if ((near.lanes >> lane & 1U) != 0) nearest.emplace_back(lower_bound(near, lane), &near);
      }
      PairClearance best;
      best.distance = within;
      if (!nearest.empty()) placed.place(Q.col(first + lane));
      std::ranges::sort(nearest);
      for (const auto& [lower, near] : nearest) {
        const SsvPair& pair = model.pair(near->pair);
        if (has_surface(model, pair)) {  // Its depth may be below the bound of its box.
          improve(placed, near->pair, best);
          continue;
        }
        if (lower >= best.distance) continue;
        const Leaves leaves = leaves_of(*near, leaves_, *model_, pair);
        best.distance = std::min(best.distance, geometry::distance(placed.piece(leaves.a, 0),
                                                                   placed.piece(leaves.b, 1)));
      }
      out[first + lane] = best.distance;
    }
  });
}

}  // namespace tandem::collision
