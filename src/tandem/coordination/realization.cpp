#include "tandem/coordination/realization.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "tandem/collision/batch_certificate.h"
#include "tandem/coordination/schedule_timing.h"
#include "tandem/core/contract.h"

namespace tandem::coordination {

using Eigen::Index, Eigen::VectorXd;
using motion::ArmMotion;
using motion::CellMotion;
using motion::TimeMap;

namespace {

/// As for other executed curves: ten times finer than the floor for edges.
constexpr collision::CertificateOptions kCertificate{.smallest_deviation = 1e-6,
                                                     .clearance_ratio = 0};

/// Places and the intervals between them.
struct Polyline {
  std::vector<VectorXd> places;
  std::vector<double> intervals;
};

/// The schedule without places at which nothing changes, and without waits of all arms.
Polyline simplified(const Schedule& schedule) {
  expects(schedule.places.size() >= 2 && schedule.places.size() == schedule.times.size(),
          "a schedule has a time for each place");
  Polyline line{{schedule.places.front()}, {}};
  VectorXd direction;
  for (std::size_t k = 1; k < schedule.places.size(); ++k) {
    const VectorXd own = schedule.places[k] - schedule.places[k - 1];
    const double own_length = own.cwiseAbs().maxCoeff();
    if (!(own_length > 0)) continue;
    const bool goes_on =
        direction.size() > 0 && (own / own_length - direction).cwiseAbs().maxCoeff() < 1e-9;
    const double interval = schedule.times[k] - schedule.times[k - 1];
    if (goes_on) {
      line.places.back() = schedule.places[k];
      line.intervals.back() += interval;
      continue;
    }
    direction = own / own_length;
    line.places.push_back(schedule.places[k]);
    line.intervals.push_back(interval);
  }
  line.places.back() = schedule.places.back();
  return line;
}

/// A place where the motion must come closer to its polyline.
struct Fault {
  std::size_t edge;
  double time;  ///< Of the motion [s].
};

/// The polyline with a place on each faulty edge, where the motion at the fault projects onto it.
Polyline refined(const Polyline& line, const CellMotion& motion, const std::vector<Fault>& faults) {
  constexpr double kMargin = 0.15;  // Keeps new edges from becoming needles.
  Polyline finer{{line.places.front()}, {}};
  std::size_t next = 0;
  for (std::size_t k = 0; k < line.intervals.size(); ++k) {
    if (next < faults.size() && faults[next].edge == k) {
      const VectorXd &from = line.places[k], d = line.places[k + 1] - from;
      VectorXd local(from.size());
      for (Index i = 0; i < local.size(); ++i) {
        local[i] = (*motion.arms()[static_cast<std::size_t>(i)].map())(faults[next].time);
      }
      const double s = std::clamp((local - from).dot(d) / d.squaredNorm(), kMargin, 1 - kMargin);
      finer.places.push_back(from + s * d);
      finer.intervals.push_back(s * line.intervals[k]);
      finer.intervals.push_back((1 - s) * line.intervals[k]);
      ++next;
    } else {
      finer.intervals.push_back(line.intervals[k]);
    }
    finer.places.push_back(line.places[k + 1]);
  }
  return finer;
}

/// Places before and after every corner that an arm takes while it moves: without them a spline
/// bends all along the edges.
/// @param reach  how far from the corner [s], but at most a third of the edge.
Polyline with_corners(const Polyline& line, double reach) {
  constexpr double kPart = 1.0 / 3;
  const std::size_t last = line.intervals.size();
  const auto is_corner = [&](std::size_t k) {
    if (k == 0 || k == last) return false;
    for (Index i = 0; i < line.places[k].size(); ++i) {
      const double at = line.places[k][i];
      if (at == line.places.front()[i] || at == line.places.back()[i]) continue;
      const double before = (at - line.places[k - 1][i]) / line.intervals[k - 1];
      const double after = (line.places[k + 1][i] - at) / line.intervals[k];
      if (std::abs(after - before) > 1e-9) return true;
    }
    return false;
  };
  Polyline finer{{line.places.front()}, {}};
  for (std::size_t k = 0; k < last; ++k) {
    const VectorXd &from = line.places[k], d = line.places[k + 1] - from;
    const double h = line.intervals[k], part = std::min(kPart, reach / h);
    std::vector<double> cuts;
    if (is_corner(k)) cuts.push_back(part);
    if (is_corner(k + 1)) cuts.push_back(1 - part);
    double done = 0;
    for (const double cut : cuts) {
      finer.places.push_back(from + cut * d);
      finer.intervals.push_back((cut - done) * h);
      done = cut;
    }
    finer.places.push_back(line.places[k + 1]);
    finer.intervals.push_back((1 - done) * h);
  }
  return finer;
}

/// One attempt after the other at one schedule.
class Realizer {
 public:
  Realizer(const CoordinationProblem& problem, collision::BatchChecker::Scratch& scratch,
           const StopCondition& stop)
      : problem_(problem),
        pairs_(problem.compiled.pairs(world::PairScope::several())),
        scratch_(scratch),
        stop_(stop),
        arms_(problem.arms.begin(), problem.arms.end()),
        timing_(arms_, problem.cell().limits()) {}

  /// A line with the real times of its places.
  struct Timed {
    Polyline line;
    std::vector<TimeMap> maps;
    std::vector<double> times;
  };
  /// The motion along maps, proven, or the faults by which it is not.
  struct Attempt {
    CellMotion motion;
    std::vector<Fault> faults;     ///< At most one per edge, ascending.
    collision::Certificate proof;  ///< The first that failed, or that of the least clearance.
  };
  Attempt prove(const Timed& timed) {
    std::vector<ArmMotion> moved;
    for (std::size_t i = 0; i < arms_.size(); ++i) moved.push_back(*arms_[i].along(timed.maps[i]));
    Attempt attempt{CellMotion(std::move(moved)), {}, {}};
    const auto parts = collision::certify_parts(problem_.compiled.batch(), *pairs_, attempt.motion,
                                                timed.times, scratch_, kCertificate, stop_);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const collision::Certificate& proof = parts[k];
      evaluations_ += proof.evaluations;
      if (!proof.is_free()) {
        if (attempt.faults.empty()) attempt.proof = proof;
        attempt.faults.push_back({k, proof.time});
        if (proof.stopped) break;
      } else if (attempt.faults.empty() && proof.least_clearance <= attempt.proof.least_clearance) {
        attempt.proof = proof;
      }
    }
    return attempt;
  }

  Timed fit(const Polyline& line) { return fit(line, guess(line)); }
  Timed stop_and_go(const Polyline& line) {
    auto maps = timing_.stop_and_go(line.places);
    return {line, std::move(maps), timing_.times()};
  }

  /// With places beside the corners, where these make the motion shorter.
  Timed soonest(const Polyline& line) {
    constexpr double kReaches[] = {0.3, 0.7};  // [s] Sharper bends take longer.
    Polyline best = line;
    ScheduleTiming::Guess least = guess(line);
    for (const double reach : kReaches) {
      Polyline candidate = with_corners(line, reach);
      if (candidate.places.size() == line.places.size()) break;  // No corner.
      ScheduleTiming::Guess of_candidate = guess(candidate);
      if (of_candidate.makespan >= least.makespan) continue;
      least = std::move(of_candidate);
      best = std::move(candidate);
    }
    return fit(best, least);
  }

  long evaluations() const { return evaluations_; }

 private:
  ScheduleTiming::Guess guess(const Polyline& line) {
    return timing_.guess(line.places,
                         Eigen::Map<const VectorXd>(line.intervals.data(),
                                                    static_cast<Index>(line.intervals.size())));
  }
  Timed fit(const Polyline& line, const ScheduleTiming::Guess& guessed) {
    auto maps = timing_.fit(line.places, guessed.intervals);
    return {line, std::move(maps), timing_.times()};
  }

  const CoordinationProblem& problem_;
  const collision::BatchChecker::Pairs pairs_;
  collision::BatchChecker::Scratch& scratch_;
  const StopCondition& stop_;
  const std::vector<ArmMotion> arms_;
  ScheduleTiming timing_;
  long evaluations_ = 0;
};

std::unexpected<Error> failure(const world::Workcell& cell, const collision::Certificate& proof) {
  char text[160];
  if (proof.verdict == collision::Verdict::kCollision) {
    std::snprintf(text, sizeof text, " touch at %.4f s, %.4f m deep", proof.time, proof.depth);
  } else {
    std::snprintf(text, sizeof text, " come too close for a proof at %.4f s", proof.time);
  }
  return fail(ErrorCode::kCollision,
              "the coordinated motion: " +
                  (proof.pair < 0 ? std::string("nothing") : cell.describe_pair(proof.pair)) +
                  text);
}

}  // namespace

Result<Realization> realize(const CoordinationProblem& problem, const Schedule& schedule,
                            collision::BatchChecker::Scratch& scratch, const StopCondition& stop,
                            const RealizationOptions& options) {
  check_arms(problem);
  expects(options.repair_rounds >= 0, "rounds of repair are counted");
  Realizer realizer(problem, scratch, stop);
  const Polyline straight = simplified(schedule);
  const auto finished = [&](Realizer::Attempt& attempt, std::size_t places, bool stops) {
    return Realization{std::move(attempt.motion), attempt.proof.least_clearance,
                       static_cast<int>(places), stops, realizer.evaluations()};
  };
  if (stop()) return std::unexpected(stop.error("timing the schedule"));
  Realizer::Timed timed = realizer.soonest(straight);
  const std::size_t without_repair = timed.line.places.size();
  for (int round = 0;; ++round) {
    auto attempt = realizer.prove(timed);
    if (attempt.proof.stopped) return std::unexpected(stop.error("proving the schedule's motion"));
    if (attempt.faults.empty()) {
      return finished(attempt, timed.line.places.size() - without_repair, false);
    }
    if (round == options.repair_rounds) break;
    timed = realizer.fit(refined(timed.line, attempt.motion, attempt.faults));
  }
  auto attempt = realizer.prove(realizer.stop_and_go(straight));
  if (attempt.proof.stopped) return std::unexpected(stop.error("proving the schedule's motion"));
  if (!attempt.faults.empty()) return failure(problem.cell(), attempt.proof);
  return finished(attempt, timed.line.places.size() - without_repair, true);
}

namespace {

/// Arms that run evenly once, at most as fast as planned, and wait before and after: within their
/// limits as they are.
class PlainMotions {
 public:
  PlainMotions(const CoordinationProblem& problem, collision::BatchChecker::Scratch& scratch,
               const StopCondition& stop)
      : problem_(problem),
        pairs_(problem.compiled.pairs(world::PairScope::several())),
        scratch_(scratch),
        stop_(stop) {}

  /// @param begins, ends  of each arm's run; at least its duration apart [s].
  std::optional<Realization> prove(const VectorXd& begins, const VectorXd& ends) {
    const double all = ends.maxCoeff();
    std::vector<ArmMotion> arms;
    for (std::size_t i = 0; i < problem_.arms.size(); ++i) {
      const auto k = static_cast<Index>(i);
      const ArmMotion arm(problem_.arms[i]);
      const double own = arm.duration(), begin = begins[k], end = ends[k];
      std::vector<double> knots{0};
      std::vector<TimeMap::Segment> segments;
      if (begin > 0) {
        knots.push_back(begin);
        segments.push_back({0});
      }
      knots.push_back(end);
      segments.push_back({0, own / (end - begin)});
      if (end < all) {
        knots.push_back(all);
        segments.push_back({own});
      }
      arms.push_back(own == all ? arm : *arm.along(*TimeMap::make(knots, segments)));
    }
    CellMotion motion(std::move(arms));
    const std::vector<double> times{0, motion.duration()};
    const collision::Certificate proof = collision::certify_parts(
        problem_.compiled.batch(), *pairs_, motion, times, scratch_, kCertificate, stop_)[0];
    evaluations_ += proof.evaluations;
    if (!proof.is_free()) return std::nullopt;
    return Realization{std::move(motion), proof.least_clearance, 0, false, evaluations_};
  }

 private:
  const CoordinationProblem& problem_;
  const collision::BatchChecker::Pairs pairs_;
  collision::BatchChecker::Scratch& scratch_;
  const StopCondition& stop_;
  long evaluations_ = 0;
};

}  // namespace

std::optional<Realization> realize_at_once(const CoordinationProblem& problem,
                                           collision::BatchChecker::Scratch& scratch,
                                           const StopCondition& stop) {
  check_arms(problem);
  const VectorXd T = durations(problem), zero = VectorXd::Zero(T.size());
  PlainMotions plain(problem, scratch, stop);
  auto made = plain.prove(zero, VectorXd::Constant(T.size(), T.maxCoeff()));
  if (made || stop() || T.minCoeff() == T.maxCoeff()) return made;
  return plain.prove(zero, T);
}

std::optional<Realization> realize_in_sequence(const CoordinationProblem& problem,
                                               collision::BatchChecker::Scratch& scratch,
                                               const StopCondition& stop) {
  check_arms(problem);
  const VectorXd T = durations(problem);
  PlainMotions plain(problem, scratch, stop);
  constexpr int kMostOrders = 120;  // All of five arms.
  std::vector<Index> order(problem.arms.size());
  std::iota(order.begin(), order.end(), 0);
  for (int tries = 0; tries < kMostOrders && !stop(); ++tries) {
    VectorXd begins(T.size()), ends(T.size());
    double now = 0;
    for (const Index arm : order) {
      begins[arm] = now;
      ends[arm] = now += T[arm];
    }
    if (auto made = plain.prove(begins, ends)) return made;
    if (!std::ranges::next_permutation(order).found) break;
  }
  return std::nullopt;
}

Result<Interpolated> interpolate_unrepaired(const CoordinationProblem& problem,
                                            const Schedule& schedule, Interpolation interpolation,
                                            collision::CollisionChecker::Scratch& scratch,
                                            const StopCondition& stop) {
  check_arms(problem);
  std::vector<ArmMotion> arms;
  const std::vector<TimeMap> maps = interpolate(schedule, interpolation);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    auto moved = ArmMotion(problem.arms[i]).along(maps[i]);
    expects(moved.has_value(), "places of a schedule are within the motions' durations");
    arms.push_back(*std::move(moved));
  }
  Interpolated result{CellMotion(std::move(arms)), {}, {}, 1};
  const world::Workcell& cell = problem.cell();
  result.certificate = collision::certify(problem.exact(), result.motion, pairs_between_arms(cell),
                                          scratch, kCertificate, stop);
  if (result.certificate.stopped) {
    return std::unexpected(stop.error("proving the schedule's motion"));
  }
  const trajectory::Extremes reached = trajectory::extremes(result.motion);
  result.violations = trajectory::check_limits(reached, cell.limits());
  result.stretch = std::max(1.0, trajectory::stretch_factor(reached, cell.limits()));
  return result;
}

}  // namespace tandem::coordination
