/// What the path length post-processor is worth and costs.
/// Usage: shortening_study solvers|growth|orientation|bound CELL [SEEDS]
///        shortening_study traces CELL QUERY > phases.svg
///   solvers      structured against SLSQP: the same paths, terms, weights, waypoints
///   growth       time and f by waypoints, for one arm of the cell, the cell, and two such cells
///   orientation  translation alone against translation and rotation: rotation of all tools
///   bound        lengths against those of straight lines from start to goal
///   traces       a query's tool paths through the phases of planning, seen from above and the side

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "shortening_traces.h"
#include "tandem/pipeline/bench.h"
#include "tandem/shortening/nlopt/slsqp_shortener.h"
#include "tandem/shortening/shortener.h"
#include "tandem/tandem.h"
#include "tandem/world/tool_poses.h"

namespace {

using namespace tandem;
using motion::JointPath;
using pipeline::Statistics;
using shortening::ShorteningOptions, shortening::Shortening;
using Cell = std::shared_ptr<const world::Workcell>;

constexpr int kWaypoints = 20;  // Ref: the paper, "Planner Parameters".

/// Simplified paths of the default preset, by query.
std::vector<std::vector<JointPath>> planned_paths(const Cell& cell, int seeds) {
  const pipeline::Planner planner(cell);
  const auto queries = planner.resolve_all(cell->queries());
  if (!queries) throw std::runtime_error(queries.error().message);
  std::vector<std::vector<JointPath>> paths;
  for (const pipeline::ResolvedQuery& query : *queries) {
    auto& of_query = paths.emplace_back();
    for (int seed = 1; seed <= seeds; ++seed) {
      PlanOptions options;
      options.seed = static_cast<std::uint64_t>(seed);
      const auto planned = planner.plan_path(query, options);
      if (planned) of_query.push_back(planned->path);
    }
  }
  return paths;
}

/// A solver on one cell, with its time.
class Run {
 public:
  Run(const shortening::Shortener& shortener, const Cell& cell)
      : shortener_(shortener), compiled_(cell) {
    compiled_.pairs(world::PairScope::all());  // Compiled once: not part of the times.
  }

  Shortening operator()(const JointPath& path, const ShorteningOptions& options) {
    const auto begin = Clock::now();
    Shortening result =
        shortener_.shorten(compiled_, world::PairScope::all(), path, options, StopCondition());
    times_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    before.push_back(result.before);
    after.push_back(result.after);
    iterations.push_back(result.iterations);
    violations.push_back(1e3 * result.violation);
    return result;
  }

  std::vector<double> times_ms, before, after, iterations, violations;

 private:
  const shortening::Shortener& shortener_;
  collision::CompiledCell compiled_;
};

void print_run(const char* name, const Run& run) {
  const Statistics time = Statistics::of(run.times_ms);
  std::printf("%-34s %9.2f %9.2f %9.2f %9.2f %9.4f %9.4f %6.1f %9.3f\n", name, time.mean, time.p50,
              time.p99, time.max, Statistics::of(run.before).mean, Statistics::of(run.after).mean,
              Statistics::of(run.iterations).mean, Statistics::of(run.violations).max);
}

int compare_solvers(const Cell& cell, int seeds) {
  const auto structured = shortening::make_structured_shortener();
  const auto slsqp = shortening::make_slsqp_shortener();
  Run fast(*structured, cell), reference(*slsqp, cell), careful(*structured, cell),
      few(*structured, cell);
  int worse = 0, count = 0;
  for (const auto& of_query : planned_paths(cell, seeds)) {
    for (const JointPath& path : of_query) {
      const JointPath dense = motion::interpolated(path, kWaypoints);
      ShorteningOptions options;
      const double by_slsqp = reference(dense, options).after;
      options.points_per_edge.assign(dense.size() - 1, 0);  // Waypoints only, like SLSQP.
      worse += fast(dense, options).after > 1.01 * by_slsqp;
      ++count;
      options.points_per_edge.clear();
      options.prove_edges = true;
      careful(dense, options);
      options.edges = 10;
      few(dense, options);
    }
  }
  std::printf("%d paths, %d joints, %d waypoints; objective divided by nothing\n", count,
              cell->dof(), kWaypoints);
  std::printf("%-34s %9s %9s %9s %9s %9s %9s %6s %9s\n", "", "ms mean", "p50", "p99", "max",
              "f before", "f after", "iter", "lacks mm");
  print_run("slsqp", reference);
  print_run("structured, same problem", fast);
  print_run("structured, with proven edges", careful);
  print_run("structured, with few of them", few);
  std::printf("ratio of medians %.0f; more than 1 %% above slsqp in %d of %d\n",
              Statistics::of(reference.times_ms).p50 / Statistics::of(fast.times_ms).p50, worse,
              count);
  return 0;
}

/// The cell and the same again, far enough away to be no neighbour.
Cell doubled(const Cell& cell) {
  world::WorkcellSpec spec = cell->spec();
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation().y() = 20;
  const auto named = [](const std::string& name) { return "second_" + name; };
  spec.queries.clear();
  spec.lists.clear();
  for (std::size_t i = 0, n = spec.robots.size(); i < n; ++i) {
    world::RobotSpec robot = spec.robots[i];
    robot.name = named(robot.name);
    robot.X_WB = X * robot.X_WB;
    spec.robots.push_back(std::move(robot));
  }
  for (std::size_t i = 0, n = spec.arms.size(); i < n; ++i) {
    world::ArmSpec arm = spec.arms[i];
    arm.name = named(arm.name);
    arm.robot = named(arm.robot);
    spec.arms.push_back(std::move(arm));
  }
  for (std::size_t i = 0, n = spec.obstacles.size(); i < n; ++i) {
    world::ObstacleSpec obstacle = spec.obstacles[i];
    obstacle.name = named(obstacle.name);
    for (geometry::Shape& shape : obstacle.shapes_W) shape = shape.in(X);
    for (geometry::PlacedSurface& surface : obstacle.surfaces_W) surface.X_FS = X * surface.X_FS;
    spec.obstacles.push_back(std::move(obstacle));
  }
  auto made = world::Workcell::make(std::move(spec));
  if (!made) throw std::runtime_error(made.error().message);
  return *made;
}

int measure_growth(const Cell& cell, int seeds) {
  const auto structured = shortening::make_structured_shortener();
  const auto by_query = planned_paths(cell, seeds);
  const Cell alone = cell->arm_alone(0), twice = doubled(cell);
  const Eigen::Index dof = cell->dof(), first = alone->dof();
  std::printf("%7s %10s %9s %9s %9s %12s %6s %10s %10s\n", "joints", "waypoints", "ms mean", "p50",
              "p99", "us/waypoint", "iter", "f before", "f after");
  for (const Cell& of : {alone, cell, twice}) {
    for (const int waypoints : {20, 40, 80, 160}) {
      Run run(*structured, of);
      for (const auto& of_query : by_query) {
        for (const JointPath& path : of_query) {
          JointPath dense = motion::interpolated(path, waypoints);
          for (Eigen::VectorXd& q : dense) {
            if (of == alone) q = q.head(first).eval();
            if (of == twice) q = q.replicate(2, 1).eval();
          }
          run(dense, {});
        }
      }
      const Statistics time = Statistics::of(run.times_ms);
      // f falls with the edges: shown as if there were as many as usual.
      const double per_f = (waypoints - 1) / (kWaypoints - 1.0);
      std::printf("%7d %10d %9.2f %9.2f %9.2f %12.1f %6.1f %10.5f %10.5f\n",
                  static_cast<int>(of == twice ? 2 * dof : of->dof()), waypoints, time.mean,
                  time.p50, time.p99, 1e3 * time.mean / waypoints,
                  Statistics::of(run.iterations).mean, per_f * Statistics::of(run.before).mean,
                  per_f * Statistics::of(run.after).mean);
    }
  }
  return 0;
}

/// Way of all tools through the waypoints: translation [m] and rotation [rad], and L.
struct ToolWay {
  double translation = 0, rotation = 0, L = 0;
};

ToolWay tool_way(const world::Workcell& cell, const JointPath& path) {
  ToolWay way;
  for (const auto& X_WE : tool_poses(cell, path)) {
    for (std::size_t i = 1; i < X_WE.size(); ++i) {
      way.translation += (X_WE[i].translation() - X_WE[i - 1].translation()).norm();
      way.rotation +=
          Eigen::AngleAxisd(X_WE[i - 1].linear().transpose() * X_WE[i].linear()).angle();
    }
    way.L += motion::cartesian_length(X_WE).L;
  }
  return way;
}

int compare_orientation(const Cell& cell, int seeds) {
  const auto structured = shortening::make_structured_shortener();
  Run run(*structured, cell);
  ShorteningOptions both, translation;
  both.prove_edges = translation.prove_edges = true;
  translation.weights.rotation = 0;
  const auto by_query = planned_paths(cell, seeds);
  std::printf("%-20s rotation of all tools [rad]: %8s %12s %8s   translation [m]: %8s %12s %8s\n",
              "", "before", "translation", "both", "before", "translation", "both");
  ToolWay sum[3];
  for (std::size_t k = 0; k < by_query.size(); ++k) {
    ToolWay mean[3];
    for (const JointPath& path : by_query[k]) {
      const JointPath dense = motion::interpolated(path, kWaypoints);
      const JointPath results[] = {dense, run(dense, translation).path, run(dense, both).path};
      for (int i = 0; i < 3; ++i) {
        const ToolWay way = tool_way(*cell, results[i]);
        mean[i].rotation += way.rotation / static_cast<double>(by_query[k].size());
        mean[i].translation += way.translation / static_cast<double>(by_query[k].size());
      }
    }
    for (int i = 0; i < 3; ++i) {
      sum[i].rotation += mean[i].rotation;
      sum[i].translation += mean[i].translation;
    }
    std::printf("%-20s %39.3f %12.3f %8.3f %26.3f %12.3f %8.3f\n", cell->queries()[k].name.c_str(),
                mean[0].rotation, mean[1].rotation, mean[2].rotation, mean[0].translation,
                mean[1].translation, mean[2].translation);
  }
  std::printf("%-20s %39.3f %12.3f %8.3f %26.3f %12.3f %8.3f\n", "all", sum[0].rotation,
              sum[1].rotation, sum[2].rotation, sum[0].translation, sum[1].translation,
              sum[2].translation);
  return 0;
}

int compare_with_bound(const Cell& cell, int seeds) {
  const auto structured = shortening::make_structured_shortener();
  Run run(*structured, cell);
  ShorteningOptions options;
  options.prove_edges = true;
  const auto by_query = planned_paths(cell, seeds);
  std::printf("%-20s %10s %10s %10s %10s\n", "L of all tools", "before", "after", "bound",
              "after/bound");
  double sums[3] = {};
  for (std::size_t k = 0; k < by_query.size(); ++k) {
    double mean[3] = {};
    for (const JointPath& path : by_query[k]) {
      const JointPath dense = motion::interpolated(path, kWaypoints);
      const auto share = 1 / static_cast<double>(by_query[k].size());
      mean[0] += share * tool_way(*cell, dense).L;
      mean[1] += share * tool_way(*cell, run(dense, options).path).L;
      mean[2] += share * tool_way(*cell, {path.front(), path.back()}).L;
    }
    for (int i = 0; i < 3; ++i) sums[i] += mean[i];
    std::printf("%-20s %10.4f %10.4f %10.4f %10.3f\n", cell->queries()[k].name.c_str(), mean[0],
                mean[1], mean[2], mean[1] / mean[2]);
  }
  std::printf("%-20s %10.4f %10.4f %10.4f %10.3f\n", "all", sums[0], sums[1], sums[2],
              sums[1] / sums[2]);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view mode = argc > 1 ? argv[1] : "";
  const auto cell = argc > 2 ? load_workcell(argv[2]) : Result<Cell>();
  if (argc < 3 || !cell) {
    std::fprintf(stderr, "%s\n",
                 argc < 3 ? "usage: shortening_study solvers|growth|orientation|bound CELL [SEEDS]"
                          : cell.error().message.c_str());
    return 2;
  }
  const int seeds = argc > 3 && mode != "traces" ? std::atoi(argv[3]) : 5;
  if (mode == "solvers") return compare_solvers(*cell, seeds);
  if (mode == "growth") return measure_growth(*cell, seeds);
  if (mode == "orientation") return compare_orientation(*cell, seeds);
  if (mode == "bound") return compare_with_bound(*cell, seeds);
  if (mode == "traces" && argc > 3) return print_traces(*cell, argv[3]);
  std::fprintf(stderr, "shortening_study: no study '%s'\n", argv[1]);
  return 2;
}
