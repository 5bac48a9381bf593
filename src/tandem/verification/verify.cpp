#include "tandem/verification/verify.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "tandem/collision/fcl/fcl_checker.h"

namespace tandem::verification {

namespace {

using motion::ArmMotion;
using motion::CellMotion;
using motion::PiecewiseCubic;

/// q, qd, qdd and qddd of one joint.
using Derivatives = Eigen::Vector4d;

/// A stretch of time in which an arm stays on one segment of its spline and of c(t).
struct Span {
  double begin, end;
  std::size_t c;  ///< Segment of c(t), if there is one.
  int q;          ///< Segment of the spline; -1 before its start, their count after its end.
};

/// c(t) and its derivatives on one of its segments; real time itself if the arm has no map.
Derivatives local_time(const ArmMotion& arm, std::size_t segment, double t) {
  if (!arm.map()) return {t, 1, 0, 0};
  const double s = t - arm.map()->knots()[segment];
  const auto& c = arm.map()->segments()[segment];
  Derivatives taylor = Derivatives::Zero();  // Horner's scheme, one row per derivative.
  for (std::size_t i = c.size(); i-- > 0;) {
    for (Eigen::Index n = 3; n > 0; --n) taylor[n] = taylor[n] * s + taylor[n - 1];
    taylor[0] = taylor[0] * s + c[i];
  }
  return {taylor[0], taylor[1], 2 * taylor[2], 6 * taylor[3]};
}

int segment_of(const PiecewiseCubic& spline, double local) {
  const std::vector<double>& knots = spline.knots();
  const auto count = static_cast<int>(spline.segments().size());
  if (local < 0) return -1;
  if (local > knots.back()) return count;
  int k = 0;
  while (k + 1 < count && local >= knots[static_cast<std::size_t>(k) + 1]) ++k;
  return k;
}

/// Joint j at `t`, by the chain rule.
Derivatives derivatives(const ArmMotion& arm, const Span& span, Eigen::Index j, double t) {
  const PiecewiseCubic& spline = arm.spline();
  const auto count = static_cast<int>(spline.segments().size());
  const Derivatives c = local_time(arm, span.c, t);
  const bool waits = span.q < 0 || span.q == count;
  const auto k = static_cast<std::size_t>(std::clamp(span.q, 0, count - 1));
  const double s =
      (waits ? std::clamp(c[0], 0.0, spline.knots().back()) : c[0]) - spline.knots()[k];
  const Eigen::RowVector4d a = spline.segments()[k].row(j);
  const double q = ((a[3] * s + a[2]) * s + a[1]) * s + a[0];
  if (waits) return {q, 0, 0, 0};
  const double q1 = (3 * a[3] * s + 2 * a[2]) * s + a[1], q2 = 6 * a[3] * s + 2 * a[2];
  return {q, q1 * c[1], q2 * c[1] * c[1] + q1 * c[2],
          6 * a[3] * c[1] * c[1] * c[1] + 3 * q2 * c[1] * c[2] + q1 * c[3]};
}

/// Where the spline's segment changes between two times of one segment of c(t): found to 1e-12 of
/// a second by halving, and unseen only if it changes back in between.
void split(const ArmMotion& arm, const Span& whole, int q_end, std::vector<Span>& spans) {
  constexpr double kResolution = 1e-12;
  Span& open = spans.back();
  if (whole.q == q_end) {
    open.end = whole.end;
    return;
  }
  const double middle = 0.5 * (whole.begin + whole.end);
  if (whole.end - whole.begin < kResolution || !(whole.begin < middle && middle < whole.end)) {
    open.end = whole.end;
    spans.push_back({whole.end, whole.end, whole.c, q_end});
    return;
  }
  const int q_middle = segment_of(arm.spline(), local_time(arm, whole.c, middle)[0]);
  split(arm, {whole.begin, middle, whole.c, whole.q}, q_middle, spans);
  split(arm, {middle, whole.end, whole.c, q_middle}, q_end, spans);
}

std::vector<Span> spans_of(const ArmMotion& arm, double rate) {
  std::vector<Span> spans;
  if (!arm.map()) {
    const std::vector<double>& knots = arm.spline().knots();
    for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
      spans.push_back({knots[k], knots[k + 1], 0, static_cast<int>(k)});
    }
    return spans;
  }
  const std::vector<double>& knots = arm.map()->knots();
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    const auto q_at = [&](double t) { return segment_of(arm.spline(), local_time(arm, k, t)[0]); };
    // What c does just after its knot decides, even where it starts on a knot of the spline.
    double last = knots[k];
    const double inside = last + std::min(1e-9, 1e-3 * (knots[k + 1] - last));
    int q_last = q_at(inside);
    spans.push_back({last, last, k, q_last});
    const auto advance = [&](double t, int q) {
      split(arm, {last, t, k, q_last}, q, spans);
      last = t;
      q_last = q;
    };
    for (double i = std::floor(last * rate) + 1; i / rate < knots[k + 1]; ++i) {
      if (i / rate > inside) advance(i / rate, q_at(i / rate));
    }
    const double before = knots[k + 1] - (inside - knots[k]);
    if (before > last) advance(before, q_at(before));
    spans.back().end = knots[k + 1];
  }
  return spans;
}

/// Where the arm is told to be at `t`; at its end it waits.
void place(const ArmMotion& arm, double t, Eigen::Ref<Eigen::VectorXd> q) {
  const std::vector<double>& knots = arm.map() ? arm.map()->knots() : arm.spline().knots();
  const double within = std::clamp(t, 0.0, knots.back());
  std::size_t k = 0;
  while (k + 2 < knots.size() && within >= knots[k + 1]) ++k;
  const Span here{within, within, k, segment_of(arm.spline(), local_time(arm, k, within)[0])};
  for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = derivatives(arm, here, j, within)[0];
}

template <class... Parts>
std::string sentence(const Parts&... parts) {
  std::ostringstream out;
  out.precision(7);
  (out << ... << parts);
  return out.str();
}

/// A joint of the cell, as the checks of one arm's curve see it.
struct JointView {
  const std::string& name;
  const robot::JointLimits& limits;
  const char* unit;
};

JointView view(const world::Workcell& cell, const world::Arm& arm, Eigen::Index j) {
  const auto entry = static_cast<std::size_t>(arm.offset + j);
  const int joint = arm.joints[static_cast<std::size_t>(j)];
  const auto type = cell.model().joints()[static_cast<std::size_t>(joint)].type;
  return {cell.joint_names()[entry], cell.limits()[entry],
          type == robot::JointType::kPrismatic ? " m" : " rad"};
}

constexpr const char* kQuantity[] = {"position", "velocity", "acceleration", "jerk"};
constexpr const char* kPerTime[] = {"", "/s", "/s^2", "/s^3"};

/// The worst excess of one quantity over what is allowed so far.
struct Excess {
  double over = 0, value = 0, limit = 0, time = 0;
  bool found = false;

  /// Written so that NaN is an excess.
  void add(const Excess& candidate, double tolerance) {
    if (candidate.over <= tolerance || (found && candidate.over <= over)) return;
    *this = candidate;
    found = true;
  }
};

/// Position, velocity, acceleration and jerk of joint j of one arm, at samples and knots.
void check_limits(const ArmMotion& arm, const std::vector<Span>& spans, Eigen::Index j,
                  const JointView& joint, const VerifyOptions& options, VerifyReport& report) {
  const robot::JointLimits& limits = joint.limits;
  const double bounds[] = {0, limits.velocity, limits.acceleration, limits.jerk};
  Excess above, below, excess[4];
  const auto check = [&](const Span& span, double t) {
    const Derivatives d = derivatives(arm, span, j, t);
    above.add({d[0] - limits.upper, d[0], limits.upper, t}, options.limit_tolerance);
    below.add({limits.lower - d[0], d[0], limits.lower, t}, options.limit_tolerance);
    for (int i = 1; i < 4; ++i) {
      if (std::isinf(bounds[i])) continue;
      report.worst_limit_ratio = std::max(report.worst_limit_ratio, std::abs(d[i]) / bounds[i]);
      excess[i].add({std::abs(d[i]) - bounds[i], d[i], bounds[i], t},
                    options.limit_tolerance * bounds[i]);
    }
  };
  for (const Span& span : spans) {
    check(span, span.begin);
    for (double i = std::floor(span.begin * options.rate) + 1; i / options.rate < span.end; ++i) {
      check(span, i / options.rate);
    }
    check(span, span.end);
  }
  for (const Excess* position : {&above, &below}) {
    if (!position->found) continue;
    report.failures.push_back(sentence("position of ", joint.name, " reaches ", position->value,
                                       joint.unit, " at ", position->time, " s, its limit is ",
                                       position->limit));
  }
  for (int i = 1; i < 4; ++i) {
    if (!excess[i].found) continue;
    report.failures.push_back(sentence(kQuantity[i], " of ", joint.name, " reaches ",
                                       excess[i].value, joint.unit, kPerTime[i], " at ",
                                       excess[i].time, " s, its limit is ", excess[i].limit));
  }
}

/// Position, velocity and acceleration of joint j on both sides of every inner knot.
void check_jumps(const ArmMotion& arm, const std::vector<Span>& spans, Eigen::Index j,
                 const JointView& joint, const VerifyOptions& options, VerifyReport& report) {
  Excess jumps[3];
  for (std::size_t k = 1; k < spans.size(); ++k) {
    const double t = spans[k].begin;
    const Derivatives jump =
        derivatives(arm, spans[k], j, t) - derivatives(arm, spans[k - 1], j, t);
    for (int i = 0; i < 3; ++i) {
      report.largest_jumps[i] = std::max(report.largest_jumps[i], std::abs(jump[i]));
      jumps[i].add({std::abs(jump[i]), jump[i], 0, t}, options.jump_tolerance);
    }
  }
  for (int i = 0; i < 3; ++i) {
    if (!jumps[i].found) continue;
    report.failures.push_back(sentence(
        kQuantity[i], " of ", joint.name, " jumps by ", jumps[i].value, joint.unit, kPerTime[i],
        " at ", jumps[i].time, " s, at most ", options.jump_tolerance, " is allowed"));
  }
}

/// What joint j does at one end of its arm's curve, against `wanted` and rest.
void check_end(const ArmMotion& arm, const std::vector<Span>& spans, Eigen::Index j,
               const JointView& joint, bool at_end, double wanted, const VerifyOptions& options,
               VerifyReport& report) {
  const Span& span = at_end ? spans.back() : spans.front();
  const double t = at_end ? span.end : span.begin;
  const Derivatives d = derivatives(arm, span, j, t);
  if (!(std::abs(d[0] - wanted) <= options.jump_tolerance)) {
    report.failures.push_back(sentence(joint.name, at_end ? " ends at " : " starts at ", d[0],
                                       joint.unit, " at ", t, " s, it should at ", wanted));
  }
  for (int i = 1; i < 3; ++i) {
    if (std::abs(d[i]) <= options.jump_tolerance) continue;
    report.failures.push_back(sentence(kQuantity[i], " of ", joint.name, " is ", d[i], joint.unit,
                                       kPerTime[i], " at the ", at_end ? "end" : "start", " (", t,
                                       " s), it should be 0"));
  }
}

void check_curves(const world::Workcell& cell, const CellMotion& motion,
                  const Eigen::VectorXd& start, const Eigen::VectorXd& goal,
                  const VerifyOptions& options, VerifyReport& report) {
  for (std::size_t i = 0; i < cell.arms().size(); ++i) {
    const world::Arm& arm = cell.arms()[i];
    const ArmMotion& curve = motion.arms()[i];
    const std::vector<Span> spans = spans_of(curve, options.rate);
    for (Eigen::Index j = 0; j < arm.dof(); ++j) {
      const JointView joint = view(cell, arm, j);
      check_end(curve, spans, j, joint, false, start[arm.offset + j], options, report);
      check_end(curve, spans, j, joint, true, goal[arm.offset + j], options, report);
      check_limits(curve, spans, j, joint, options, report);
      check_jumps(curve, spans, j, joint, options, report);
    }
  }
}

/// When a pair touches, and where it does so most.
struct Contact {
  double first = 0, last = 0, deepest = 0, deepest_time = 0;
  long samples = 0;
};

/// Walks the samples with FCL.
class CollisionWalk {
 public:
  CollisionWalk(const world::Workcell& cell, const collision::FclChecker& checker)
      : cell_(cell),
        checker_(checker),
        selection_(cell.select(world::PairScope::all())),
        scratch_(checker.make_scratch()) {}

  void visit(double t, const Eigen::VectorXd& q) {
    // A pair farther than the nearest so far changes nothing, unless it touches.
    constexpr double kTouching = 1e-9;  // [m]
    checker_.clearances(q, selection_, std::max(least_, kTouching), *scratch_, found_);
    for (const collision::PairClearance& c : found_) {
      if (c.distance < least_) {
        least_ = c.distance;
        nearest_pair_ = c.pair;
        nearest_time_ = t;
      }
      if (!(c.distance > 0)) touch(t, c);
    }
  }

  void report(VerifyReport& report) const {
    report.least_clearance = least_;
    report.nearest_time = nearest_time_;
    if (nearest_pair_ >= 0) report.nearest_pair = cell_.describe_pair(nearest_pair_);
    for (const auto& [pair, contact] : contacts_) {
      report.failures.push_back(
          sentence(cell_.describe_pair(pair), " touch from ", contact.first, " s to ", contact.last,
                   " s (", contact.samples, " samples), deepest at ", contact.deepest_time,
                   " s: clearance ", -contact.deepest, " m, it must be above 0"));
    }
  }

 private:
  void touch(double t, const collision::PairClearance& c) {
    Contact& contact = contacts_[c.pair];
    if (contact.samples++ == 0) contact.first = contact.deepest_time = t;
    contact.last = t;
    if (-c.distance > contact.deepest) {
      contact.deepest = -c.distance;
      contact.deepest_time = t;
    }
  }

  const world::Workcell& cell_;
  const collision::FclChecker& checker_;
  world::PairSelection selection_;
  std::unique_ptr<collision::CollisionChecker::Scratch> scratch_;
  std::vector<collision::PairClearance> found_;
  double least_ = std::numeric_limits<double>::infinity();
  int nearest_pair_ = -1;
  double nearest_time_ = 0;
  std::map<int, Contact> contacts_;
};

Result<void> check_input(const world::Workcell& cell, const CellMotion& motion,
                         const Eigen::VectorXd& start, const Eigen::VectorXd& goal,
                         const VerifyOptions& options) {
  if (!(options.rate > 0) || std::isinf(options.rate)) {
    return fail(ErrorCode::kInvalidInput,
                sentence("the rate of samples must be positive, is ", options.rate, " Hz"));
  }
  if (motion.arms().size() != cell.arms().size()) {
    return fail(ErrorCode::kInvalidInput,
                sentence("the motion has ", motion.arms().size(), " arms, workcell ", cell.name(),
                         " has ", cell.arms().size(), ": is it a plan for another cell?"));
  }
  for (std::size_t i = 0; i < cell.arms().size(); ++i) {
    if (motion.arms()[i].dof() == cell.arms()[i].dof()) continue;
    return fail(ErrorCode::kInvalidInput,
                sentence("the motion of arm ", cell.arms()[i].name, " has ", motion.arms()[i].dof(),
                         " joints, the arm has ", cell.arms()[i].dof()));
  }
  if (start.size() != cell.dof() || goal.size() != cell.dof()) {
    return fail(ErrorCode::kInvalidInput,
                sentence("start has ", start.size(), " and goal ", goal.size(),
                         " values, workcell ", cell.name(), " has ", cell.dof(), " joints"));
  }
  return {};
}

}  // namespace

Result<VerifyReport> verify(const std::shared_ptr<const world::Workcell>& cell,
                            const motion::CellMotion& motion, const Eigen::VectorXd& start,
                            const Eigen::VectorXd& goal, const VerifyOptions& options,
                            const StopCondition& stop) {
  if (auto input = check_input(*cell, motion, start, goal, options); !input) {
    return std::unexpected(input.error());
  }
  const auto checker = collision::FclChecker::make(cell, collision::FclGeometry::kUrdf);
  if (!checker) return std::unexpected(checker.error());
  VerifyReport report;
  CollisionWalk walk(*cell, **checker);
  Eigen::VectorXd q(cell->dof());
  const double end = motion.duration();
  for (bool last = false; !last; ++report.samples) {
    if (stop()) return std::unexpected(stop.error("verification"));
    const double tick = static_cast<double>(report.samples) / options.rate;
    last = tick >= end;
    const double t = last ? end : tick;
    for (std::size_t i = 0; i < cell->arms().size(); ++i) {
      const world::Arm& arm = cell->arms()[i];
      place(motion.arms()[i], t, q.segment(arm.offset, arm.dof()));
    }
    if (!q.allFinite()) {
      report.failures.push_back(sentence("the position is not a finite number at ", t, " s"));
      break;
    }
    walk.visit(t, q);
  }
  walk.report(report);
  check_curves(*cell, motion, start, goal, options, report);
  return report;
}

}  // namespace tandem::verification
