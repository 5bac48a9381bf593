/// What obstacles cost: a check of a free configuration among 10 to 10,000 boxes, one by one and in
/// batches, and a change of the scene. Usage: scene_study WORKCELL [MOST]   (medians of 7 rounds)
/// The robots of the workcell stand in a field of random boxes that fill one part in two hundred of
/// it, whatever their number, and leave free the configurations that checks are timed at: among ten
/// thousand no random one would be.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <set>

#include "tandem/collision/compiled_cell.h"
#include "tandem/core/rng.h"
#include "tandem/tandem.h"
#include "tandem/world/obstacles.h"

namespace {

using tandem::Clock;
using tandem::collision::CompiledCell;
using tandem::world::PairScope;
using Cell = std::shared_ptr<const tandem::world::Workcell>;

constexpr int kRounds = 7;

/// Median wall time [s].
double seconds(const std::function<void()>& work) {
  std::array<double, kRounds> took{};
  for (double& one : took) {
    const auto begin = Clock::now();
    work();
    one = std::chrono::duration<double>(Clock::now() - begin).count();
  }
  std::ranges::sort(took);
  return took[kRounds / 2];
}

tandem::world::ObstacleSpec random_box(tandem::Rng& rng, const std::string& name, double size) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Eigen::Vector3d(rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-0.5, 1.5));
  X.linear() = Eigen::AngleAxisd(rng.uniform(-3, 3), Eigen::Vector3d::UnitZ()).matrix();
  tandem::world::ObstacleSpec obstacle;
  obstacle.name = name;
  obstacle.shapes_W = {*tandem::geometry::Shape::box(X, Eigen::Vector3d::Constant(size))};
  obstacle.X_WO = X;
  return obstacle;
}

tandem::world::WorkcellSpec without_obstacles(const Cell& robots) {
  tandem::world::WorkcellSpec spec = robots->spec();
  spec.obstacles.clear();
  spec.allowed.clear();
  spec.queries.clear();
  spec.lists.clear();
  spec.body_padding.clear();
  return spec;
}

/// Random configurations in which the robots touch nothing of themselves, as columns.
Eigen::MatrixXd configurations(const Cell& robots, int count) {
  const auto alone = tandem::world::Workcell::make(without_obstacles(robots));
  const CompiledCell compiled(*alone);
  const auto& cell = compiled.cell();
  const auto scratch = compiled.batch().make_scratch();
  const auto pairs = compiled.pairs(PairScope::all());
  tandem::Rng rng(2);
  Eigen::MatrixXd Q(cell.dof(), count);
  for (int found = 0; found < count;) {
    for (Eigen::Index j = 0; j < Q.rows(); ++j) {
      Q(j, found) = rng.uniform(cell.lower()[j], cell.upper()[j]);
    }
    found += compiled.batch().are_free(Q.col(found), *pairs, *scratch);
  }
  return Q;
}

/// The obstacles that anything touches at the columns of Q.
std::set<std::string> in_the_way(const Cell& cell, const Eigen::MatrixXd& Q) {
  const CompiledCell compiled(cell);
  const auto scratch = compiled.exact().make_scratch();
  std::vector<tandem::collision::PairClearance> touching;
  std::set<std::string> names;
  for (const auto& q : Q.colwise()) {
    compiled.exact().clearances(q, compiled.selection(PairScope::all()), 0.0, *scratch, touching);
    for (const auto& found : touching) {
      const auto& pair = cell->pairs()[static_cast<std::size_t>(found.pair)];
      for (const int body : {pair.a, pair.b}) {
        names.insert(cell->bodies()[static_cast<std::size_t>(body)].name);
      }
    }
  }
  return names;
}

/// The robots among `count` boxes, drawn again until none is in the way at the columns of Q.
Cell among_boxes(const Cell& robots, int count, const Eigen::MatrixXd& Q) {
  const double size = std::cbrt(4.0 * 4.0 * 2.0 / 200 / count);
  tandem::Rng rng(1);
  tandem::world::WorkcellSpec spec = without_obstacles(robots);
  for (int i = 0; i < count; ++i) {
    spec.obstacles.push_back(random_box(rng, "box" + std::to_string(i), size));
  }
  while (true) {
    const Cell cell = *tandem::world::Workcell::make(spec);
    const std::set<std::string> touched = in_the_way(cell, Q);
    if (touched.empty()) return cell;
    for (auto& obstacle : spec.obstacles) {
      if (touched.contains(obstacle.name)) obstacle = random_box(rng, obstacle.name, size);
    }
  }
}

void print_checks(const CompiledCell& compiled, const Eigen::MatrixXd& Q) {
  const auto& all = compiled.selection(PairScope::all());
  const auto pairs = compiled.pairs(PairScope::all());
  const auto scratch = compiled.batch().make_scratch();
  const auto exact_scratch = compiled.exact().make_scratch();
  bool free = true;
  const double batch = seconds([&] {
    for (int i = 0; i < 20; ++i) free = compiled.batch().are_free(Q, *pairs, *scratch) && free;
  });
  const double scalar = seconds([&] {
    for (const auto& q : Q.colwise())
      free = compiled.exact().is_free(q, all, *exact_scratch) && free;
  });
  const double n = static_cast<double>(Q.cols());
  std::printf(" %9.3f %9.2f%s", 1e6 * batch / (20 * n), 1e6 * scalar / n, free ? "" : " ?");
}

/// A change of the cell, and compiling it.
template <class F>
void print_change(const CompiledCell& before, F&& change) {
  Cell cell;
  const double world = seconds([&] { cell = *change(before.cell()); });
  const double compiling =
      seconds([&] { (void)CompiledCell(cell, &before).pairs(PairScope::all()); });
  std::printf(" %7.2f+%-7.2f", 1e3 * world, 1e3 * compiling);
}

void print_changes(const CompiledCell& compiled, const std::string& hand) {
  using tandem::world::SceneState;
  using tandem::world::Workcell;
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation().z() = 0.9;
  const auto in = [](const Workcell& cell, tandem::world::ObjectState object) {
    SceneState scene = cell.scene();
    scene.objects["box3"] = std::move(object);
    return cell.in_scene(std::move(scene));
  };
  print_change(compiled, [&](const Workcell& cell) { return in(cell, {"world", X, {}, {}}); });
  print_change(compiled, [&](const Workcell& cell) {
    tandem::Rng rng(3);
    return tandem::world::with_obstacle(cell, random_box(rng, "new", 0.05));
  });
  print_change(compiled,
               [&](const Workcell& cell) { return tandem::world::without_obstacle(cell, "box5"); });
  X.translation().z() = 0.1;
  print_change(compiled, [&](const Workcell& cell) { return in(cell, {hand, X, {}, {}}); });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::printf("usage: scene_study WORKCELL [MOST]\n"), 2;
  const auto robots = tandem::load_workcell(argv[1]);
  if (!robots) return std::printf("%s\n", robots.error().message.c_str()), 1;
  constexpr int kConfigurations = 128;
  const Eigen::MatrixXd Q = configurations(*robots, kConfigurations);
  const int most = argc > 2 ? std::atoi(argv[2]) : 10'000;
  const auto& arm = (*robots)->arms().front();
  const std::string hand = (*robots)->model().links()[static_cast<std::size_t>(arm.tip_link)].name;
  std::printf(
      "us per free configuration; ms per change of the scene: of the cell + compiling it\n");
  std::printf("%7s %9s %9s %9s %9s %15s %15s %15s %15s\n", "boxes", "batch", "scalar", "make ms",
              "compile", "move", "add", "remove", "attach");
  for (int count = 10; count <= most; count *= 10) {
    const Cell cell = among_boxes(*robots, count, Q);
    const double making = seconds([&] {
      auto spec = cell->spec();
      (void)tandem::world::Workcell::make(std::move(spec));
    });
    std::unique_ptr<CompiledCell> compiled;
    const double compiling = seconds([&] {
      compiled = std::make_unique<CompiledCell>(cell);
      (void)compiled->pairs(PairScope::all());
    });
    std::printf("%7d", count);
    print_checks(*compiled, Q);
    std::printf(" %9.1f %9.1f", 1e3 * making, 1e3 * compiling);
    print_changes(*compiled, hand);
    std::printf("\n");
  }
}
