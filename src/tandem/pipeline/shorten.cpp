#include "tandem/pipeline/shorten.h"

#include <algorithm>
#include <cmath>

#include "tandem/world/tool_poses.h"

namespace tandem::pipeline {

using motion::JointPath;

namespace {

constexpr int kWaypoints = 20;       // Ref: the paper, "Planner Parameters".
constexpr double kEdgeLength = 0.3;  // [rad] Longer ones make long paths longer.
/// How much longer the tools' paths may become where waypoints are dropped, as a fraction of the
/// whole.
constexpr double kLonger = 2e-3;

/// Long paths are shortened with more edges, where few are asked for.
shortening::ShorteningOptions options_for(const JointPath& path, const Modules& modules) {
  shortening::ShorteningOptions options = modules.shortening;
  if (options.edges == 0) return options;
  const double most = static_cast<double>(path.size());
  const double edges = std::min(most, std::ceil(motion::joint_length(path) / kEdgeLength));
  options.edges = std::max(options.edges, static_cast<int>(edges));
  return options;
}

/// Sum over the arms of L, measured at the waypoints.
double tool_length(const world::Workcell& cell, const JointPath& path) {
  double sum = 0;
  for (const auto& X_WE : tool_poses(cell, path)) sum += motion::cartesian_length(X_WE).L;
  return sum;
}

/// Drops waypoints whose detour is not worth anything, part by part.
class Thinning {
 public:
  Thinning(const world::Workcell& cell, planning::Validity& validity, const JointPath& path,
           const StopCondition& stop)
      : cell_(cell),
        validity_(validity),
        path_(path),
        stop_(stop),
        total_(tool_length(cell, path)) {}

  JointPath run() {
    kept_ = {path_.front()};
    thin(0, path_.size() - 1);
    return std::move(kept_);
  }

 private:
  /// Appends what is needed of waypoints (first, last].
  void thin(std::size_t first, std::size_t last) {
    if (last - first == 1 || (!stop_() && straight(first, last))) {
      kept_.push_back(path_[last]);
      return;
    }
    const std::size_t middle = furthest(first, last);
    thin(first, middle);
    thin(middle, last);
  }

  /// Whether the straight edge is accepted and its tools' paths are as short.
  bool straight(std::size_t first, std::size_t last) {
    JointPath part(path_.begin() + static_cast<std::ptrdiff_t>(first),
                   path_.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    const JointPath edge =
        motion::interpolated({part.front(), part.back()}, static_cast<int>(part.size()));
    return tool_length(cell_, edge) <= tool_length(cell_, part) + kLonger * total_ &&
           validity_.edge(part.front(), part.back());
  }

  /// The waypoint between that is furthest from the straight edge.
  std::size_t furthest(std::size_t first, std::size_t last) const {
    const Eigen::VectorXd along = path_[last] - path_[first];
    const double squared = along.squaredNorm();
    std::size_t best = (first + last) / 2;
    double most = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const Eigen::VectorXd d = path_[i] - path_[first];
      const double s = squared > 0 ? std::clamp(d.dot(along) / squared, 0.0, 1.0) : 0;
      const double away = (d - s * along).squaredNorm();
      if (away > most) {
        most = away;
        best = i;
      }
    }
    return best;
  }

  const world::Workcell& cell_;
  planning::Validity& validity_;
  const JointPath& path_;
  const StopCondition& stop_;
  double total_;
  JointPath kept_;
};

}  // namespace

std::vector<ArmLengths> arm_lengths(const world::Workcell& cell, const JointPath& before,
                                    const JointPath& after) {
  const auto first = tool_poses(cell, motion::interpolated(before, kWaypoints));
  const auto last = tool_poses(cell, motion::interpolated(after, kWaypoints));
  std::vector<ArmLengths> lengths(cell.arms().size());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const world::Arm& arm = cell.arms()[i];
    JointPath part;
    for (const Eigen::VectorXd& q : after) part.push_back(q.segment(arm.offset, arm.dof()));
    const motion::CartesianLength was = motion::cartesian_length(first[i]);
    const motion::CartesianLength is = motion::cartesian_length(last[i]);
    lengths[i] = {was.f, is.f, was.L, is.L, motion::joint_length(part)};
  }
  return lengths;
}

JointPath shorten_path(const ShortenContext& context, const ResolvedQuery& ends,
                       const JointPath& path) {
  const world::Workcell& cell = context.compiled.cell();
  PlanReport& report = context.report;
  const auto keep = [&](const char* name, const JointPath& waypoints) {
    if (context.options.keep_phases) report.phases.push_back({name, waypoints});
  };
  const JointPath dense = motion::interpolated(path, kWaypoints);
  keep("interpolated", dense);
  JointPath shortened;
  {
    ModuleTimer timer(report.times.plpp);
    ++report.counts.shortenings;
    shortening::Shortening result =
        context.modules.shortener->shorten(context.compiled, world::PairScope::all(), dense,
                                           options_for(dense, context.modules), context.stop);
    if (result.drawn_back > 0) ++report.rungs["plpp_blend"];
    shortened = std::move(result.path);
    if (context.options.preset == Preset::kDefault &&
        tool_length(cell, shortened) > tool_length(cell, dense)) {
      shortened = dense;
    }
  }
  keep("shortened", shortened);
  JointPath simplified;
  {
    ModuleTimer timer(report.times.simplification);
    if (context.options.preset == Preset::kPaper) {
      const planning::PathProblem problem{ends.start, ends.goal, cell.lower(), cell.upper()};
      simplified = context.modules.simplifier->simplify(
          problem, shortened, *context.modules.validity, context.options.seed, context.stop);
    } else {
      simplified = Thinning(cell, *context.modules.validity, shortened, context.stop).run();
    }
  }
  keep("simplified_again", simplified);
  report.arms = arm_lengths(cell, dense, shortened);
  return simplified;
}

}  // namespace tandem::pipeline
