#include "tandem/planning/simplifier.h"

#include <algorithm>
#include <cmath>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::planning {

using Eigen::VectorXd;
using motion::JointPath;

namespace {

/// What one edge must save to be worth its check, as a fraction of the path.
constexpr double kWorthwhile = 5e-3;
constexpr int kCornerTries = 3;

/// One path on its way.
class Simplification {
 public:
  Simplification(JointPath path, Validity& validity, std::uint64_t seed, const StopCondition& stop)
      : path_(std::move(path)), validity_(validity), rng_(seed), stop_(stop) {}

  JointPath run(const SimplifierOptions& options);

 private:
  /// A point of the path: on edge `edge`, at `at` in [0, 1).
  struct Place {
    std::size_t edge;
    double at;
  };

  void drop_waypoints();
  void drop_single_waypoints();
  void drop(std::size_t first, std::size_t last);
  void shortcut();
  void cut_corners();
  /// Cuts the corner at waypoint i.   @return whether it did.
  bool cut(std::size_t i);
  Place place(double length) const;
  VectorXd position(const Place& place) const {
    return path_[place.edge] + place.at * (path_[place.edge + 1] - path_[place.edge]);
  }
  /// Whether a part of an edge of the path is valid.
  bool is_kept(const VectorXd& a, const VectorXd& b) {
    return validity_.holds_in_part() || validity_.edge(a, b);
  }
  double length(std::size_t edge) const { return (path_[edge + 1] - path_[edge]).norm(); }

  JointPath path_;
  Validity& validity_;
  Rng rng_;
  const StopCondition& stop_;
  double total_ = 0;
};

JointPath Simplification::run(const SimplifierOptions& options) {
  drop_waypoints();
  for (int round = 0; round < options.rounds && path_.size() > 2 && !stop_(); ++round) {
    const double before = total_ = motion::joint_length(path_);
    cut_corners();
    for (int k = 0; k < options.shortcuts && path_.size() > 2 && !stop_(); ++k) shortcut();
    drop_single_waypoints();
    if (before - motion::joint_length(path_) < options.tolerance * before) break;
  }
  return std::move(path_);
}

/// Removes the waypoints between two.
void Simplification::drop(std::size_t first, std::size_t last) {
  path_.erase(path_.begin() + static_cast<std::ptrdiff_t>(first) + 1,
              path_.begin() + static_cast<std::ptrdiff_t>(last));
}

/// From each waypoint straight to the last one that can be seen, looking from the far end.
void Simplification::drop_waypoints() {
  for (std::size_t i = 0; i + 2 < path_.size(); ++i) {
    for (std::size_t k = path_.size() - 1; k > i + 1 && !stop_(); --k) {
      if (!validity_.edge(path_[i], path_[k])) continue;
      drop(i, k);
      break;
    }
  }
}

/// Leaves out one waypoint at a time: more is rare where corners were cut.
void Simplification::drop_single_waypoints() {
  for (std::size_t i = 0; i + 2 < path_.size() && !stop_();) {
    if (validity_.edge(path_[i], path_[i + 2])) {
      drop(i, i + 2);
    } else {
      ++i;
    }
  }
}

Simplification::Place Simplification::place(double at) const {
  for (std::size_t edge = 0; edge + 2 < path_.size(); ++edge) {
    const double l = length(edge);
    if (at < l) return {edge, at / l};
    at -= l;
  }
  const std::size_t last = path_.size() - 2;
  return {last, std::clamp(at / length(last), 0.0, 1.0)};
}

/// Joins two random places of the path.
void Simplification::shortcut() {
  double low = rng_.uniform(0, total_), high = rng_.uniform(0, total_);
  if (high < low) std::swap(low, high);
  const Place from = place(low), to = place(high);
  if (from.edge == to.edge) return;
  const VectorXd a = position(from), b = position(to);
  const double saved = (high - low) - (b - a).norm();
  if (saved < kWorthwhile * total_ || !validity_.edge(a, b)) return;
  // The parts of edges that are kept are new edges to a validity that samples.
  const bool keeps_from = (a - path_[from.edge]).norm() >= kSameWaypoint;
  const bool keeps_to = (path_[to.edge + 1] - b).norm() >= kSameWaypoint;
  if (!keeps_from || !keeps_to) return;
  if (!is_kept(path_[from.edge], a) || !is_kept(b, path_[to.edge + 1])) return;
  const auto first = path_.begin() + static_cast<std::ptrdiff_t>(from.edge) + 1;
  const auto last = path_.begin() + static_cast<std::ptrdiff_t>(to.edge) + 1;
  path_.insert(path_.erase(first, last), {a, b});
  total_ -= saved;
}

bool Simplification::cut(std::size_t i) {
  // About the middle of both edges: drawn, so that another seed finds another path.
  double part = rng_.uniform(0.4, 0.6);
  for (int tries = 0; tries < kCornerTries; ++tries, part *= 0.5) {
    const VectorXd a = path_[i] + part * (path_[i - 1] - path_[i]);
    const VectorXd b = path_[i] + part * (path_[i + 1] - path_[i]);
    const double saved = (a - path_[i]).norm() + (path_[i] - b).norm() - (b - a).norm();
    if (saved < kWorthwhile * total_) return false;
    if (!validity_.edge(a, b) || !is_kept(path_[i - 1], a) || !is_kept(b, path_[i + 1])) {
      continue;
    }
    path_[i] = a;
    path_.insert(path_.begin() + static_cast<std::ptrdiff_t>(i) + 1, b);
    return true;
  }
  return false;
}

void Simplification::cut_corners() {
  for (std::size_t i = 1; i + 1 < path_.size() && !stop_(); ++i) {
    if (cut(i)) ++i;
  }
}

class Simplifier final : public PathSimplifier {
 public:
  explicit Simplifier(const SimplifierOptions& options) : options_(options) {
    expects(options.rounds >= 1 && options.tolerance >= 0 && options.shortcuts >= 0,
            "at least one round; counts and tolerance are not negative");
  }

  JointPath simplify(const PathProblem&, JointPath path, Validity& validity, std::uint64_t seed,
                     const StopCondition& stop) const override {
    expects(path.size() >= 2, "a path has at least two waypoints");
    return without_duplicates(
        Simplification(without_duplicates(path), validity, seed, stop).run(options_));
  }

 private:
  SimplifierOptions options_;
};

}  // namespace

std::unique_ptr<PathSimplifier> make_simplifier(const SimplifierOptions& options) {
  return std::make_unique<Simplifier>(options);
}

}  // namespace tandem::planning
