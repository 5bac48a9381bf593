#include "tandem/pipeline/curve.h"

#include <algorithm>
#include <cstdio>

#include "tandem/trajectory/limit_check.h"
#include "tandem/trajectory/spline.h"

namespace tandem::pipeline {

namespace {

using motion::JointPath;
using motion::PiecewiseCubic;

constexpr int kRepairRounds = 16;
/// Ten times finer than the floor for edges, so that a curve on its polyline is refused only where
/// the edge itself has no more than about a micrometre to spare. Proving half of the true least
/// clearance costs a third more and tells people how near it came.
constexpr collision::CertificateOptions kCurveCertificate{.smallest_deviation = 1e-6,
                                                          .clearance_ratio = 0.5};

/// A place where the curve must come closer to its polyline.
struct Fault {
  int edge;     ///< Waypoints edge and edge + 1.
  double time;  ///< Of the curve [s].
};

struct Findings {
  std::vector<Fault> faults;  ///< At most one per edge and kind, by ascending edge.
  Error first{ErrorCode::kCollision, ""};
  double least_clearance = std::numeric_limits<double>::infinity();
  bool stopped = false;
};

std::string message_of(const world::Workcell& cell, const collision::Certificate& certificate) {
  const std::string pair = certificate.pair < 0 ? "nothing" : cell.describe_pair(certificate.pair);
  char text[160];
  if (certificate.verdict == collision::Verdict::kCollision) {
    std::snprintf(text, sizeof text, " touch at %.4f s, %.4f m deep", certificate.time,
                  certificate.depth);
  } else {
    std::snprintf(text, sizeof text, " come too close for a proof at %.4f s", certificate.time);
  }
  return pair + text;
}

/// Position limits on one waypoint edge: overshoot does not depend on the time scale, so it is
/// cured like a collision.
void find_overshoot(const world::Workcell& cell, const PiecewiseCubic& spline, int edge, double t0,
                    double t1, Findings& findings) {
  constexpr double kTolerance = 1e-6;  // That of the limit check [rad or m].
  double worst = kTolerance, worst_time = 0.5 * (t0 + t1);
  int joint = -1;
  // Exact, as the limit check is: a peak between samples would be found there, where nothing cures
  // it.
  for (std::size_t k = 0; k + 1 < spline.knots().size(); ++k) {
    const double begin = spline.knots()[k], h = spline.knots()[k + 1] - begin;
    if (begin + h / 2 < t0 || begin + h / 2 > t1) continue;
    for (int j = 0; j < spline.dof(); ++j) {
      const auto c = spline.segments()[k].row(j);
      const motion::StationaryPoints peaks = motion::stationary_points(c[1], c[2], c[3]);
      for (const double peak : {0.0, h, peaks.s[0], peaks.s[1]}) {
        const double s = std::clamp(peak, 0.0, h);
        const double q = c[0] + s * (c[1] + s * (c[2] + s * c[3]));
        const double over = std::max(q - cell.upper()[j], cell.lower()[j] - q);
        if (over <= worst) continue;
        worst = over;
        worst_time = begin + s;
        joint = j;
      }
    }
  }
  if (joint < 0) return;
  if (findings.faults.empty()) {
    char text[160];
    std::snprintf(text, sizeof text, " leaves its position limits by %.4f at %.4f s", worst,
                  worst_time);
    findings.first = {
        ErrorCode::kLimits,
        "the executed curve: " + cell.joint_names()[static_cast<std::size_t>(joint)] + text};
  }
  findings.faults.push_back({edge, worst_time});
}

/// Certificates of all waypoint edges; by the exact certificate none after one that was stopped.
std::vector<collision::Certificate> certify(const CurveContext& context,
                                            const PiecewiseCubic& spline,
                                            const std::vector<double>& waypoint_times) {
  const collision::CompiledCell& compiled = context.compiled;
  const world::PairScope all = world::PairScope::all();
  // Without pairs there is no clearance to name, which only the exact certificate says.
  if (context.by_batches && !compiled.selection(all).empty()) {
    const auto scratch = compiled.batch().make_scratch();
    return collision::certify_parts(compiled.batch(), *compiled.pairs(all), spline, waypoint_times,
                                    *scratch, kCurveCertificate, context.stop);
  }
  const auto scratch = compiled.exact().make_scratch();
  std::vector<collision::Certificate> certificates;
  for (std::size_t i = 0; i + 1 < waypoint_times.size(); ++i) {
    certificates.push_back(collision::certify_interval(
        compiled.exact(), spline, waypoint_times[i], waypoint_times[i + 1], compiled.selection(all),
        *scratch, kCurveCertificate, context.stop));
    if (certificates.back().stopped) break;
  }
  return certificates;
}

/// Proves every waypoint edge of the curve, or says where it fails.
Findings inspect(const CurveContext& context, const PiecewiseCubic& spline,
                 const std::vector<double>& waypoint_times) {
  const world::Workcell& cell = context.compiled.cell();
  Findings findings;
  const trajectory::Extremes extremes = trajectory::extremes(spline);
  const bool overshoots = (extremes.highest.array() > cell.upper().array()).any() ||
                          (extremes.lowest.array() < cell.lower().array()).any();
  ModuleTimer timer(context.report.times.certificate);
  const std::vector<collision::Certificate> certificates = certify(context, spline, waypoint_times);
  for (std::size_t i = 0; i < certificates.size(); ++i) {
    const int edge = static_cast<int>(i);
    const collision::Certificate& certificate = certificates[i];
    if (overshoots) {
      find_overshoot(cell, spline, edge, waypoint_times[i], waypoint_times[i + 1], findings);
    }
    context.report.counts.certificate_evaluations += certificate.evaluations;
    if (certificate.stopped) {
      findings.stopped = true;
      return findings;
    }
    if (certificate.is_free()) {
      findings.least_clearance = std::min(findings.least_clearance, certificate.least_clearance);
      continue;
    }
    if (findings.faults.empty()) {
      findings.first = {ErrorCode::kCollision,
                        "the executed curve: " + message_of(cell, certificate)};
    }
    findings.faults.push_back({edge, certificate.time});
  }
  return findings;
}

/// The path with a waypoint on each faulty edge, where the curve at the fault projects onto it.
JointPath refined(const JointPath& path, const PiecewiseCubic& spline,
                  const std::vector<Fault>& faults) {
  constexpr double kMargin = 0.15;  // Keeps new edges from becoming needles.
  JointPath finer;
  std::size_t next = 0;
  Eigen::VectorXd q(spline.dof());
  for (std::size_t i = 0; i < path.size(); ++i) {
    finer.push_back(path[i]);
    std::vector<double> parameters;
    for (; next < faults.size() && faults[next].edge == static_cast<int>(i); ++next) {
      const Eigen::VectorXd d = path[i + 1] - path[i];
      spline.position(faults[next].time, q);
      parameters.push_back(
          std::clamp((q - path[i]).dot(d) / d.squaredNorm(), kMargin, 1 - kMargin));
    }
    std::sort(parameters.begin(), parameters.end());
    double last = 0;
    for (const double s : parameters) {
      if (s - last < kMargin) continue;
      finer.push_back(path[i] + s * (path[i + 1] - path[i]));
      last = s;
    }
  }
  return finer;
}

struct TimedSpline {
  PiecewiseCubic spline;
  std::vector<double> waypoint_times;
};

TimedSpline time_path(const CurveContext& context, const JointPath& path) {
  ModuleTimer timer(context.report.times.trajectory);
  ++context.report.counts.timings;
  const trajectory::Timing timing =
      context.timing.optimize(path, context.compiled.cell().limits(), {}, context.stop);
  TimedSpline timed{trajectory::fit_spline(path, timing.durations), {}};
  const int count = static_cast<int>(path.size());
  for (int i = 0; i < count; ++i) {
    timed.waypoint_times.push_back(
        timed.spline.knots()[static_cast<std::size_t>(trajectory::knot_of_waypoint(i, count))]);
  }
  return timed;
}

/// Every edge from rest to rest: the curve is the polyline.
TimedSpline time_rest_to_rest(const CurveContext& context, const JointPath& path) {
  TimedSpline whole = time_path(context, {path[0], path[1]});
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const TimedSpline edge = time_path(context, {path[i], path[i + 1]});
    whole.waypoint_times.push_back(whole.waypoint_times.back() + edge.waypoint_times.back());
    whole.spline = whole.spline.then(edge.spline);
  }
  return whole;
}

/// The exact limit check, then the curve by arms.
Result<motion::CellMotion> finished(const CurveContext& context, const PiecewiseCubic& spline,
                                    double least_clearance) {
  const world::Workcell& cell = context.compiled.cell();
  const auto violations = trajectory::check_limits(spline, cell.limits());
  if (!violations.empty()) {
    return fail(ErrorCode::kLimits,
                "the executed curve: " + trajectory::describe(violations[0], cell.joint_names()));
  }
  context.report.least_clearance = least_clearance;
  std::vector<motion::ArmMotion> arms;
  for (const world::Arm& arm : cell.arms()) {
    arms.emplace_back(spline.joints(arm.offset, arm.dof()));
  }
  return motion::CellMotion(std::move(arms));
}

}  // namespace

Result<motion::CellMotion> make_curve(const CurveContext& context, const JointPath& path,
                                      bool repair) {
  JointPath waypoints = path;
  for (int round = 0; round <= kRepairRounds; ++round) {
    const TimedSpline timed = time_path(context, waypoints);
    if (context.stop()) return std::unexpected(context.stop.error("timing the path"));
    const Findings findings = inspect(context, timed.spline, timed.waypoint_times);
    if (findings.stopped) return std::unexpected(context.stop.error("proving the curve"));
    if (findings.faults.empty()) {
      if (round > 0) ++context.report.rungs["repair"];
      return finished(context, timed.spline, findings.least_clearance);
    }
    if (!repair) {
      return fail(findings.first.code,
                  findings.first.message + "; this preset repairs nothing, --preset default does");
    }
    JointPath finer = refined(waypoints, timed.spline, findings.faults);
    context.report.counts.repairs += static_cast<long>(finer.size() - waypoints.size());
    waypoints = std::move(finer);
  }
  ++context.report.rungs["rest_to_rest"];
  const TimedSpline timed = time_rest_to_rest(context, path);
  const Findings findings = inspect(context, timed.spline, timed.waypoint_times);
  if (findings.stopped) return std::unexpected(context.stop.error("proving the curve"));
  if (!findings.faults.empty()) return std::unexpected(findings.first);
  return finished(context, timed.spline, findings.least_clearance);
}

}  // namespace tandem::pipeline
