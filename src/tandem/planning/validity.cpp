#include "tandem/planning/validity.h"

#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

#include "tandem/core/contract.h"

namespace tandem::planning {

namespace {

/// Adds the time it lives to `seconds`.
class Timer {
 public:
  explicit Timer(double& seconds) : seconds_(seconds) {}
  ~Timer() { seconds_ += std::chrono::duration<double>(Clock::now() - begin_).count(); }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  double& seconds_;
  Clock::time_point begin_ = Clock::now();
};

class SampledValidity final : public Validity {
 public:
  SampledValidity(std::function<bool(const Eigen::VectorXd&)> is_free, double resolution)
      : is_free_(std::move(is_free)), resolution_(resolution) {}

  bool state(const Eigen::VectorXd& q) override {
    const Timer timer(stats_.seconds);
    ++stats_.states;
    return is_free_(q);
  }
  const ValidityStats& stats() const override { return stats_; }

  bool edge(const Eigen::VectorXd& a, const Eigen::VectorXd& b) override {
    expects(a.size() == b.size(), "both ends of an edge have the same size");
    const Timer timer(stats_.seconds);
    ++stats_.edges;
    const double length = (b - a).lpNorm<1>();
    expects(std::isfinite(length), "the ends of an edge are finite");
    const auto n = static_cast<unsigned long>(std::max(1.0, std::ceil(length / resolution_)));
    const auto free_at = [&](unsigned long k) {
      // Both weights explicit: the same points, bit by bit, from either end.
      const double u = static_cast<double>(k) / static_cast<double>(n);
      const double v = static_cast<double>(n - k) / static_cast<double>(n);
      q_ = v * a + u * b;
      return is_free_(q_);
    };
    // Coarse to fine finds collisions early; a is tried last, for planners start from valid states.
    if (!free_at(n)) return false;
    for (unsigned long stride = std::bit_ceil(n); stride > 1; stride /= 2) {
      for (unsigned long k = stride / 2; k < n; k += stride) {
        if (!free_at(k)) return false;
      }
    }
    return free_at(0);
  }

 private:
  std::function<bool(const Eigen::VectorXd&)> is_free_;
  double resolution_;
  Eigen::VectorXd q_;
  ValidityStats stats_;
};

class CertifiedValidity final : public Validity {
 public:
  CertifiedValidity(const collision::SsvChecker& checker, world::PairSelection selection,
                    const collision::CertificateOptions& options, StopCondition stop)
      : checker_(checker),
        selection_(std::move(selection)),
        scratch_(checker.make_scratch()),
        options_(options),
        stop_(std::move(stop)) {}

  bool state(const Eigen::VectorXd& q) override {
    const Timer timer(stats_.seconds);
    ++stats_.states;
    return checker_.is_free(q, selection_, *scratch_);
  }
  const ValidityStats& stats() const override { return stats_; }

  bool edge(const Eigen::VectorXd& a, const Eigen::VectorXd& b) override {
    expects(a.size() == b.size(), "both ends of an edge have the same size");
    const Timer timer(stats_.seconds);
    ++stats_.edges;
    // One direction for both, or rounding could tell them apart.
    const bool forward = std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    const motion::StraightEdge edge =
        forward ? motion::StraightEdge(a, b) : motion::StraightEdge(b, a);
    return collision::certify(checker_, edge, selection_, *scratch_, options_, stop_).is_free();
  }
  bool holds_in_part() const override { return true; }

 private:
  const collision::SsvChecker& checker_;
  const world::PairSelection selection_;
  const std::unique_ptr<collision::CollisionChecker::Scratch> scratch_;
  collision::CertificateOptions options_;
  StopCondition stop_;
  ValidityStats stats_;
};

class BatchValidity final : public Validity {
 public:
  /// @param stats  shared by the parts of one question.
  BatchValidity(const collision::BatchChecker& checker, collision::BatchChecker::Pairs pairs,
                StopCondition stop, std::shared_ptr<ValidityStats> stats)
      : checker_(checker),
        pairs_(std::move(pairs)),
        scratch_(checker.make_scratch()),
        stop_(std::move(stop)),
        stats_(std::move(stats)) {}

  bool state(const Eigen::VectorXd& q) override {
    const Timer timer(stats_->seconds);
    ++stats_->states;
    return checker_.are_free(q, *pairs_, *scratch_);
  }
  bool edge(const Eigen::VectorXd& a, const Eigen::VectorXd& b) override {
    const Timer timer(stats_->seconds);
    ++stats_->edges;
    return checker_.is_edge_free(a, b, *pairs_, *scratch_, stop_);
  }
  bool holds_in_part() const override { return true; }
  const ValidityStats& stats() const override { return *stats_; }
  bool splits_by_arm() const override { return compiled_ != nullptr; }
  ArmQuestions* by_arm() override {
    if (!compiled_) return nullptr;
    if (!by_arm_) split();
    return &*by_arm_;
  }
  /// @param compiled  knows the pairs of the parts.
  void allow_split(const collision::CompiledCell& compiled) { compiled_ = &compiled; }

 private:
  void split();

  const collision::BatchChecker& checker_;
  const collision::BatchChecker::Pairs pairs_;
  const collision::BatchChecker::ScratchPtr scratch_;
  StopCondition stop_;
  std::shared_ptr<ValidityStats> stats_;
  const collision::CompiledCell* compiled_ = nullptr;
  std::optional<ArmQuestions> by_arm_;
};

/// Makes the questions by arm.
void BatchValidity::split() {
  const world::Workcell& cell = checker_.cell();
  const auto part = [&](const world::PairScope& scope) {
    return std::make_unique<BatchValidity>(checker_, compiled_->pairs(scope), stop_, stats_);
  };
  by_arm_.emplace();
  for (std::size_t i = 0; i < cell.arms().size(); ++i) {
    by_arm_->arms.push_back({cell.arms()[i].offset, cell.arms()[i].dof(),
                             part(world::PairScope::arm(static_cast<int>(i)))});
  }
  by_arm_->between = part(world::PairScope::several());
}

}  // namespace

std::unique_ptr<Validity> make_sampled_validity(std::function<bool(const Eigen::VectorXd&)> is_free,
                                                double resolution) {
  expects(resolution > 0, "the resolution of edges is positive");
  return std::make_unique<SampledValidity>(std::move(is_free), resolution);
}

std::unique_ptr<Validity> make_sampled_validity(const collision::CollisionChecker& checker,
                                                world::PairSelection selection, double resolution) {
  const std::shared_ptr scratch = checker.make_scratch();
  return make_sampled_validity(
      [&checker, selection = std::move(selection), scratch](const Eigen::VectorXd& q) {
        return checker.is_free(q, selection, *scratch);
      },
      resolution);
}

std::unique_ptr<Validity> make_certified_validity(const collision::SsvChecker& checker,
                                                  world::PairSelection selection,
                                                  const collision::CertificateOptions& options,
                                                  const StopCondition& stop) {
  return std::make_unique<CertifiedValidity>(checker, std::move(selection), options, stop);
}

std::unique_ptr<Validity> make_batch_validity(const collision::BatchChecker& checker,
                                              const world::PairSelection& selection,
                                              const StopCondition& stop) {
  return make_batch_validity(checker, checker.compile(selection), stop);
}

std::unique_ptr<Validity> make_batch_validity(const collision::BatchChecker& checker,
                                              collision::BatchChecker::Pairs pairs,
                                              const StopCondition& stop) {
  return std::make_unique<BatchValidity>(checker, std::move(pairs), stop,
                                         std::make_shared<ValidityStats>());
}

std::unique_ptr<Validity> make_batch_validity_by_arm(const collision::CompiledCell& cell,
                                                     const StopCondition& stop) {
  auto validity = std::make_unique<BatchValidity>(cell.batch(), cell.pairs(world::PairScope::all()),
                                                  stop, std::make_shared<ValidityStats>());
  if (cell.cell().arms().size() > 1) validity->allow_split(cell);
  return validity;
}

double l1_extent(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  expects(lower.size() == upper.size(), "limits have the same size");
  double extent = 0;
  for (Eigen::Index j = 0; j < lower.size(); ++j) {
    const double range = upper[j] - lower[j];
    extent += std::isfinite(range) ? range : 2 * std::numbers::pi;
  }
  return extent;
}

}  // namespace tandem::planning
