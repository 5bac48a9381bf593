/// What meshes and point clouds cost: a workcell as it is, with a terrain of 50,000 triangles and
/// with a cloud of 100,000 points under its arms. Plans are made by one planner, so that building
/// is not part of them.
/// Usage: surface_study WORKCELL [SEEDS]   (over all queries, SEEDS plans each, default 3)

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <optional>

#include "tandem/collision/ssv_scratch.h"
#include "tandem/core/rng.h"
#include "tandem/pipeline/planner.h"
#include "tandem/tandem.h"

namespace {

using Eigen::Vector3d;
using tandem::Rng;
using tandem::geometry::Surface;
using tandem::world::PairScope;
using tandem::world::Workcell;
using CellPtr = std::shared_ptr<const Workcell>;

/// A plate of 1.2 m x 1.4 m before the arms, a little below the height of their table.
constexpr double kLeft = -0.7, kWidth = 1.4, kNear = 0.2, kDepth = 1.2, kHeight = 0.66;

std::shared_ptr<const Surface> terrain(int rows) {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  Rng rng(1);
  for (int i = 0; i <= rows; ++i) {
    for (int k = 0; k <= rows; ++k) {
      const double x = kNear + kDepth * i / rows, y = kLeft + kWidth * k / rows;
      const double z = kHeight + 0.015 * std::sin(20 * x) * std::cos(17 * y);
      vertices.emplace_back(x, y, z + rng.uniform(0, 0.003));
      if (i == rows || k == rows) continue;
      const int v = i * (rows + 1) + k;
      triangles.push_back({v, v + rows + 1, v + rows + 2});
      triangles.push_back({v, v + rows + 2, v + 1});
    }
  }
  return Surface::mesh(std::move(vertices), std::move(triangles)).value();
}

std::shared_ptr<const Surface> cloud(int count) {
  std::vector<Vector3d> points;
  Rng rng(2);
  for (int i = 0; i < count; ++i) {
    points.emplace_back(kNear + rng.uniform(0, kDepth), kLeft + rng.uniform(0, kWidth),
                        kHeight + rng.uniform(0, 0.02));
  }
  return Surface::cloud(std::move(points), 0.004).value();
}

/// Of processor time: others may use the machine.
double seconds(const std::function<void()>& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Median microseconds per check of a list of configurations, of seven runs.
double check_time(const tandem::collision::SsvChecker& checker,
                  const std::vector<Eigen::VectorXd>& list) {
  const auto scratch = checker.make_scratch();
  const auto all = checker.cell().select(PairScope::all());
  std::vector<double> runs;
  for (int run = 0; run < 7 && !list.empty(); ++run) {
    const double took = seconds([&] {
      for (const Eigen::VectorXd& q : list) checker.is_free(q, all, *scratch);
    });
    runs.push_back(1e6 * took / static_cast<double>(list.size()));
  }
  return median(runs);
}

/// The cell with its first obstacle elsewhere.
CellPtr first_object_moved(const Workcell& cell) {
  const std::string& object = cell.spec().obstacles.front().name;
  tandem::world::SceneState scene = cell.scene();
  scene.objects[object] = *cell.find_object(object);
  scene.objects[object].X_LO.translation().x() += 0.001;
  return *cell.in_scene(std::move(scene));
}

void study(const char* name, const CellPtr& cell, int seeds) {
  std::vector<double> builds, plans;
  std::unique_ptr<tandem::collision::SsvChecker> checker;
  for (int i = 0; i < 5; ++i) {
    builds.push_back(
        1e3 * seconds([&] { checker = std::make_unique<tandem::collision::SsvChecker>(cell); }));
  }
  std::vector<double> changes;
  const CellPtr changed = first_object_moved(*cell);
  for (int i = 0; i < 5; ++i) {
    changes.push_back(
        1e3 * seconds([&] { (void)tandem::collision::SsvChecker(changed, checker.get()); }));
  }
  const tandem::collision::SsvScratch memory(checker->model());
  const auto scratch = checker->make_scratch();
  const auto all = cell->select(PairScope::all());
  std::vector<Eigen::VectorXd> valid, invalid, on_plans;
  Rng rng(1);
  while (invalid.size() < 2000 || (valid.size() < 500 && invalid.size() < 100000)) {
    Eigen::VectorXd q(cell->dof());
    for (Eigen::Index j = 0; j < q.size(); ++j)
      q[j] = rng.uniform(cell->lower()[j], cell->upper()[j]);
    (checker->is_free(q, all, *scratch) ? valid : invalid).push_back(q);
  }
  int failed = 0;
  const tandem::pipeline::Planner planner(cell);
  planner.prepare({}, {});
  for (const auto& query : cell->queries()) {
    for (int seed = 1; seed <= seeds; ++seed) {
      tandem::PlanOptions options;
      options.seed = static_cast<std::uint64_t>(seed);
      std::optional<tandem::Result<tandem::Plan>> plan;
      const double took = seconds([&] { plan.emplace(planner.plan(query, options)); });
      if (!*plan) {
        ++failed;
        continue;
      }
      plans.push_back(1e3 * took);
      Eigen::VectorXd q(cell->dof());
      for (int i = 0; i < 50; ++i) {
        (*plan)->trajectory.position(i / 50.0 * (*plan)->trajectory.duration(), q);
        on_plans.push_back(q);
      }
    }
  }
  std::printf(
      "%-8s build %6.1f ms  after a change %5.2f ms  model nodes %6.1f kB  scratch %5.1f kB  per "
      "configuration: valid "
      "%6.2f us, invalid %5.2f us, on plans %6.2f us  per plan %6.1f ms (%zu plans, %d failed)\n",
      name, median(builds), median(changes),
      1e-3 *
          static_cast<double>(checker->model().nodes.size() * sizeof(tandem::collision::SsvNode)),
      1e-3 * static_cast<double>(memory.memory()), check_time(*checker, valid),
      check_time(*checker, invalid), check_time(*checker, on_plans), median(plans), plans.size(),
      failed);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: surface_study WORKCELL [SEEDS]\n");
    return 2;
  }
  const int seeds = argc > 2 ? std::atoi(argv[2]) : 3;
  const auto loaded = tandem::load_workcell(argv[1]);
  if (!loaded) {
    std::fprintf(stderr, "surface_study: %s\n", loaded.error().message.c_str());
    return 2;
  }
  study("as it is", *loaded, seeds);
  for (const auto& [name, surface] :
       {std::pair{"terrain", terrain(158)}, std::pair{"cloud", cloud(100000)}}) {
    tandem::world::WorkcellSpec spec = (*loaded)->spec();
    tandem::world::ObstacleSpec obstacle;
    obstacle.name = name;
    obstacle.surfaces_W = {{surface}};
    spec.obstacles.push_back(std::move(obstacle));
    const auto cell = Workcell::make(std::move(spec));
    if (!cell) {
      std::fprintf(stderr, "surface_study: %s\n", cell.error().message.c_str());
      return 2;
    }
    study(name, *cell, seeds);
  }
  return 0;
}
