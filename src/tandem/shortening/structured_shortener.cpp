#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "tandem/core/contract.h"
#include "tandem/shortening/coarse_path.h"
#include "tandem/shortening/input.h"
#include "tandem/shortening/path_cost.h"
#include "tandem/shortening/probes.h"
#include "tandem/shortening/proven_edges.h"
#include "tandem/shortening/soft_qp.h"

namespace tandem::shortening {

using Eigen::Index, Eigen::VectorXd;
using motion::JointPath;

namespace {

constexpr double kActivation = 0.004;  // [m] beyond the clearance: pairs a step might bring near.
constexpr double kDamping = 0.02;      // Of differences between neighbouring steps.
constexpr double kLongestStep = 0.6;   // [rad or m] per joint.
// What makes steps shorter: added to the Hessian's diagonal, against its mean over the square of
// the edges. So is the Hessian's stiffness to steps that bend the path as a whole.
constexpr double kFirstBrake = 18;  // Once a step was too long,
constexpr double kMostBrake = 4e5;  // and giving up beyond this.
constexpr double kQpTolerance = 6e-2;
constexpr double kFirstPenalty = 2.0;  // Per clearance lacking; the objective is scaled to 1.
constexpr double kMostPenalty = 1e3;
constexpr double kEnough = 2e-2;  // Of the clearance may lack when the search ends.
constexpr int kMostIterations = 60;
// Edges of the path that is shortened first, where there are far more,
constexpr int kCoarseEdges = 19;
// and what may be lacking then, in clearances: more might have jumped through something.
constexpr double kShallow = 0.5;
constexpr int kMostPoints = 15;  // Inside an edge that cannot be proven.

/// A path with everything the merit function knows of it.
struct Candidate {
  JointPath path;
  std::vector<Waypoint> waypoints;
  collision::NearShapes near;  ///< By probe.
  double objective = 0;
  double lacking = 0;    ///< Sum over pairs at probes of what the clearance lacks, in clearances.
  double worst = 0;      ///< The largest of them [m].
  double stretched = 0;  ///< Sum over edges of the excess of squared length, in allowed ones.

  double merit(double scale, double penalty) const {
    return scale * objective + penalty * (lacking + stretched);
  }
};

/// One run on one path, whose edges may stand for several.
class Search {
 public:
  Search(const collision::BatchChecker& checker, const collision::BatchPairs& pairs,
         const CoarsePath& reference, std::vector<int> points_per_edge,
         const ShorteningOptions& options, collision::BatchChecker::Scratch& scratch,
         const StopCondition& stop)
      : checker_(checker),
        pairs_(pairs),
        reference_(reference.waypoints),
        parts_(reference.parts),
        options_(options),
        scratch_(scratch),
        stop_(stop),
        cell_(checker.cell()),
        cost_(cell_, options.weights),
        points_(std::move(points_per_edge)),
        qp_(cell_.dof(), static_cast<int>(parts_.size()) - 1),
        safe_(&reference_) {
    look();
  }

  /// @param start  where to begin instead of at the reference, unless it lacks too much; or null.
  /// Shorter than the reference; with `prove_edges` its edges are proven if the reference's are.
  Shortening run(const JointPath* start);

 private:
  void look();
  void measure_path(Candidate& at);
  void measure_distances(Candidate& at);
  void evaluate(Candidate& at);
  void allow_edges();
  Candidate begin(const JointPath* start);
  void linearise(const Candidate& at);
  void add_clearances(const Candidate& at);
  void add_edges(const Candidate& at);
  void remember(const Candidate& at, const Eigen::ArrayXd& multipliers);
  void bound_steps(const Candidate& at);
  void brake(double by);
  void step(const JointPath& path, const VectorXd& x, JointPath& next) const;
  bool prove(Candidate& at);
  Shortening finish(Candidate& best);

  const collision::BatchChecker& checker_;
  const collision::BatchPairs& pairs_;
  const JointPath& reference_;
  const std::vector<int>& parts_;
  const ShorteningOptions& options_;
  collision::BatchChecker::Scratch& scratch_;
  const StopCondition& stop_;
  const world::Workcell& cell_;
  PathCost cost_;
  std::vector<int> points_;  ///< Inside each edge.
  std::vector<Probe> probes_;
  SoftQp qp_;
  Eigen::ArrayXd multipliers_;  ///< To begin with.
  double mean_diagonal_ = 0, braked_ = 0;
  double scale_ = 1;            ///< Of the objective: the paper divides by its first value.
  double allowed_squared_ = 0;  ///< Most squared length of an edge; infinity: any.
  Eigen::MatrixXd Q_;
  std::optional<Candidate> proven_;  ///< The best one with proven edges,
  const JointPath* safe_;            ///< and what is there before.
  Shortening result_;
};

/// Chooses the probes anew, and what they must keep. What pushed at the old ones is remembered.
void Search::look() {
  std::vector<Probe> probes = make_probes(reference_, points_);
  require(checker_, pairs_, reference_, options_.clearance, scratch_, probes);
  auto old = probes_.begin();
  for (Probe& probe : probes) {
    const auto before = [](const Probe& a, const Probe& b) {
      return std::pair(a.edge, a.at) < std::pair(b.edge, b.at);
    };
    while (old != probes_.end() && before(*old, probe)) ++old;
    if (old != probes_.end() && !before(probe, *old)) probe.pushing = std::move(old->pushing);
  }
  probes_ = std::move(probes);
  result_.evaluations += static_cast<long>(probes_.size());
}

void Search::measure_path(Candidate& at) {
  at.objective = at.stretched = 0;
  at.waypoints.resize(at.path.size());
  for (std::size_t i = 0; i < at.path.size(); ++i) {
    cost_.place(at.path[i], true, at.waypoints[i]);
    if (i == 0) continue;
    const Waypoint &from = at.waypoints[i - 1], &to = at.waypoints[i];
    const int parts = parts_[i - 1];
    at.objective += cost_.edge(from, to) / parts;
    if (std::isfinite(allowed_squared_)) {
      const double squared = cost_.squared_length(from, to) / (parts * parts);
      at.stretched += std::max(0.0, squared / allowed_squared_ - 1);
    }
  }
}

void Search::measure_distances(Candidate& at) {
  at.lacking = at.worst = 0;
  place_probes(at.path, probes_, Q_);
  checker_.shape_clearances(Q_, pairs_, options_.clearance + kActivation, scratch_, at.near);
  for (std::size_t k = 0; k < probes_.size(); ++k) {
    const double enough = probes_[k].required - kEnough * options_.clearance;
    for (std::size_t i = at.near.first[k]; i < at.near.first[k + 1]; ++i) {
      const double lacking = std::max(0.0, enough - at.near.clearances[i].distance);
      at.lacking += lacking / options_.clearance;
      at.worst = std::max(at.worst, lacking);
    }
  }
  result_.evaluations += static_cast<long>(probes_.size());
}

void Search::evaluate(Candidate& at) {
  measure_path(at);
  measure_distances(at);
}

void Search::allow_edges() {
  allowed_squared_ = std::numeric_limits<double>::infinity();
  if (!std::isfinite(options_.longest_edge)) return;
  double length = 0;
  Waypoint from, to;
  cost_.place(reference_[0], false, from);
  for (std::size_t i = 1; i < reference_.size(); ++i) {
    cost_.place(reference_[i], false, to);
    length += std::sqrt(cost_.squared_length(from, to));
    std::swap(from, to);
  }
  const double mean = length / std::accumulate(parts_.begin(), parts_.end(), 0.0);
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
    const double scale = scale_ / parts_[i];
    cost_.add_derivatives(at.waypoints[i], at.waypoints[i + 1], scale, e - 1, qp_.g, &qp_.H);
    // Damping the steps' differences keeps them smooth along the path.
    const double damping = scale * kDamping;
    if (e > 0) qp_.H.diagonal(e - 1).diagonal().array() += damping;
    if (e < count) qp_.H.diagonal(e).diagonal().array() += damping;
    if (e > 0 && e < count) qp_.H.lower(e - 1).diagonal().array() -= damping;
  }
  mean_diagonal_ = braked_ = 0;
  for (int b = 0; b < count; ++b) mean_diagonal_ += qp_.H.diagonal(b).diagonal().mean() / count;
  bound_steps(at);
  qp_.groups.clear();
  add_clearances(at);
  if (std::isfinite(allowed_squared_)) add_edges(at);
}

/// Every near pair keeps what is required, to first order: in units of the clearance.
void Search::add_clearances(const Candidate& at) {
  const Index dof = cell_.dof();
  multipliers_.setZero(static_cast<Index>(at.near.clearances.size()));
  for (std::size_t k = 0; k < probes_.size(); ++k) {
    const std::size_t first = at.near.first[k], end = at.near.first[k + 1];
    if (first == end) continue;
    const Probe& probe = probes_[k];
    const auto count = static_cast<Index>(end - first);
    SoftQp::Group group{
        probe.edge - 1, (1 - probe.at) / options_.clearance, probe.at / options_.clearance,
        Eigen::Map<const Eigen::MatrixXd>(
            at.near.gradients.data() + first * static_cast<std::size_t>(dof), dof, count),
        VectorXd(count)};
    for (std::size_t i = first; i < end; ++i) {
      group.bounds[static_cast<Index>(i - first)] =
          (probe.required - at.near.clearances[i].distance) / options_.clearance;
      const auto pushed = std::ranges::find(probe.pushing, at.near.keys[i],
                                            &std::pair<std::uint64_t, double>::first);
      if (pushed != probe.pushing.end()) multipliers_[static_cast<Index>(i)] = pushed->second;
    }
    qp_.groups.push_back(std::move(group));
  }
}

/// No edge becomes longer than allowed, to first order.
void Search::add_edges(const Candidate& at) {
  VectorXd at_from, at_to;
  for (int e = 0; e + 1 < static_cast<int>(at.path.size()); ++e) {
    const Waypoint& from = at.waypoints[static_cast<std::size_t>(e)];
    const Waypoint& to = at.waypoints[static_cast<std::size_t>(e) + 1];
    const int parts = parts_[static_cast<std::size_t>(e)];
    const double scale = 1 / (allowed_squared_ * parts * parts);
    cost_.length_gradient(from, to, at_from, at_to);
    SoftQp::Group group{e - 1, -scale, -scale, at_from, VectorXd(1), at_to};
    group.bounds[0] = scale * cost_.squared_length(from, to) - 1;
    qp_.groups.push_back(std::move(group));
  }
  const Index known = multipliers_.size();
  multipliers_.conservativeResize(qp_.constraint_count());
  multipliers_.tail(multipliers_.size() - known).setZero();
}

/// Keeps what pushed, for the next program.
void Search::remember(const Candidate& at, const Eigen::ArrayXd& multipliers) {
  for (std::size_t k = 0; k < probes_.size(); ++k) {
    probes_[k].pushing.clear();
    for (std::size_t i = at.near.first[k]; i < at.near.first[k + 1]; ++i) {
      const double multiplier = multipliers[static_cast<Index>(i)];
      if (multiplier > 0) probes_[k].pushing.emplace_back(at.near.keys[i], multiplier);
    }
  }
}
/// Sets what is added to the diagonal, relative to its mean over the square of the edges.
void Search::brake(double by) {
  const double edges = qp_.H.block_count() + 1;
  const double added = by * mean_diagonal_ / (edges * edges) - braked_;
  for (int b = 0; b < qp_.H.block_count(); ++b) qp_.H.diagonal(b).diagonal().array() += added;
  braked_ += added;
}

void Search::bound_steps(const Candidate& at) {
  const Index dof = cell_.dof();
  qp_.lower.setConstant(qp_.g.size(), -kLongestStep);
  qp_.upper.setConstant(qp_.g.size(), kLongestStep);
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

void Search::step(const JointPath& path, const VectorXd& x, JointPath& next) const {
  next = path;
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
}

/// Keeps a path whose edges are proven; of one whose edges are not, looks closer at these.
/// @return whether there is more to look at.
bool Search::prove(Candidate& at) {
  const std::vector<int> open = unproven_edges(checker_, pairs_, at.path, scratch_, stop_);
  if (open.empty()) {
    if (!proven_ || at.objective < proven_->objective) proven_ = at;
    return false;
  }
  bool closer = false;
  for (const int edge : open) {
    int& inside = points_[static_cast<std::size_t>(edge)];
    if (2 * inside + 1 > kMostPoints) continue;
    inside = 2 * inside + 1;
    closer = true;
  }
  if (!closer) return false;
  look();
  measure_distances(at);
  return true;
}

Shortening Search::finish(Candidate& best) {
  const JointPath& safe = proven_ ? proven_->path : *safe_;
  if (options_.prove_edges && best.path != safe) {
    Candidate back;
    back.path = best.path;
    const int moved = draw_back(checker_, pairs_, safe, back.path, scratch_, stop_);
    evaluate(back);
    if (!proven_ || back.objective < proven_->objective) {
      result_.drawn_back = moved;
      best = std::move(back);
    } else {
      best = std::move(*proven_);
    }
  }
  result_.path = std::move(best.path);
  result_.after = best.objective;
  result_.violation = best.worst;
  return std::move(result_);
}

/// What the search begins with.
Candidate Search::begin(const JointPath* start) {
  allow_edges();
  Candidate best, other;
  best.path = reference_;
  evaluate(best);
  result_.before = best.objective;
  if (best.objective > 0) scale_ = 1 / best.objective;
  if (!start) return best;
  other.path = *start;
  evaluate(other);
  if (!(other.worst < kShallow * options_.clearance)) return best;
  safe_ = start;
  return other;
}

Shortening Search::run(const JointPath* start) {
  Candidate best = begin(start), next;
  double penalty = kFirstPenalty, slow = 0;
  bool fresh = true;
  while (result_.iterations < kMostIterations && slow <= kMostBrake) {
    if (stop_()) {
      result_.stopped = true;
      break;
    }
    ++result_.iterations;
    if (fresh) linearise(best);
    brake(slow);
    qp_.penalty = penalty;
    const QpSolution solution = solve(qp_, kQpTolerance, multipliers_, stop_);
    if (stop_()) continue;  // What it found so far is worth no proof.
    const double foreseen =
        qp_.value(VectorXd::Zero(solution.x.size()), kEnough) - qp_.value(solution.x, kEnough);
    const double now = best.merit(scale_, penalty);
    // Neither the model sees a way down, or it is not worth a step.
    const bool small = foreseen < 0.5 * options_.tolerance * now;
    double fall = 0;
    if (!small) {
      step(best.path, solution.x, next.path);
      evaluate(next);
      fall = now - next.merit(scale_, penalty);
    }
    fresh = fall > 0.05 * foreseen && !small;
    if (fresh) {
      remember(best, solution.multipliers);
      std::swap(best, next);
    }
    const bool at_rest = small || (fall >= 0 && fall < options_.tolerance * now);
    if (options_.prove_edges && (fresh || at_rest) && prove(best)) {
      fresh = true;
      slow = std::min(slow, kFirstBrake);
      continue;
    }
    if (at_rest) {
      const bool clear = best.worst == 0 && best.stretched <= kEnough;
      if (clear || penalty >= kMostPenalty) break;
      penalty *= 8;
      slow = std::min(slow, kFirstBrake);
      continue;
    }
    if (fall < 0.25 * foreseen) slow = std::max(kFirstBrake, (fresh ? 2 : 6) * slow);
    if (fall > 0.75 * foreseen) slow = slow > kFirstBrake ? slow / 4 : 0;
  }
  return finish(best);
}

/// Shortens a path with all its waypoints, with few, or first with few and then with all.
class Run {
 public:
  Run(const collision::CompiledCell& compiled, const world::PairScope& scope, const JointPath& path,
      const ShorteningOptions& options, const StopCondition& stop)
      : checker_(compiled.batch()),
        pairs_(pairs_within(compiled, scope, options.clearance)),
        path_(path),
        options_(options),
        stop_(stop),
        scratch_(checker_.make_scratch()) {}

  Shortening with_all(const JointPath* start) const {
    const CoarsePath all = CoarsePath::of(path_);
    return search(all, options_.points_per_edge.empty() ? all.parts : options_.points_per_edge,
                  start);
  }

  /// Every waypoint is looked at all the same.
  Shortening with(CoarsePath few) const {
    std::vector<int> between = few.parts;
    for (int& points : between) points = std::max(1, points - 1);
    Shortening result = search(few, std::move(between), nullptr);
    few.waypoints = std::move(result.path);
    result.path = few.divided();
    PathCost cost(checker_.cell(), options_.weights);
    result.before = cost.path(path_);
    result.after = cost.path(result.path);
    if (result.after < result.before) return result;
    Shortening again = with_all(nullptr);  // All of it was drawn back, or there was no time.
    again.evaluations += result.evaluations;
    return again;
  }

  /// Bends that are as long as the path are found with few waypoints, the rest is near.
  Shortening with_all_after(CoarsePath few) const {
    Shortening rough = search(few, std::vector<int>(few.parts.size(), 1), nullptr);
    few.waypoints = std::move(rough.path);
    const JointPath start = few.divided();
    Shortening result = with_all(rough.after < rough.before ? &start : nullptr);
    result.evaluations += rough.evaluations;
    return result;
  }

 private:
  Shortening search(const CoarsePath& reference, std::vector<int> points_per_edge,
                    const JointPath* start) const {
    return Search(checker_, *pairs_, reference, std::move(points_per_edge), options_, *scratch_,
                  stop_)
        .run(start);
  }

  const collision::BatchChecker& checker_;
  const collision::BatchChecker::Pairs pairs_;
  const JointPath& path_;
  const ShorteningOptions& options_;
  const StopCondition& stop_;
  const collision::BatchChecker::ScratchPtr scratch_;
};

class StructuredShortener final : public Shortener {
 public:
  Shortening shorten(const collision::CompiledCell& compiled, const world::PairScope& scope,
                     const JointPath& path, const ShorteningOptions& options,
                     const StopCondition& stop) const override {
    check_input(compiled.cell(), path, options);
    if (path.size() == 2) return unchanged(compiled.cell(), path, options);
    const Run run(compiled, scope, path, options, stop);
    CoarsePath few = coarsened(path, options.edges > 0 ? options.edges : kCoarseEdges);
    if (options.edges > 0) return run.with(std::move(few));
    return 2 * few.parts.size() < path.size() ? run.with_all_after(std::move(few))
                                              : run.with_all(nullptr);
  }
};

}  // namespace

std::unique_ptr<Shortener> make_structured_shortener() {
  return std::make_unique<StructuredShortener>();
}

}  // namespace tandem::shortening
