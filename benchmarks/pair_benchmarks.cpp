#include "pair_benchmarks.h"

#include <benchmark/benchmark.h>

#include "cells.h"
#include "tandem/collision/batch_checker.h"
#include "tandem/geometry/distance.h"

namespace tandem::bench {

namespace {

using geometry::Shape;

constexpr double kGap = 0.01;  // [m]
constexpr int kConfigurations = 256;

struct NamedShape {
  std::string name;
  Shape shape;
};

/// A shape of each kind about the origin, some 10 cm large.
std::vector<NamedShape> shapes() {
  const Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d turned = X;
  turned.rotate(Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized()));
  const Eigen::Vector3d end(0.05, 0.02, 0.06);
  std::vector<Eigen::Vector3d> corners;
  Rng rng(1);
  for (int i = 0; i < 12; ++i) {
    corners.emplace_back(rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05),
                         rng.uniform(-0.05, 0.05));
  }
  const Eigen::Vector3d edges(0.1, 0.06, 0.14);
  return {{"sphere", *Shape::sphere(Eigen::Vector3d::Zero(), 0.05)},
          {"capsule", *Shape::capsule(-end, end, 0.04)},
          {"box", *Shape::box(X, edges, 0.0)},
          {"turned_box", *Shape::box(turned, edges, 0.0)},
          {"rounded_box", *Shape::box(turned, edges, 0.01)},
          {"triangle", *Shape::rounded_triangle(-end, end, {0.05, -0.05, 0}, 0.01)},
          {"cylinder", *Shape::cylinder(turned, 0.05, 0.12, 0.0)},
          {"convex", *Shape::convex(corners, 0.0)}};
}

/// `b` moved along x until it is kGap from `a`.
Shape beside(const Shape& a, const Shape& b) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    X.translation().x() = 0.5 * (low + high);
    (geometry::distance(a, b.in(X)) < kGap ? low : high) = X.translation().x();
  }
  return b.in(X);
}

/// One joint that turns `moving` a little; `standing` beside it.
Cell cell_of(const Shape& moving, const Shape& standing) {
  world::WorkcellSpec spec;
  spec.name = "pair";
  std::vector<robot::Link> links(2);
  links[0].name = "base";
  links[1].name = "mover";
  robot::Joint joint;
  joint.name = "turn";
  joint.type = robot::JointType::kRevolute;
  joint.parent_link = 0;
  joint.child_link = 1;
  joint.axis_J = Eigen::Vector3d::UnitX();
  joint.limits = {-1e-3, 1e-3, 1, 1, std::numeric_limits<double>::infinity()};
  world::RobotSpec robot;
  robot.name = "robot";
  robot.model = *robot::Model::make("turner", links, {joint});
  robot.volumes["mover"] = {moving};
  spec.robots = {robot};
  world::ArmSpec arm;
  arm.name = "arm";
  arm.robot = "robot";
  arm.base = "base";
  arm.tip = "mover";
  spec.arms = {arm};
  world::ObstacleSpec obstacle;
  obstacle.name = "obstacle";
  obstacle.shapes_W = {standing};
  spec.obstacles = {obstacle};
  return world::Workcell::make(std::move(spec)).value();
}

void run_distance(benchmark::State& state, const Shape& a, const Shape& b) {
  for (auto _ : state) benchmark::DoNotOptimize(geometry::distance(a, b));
}

void run_batch(benchmark::State& state, const Cell& cell, std::int64_t target) {
  use_target(target);
  const collision::SsvChecker exact(cell);
  const collision::BatchChecker batch(exact);
  const auto pairs = batch.compile(world::PairScope::all());
  const auto scratch = batch.make_scratch();
  Rng rng(1);
  Eigen::MatrixXd Q(cell->dof(), kConfigurations);
  for (double& q : Q.reshaped()) q = rng.uniform(-1e-3, 1e-3);
  if (!batch.are_free(Q, *pairs, *scratch)) return state.SkipWithError("the pair touches");
  for (auto _ : state) benchmark::DoNotOptimize(batch.are_free(Q, *pairs, *scratch));
  state.counters["each"] = benchmark::Counter(
      kConfigurations, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

}  // namespace

void add_pairs() {
  const std::vector<NamedShape> all = shapes();
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t k = i; k < all.size(); ++k) {
      const Shape moving = all[i].shape, standing = beside(all[i].shape, all[k].shape);
      const std::string pair = "pair/" + all[i].name + "-" + all[k].name + "/";
      benchmark::RegisterBenchmark(
          (pair + "scalar").c_str(),
          [moving, standing](benchmark::State& state) { run_distance(state, moving, standing); });
      const Cell cell = cell_of(moving, standing);
      for (const std::int64_t target : targets()) {
        benchmark::RegisterBenchmark(
            (pair + hwy::TargetName(target)).c_str(),
            [cell, target](benchmark::State& state) { run_batch(state, cell, target); });
      }
    }
  }
}

}  // namespace tandem::bench
