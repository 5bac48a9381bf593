/// Whether batches keep their word, per robot and instruction set: verdicts on random
/// configurations against the exact checker's, and dense samples of edges that were accepted.
/// Usage: agreement_study [CONFIGURATIONS [EDGES [ROBOT]]]   (per robot; default 1000000, 10000,
/// all)
///
/// Free configurations are asked about in full blocks, colliding ones in blocks of otherwise free
/// ones, so that every lane counts. Edges are sampled 32 times as densely as the paper samples its
/// own, 0.0335 rad in the sum of joint distances: by batches, and at each 32nd sample by the exact
/// checker. Exits with 1 if a verdict differs further from touching than the margin of single
/// precision, or a sample of an accepted edge collides.

#include <algorithm>

#include "cells.h"
#include "tandem/collision/batch_checker.h"

namespace {

using namespace tandem;
using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr Index kBlock = 8;
constexpr int kDensity = 32;
constexpr double kUsualResolution = 0.0335;  // [rad], L1

struct Counts {
  long configurations = 0, free = 0;
  long differ_near = 0, differ_far = 0;  ///< Within the margin of touching, and beyond.
  long edges = 0, samples = 0, colliding = 0;
};

/// Both checkers of one cell.
class Study {
 public:
  explicit Study(const bench::NamedCell& named) : named_(named) {}

  void compare_verdicts(std::uint64_t seed, long count, std::map<std::int64_t, Counts>& counts);
  void sample_edges(std::uint64_t seed, long count, std::map<std::int64_t, Counts>& counts);

 private:
  bool is_free(const Eigen::Ref<const MatrixXd>& Q) const {
    return batch_.are_free(Q, *pairs_, *scratch_);
  }
  bool is_exactly_free(const VectorXd& q) const { return exact_.is_free(q, all_, *exact_scratch_); }
  /// Counts a configuration that the batch judged by `batch_says`.
  void judge(const VectorXd& q, bool batch_says, Counts& counts) const;
  /// Asks about blocks of what the exact checker found free, or of a colliding one among them.
  void ask_block(const MatrixXd& free, const VectorXd* colliding, Index lane, Counts& counts) const;
  bool is_dense_free(const VectorXd& a, const VectorXd& b, Counts& counts) const;

  const bench::NamedCell& named_;
  collision::SsvChecker exact_{named_.cell};
  collision::BatchChecker batch_{exact_};
  world::PairSelection all_ = named_.cell->select(world::PairScope::all());
  collision::BatchChecker::Pairs pairs_ = batch_.compile(all_);
  collision::BatchChecker::ScratchPtr scratch_ = batch_.make_scratch();
  std::unique_ptr<collision::CollisionChecker::Scratch> exact_scratch_ = exact_.make_scratch();
};

void Study::judge(const VectorXd& q, bool batch_says, Counts& counts) const {
  const bool expected = is_exactly_free(q);
  if (batch_says == expected) return;
  const double distance = exact_.least_clearance(q, all_, *exact_scratch_).distance;
  if (std::abs(distance) <= batch_.margin()) {
    ++counts.differ_near;
    return;
  }
  ++counts.differ_far;
  std::printf("%s: %.3g m, exact %s, batch %s\n", named_.name.c_str(), distance,
              expected ? "free" : "touching", batch_says ? "free" : "touching");
}

void Study::ask_block(const MatrixXd& free, const VectorXd* colliding, Index lane,
                      Counts& counts) const {
  MatrixXd Q = free;
  if (colliding) Q.col(lane) = *colliding;
  const bool says = is_free(Q);
  if (says == (colliding == nullptr)) return;
  for (Index k = 0; k < Q.cols(); ++k) judge(Q.col(k), is_free(Q.col(k)), counts);
}

void Study::compare_verdicts(std::uint64_t seed, long count,
                             std::map<std::int64_t, Counts>& counts) {
  Rng rng(seed);
  const Index dof = named_.cell->dof();
  MatrixXd free(dof, kBlock), whole;  // The free ones that are gathered, and the last full block.
  Index gathered = 0;
  for (long n = 0; n < count; ++n) {
    const VectorXd q = bench::random_configuration(rng, *named_.cell);
    const bool expected = is_exactly_free(q);
    if (expected) free.col(gathered++) = q;
    for (auto& [target, of_target] : counts) {
      ++of_target.configurations;
      of_target.free += expected;
      bench::use_target(target);
      if (expected && gathered == kBlock) ask_block(free, nullptr, 0, of_target);
      if (!expected && whole.size() > 0) ask_block(whole, &q, n % kBlock, of_target);
      if (!expected && whole.size() == 0) judge(q, is_free(q), of_target);
    }
    if (gathered < kBlock) continue;
    whole = free;
    gathered = 0;
  }
  // What did not fill a block.
  for (auto& [target, of_target] : counts) {
    bench::use_target(target);
    for (Index k = 0; k < gathered; ++k) judge(free.col(k), is_free(free.col(k)), of_target);
  }
}

bool Study::is_dense_free(const VectorXd& a, const VectorXd& b, Counts& counts) const {
  const double length = (b - a).lpNorm<1>();
  const long steps = std::max(1L, std::lround(std::ceil(length * kDensity / kUsualResolution)));
  MatrixXd Q(a.size(), kBlock);
  for (long first = 0; first <= steps; first += kBlock) {
    for (Index k = 0; k < kBlock; ++k) {
      const long step = std::min(first + k, steps);
      Q.col(k) = a + static_cast<double>(step) / static_cast<double>(steps) * (b - a);
    }
    counts.samples += std::min<long>(kBlock, steps - first + 1);
    if (!is_free(Q)) return false;
    if (first % kDensity == 0 && !is_exactly_free(Q.col(0))) return false;
  }
  return true;
}

void Study::sample_edges(std::uint64_t seed, long count, std::map<std::int64_t, Counts>& counts) {
  Rng rng(seed);
  // Instruction sets take turns.
  auto turn = counts.begin();
  for (long accepted = 0; accepted < count;) {
    bench::use_target(turn->first);
    const VectorXd a = bench::random_configuration(rng, *named_.cell);
    if (!is_free(a)) continue;
    const VectorXd towards = bench::random_configuration(rng, *named_.cell) - a;
    const double length = rng.uniform(0.2, 2.0);
    const VectorXd b = a + std::min(1.0, length / towards.norm()) * towards;
    if (!batch_.is_edge_free(a, b, *pairs_, *scratch_)) continue;
    ++accepted;
    ++turn->second.edges;
    if (!is_dense_free(a, b, turn->second)) {
      ++turn->second.colliding;
      std::printf("%s: accepted edge %ld collides\n", named_.name.c_str(), accepted);
    }
    if (++turn == counts.end()) turn = counts.begin();
  }
}

struct Robot {
  std::string name;
  std::vector<bench::NamedCell> cells;
};

/// @return whether all is well.
bool run(const Robot& robot, long configurations, long edges) {
  std::map<std::int64_t, Counts> counts;
  for (const std::int64_t target : bench::targets()) counts[target] = {};
  const auto cells = static_cast<long>(robot.cells.size());
  std::uint64_t seed = 0;
  for (const bench::NamedCell& cell : robot.cells) {
    Study study(cell);
    study.compare_verdicts(++seed, (configurations + cells - 1) / cells, counts);
    study.sample_edges(seed, (edges + cells - 1) / cells, counts);
  }
  bool good = true;
  for (const auto& [target, of] : counts) {
    std::printf("%-12s %-10s %9ld %9ld %6ld %6ld | %6ld %10ld %6ld\n", robot.name.c_str(),
                hwy::TargetName(target), of.configurations, of.free, of.differ_near, of.differ_far,
                of.edges, of.samples, of.colliding);
    good = good && of.differ_far == 0 && of.colliding == 0;
  }
  std::fflush(stdout);
  bench::use_target(0);
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  const long configurations = argc > 1 ? std::atol(argv[1]) : 1000000;
  const long edges = argc > 2 ? std::atol(argv[2]) : 10000;
  if (configurations < 1 || edges < 0 || argc > 4) {
    std::fprintf(stderr, "usage: agreement_study [CONFIGURATIONS [EDGES [ROBOT]]]\n");
    return 2;
  }
  const std::vector<std::pair<std::string, std::function<std::vector<bench::NamedCell>()>>> robots{
      {"panda", [] { return bench::problem_cells("panda"); }},
      {"dual_panda",
       [] { return std::vector{bench::scenario("gearbox", "gearbox/workcell.yaml")}; }},
      {"fr3_duo", [] { return std::vector{bench::scenario("shelf", "shelf/fr3_duo.yaml")}; }},
      {"dual_ur5e", [] { return std::vector{bench::scenario("bins", "bins/dual_ur5e.yaml")}; }},
      {"baxter", [] { return bench::problem_cells("baxter"); }}};
  std::printf("%-12s %-10s %9s %9s %6s %6s | %6s %10s %6s\n", "robot", "target", "verdicts", "free",
              "near", "differ", "edges", "samples", "hit");
  bool good = true;
  for (const auto& [name, cells] : robots) {
    if (argc > 3 && name != argv[3]) continue;
    if (Robot robot{name, cells()}; !robot.cells.empty()) {
      good = run(robot, configurations, edges) && good;
    }
  }
  return good ? 0 : 1;
}
