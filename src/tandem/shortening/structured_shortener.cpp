#include <algorithm>
#include <cmath>

#include "tandem/core/contract.h"
#include "tandem/shortening/input.h"
#include "tandem/shortening/path_cost.h"
#include "tandem/shortening/probes.h"
#include "tandem/shortening/soft_qp.h"

namespace tandem::shortening {

using collision::PairClearance;
using Eigen::Index, Eigen::VectorXd;
using motion::JointPath;

namespace {

constexpr double kActivation = 0.03;  // [m] beyond the clearance: pairs a step might bring near.
constexpr double kDamping = 0.02;     // Of differences between neighbouring steps.
constexpr double kFirstTrust = 0.3;   // [rad or m] per joint and step,
constexpr double kMostTrust = 0.6;    // growing to this
constexpr double kLeastTrust = 1e-4;  // and giving up below this.
constexpr double kQpTolerance = 3e-2;
constexpr double kFirstPenalty = 2.0;  // Per clearance lacking; the objective is scaled to 1.
constexpr double kMostPenalty = 1e3;
constexpr double kEnough = 2e-2;  // Of the clearance may lack when the search ends.
constexpr int kMostIterations = 60;

/// A path with everything the merit function knows of it.
struct Candidate {
  JointPath path;
  std::vector<Waypoint> waypoints;
  std::vector<NearPairs> near;  ///< By probe.
  double objective = 0;
  double lacking = 0;    ///< Sum over pairs at probes of what the clearance lacks, in clearances.
  double worst = 0;      ///< The largest of them [m].
  double stretched = 0;  ///< Sum over edges of the excess of squared length, in allowed ones.

  double merit(double scale, double penalty) const {
    return scale * objective + penalty * (lacking + stretched);
  }
};

/// One run on one path.
class Search {
 public:
  Search(const collision::SsvChecker& checker, const world::PairSelection& selection,
         const JointPath& reference, const ShorteningOptions& options,
         collision::CollisionChecker::Scratch& scratch, const StopCondition& stop)
      : checker_(checker),
        selection_(selection),
        options_(options),
        scratch_(scratch),
        stop_(stop),
        cell_(checker.cell()),
        cost_(cell_, options.weights),
        probes_(make_probes(checker, selection, reference, options.points_per_edge,
                            options.clearance, scratch)),
        qp_(cell_.dof(), static_cast<int>(reference.size()) - 2) {
    result_.evaluations = static_cast<long>(probes_.size());
  }

  Shortening run(const JointPath& reference, const JointPath& start);

 private:
  Candidate evaluate(JointPath path);
  void allow_edges(const JointPath& reference);
  void linearise(const Candidate& at);
  void add_clearances(const Candidate& at);
  void add_edges(const Candidate& at);
  void bound_steps(const Candidate& at, double trust);
  JointPath stepped(const JointPath& path, const VectorXd& x) const;

  const collision::SsvChecker& checker_;
  const world::PairSelection& selection_;
  const ShorteningOptions& options_;
  collision::CollisionChecker::Scratch& scratch_;
  const StopCondition& stop_;
  const world::Workcell& cell_;
  PathCost cost_;
  std::vector<Probe> probes_;
  SoftQp qp_;
  double scale_ = 1;            ///< Of the objective: the paper divides by its first value.
  double allowed_squared_ = 0;  ///< Most squared length of an edge; infinity: any.
  VectorXd positions_;
  Eigen::MatrixXd gradients_;
  robot::LinkPoses X_WL_;
  Shortening result_;
};

Candidate Search::evaluate(JointPath path) {
  Candidate candidate;
  candidate.path = std::move(path);
  candidate.waypoints.resize(candidate.path.size());
  for (std::size_t i = 0; i < candidate.path.size(); ++i) {
    cost_.place(candidate.path[i], true, candidate.waypoints[i]);
    if (i == 0) continue;
    const Waypoint &from = candidate.waypoints[i - 1], &to = candidate.waypoints[i];
    candidate.objective += cost_.edge(from, to);
    if (std::isfinite(allowed_squared_)) {
      candidate.stretched += std::max(0.0, cost_.squared_length(from, to) / allowed_squared_ - 1);
    }
  }
  candidate.near.resize(probes_.size());
  for (std::size_t k = 0; k < probes_.size(); ++k) {
    const Probe& probe = probes_[k];
    checker_.shape_clearances(probe_position(candidate.path, probe), selection_,
                              probe.required + kActivation, scratch_, candidate.near[k]);
    for (const PairClearance& pair : candidate.near[k]) {
      const double lacking =
          std::max(0.0, probe.required - pair.distance - kEnough * options_.clearance);
      candidate.lacking += lacking / options_.clearance;
      candidate.worst = std::max(candidate.worst, lacking);
    }
  }
  result_.evaluations += static_cast<long>(probes_.size());
  return candidate;
}

void Search::allow_edges(const JointPath& reference) {
  allowed_squared_ = std::numeric_limits<double>::infinity();
  if (!std::isfinite(options_.longest_edge)) return;
  double length = 0;
  Waypoint from, to;
  cost_.place(reference[0], false, from);
  for (std::size_t i = 1; i < reference.size(); ++i) {
    cost_.place(reference[i], false, to);
    length += std::sqrt(cost_.squared_length(from, to));
    std::swap(from, to);
  }
  const double mean = length / static_cast<double>(reference.size() - 1);
  // A path that goes nowhere has nothing to spread.
  if (mean > 0) allowed_squared_ = std::pow(options_.longest_edge * mean, 2);
}

void Search::linearise(const Candidate& at) {
  const Index dof = cell_.dof();
  const int count = qp_.H.block_count();
  qp_.H.set_zero();
  qp_.g.setZero(dof * count);
  for (int e = 0; e + 1 < static_cast<int>(at.path.size()); ++e) {
    const auto i = static_cast<std::size_t>(e);
    cost_.add_derivatives(at.waypoints[i], at.waypoints[i + 1], scale_, e - 1, qp_.g, &qp_.H);
  }
  // Damping the steps' differences keeps them smooth along the path, however many waypoints it has.
  const double damping = scale_ * kDamping;
  for (int b = 0; b < count; ++b) {
    qp_.H.diagonal(b).diagonal().array() += 2 * damping;
    if (b + 1 < count) qp_.H.lower(b).diagonal().array() -= damping;
  }
  qp_.groups.clear();
  add_clearances(at);
  if (std::isfinite(allowed_squared_)) add_edges(at);
}

/// Every near pair keeps what is required, to first order: in units of the clearance.
void Search::add_clearances(const Candidate& at) {
  const int count = qp_.H.block_count();
  for (std::size_t k = 0; k < probes_.size(); ++k) {
    if (at.near[k].empty()) continue;
    const Probe& probe = probes_[k];
    cell_.forward_kinematics(probe_position(at.path, probe), positions_, X_WL_);
    const auto pairs = static_cast<Index>(at.near[k].size());
    gradients_.resize(cell_.dof(), pairs);
    SoftQp::Group group{probe.edge - 1, {}, {}, VectorXd(pairs)};
    for (Index i = 0; i < pairs; ++i) {
      const PairClearance& pair = at.near[k][static_cast<std::size_t>(i)];
      collision::distance_gradient(cell_, X_WL_, pair, gradients_.col(i));
      group.bounds[i] = (probe.required - pair.distance) / options_.clearance;
    }
    gradients_ /= options_.clearance;
    if (group.block >= 0) group.at_block = (1 - probe.at) * gradients_;
    if (probe.at > 0 && group.block + 1 < count) group.at_next = probe.at * gradients_;
    qp_.groups.push_back(std::move(group));
  }
}

/// No edge becomes longer than allowed, to first order.
void Search::add_edges(const Candidate& at) {
  const int count = qp_.H.block_count();
  VectorXd at_from, at_to;
  for (int e = 0; e + 1 < static_cast<int>(at.path.size()); ++e) {
    const Waypoint& from = at.waypoints[static_cast<std::size_t>(e)];
    const Waypoint& to = at.waypoints[static_cast<std::size_t>(e) + 1];
    cost_.length_gradient(from, to, at_from, at_to);
    SoftQp::Group group{e - 1, {}, {}, VectorXd(1)};
    group.bounds[0] = cost_.squared_length(from, to) / allowed_squared_ - 1;
    if (group.block >= 0) group.at_block = -at_from / allowed_squared_;
    if (group.block + 1 < count) group.at_next = -at_to / allowed_squared_;
    qp_.groups.push_back(std::move(group));
  }
}

void Search::bound_steps(const Candidate& at, double trust) {
  const Index dof = cell_.dof();
  qp_.lower.setConstant(qp_.g.size(), -trust);
  qp_.upper.setConstant(qp_.g.size(), trust);
  if (!options_.joint_limits) return;
  constexpr double kInside = 1e-6;  // [rad or m] at a limit: what the search needs to begin.
  for (Index b = 0; b < qp_.H.block_count(); ++b) {
    const VectorXd& q = at.path[static_cast<std::size_t>(b) + 1];
    qp_.lower.segment(b * dof, dof) =
        qp_.lower.segment(b * dof, dof).cwiseMax(cell_.lower() - q).cwiseMin(-kInside);
    qp_.upper.segment(b * dof, dof) =
        qp_.upper.segment(b * dof, dof).cwiseMin(cell_.upper() - q).cwiseMax(kInside);
  }
}

JointPath Search::stepped(const JointPath& path, const VectorXd& x) const {
  JointPath next = path;
  const Index dof = cell_.dof();
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    next[i] += x.segment(static_cast<Index>(i - 1) * dof, dof);
    // The few micrometres that the bounds allow at a limit; what came in outside of it may stay.
    if (options_.joint_limits) {
      next[i] = next[i]
                    .cwiseMax(cell_.lower().cwiseMin(path[i]))
                    .cwiseMin(cell_.upper().cwiseMax(path[i]));
    }
  }
  return next;
}

Shortening Search::run(const JointPath& reference, const JointPath& start) {
  allow_edges(reference);
  Candidate best = evaluate(reference);
  result_.before = best.objective;
  if (best.objective > 0) scale_ = 1 / best.objective;
  if (&start != &reference) best = evaluate(start);
  double penalty = kFirstPenalty, trust = kFirstTrust;
  bool fresh = true;
  while (result_.iterations < kMostIterations && trust >= kLeastTrust) {
    if (stop_()) {
      result_.stopped = true;
      break;
    }
    ++result_.iterations;
    if (fresh) linearise(best);
    bound_steps(best, trust);
    qp_.penalty = penalty;
    const QpSolution step = solve(qp_, kQpTolerance);
    const double foreseen =
        qp_.value(VectorXd::Zero(step.x.size()), kEnough) - qp_.value(step.x, kEnough);
    const double now = best.merit(scale_, penalty);
    // Neither the model sees a way down, or it is not worth a step.
    const bool small = foreseen < 0.5 * options_.tolerance * now;
    Candidate next = small ? Candidate{} : evaluate(stepped(best.path, step.x));
    const double fall = small ? 0 : now - next.merit(scale_, penalty);
    fresh = fall > 0.05 * foreseen && !small;
    if (fresh) best = std::move(next);
    if (small || (fall >= 0 && fall < options_.tolerance * now)) {
      const bool clear = best.worst == 0 && best.stretched <= kEnough;
      if (clear || penalty >= kMostPenalty) break;
      penalty *= 8;
      trust = std::max(trust, 0.1 * kFirstTrust);
      continue;
    }
    if (fall < 0.25 * foreseen) trust *= fresh ? 0.5 : 0.3;
    if (fall > 0.75 * foreseen) trust = std::min(2 * trust, kMostTrust);
  }
  result_.path = std::move(best.path);
  result_.after = best.objective;
  result_.violation = best.worst;
  return std::move(result_);
}

class StructuredShortener final : public Shortener {
 public:
  Shortening shorten(const collision::SsvChecker& checker, const world::PairSelection& selection,
                     const JointPath& path, const ShorteningOptions& options,
                     collision::CollisionChecker::Scratch& scratch, const StopCondition& stop,
                     const JointPath* start) const override {
    check_input(checker.cell(), path, options, start);
    if (path.size() == 2) return unchanged(checker.cell(), path, options);
    return Search(checker, selection, path, options, scratch, stop)
        .run(path, start ? *start : path);
  }
};

}  // namespace

std::unique_ptr<Shortener> make_structured_shortener() {
  return std::make_unique<StructuredShortener>();
}

}  // namespace tandem::shortening
