/// What a collision check of a cell costs by swept sphere volumes, one by one and in batches, and
/// by FCL on the URDF's own geometry (meshes) and on the volumes. Usage: checker_study WORKCELL
/// [CONFIGURATIONS]   (random ones, default 10000; medians of 5 rounds) A round asks every checker
/// the same questions in turn, so that ratios hold on a noisy machine.

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "tandem/collision/batch_checker.h"
#include "tandem/collision/fcl/fcl_checker.h"
#include "tandem/core/rng.h"
#include "tandem/tandem.h"

namespace {

using tandem::Clock;
using tandem::collision::BatchChecker;
using tandem::collision::CollisionChecker;
using tandem::collision::FclChecker;
using tandem::collision::FclGeometry;
using tandem::collision::SsvChecker;

constexpr int kRounds = 5;
constexpr int kBlock = 8;

double seconds(const std::function<void()>& work) {
  const auto begin = Clock::now();
  work();
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double median(std::array<double, kRounds> values) {
  std::ranges::sort(values);
  return values[kRounds / 2];
}

/// Random configurations inside the limits, by whether they are free.
std::array<Eigen::MatrixXd, 2> configurations(const SsvChecker& checker, int count) {
  const auto& cell = checker.cell();
  const auto all = cell.select(tandem::world::PairScope::all());
  const auto scratch = checker.make_scratch();
  tandem::Rng rng(1);
  std::array<std::vector<Eigen::VectorXd>, 2> found;
  for (int n = 0; n < count; ++n) {
    Eigen::VectorXd q(cell.dof());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      q[j] = rng.uniform(std::max(cell.lower()[j], -M_PI), std::min(cell.upper()[j], M_PI));
    }
    found[checker.is_free(q, all, *scratch)].push_back(q);
  }
  std::array<Eigen::MatrixXd, 2> columns;
  for (int free : {0, 1}) {
    columns[free].resize(cell.dof(), static_cast<Eigen::Index>(found[free].size()));
    for (std::size_t k = 0; k < found[free].size(); ++k) {
      columns[free].col(static_cast<Eigen::Index>(k)) = found[free][k];
    }
  }
  return columns;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: checker_study WORKCELL [CONFIGURATIONS]\n"), 2;
  const auto cell = tandem::load_workcell(argv[1]);
  if (!cell) return std::fprintf(stderr, "%s\n", cell.error().message.c_str()), 2;
  const int count = argc > 2 ? std::atoi(argv[2]) : 10000;
  const SsvChecker ssv(*cell);
  const BatchChecker batch(ssv);
  const auto meshes = FclChecker::make(*cell, FclGeometry::kUrdf);
  const auto volumes = FclChecker::make(*cell, FclGeometry::kVolumes);
  if (!meshes) return std::fprintf(stderr, "%s\n", meshes.error().message.c_str()), 2;
  if (!volumes) return std::fprintf(stderr, "%s\n", volumes.error().message.c_str()), 2;

  const auto all = (*cell)->select(tandem::world::PairScope::all());
  const auto pairs = batch.compile(all);
  const auto batch_scratch = batch.make_scratch();
  const std::array<const CollisionChecker*, 3> checkers{&ssv, meshes->get(), volumes->get()};
  const char* names[] = {"swept spheres, batches", "swept spheres, scalar", "FCL, URDF geometry",
                         "FCL, the volumes"};
  const auto questions = configurations(ssv, count);
  for (int free : {1, 0}) {
    const Eigen::MatrixXd& Q = questions[static_cast<std::size_t>(free)];
    if (Q.cols() == 0) continue;
    std::array<std::array<double, kRounds>, 4> times;
    for (std::size_t round = 0; round < kRounds; ++round) {
      times[0][round] = seconds([&] {
        for (Eigen::Index k = 0; k < Q.cols(); k += kBlock) {
          const Eigen::Index n = std::min<Eigen::Index>(kBlock, Q.cols() - k);
          static_cast<void>(batch.are_free(Q.middleCols(k, n), *pairs, *batch_scratch));
        }
      });
      for (std::size_t c = 0; c < checkers.size(); ++c) {
        const auto scratch = checkers[c]->make_scratch();
        times[c + 1][round] = seconds([&] {
          for (Eigen::Index k = 0; k < Q.cols(); ++k) {
            static_cast<void>(checkers[c]->is_free(Q.col(k), all, *scratch));
          }
        });
      }
    }
    std::printf("%td %s configurations\n", Q.cols(), free ? "valid" : "invalid");
    const double base = median(times[0]);
    for (std::size_t c = 0; c < times.size(); ++c) {
      const double time = median(times[c]);
      std::printf("  %-24s %10.3f us   %8.1f\n", names[c], 1e6 * time / double(Q.cols()),
                  time / base);
    }
  }
  return 0;
}
